#include "validation/raster.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace heart::validation {
namespace {

Vec3 light_direction(const Camera& camera) {
  return normalized(-0.35 * camera.right + 0.55 * camera.up + 0.9 * camera.toward);
}

/// Two-sided Lambert light from the upper left, a weak fill, and a small highlight.
double light(const Camera& camera, const Vec3& normal) {
  const double facing = dot(normal, camera.toward);
  const Vec3 n = facing < 0 ? -normal : normal;
  const Vec3 key = light_direction(camera);
  const double lambert = std::max(0.0, dot(n, key));
  const double fill = std::max(0.0, dot(n, camera.toward));
  return 0.4 + 0.42 * lambert + 0.24 * fill;
}

double highlight(const Camera& camera, const Vec3& normal) {
  const Vec3 n = dot(normal, camera.toward) < 0 ? -normal : normal;
  const double s = std::max(0.0, dot(n, normalized(light_direction(camera) + camera.toward)));
  const double s2 = s * s, s4 = s2 * s2, s8 = s4 * s4;
  return 0.16 * s8 * s8 * s8;
}

double signed_area(const ScreenPoint& a, const ScreenPoint& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

double edge_length(const ScreenPoint& a, const ScreenPoint& b) {
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
}

Rgb blended(const std::array<Rgb, 3>& c, const std::array<double, 3>& w) {
  const auto channel = [&](auto member) {
    const double v = w[0] * (c[0].*member) + w[1] * (c[1].*member) + w[2] * (c[2].*member);
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 255.0)));
  };
  return {channel(&Rgb::r), channel(&Rgb::g), channel(&Rgb::b)};
}

}  // namespace

Camera camera_for(View view, const std::vector<Vec3>& shown_mm, int width, int height) {
  Camera c;
  c.width = width, c.height = height;
  switch (view) {
    case View::front:
      c.right = {1, 0, 0}, c.up = {0, 0, 1}, c.toward = {0, -1, 0}, c.sides = {"R", "L", "S", "I"};
      break;
    case View::back:
      c.right = {-1, 0, 0}, c.up = {0, 0, 1}, c.toward = {0, 1, 0}, c.sides = {"L", "R", "S", "I"};
      break;
    case View::left:
      c.right = {0, 1, 0}, c.up = {0, 0, 1}, c.toward = {1, 0, 0}, c.sides = {"A", "P", "S", "I"};
      break;
    case View::below:
      c.right = {1, 0, 0}, c.up = {0, -1, 0}, c.toward = {0, 0, -1}, c.sides = {"R", "L", "A", "P"};
      break;
  }
  fit_camera(c, shown_mm);
  return c;
}

void fit_camera(Camera& c, const std::vector<Vec3>& shown_mm) {
  if (shown_mm.empty()) return;
  const std::array<Vec3, 3> axes = {c.right, c.up, c.toward};
  std::array<double, 3> low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const Vec3& p : shown_mm)
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], dot(p, axes[a]));
      high[a] = std::max(high[a], dot(p, axes[a]));
    }
  c.center_mm = {};
  for (std::size_t a = 0; a < 3; ++a) c.center_mm += 0.5 * (low[a] + high[a]) * axes[a];
  constexpr double filled = 0.87;
  c.pixels_per_mm =
      filled * std::min(c.width / std::max(1.0, high[0] - low[0]), c.height / std::max(1.0, high[1] - low[1]));
}

ScreenPoint project(const Camera& camera, const Vec3& p) {
  const Vec3 d = p - camera.center_mm;
  return {camera.width / 2.0 + camera.pixels_per_mm * dot(d, camera.right),
          camera.height / 2.0 - camera.pixels_per_mm * dot(d, camera.up), dot(d, camera.toward)};
}

