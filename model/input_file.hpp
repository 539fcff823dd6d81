// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A file that is to be read.
#pragma once
#include <filesystem>

namespace heartgen {

/// Whatever reads a file that a user or another file names calls this first. Throws UserError where there is none,
/// where it is a folder, a pipe or a device (which may have no end), and where there is no right to read it.
void require_input_file(const std::filesystem::path& path, const char* remedy = "check the path");

}  // namespace heartgen
