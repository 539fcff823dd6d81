// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Where the code that runs was loaded from.
#pragma once
#include <filesystem>

namespace heartgen {

/// The file of the program, or of the shared library, that holds this function.
std::filesystem::path own_file();

}  // namespace heartgen
