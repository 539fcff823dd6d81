// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/landmarks_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "validation/report/slice_canvas.hpp"

namespace heartgen::pipeline {
namespace {

using report::Canvas;
using report::Point2;
using report::Rgb;
using report::SliceCanvas;
using report::SlicePlane;

constexpr Rgb white{255, 255, 255}, yellow{255, 225, 60};
constexpr double text_px = 9;

Vec3 middle_of(const Landmarks& landmarks) {
  Vec3 sum;
  double count = 0;
  for (const char* chamber : {"lv_blood", "rv_blood", "la_blood", "ra_blood"})
    if (const auto seed = landmarks.seeds_mm.find(chamber); seed != landmarks.seeds_mm.end()) {
      sum += seed->second;
      ++count;
    }
  return count > 0 ? sum / count : sum;
}

/// Which voxel along the grid axis nearest to a patient axis holds the point, at most the last.
std::int64_t slice_through(const Grid& grid, int patient_axis, const Vec3& lps_mm) {
  int axis = 0;
  for (int other = 1; other < 3; ++other)
    if (std::abs(grid.direction[patient_axis][other]) > std::abs(grid.direction[patient_axis][axis])) axis = other;
  const auto last = grid.size[static_cast<std::size_t>(axis)] - 1;
  return std::clamp<std::int64_t>(std::llround(index_from_lps(grid, lps_mm)[axis]), 0, last);
}

/// With the distance from the slice, where that is more than the chambers' outlines show.
void draw_seed(SliceCanvas& slice, const std::string& name, const Vec3& seed) {
  constexpr double half_px = 4, picture_slab_mm = 40;
  if (std::abs(slice.off_mm(seed)) > picture_slab_mm) return;
  const Point2 at = slice.at(seed);
  report::draw_line(slice.canvas, {at.x - half_px, at.y}, {at.x + half_px, at.y}, 1.5, white);
  report::draw_line(slice.canvas, {at.x, at.y - half_px}, {at.x, at.y + half_px}, 1.5, white);
  report::draw_text(slice.canvas, name, at.x + half_px + 2, at.y - 2, text_px, white);
}

/// The line in which a disc and the slice's plane cut each other.
void draw_valve(SliceCanvas& slice, const std::string& name, const ValvePlane& valve) {
  const Vec3 normal = cross(slice.right, slice.down), along = cross(normal, valve.normal);
  const double off = slice.off_mm(valve.center_mm), sine = norm(along);
  if (sine < 0.1) return;                                        // the disc lies in the slice
  const Vec3 towards = (1 / sine) * cross(along, valve.normal);  // in the disc, to the slice; its length is 1
  const double step = -off / dot(towards, normal);
  if (std::abs(step) > valve.radius_mm) return;
  const Vec3 middle = valve.center_mm + step * towards;
  const double half = std::sqrt(valve.radius_mm * valve.radius_mm - step * step) / sine;
  const Point2 from = slice.at(middle - half * along), to = slice.at(middle + half * along);
  report::draw_line(slice.canvas, from, to, 2, yellow);
  report::draw_text(slice.canvas, name, to.x + 3, to.y, text_px, yellow);
}

SliceCanvas draw_slice(const CtVolume& ct, const landmarks::SearchResult& result, SlicePlane plane, int axis) {
  constexpr int side_px = 480;
  constexpr double picture_field_mm = 230;
  const Vec3 middle = middle_of(result.found.landmarks);
  report::SliceOptions options;
  options.width_px = side_px;
  options.center_mm = middle;
  options.field_mm = picture_field_mm;
  options.legend = plane == SlicePlane::axial;
  auto slice = report::slice_canvas(&ct, &result.chambers, plane, slice_through(ct.grid, axis, middle), options);
  for (const auto& [name, valve] : result.found.landmarks.valves) draw_valve(slice, name, valve);
  for (const auto& [name, seed] : result.found.landmarks.seeds_mm) draw_seed(slice, name, seed);
  return slice;
}

void paste_at(const Canvas& part, int left, Canvas& whole) {
  for (int y = 0; y < std::min(part.height, whole.height); ++y)
    std::copy_n(part.pixels.begin() + static_cast<std::ptrdiff_t>(part.at(0, y)), part.width,
                whole.pixels.begin() + static_cast<std::ptrdiff_t>(whole.at(left, y)));
}

}  // namespace

std::vector<std::uint8_t> landmarks_picture(const CtVolume& ct, const landmarks::SearchResult& result) {
  const std::array slices = {draw_slice(ct, result, SlicePlane::axial, 2),
                             draw_slice(ct, result, SlicePlane::coronal, 1),
                             draw_slice(ct, result, SlicePlane::sagittal, 0)};
  constexpr int gap_px = 6;
  int width = -gap_px, height = 0;
  for (const auto& slice : slices) {
    width += slice.canvas.width + gap_px;
    height = std::max(height, slice.canvas.height);
  }
  Canvas whole(width, height, white);
  int left = 0;
  for (const auto& slice : slices) {
    paste_at(slice.canvas, left, whole);
    left += slice.canvas.width + gap_px;
  }
  return report::encode_png(whole);
}

}  // namespace heartgen::pipeline
