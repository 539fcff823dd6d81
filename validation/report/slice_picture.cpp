// SPDX-License-Identifier: GPL-3.0-or-later
// Slices of the CT with region outlines. Drawn at twice the size and averaged down, which smooths outlines; labels are
// interpolated by quadratic B-splines of the regions' indicators, so that outlines do not show voxel stairs.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "model/error.hpp"
#include "model/labels.hpp"
#include "validation/report/canvas.hpp"
#include "validation/report/palette.hpp"
#include "validation/report/pictures.hpp"
#include "validation/report/slice_canvas.hpp"

namespace heartgen::report {
namespace {

constexpr int supersampling = 2;
constexpr int outline_px = 2;  // half-width of an outline, in supersampled pixels

/// Where the picture lies in space: a corner, and the steps of one pixel to the right and down.
struct Frame {
  Vec3 corner_mm, right, down;  ///< right and down in mm per supersampled pixel
  double pixel_mm = 1;          ///< of the finished picture
  int width = 0, height = 0;    ///< finished pixels
};

struct PlaneAxes {
  int normal;         ///< LPS axis
  Vec3 right, down;   ///< unit LPS directions
  const char* sides;  ///< letters left, right, top, bottom
};

PlaneAxes axes_of(SlicePlane plane) {
  switch (plane) {
    case SlicePlane::axial:
      return {2, {1, 0, 0}, {0, 1, 0}, "RLAP"};
    case SlicePlane::coronal:
      return {1, {1, 0, 0}, {0, 0, -1}, "RLSI"};
    default:
      return {0, {0, 1, 0}, {0, 0, -1}, "APSI"};
  }
}

/// The grid axis that runs nearest to a patient axis.
int nearest_grid_axis(const Grid& grid, int patient_axis) {
  int best = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(grid.direction[patient_axis][axis]) > std::abs(grid.direction[patient_axis][best])) best = axis;
  return best;
}

struct Box {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
};

Box bounds_mm(const Grid& grid) {
  Box box;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (int a = 0; a < 3; ++a)
      index[a] = ((corner >> a) & 1) ? static_cast<double>(grid.size[static_cast<std::size_t>(a)]) - 0.5 : -0.5;
    const Vec3 p = lps_from_index(grid, index);
    for (int a = 0; a < 3; ++a) box.low[a] = std::min(box.low[a], p[a]), box.high[a] = std::max(box.high[a], p[a]);
  }
  return box;
}

double slice_position_mm(const Grid& grid, int patient_axis, std::int64_t index) {
  const auto axis = static_cast<std::size_t>(nearest_grid_axis(grid, patient_axis));
  if (index < 0 || index >= grid.size[axis])
    throw UserError("slice " + std::to_string(index) + " is outside the image", "slice picture",
                    "choose 0 to " + std::to_string(grid.size[axis] - 1));
  Vec3 at;
  for (int a = 0; a < 3; ++a) at[a] = static_cast<double>(grid.size[static_cast<std::size_t>(a)] - 1) / 2;
  at[static_cast<int>(axis)] = static_cast<double>(index);
  return lps_from_index(grid, at)[patient_axis];
}

Frame place_frame(const Grid& grid, const PlaneAxes& axes, double position_mm, const SliceOptions& options) {
  const Box box = bounds_mm(grid);
  const Vec3 middle = options.center_mm ? *options.center_mm : 0.5 * (box.low + box.high);
  const Vec3 size = box.high - box.low;
  double width_mm = std::abs(dot(size, axes.right)), height_mm = std::abs(dot(size, axes.down));
  if (options.field_mm > 0) width_mm = height_mm = options.field_mm;
  Frame frame;
  frame.width = options.width_px;
  frame.pixel_mm = width_mm / options.width_px;
  frame.height = std::clamp(static_cast<int>(std::lround(height_mm / frame.pixel_mm)), 16, 4 * options.width_px);
  const double step = frame.pixel_mm / supersampling;
  frame.right = step * axes.right;
  frame.down = step * axes.down;
  Vec3 center = middle;
  center[axes.normal] = position_mm;
  frame.corner_mm = center - (0.5 * frame.width * supersampling - 0.5) * frame.right -
                    (0.5 * frame.height * supersampling - 0.5) * frame.down;
  return frame;
}

bool inside(const Grid& grid, const Vec3& index) {
  for (int a = 0; a < 3; ++a)
    if (index[a] < -0.5 || index[a] > static_cast<double>(grid.size[static_cast<std::size_t>(a)]) - 0.5) return false;
  return true;
}

