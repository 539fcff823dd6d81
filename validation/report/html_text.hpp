// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Text into HTML: escaping and base64.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace heartgen::report {

/// & < > " ' as entities; control characters other than line ends become spaces.
std::string escaped(std::string_view text);
std::string base64(const void* data, std::size_t bytes);
/// An \<img> source with the picture inside.
std::string png_source(const std::vector<std::uint8_t>& png);

}  // namespace heartgen::report
