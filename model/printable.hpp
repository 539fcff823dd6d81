// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Text from files, for terminals and pages.
#pragma once
#include <string>
#include <string_view>

namespace heartgen {

/// The text with a '?' for every control character but newline and tab: what a file holds may otherwise steer the
/// terminal that it is printed on. UTF-8 stays as it is, but for its own control characters, U+0080 to U+009F.
std::string printable(std::string_view text);

/// Whether printable changes nothing.
bool is_printable(std::string_view text);

}  // namespace heartgen