/// Weights of the three voxels around a coordinate (quadratic B-spline), the middle one being `middle`.
std::array<double, 3> spline_weights(double coordinate, std::int64_t middle) {
  const double t = coordinate - static_cast<double>(middle);
  return {0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)};
}

/// The label of greatest weight around a continuous index, smoothed in the slice and nearest across it.
std::uint8_t label_at(const LabelVolume& labels, const Vec3& index, int normal_axis) {
  if (!inside(labels.grid, index)) return 0;
  std::array<std::int64_t, 3> middle{};
  for (int a = 0; a < 3; ++a)
    middle[static_cast<std::size_t>(a)] =
        std::clamp<std::int64_t>(std::lround(index[a]), 0, labels.grid.size[static_cast<std::size_t>(a)] - 1);
  const auto u = static_cast<std::size_t>((normal_axis + 1) % 3), v = static_cast<std::size_t>((normal_axis + 2) % 3);
  const auto wu = spline_weights(index[static_cast<int>(u)], middle[u]);
  const auto wv = spline_weights(index[static_cast<int>(v)], middle[v]);
  std::array<std::uint8_t, 9> names{};
  std::array<double, 9> weights{};
  std::size_t count = 0;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) {
      auto at = middle;
      at[u] = std::clamp<std::int64_t>(at[u] + static_cast<std::int64_t>(a) - 1, 0, labels.grid.size[u] - 1);
      at[v] = std::clamp<std::int64_t>(at[v] + static_cast<std::int64_t>(b) - 1, 0, labels.grid.size[v] - 1);
      const std::uint8_t label = labels(at[0], at[1], at[2]);
      const auto slot =
          static_cast<std::size_t>(std::find(names.begin(), names.begin() + count, label) - names.begin());
      if (slot == count) names[count++] = label;
      weights[slot] += wu[a] * wv[b];
    }
  return names[static_cast<std::size_t>(std::max_element(weights.begin(), weights.begin() + count) - weights.begin())];
}

Canvas draw_ct(const CtVolume* ct, const Frame& frame, const GreyWindow& window) {
  Canvas canvas(frame.width * supersampling, frame.height * supersampling, Rgb{0, 0, 0});
  if (!ct) return canvas;
  for (int y = 0; y < canvas.height; ++y)
    for (int x = 0; x < canvas.width; ++x) {
      const Vec3 index = index_from_lps(ct->grid, frame.corner_mm + double(x) * frame.right + double(y) * frame.down);
      if (!inside(ct->grid, index)) continue;
      const double hu = sample_linear(*ct, index);
      const double grey = std::clamp((hu - window.center_hu) / window.width_hu + 0.5, 0.0, 1.0) * 255;
      const auto g = static_cast<std::uint8_t>(std::lround(grey));
      canvas.pixels[canvas.at(x, y)] = {g, g, g};
    }
  return canvas;
}

