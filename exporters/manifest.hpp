// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// manifest.json: made from a bundle, written, read, checked against itself.
#pragma once
#include <string>
#include <vector>

#include "exporters/bundle.hpp"

namespace heartgen::exporters {

inline constexpr const char* bundle_schema = "heartgen-bundle-2";
inline constexpr const char* first_bundle_schema = "heartgen-bundle-1";  ///< its content id covers the files alone

/// Files that the manifest lists and the content id covers: all but the manifest and the logs, `logs/NAME.log`.
bool is_covered(const std::string& path);

/// SHA-256 of the manifest's canonical text without `content_id`, `inputs` and `tools`: the model and its files,
/// whatever they were made from and by. Of the first schema: over the sorted lines "path sha256\n".
std::string content_id(const Manifest& manifest);

/// The files below `folder` that the content id covers, hashed, sorted by path.
std::vector<ManifestFile> hash_files(const std::filesystem::path& folder);

/// Everything but `files` and `content_id`.
Manifest describe_bundle(const Bundle& bundle);

/// Canonical text: sorted keys, two spaces; `manifest_sha256` is the hash of the same text without that key.
std::string manifest_text(const Manifest& manifest);

/// Throws UserError (where = `path`) for anything that manifest_text would not have written, byte for byte.
Manifest parse_manifest(const std::string& text, const std::string& path);

}  // namespace heartgen::exporters
