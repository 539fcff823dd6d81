// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the certificate's words mean, one or two sentences each.
#pragma once
#include <string>
#include <string_view>

namespace heartgen::report {

/// Of a row's metric ("dihedral_min", "to_labels_p99_in_edges"); empty where nothing is known of it.
std::string meaning_of(std::string_view metric);

}  // namespace heartgen::report