std::vector<std::uint8_t> label_raster(const LabelVolume& labels, const Frame& frame, int patient_axis) {
  const int width = frame.width * supersampling, height = frame.height * supersampling;
  const int normal_axis = nearest_grid_axis(labels.grid, patient_axis);
  std::vector<std::uint8_t> raster(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::size_t at = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      raster[at++] = label_at(
          labels, index_from_lps(labels.grid, frame.corner_mm + double(x) * frame.right + double(y) * frame.down),
          normal_axis);
  return raster;
}

/// The tint over the grey image: walls and blood keep their grey structure in the region's colour, what lies around the
/// heart stays grey.
Rgb tinted(Rgb grey, std::uint8_t region) {
  const auto r = static_cast<Region>(region);
  if (!is_myocardium(r) && !is_blood(r)) return grey;
  constexpr double share = 0.26, brightest = 190;
  return mix(grey, scaled(region_color(region), grey.r / brightest), share);
}

void draw_regions(Canvas& canvas, const std::vector<std::uint8_t>& raster, bool ground_is_empty) {
  for (int y = 0; y < canvas.height; ++y)
    for (int x = 0; x < canvas.width; ++x) {
      const auto at = canvas.at(x, y);
      const std::uint8_t label = raster[at];
      if (label == 0) continue;
      bool outline = false;
      for (int dy = -outline_px; dy <= outline_px && !outline; ++dy)
        for (int dx = -outline_px; dx <= outline_px && !outline; ++dx) {
          const int nx = x + dx, ny = y + dy;
          if (dx * dx + dy * dy > outline_px * outline_px + 1 || nx < 0 || ny < 0 || nx >= canvas.width ||
              ny >= canvas.height)
            continue;
          outline = raster[canvas.at(nx, ny)] != label;
        }
      const Rgb color = region_color(label);
      canvas.pixels[at] = outline           ? color
                          : ground_is_empty ? mix(canvas.pixels[at], color, 0.55)
                                            : tinted(canvas.pixels[at], label);
    }
}

void draw_outlined_text(Canvas& canvas, const std::string& text, double x, double y, double height) {
  for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
    draw_text(canvas, text, x + dx, y + dy, height, Rgb{0, 0, 0});
  draw_text(canvas, text, x, y, height, Rgb{255, 255, 255});
}

void draw_orientation(Canvas& canvas, const PlaneAxes& axes) {
  const double h = 12, margin = 8, middle_x = canvas.width / 2.0, middle_y = (canvas.height + h) / 2.0;
  const auto letter = [&](int side) { return std::string(1, axes.sides[side]); };
  draw_outlined_text(canvas, letter(0), margin, middle_y, h);
  draw_outlined_text(canvas, letter(1), canvas.width - margin - text_width(letter(1), h), middle_y, h);
  draw_outlined_text(canvas, letter(2), middle_x - text_width(letter(2), h) / 2, margin + h, h);
  draw_outlined_text(canvas, letter(3), middle_x - text_width(letter(3), h) / 2, canvas.height - margin, h);
}

/// A bar of 1, 2, 5 or 10 cm, at most a quarter of the picture.
void draw_scale_bar(Canvas& canvas, double pixel_mm) {
  int length_mm = 10;
  for (const int candidate : {20, 50, 100})
    if (candidate / pixel_mm <= canvas.width / 4.0) length_mm = candidate;
  const double right = canvas.width - 14, left = right - length_mm / pixel_mm, y = canvas.height - 14;
  draw_line(canvas, {left, y}, {right, y}, 4.5, Rgb{0, 0, 0});
  draw_line(canvas, {left, y}, {right, y}, 2.5, Rgb{255, 255, 255});
  const std::string text = std::to_string(length_mm / 10) + " cm";
  draw_outlined_text(canvas, text, (left + right - text_width(text, 10)) / 2, y - 7, 10);
}

void draw_legend(Canvas& canvas, const std::vector<std::uint8_t>& raster) {
  std::array<std::size_t, 256> count{};
  for (const auto label : raster) ++count[label];
  double y = 12;
  for (std::size_t label = 1; label < count.size(); ++label) {
    if (count[label] == 0) continue;
    std::string name = region_name(static_cast<std::int32_t>(label));
    std::replace(name.begin(), name.end(), '_', ' ');
    fill_box(canvas, 8, y, 10, 10, region_color(static_cast<std::int32_t>(label)));
    draw_outlined_text(canvas, name, 24, y + 9, 9);
    y += 16;
  }
}

}  // namespace

SliceCanvas slice_canvas(const CtVolume* ct, const LabelVolume* labels, SlicePlane plane, std::int64_t index,
                         const SliceOptions& options) {
  if (!ct && !labels) throw UserError("neither an image nor labels to draw", "slice picture", "give one of them");
  const Grid& grid = ct ? ct->grid : labels->grid;
  const PlaneAxes axes = axes_of(plane);
  const Frame frame = place_frame(grid, axes, slice_position_mm(grid, axes.normal, index), options);
  Canvas large = draw_ct(ct, frame, options.window);
  std::vector<std::uint8_t> raster;
  if (labels) {
    raster = label_raster(*labels, frame, axes.normal);
    draw_regions(large, raster, ct == nullptr);
  }
  Canvas picture = downsampled(large, supersampling);
  draw_orientation(picture, axes);
  draw_scale_bar(picture, frame.pixel_mm);
  if (options.legend && labels) draw_legend(picture, raster);
  const Vec3 first = frame.corner_mm + (0.5 * (supersampling - 1)) * (frame.right + frame.down);
  return {std::move(picture), first, axes.right, axes.down, frame.pixel_mm};
}

PngBytes slice_picture(const CtVolume* ct, const LabelVolume* labels, SlicePlane plane, std::int64_t index,
                       const SliceOptions& options) {
  return encode_png(slice_canvas(ct, labels, plane, index, options).canvas);
}

}  // namespace heartgen::report
