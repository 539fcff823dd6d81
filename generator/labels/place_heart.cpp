// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/place_heart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"
#include "model/priors.hpp"

namespace heartgen::labels {
namespace {

constexpr std::array chambers{Region::lv_blood, Region::rv_blood, Region::la_blood, Region::ra_blood};

bool belongs_to_heart(std::uint8_t label) {
  return is_myocardium(static_cast<Region>(label)) || is_blood(static_cast<Region>(label));
}

/// Middle of a region, LPS mm.
std::optional<Vec3> middle_of(const LabelVolume& labels, Region region) {
  Vec3 sum;
  double count = 0;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < labels.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < labels.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < labels.grid.size[0]; ++i, ++v)
        if (labels.voxels[v] == tag(region)) {
          sum += Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          ++count;
        }
  if (count == 0) return std::nullopt;
  return lps_from_index(labels.grid, sum / count);
}

/// Whether points lie on a line, or nearly: then rotation about it is open.
bool on_one_line(const std::vector<CommonMark>& marks) {
  const Vec3 start = marks[0].heart_mm;
  Vec3 along;
  for (const auto& mark : marks)
    if (norm(mark.heart_mm - start) > norm(along)) along = mark.heart_mm - start;
  const Vec3 way = normalized(along);
  return std::all_of(marks.begin(), marks.end(), [&](const CommonMark& mark) {
    return norm(cross(way, mark.heart_mm - start)) < priors::marks_width_min_mm;
  });
}

/// Corners of a grid's field of view.
std::array<Vec3, 8> corners_of(const Grid& grid) {
  std::array<Vec3, 8> corners;
  for (int c = 0; c < 8; ++c) {
    Vec3 index;
    for (int axis = 0; axis < 3; ++axis)
      index[axis] = (c >> axis) & 1 ? static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5 : -0.5;
    corners[static_cast<std::size_t>(c)] = lps_from_index(grid, index);
  }
  return corners;
}

/// A grid continued by whole voxels; `first` is its first voxel in the old one's numbers.
struct LargerGrid {
  Grid grid;
  Index3 first{0, 0, 0};
};

LargerGrid continued(const Grid& grid, const std::array<Vec3, 8>& points_mm) {
  Index3 low{0, 0, 0}, high;
  for (std::size_t a = 0; a < 3; ++a) high[a] = grid.size[a] - 1;
  for (const auto& p : points_mm) {
    const Vec3 index = index_from_lps(grid, p);
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      low[a] = std::min(low[a], static_cast<std::int64_t>(std::floor(index[axis])));
      high[a] = std::max(high[a], static_cast<std::int64_t>(std::ceil(index[axis])));
    }
  }
  LargerGrid larger{grid, low};
  for (std::size_t a = 0; a < 3; ++a) larger.grid.size[a] = high[a] - low[a] + 1;
  larger.grid.origin_mm =
      lps_from_index(grid, {static_cast<double>(low[0]), static_cast<double>(low[1]), static_cast<double>(low[2])});
  return larger;
}

std::uint8_t nearest_label(const LabelVolume& labels, const Vec3& lps_mm) {
  const Vec3 index = index_from_lps(labels.grid, lps_mm);
  const std::int64_t i = std::llround(index.x), j = std::llround(index.y), k = std::llround(index.z);
  return labels.grid.contains(i, j, k) ? labels(i, j, k) : std::uint8_t{0};
}

}  // namespace

std::vector<CommonMark> common_marks(const LabelVolume& heart, const Landmarks& heart_landmarks,
                                     const LabelVolume& torso, const Landmarks& torso_landmarks) {
  std::vector<CommonMark> marks;
  for (const Region chamber : chambers) {
    const auto here = middle_of(heart, chamber), there = middle_of(torso, chamber);
    if (here && there) marks.push_back({region_name(tag(chamber)), *here, *there});
  }
  for (const auto& [name, valve] : heart_landmarks.valves) {
    const auto other = torso_landmarks.valves.find(name);
    if (other != torso_landmarks.valves.end())
      marks.push_back({name + " valve", valve.center_mm, other->second.center_mm});
  }
  if (heart_landmarks.lv_apex_mm && torso_landmarks.lv_apex_mm)
    marks.push_back({"apex", *heart_landmarks.lv_apex_mm, *torso_landmarks.lv_apex_mm});
  if (marks.size() < 3 || on_one_line(marks))
    throw UserError(
        fmt::format("the heart and the torso have {} marks in common, too few or on one line", marks.size()),
        "landmarks", "give valve centres and the apex for both");
  return marks;
}

TorsoPose fit_torso(const std::vector<CommonMark>& marks, bool with_scale) {
  std::vector<Vec3> from, to;
  for (const auto& mark : marks) {
    from.push_back(mark.heart_mm);
    to.push_back(mark.torso_mm);
  }
  const auto fit =
      adapters::fit_points(from, to, with_scale ? adapters::PoseFreedom::similarity : adapters::PoseFreedom::rigid);
  TorsoPose pose{fit.map, math::cbrt(determinant(fit.map.matrix)), fit.rms, {}};
  for (const auto& mark : marks) pose.residual_mm.push_back(norm(fit.map(mark.heart_mm) - mark.torso_mm));
  return pose;
}

PlacedHeart place_heart(const LabelVolume& heart, const LabelVolume& torso, const TorsoPose& pose) {
  auto corners = corners_of(torso.grid);
  const auto heart_from_torso = inverse(pose.torso_from_heart);
  for (auto& corner : corners) corner = heart_from_torso(corner);
  const auto larger = continued(heart.grid, corners);
  PlacedHeart placed;
  placed.labels = LabelVolume(larger.grid);
  double count = 0, outside = 0, bone = 0;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < larger.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < larger.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < larger.grid.size[0]; ++i, ++v) {
        const Vec3 at =
            lps_from_index(larger.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const auto there = nearest_label(torso, pose.torso_from_heart(at));
        const std::int64_t x = i + larger.first[0], y = j + larger.first[1], z = k + larger.first[2];
        const auto own = heart.grid.contains(x, y, z) ? heart(x, y, z) : std::uint8_t{0};
        if (!belongs_to_heart(own)) {
          placed.labels.voxels[v] = belongs_to_heart(there) ? tag(Region::torso) : there;
          continue;
        }
        placed.labels.voxels[v] = own;
        ++count;
        outside += there == 0;
        bone += there == tag(Region::bone);
      }
  if (count == 0) throw UserError("has no region of a heart", "heart's label map", "give the labels of a heart");
  placed.outside_share = outside / count;
  placed.bone_share = bone / count;
  constexpr double max_outside = 0.1;
  if (placed.outside_share > max_outside)
    throw UserError(fmt::format("{:.0f} % of the heart would lie outside the torso", 100 * placed.outside_share),
                    "torso", "check the landmarks of both, or let the torso's size follow with --scale");
  return placed;
}

}  // namespace heartgen::labels
