// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/canvas.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "model/contract.hpp"
#include "validation/report/stroke_font.hpp"

namespace heartgen::report {
namespace {

std::uint8_t channel(double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))); }

int base36(char c) { return c <= '9' ? c - '0' : c - 'a' + 10; }

double distance_to_segment(Point2 p, Point2 a, Point2 b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0;
  const double ex = p.x - a.x - t * dx, ey = p.y - a.y - t * dy;
  return std::sqrt(ex * ex + ey * ey);
}

/// Glyph width in font units.
int glyph_width(unsigned char character) {
  const auto strokes = glyph_strokes(character);
  if (strokes.empty()) return 4;
  int widest = 0;
  for (std::size_t i = 0; i + 1 < strokes.size();) {
    if (strokes[i] == '|') {
      ++i;
      continue;
    }
    widest = std::max(widest, base36(strokes[i]));
    i += 2;
  }
  return widest;
}

constexpr double glyph_gap = 3.6;  // font units between glyphs
constexpr double cap_height = 12;

/// The font's bytes of UTF-8 text: the degree sign becomes its one byte, underscores stay.
std::string font_text(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (static_cast<unsigned char>(text[i]) == 0xC2 && i + 1 < text.size()) continue;
    bytes += text[i];
  }
  return bytes;
}

void append_png(png_structp png, png_bytep data, png_size_t length) {
  auto* bytes = static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  bytes->insert(bytes->end(), data, data + length);
}

}  // namespace

Rgb mix(Rgb under, Rgb over, double share) {
  const auto blend = [share](std::uint8_t a, std::uint8_t b) {
    return channel(a + share * (static_cast<double>(b) - a));
  };
  return {blend(under.r, over.r), blend(under.g, over.g), blend(under.b, over.b)};
}

Rgb scaled(Rgb color, double factor) {
  return {channel(color.r * factor), channel(color.g * factor), channel(color.b * factor)};
}

void draw_line(Canvas& canvas, Point2 from, Point2 to, double width_px, Rgb color, double opacity) {
  const double reach = width_px / 2 + 1;
  const auto first = [](double v) { return std::max(0, static_cast<int>(std::floor(v))); };
  const int x0 = first(std::min(from.x, to.x) - reach), y0 = first(std::min(from.y, to.y) - reach);
  const int x1 = std::min(canvas.width - 1, static_cast<int>(std::ceil(std::max(from.x, to.x) + reach)));
  const int y1 = std::min(canvas.height - 1, static_cast<int>(std::ceil(std::max(from.y, to.y) + reach)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double d = distance_to_segment({x + 0.5, y + 0.5}, from, to);
      const double cover = std::clamp(width_px / 2 + 0.5 - d, 0.0, 1.0) * opacity;
      if (cover > 0) canvas.pixels[canvas.at(x, y)] = mix(canvas.pixels[canvas.at(x, y)], color, cover);
    }
}

void fill_box(Canvas& canvas, double x, double y, double width, double height, Rgb color, double opacity) {
  const int x0 = std::max(0, static_cast<int>(x)), y0 = std::max(0, static_cast<int>(y));
  const int x1 = std::min(canvas.width, static_cast<int>(x + width));
  const int y1 = std::min(canvas.height, static_cast<int>(y + height));
  for (int row = y0; row < y1; ++row)
    for (int column = x0; column < x1; ++column)
      canvas.pixels[canvas.at(column, row)] = mix(canvas.pixels[canvas.at(column, row)], color, opacity);
}

void draw_text(Canvas& canvas, std::string_view text, double left, double baseline, double height_px, Rgb color) {
  const double unit = height_px / cap_height;
  const double stroke = std::max(1.1, height_px / 8);
  double x = left;
  for (const char c : font_text(text)) {
    const auto strokes = glyph_strokes(static_cast<unsigned char>(c));
    bool pen_down = false;
    Point2 pen;
    for (std::size_t i = 0; i + 1 < strokes.size();) {
      if (strokes[i] == '|') {
        pen_down = false;
        ++i;
        continue;
      }
      const Point2 next{x + unit * base36(strokes[i]), baseline + unit * (base36(strokes[i + 1]) - cap_height)};
      if (pen_down) draw_line(canvas, pen, next, stroke, color);
      pen = next;
      pen_down = true;
      i += 2;
    }
    x += unit * (glyph_width(static_cast<unsigned char>(c)) + glyph_gap);
  }
}

double text_width(std::string_view text, double height_px) {
  double units = 0;
  for (const char c : font_text(text)) units += glyph_width(static_cast<unsigned char>(c)) + glyph_gap;
  return units > 0 ? (units - glyph_gap) * height_px / cap_height : 0;
}

Canvas downsampled(const Canvas& canvas, int factor) {
  HEARTGEN_EXPECTS(factor > 0 && canvas.width % factor == 0 && canvas.height % factor == 0);
  Canvas small(canvas.width / factor, canvas.height / factor, Rgb{});
  const int area = factor * factor;
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x) {
      int r = area / 2, g = area / 2, b = area / 2;
      for (int sy = 0; sy < factor; ++sy)
        for (int sx = 0; sx < factor; ++sx) {
          const Rgb p = canvas.pixels[canvas.at(x * factor + sx, y * factor + sy)];
          r += p.r, g += p.g, b += p.b;
        }
      small.pixels[small.at(x, y)] = {static_cast<std::uint8_t>(r / area), static_cast<std::uint8_t>(g / area),
                                      static_cast<std::uint8_t>(b / area)};
    }
  return small;
}

std::vector<std::uint8_t> encode_png(const Canvas& canvas) {
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint8_t> row(static_cast<std::size_t>(canvas.width) * 3);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    throw std::runtime_error("libpng refused to encode a picture");
  }
  png_set_write_fn(png, &bytes, append_png, nullptr);
  png_set_compression_level(png, 7);
  png_set_IHDR(png, info, static_cast<png_uint_32>(canvas.width), static_cast<png_uint_32>(canvas.height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (int y = 0; y < canvas.height; ++y) {
    for (int x = 0; x < canvas.width; ++x) {
      const Rgb p = canvas.pixels[canvas.at(x, y)];
      const auto i = static_cast<std::size_t>(x) * 3;
      row[i] = p.r, row[i + 1] = p.g, row[i + 2] = p.b;
    }
    png_write_row(png, row.data());
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

}  // namespace heartgen::report
