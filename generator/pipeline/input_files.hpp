// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Files that go into a build, as the cache and the manifest know them.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "exporters/bundle.hpp"

namespace heartgen::pipeline {

/// The files that are read when the user names `path`, sorted: itself; every file of a folder; with a header (.mhd,
/// .nhdr, .hdr) the files that hold its voxels, with .exnode its .exelem and the other way round. Only those that
/// exist.
std::vector<std::filesystem::path> files_behind(const std::filesystem::path& path);

/// SHA-256 of a file, or of the list of several files' names and hashes; and the total size.
exporters::BundleInput hash_input(const std::string& role, const std::string& path);

}  // namespace heartgen::pipeline
