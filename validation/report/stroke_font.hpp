// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The letters of the pictures as strokes.
#pragma once
#include <string_view>

namespace heartgen::report {

/// Strokes of a character: points as two characters each, x then y, in base 36; strokes are separated by '|'. Capitals
/// span y = 0 .. 12 (the baseline), small letters 4 .. 12, tails reach to 16. Empty for a space or an unknown
/// character. The degree sign is U+00B0, one byte 0xB0 in this font.
std::string_view glyph_strokes(unsigned char character);

}  // namespace heartgen::report
