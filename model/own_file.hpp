// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Where the code that runs was loaded from.
#pragma once
#include <filesystem>

namespace heartgen {

/// The file of the shared library that holds this function; of a program /proc/self/exe, which can be read even where
/// another file has taken its place.
std::filesystem::path own_file();

}  // namespace heartgen
