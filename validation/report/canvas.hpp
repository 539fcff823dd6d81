// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A small RGB picture to draw on: lines, text and PNG output. Integer pixels, origin at the top left; lines and text
/// take continuous coordinates with pixel centres at .5 and are anti-aliased.
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

namespace heartgen::report {

struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

struct Point2 {
  double x = 0, y = 0;
};

struct Canvas {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;  ///< width * height, row by row from the top

  Canvas(int width_px, int height_px, Rgb ground)
      : width(width_px),
        height(height_px),
        pixels(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), ground) {}
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// (1 - share) * under + share * over, per channel.
Rgb mix(Rgb under, Rgb over, double share);
Rgb scaled(Rgb color, double factor);

/// A straight line with round ends.
void draw_line(Canvas& canvas, Point2 from, Point2 to, double width_px, Rgb color, double opacity = 1);
void fill_box(Canvas& canvas, double x, double y, double width, double height, Rgb color, double opacity = 1);

/// Text in a plain stroke font; `left` and `baseline` place it, `height_px` is the height of a capital letter.
/// Characters outside the font (ASCII letters, digits, " -_.,:/()+%°") are drawn as a space.
void draw_text(Canvas& canvas, std::string_view text, double left, double baseline, double height_px, Rgb color);
double text_width(std::string_view text, double height_px);

/// Mean over blocks of factor × factor pixels; the sides must be multiples of `factor`.
Canvas downsampled(const Canvas& canvas, int factor);

/// The picture as a PNG file (8 bit RGB).
std::vector<std::uint8_t> encode_png(const Canvas& canvas);

}  // namespace heartgen::report
