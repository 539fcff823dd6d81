// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The texts of a bundle that people and catalogues read. All are functions of the bundle's content alone.
#pragma once
#include <string>
#include <vector>

#include "exporters/bundle.hpp"

namespace heartgen::exporters {

/// README.md: files, frame, units, arrays, tags, loading, licence, atlas.
std::string readme_text(const Manifest& manifest);

/// LICENSE: identifier, owner and where the full text stands.
std::string license_text(const Manifest& manifest);

/// CITATION.cff, format 1.2.0.
std::string citation_text(const Manifest& manifest);

/// ro-crate-metadata.json, RO-Crate 1.1; `files` are the files of the bundle written so far.
std::string ro_crate_text(const Manifest& manifest, const std::vector<ManifestFile>& files);

}  // namespace heartgen::exporters
