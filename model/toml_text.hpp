// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The text of a TOML file, looked at before a parser that goes one call deeper for every table within a table.
#pragma once
#include <string>

namespace heartgen {

/// Throws UserError for a file that cannot be read, is larger than 4 MiB, or has keys of more than 16 parts (a.b.c has
/// three) or values nested more than 64 deep.
std::string checked_toml(const std::string& path);

}  // namespace heartgen