void rasterize(Layer& layer, const Camera& camera, const Triangle& t) {
  const auto& [a, b, c] = t.corner;
  const double area = signed_area(a, b, c.x, c.y);
  if (area == 0) return;
  const int x0 = std::max(0, static_cast<int>(std::floor(std::min({a.x, b.x, c.x}))));
  const int y0 = std::max(0, static_cast<int>(std::floor(std::min({a.y, b.y, c.y}))));
  const int x1 = std::min(layer.canvas.width - 1, static_cast<int>(std::ceil(std::max({a.x, b.x, c.x}))));
  const int y1 = std::min(layer.canvas.height - 1, static_cast<int>(std::ceil(std::max({a.y, b.y, c.y}))));
  const std::array<double, 3> heights = {std::abs(area) / std::max(1e-9, edge_length(b, c)),
                                         std::abs(area) / std::max(1e-9, edge_length(c, a)),
                                         std::abs(area) / std::max(1e-9, edge_length(a, b))};
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double px = x + 0.5, py = y + 0.5;
      const std::array<double, 3> w = {signed_area(b, c, px, py) / area, signed_area(c, a, px, py) / area,
                                       signed_area(a, b, px, py) / area};
      if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
      const double depth = w[0] * a.depth + w[1] * b.depth + w[2] * c.depth;
      const auto at = layer.canvas.at(x, y);
      if (depth <= layer.depth[at]) continue;
      const Vec3 normal = normalized(w[0] * t.normal[0] + w[1] * t.normal[1] + w[2] * t.normal[2]);
      Rgb color = scaled(blended(t.color, w), light(camera, normal));
      color = mix(color, Rgb{255, 255, 255}, highlight(camera, normal));
      const double to_edge = std::min({w[0] * heights[0], w[1] * heights[1], w[2] * heights[2]});
      color = mix(color, Rgb{30, 24, 28}, t.edge_opacity * std::clamp(1.4 - to_edge, 0.0, 1.0));
      layer.canvas.pixels[at] = color;
      layer.depth[at] = depth;
      layer.facing[at] = static_cast<float>(std::abs(dot(normal, camera.toward)));
    }
}

namespace {

/// Share of the surroundings (12 directions, two radii) that rises above a pixel and hides it from the light.
double hidden_share(const Layer& layer, int x, int y, double radius_px) {
  constexpr int directions = 12, rings = 2;
  // Unit offsets on a circle, written out so that no library's cosine decides on pixels.
  constexpr double c30 = 0.8660254037844386;
  constexpr double ux[directions] = {1, c30, .5, 0, -.5, -c30, -1, -c30, -.5, 0, .5, c30};
  constexpr double uy[directions] = {0, .5, c30, 1, c30, .5, 0, -.5, -c30, -1, -c30, -.5};
  constexpr double least_mm = 0.6, full_mm = 4.6;  // rises that begin to hide, and that hide altogether
  const double here = layer.depth[layer.canvas.at(x, y)];
  double hidden = 0;
  for (int ring = 1; ring <= rings; ++ring)
    for (int k = 0; k < directions; ++k) {
      const double r = radius_px * ring / rings;
      const int nx = x + static_cast<int>(std::lround(r * ux[k])), ny = y + static_cast<int>(std::lround(r * uy[k]));
      if (nx < 0 || ny < 0 || nx >= layer.canvas.width || ny >= layer.canvas.height) continue;
      const double rise = layer.depth[layer.canvas.at(nx, ny)] - here;
      hidden += std::clamp((rise - least_mm) / (full_mm - least_mm), 0.0, 1.0);
    }
  return hidden / (directions * rings);
}

}  // namespace

void shade_depth(Layer& layer, const Camera& camera) {
  constexpr double radius_mm = 5, darkest = 0.62;
  constexpr int block = 2;  // one measurement per block of pixels
  for (int y = 0; y < layer.canvas.height; y += block)
    for (int x = 0; x < layer.canvas.width; x += block) {
      if (layer.depth[layer.canvas.at(x, y)] < -1e299) continue;
      const double light = 1 - darkest * hidden_share(layer, x, y, radius_mm * camera.pixels_per_mm);
      for (int by = y; by < std::min(y + block, layer.canvas.height); ++by)
        for (int bx = x; bx < std::min(x + block, layer.canvas.width); ++bx) {
          const auto at = layer.canvas.at(bx, by);
          if (layer.depth[at] > -1e299) layer.canvas.pixels[at] = scaled(layer.canvas.pixels[at], light);
        }
    }
}

void annotate(Canvas& canvas, const Camera& camera, double pixels_per_mm, Rgb ink) {
  const double h = 11, margin = 9;
  const auto letter = [&](std::size_t side) { return camera.sides[side]; };
  const double middle_x = canvas.width / 2.0, middle_y = (canvas.height + h) / 2.0;
  draw_text(canvas, letter(0), margin, middle_y, h, ink);
  draw_text(canvas, letter(1), canvas.width - margin - text_width(letter(1), h), middle_y, h, ink);
  draw_text(canvas, letter(2), middle_x - text_width(letter(2), h) / 2, margin + h, h, ink);
  draw_text(canvas, letter(3), middle_x - text_width(letter(3), h) / 2, canvas.height - margin, h, ink);
  int length_mm = 10;
  for (const int candidate : {20, 50, 100})
    if (candidate * pixels_per_mm <= canvas.width / 4.0) length_mm = candidate;
  const double right = canvas.width - 14, left = right - length_mm * pixels_per_mm, y = canvas.height - 14;
  draw_line(canvas, {left, y}, {right, y}, 2, ink);
  const std::string text = std::to_string(length_mm / 10) + " cm";
  draw_text(canvas, text, (left + right - text_width(text, 9)) / 2, y - 7, 9, ink);
}

}  // namespace heart::validation
