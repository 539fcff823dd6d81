// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Words and numbers as text, the same in every locale.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace heartgen {

/// The candidate with the smallest edit distance to `word`, for "did you mean ...?"; empty without candidates.
std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates);

/// Shortest text that reads back as the same double, always with a '.' or an exponent ("2.0", "0.35", "1e-07").
std::string number_text(double value);

/// The number that a text holds, whole. Throws UserError naming `where`.
double parse_number(std::string_view text, const std::string& where);

/// Before long work whose result goes to the file `path`. Throws UserError when nothing can be written there, or when
/// `path` is a folder; changes nothing.
void check_output(const std::filesystem::path& path);

/// Whether a path is a folder or leads into it, links followed as far as they exist.
bool lies_in(const std::filesystem::path& path, const std::filesystem::path& folder);

/// What writes the file `path` calls this first: makes the folder it is in. Throws UserError when it cannot.
void make_folder_of(const std::filesystem::path& path);

/// Writes a text file, byte for byte; makes the folder. Throws UserError when it cannot (also when the disk is full).
void write_text(const std::filesystem::path& path, std::string_view text);

}  // namespace heartgen
