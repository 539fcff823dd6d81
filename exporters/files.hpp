// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Small helpers around whole files and paths inside a bundle.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace heartgen::exporters {

/// Throws UserError when the file is missing or cannot be read.
std::string read_text(const std::filesystem::path& path);

/// Throws UserError where there is no such folder, and tells of a bundle that a stopped run left aside.
void require_bundle_folder(const std::filesystem::path& folder);

/// The name, which becomes part of a file's name. Throws UserError where the file would then lie elsewhere.
const std::string& in_file_name(const std::string& name);

/// Relative, without empty, "." or ".." parts, back slashes or control characters: it cannot leave its folder.
bool is_safe_path(const std::string& path);

/// Paths (relative, '/', sorted by bytes) of everything below `folder` that is not a folder; links are listed as
/// themselves and not followed.
std::vector<std::string> files_below(const std::filesystem::path& folder);

/// The folder's path without a trailing slash, and the hidden sibling "."NAME"."suffix where it is prepared.
std::filesystem::path plain_path(const std::filesystem::path& folder);
std::filesystem::path hidden_sibling(const std::filesystem::path& folder, const std::string& suffix);

}  // namespace heartgen::exporters
