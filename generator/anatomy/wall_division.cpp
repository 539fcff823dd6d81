// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/wall_division.hpp"

#include <algorithm>
#include <cmath>

#include "generator/anatomy/wall_band.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/morphology.hpp"
#include "generator/parallel/threads.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double smoothing_mm = 1;            // of the distances to the cavities, against trabeculae
constexpr double thickness_smoothing_mm = 4;  // thicknesses are averaged with this standard deviation
constexpr double facing = -0.7;          // cosine between the ways out of the two cavities, at the septum's right side
constexpr float weight_of_mean = 1e-4F;  // per mm, against the density of measurements: what counts far from them all

/// Sum and number (per mm) of the thicknesses measured at the faces of one voxel.
struct Thickness {
  Volume<float> sum, weight;
};

/// Whether the shortest way from here to the left cavity stays in the wall: behind a notch of the right cavity the
/// distance to the left one is no thickness.
bool wall_all_the_way(const HeartBand& heart, const Mask& ventricles, const Mask& right, const Volume<float>& to_lv,
                      const Index3& from) {
  const Vec3& spacing = to_lv.grid.spacing_mm;
  const double step_mm = std::min({spacing.x, spacing.y, spacing.z});
  Vec3 place{static_cast<double>(from[0]), static_cast<double>(from[1]), static_cast<double>(from[2])};
  Index3 at = from;
  const int steps = static_cast<int>(std::ceil(static_cast<double>(to_lv(at[0], at[1], at[2])) / step_mm)) - 1;
  for (int step = 0; step < steps; ++step) {
    const Vec3 out = normalized(gradient(to_lv, at));
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] -= step_mm * out[axis] / spacing[axis];
      at[static_cast<std::size_t>(axis)] = std::lround(place[axis]);
    }
    if (!to_lv.grid.contains(at[0], at[1], at[2]) || !ventricles(at[0], at[1], at[2])) return false;
    if (right(at[0], at[1], at[2])) return false;
    if (heart.chambers(at[0], at[1], at[2])) return true;  // the left cavity
  }
  return true;
}

/// Distance to the left cavity at the faces of the left wall: towards the outside, where it is the left ventricle's,
/// and towards the right cavity, where that lies opposite the left one.
Thickness measure_thickness(const HeartBand& heart, const Mask& ventricles, const Mask& right,
                            const Volume<float>& to_lv, const Volume<float>& to_rv) {
  const Grid& grid = heart.owner.grid;
  Thickness found{Volume<float>(grid), Volume<float>(grid)};
  const auto is_outside = [&](const Index3& p) {
    return !ventricles(p[0], p[1], p[2]) && !heart.chambers(p[0], p[1], p[2]) &&
           heart.owner(p[0], p[1], p[2]) == tag(Region::lv_blood);
  };
  const auto faces_right = [&](const Index3& at, const Index3& next) {
    return right(next[0], next[1], next[2]) &&
           dot(normalized(gradient(to_lv, at)), normalized(gradient(to_rv, at))) < facing;
  };
  const auto measure = [&](const Index3& at) {
    for (int face = 0; face < 6; ++face) {
      Index3 next = at;
      next[static_cast<std::size_t>(face / 2)] += face % 2 ? 1 : -1;
      if (!grid.contains(next[0], next[1], next[2]) || !(is_outside(next) || faces_right(at, next))) continue;
      if (!wall_all_the_way(heart, ventricles, right, to_lv, at)) return;
      const auto area = static_cast<float>(1 / grid.spacing_mm[face / 2]);  // of a voxel's volume
      const float middle = (to_lv(at[0], at[1], at[2]) + to_lv(next[0], next[1], next[2])) / 2;
      found.sum(at[0], at[1], at[2]) += area * middle;
      found.weight(at[0], at[1], at[2]) += area;
    }
  };
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i)
          if (ventricles(i, j, k) && !heart.chambers(i, j, k)) measure({i, j, k});
  });
  return found;
}

double mean_of(const Thickness& found) {
  double sum = 0, weight = 0;
  for (std::size_t v = 0; v < found.sum.voxels.size(); ++v) {
    sum += static_cast<double>(found.sum.voxels[v]);
    weight += static_cast<double>(found.weight.voxels[v]);
  }
  return weight > 0 ? sum / weight : 0;
}

}  // namespace

Mask left_part(const HeartBand& heart, const Mask& ventricles) {
  const Mask right = cavity(heart, Region::rv_blood);
  const auto to_lv = image::gaussian(image::distance_to(cavity(heart, Region::lv_blood)), smoothing_mm);
  const auto to_rv = image::gaussian(image::distance_to(right), smoothing_mm);
  Thickness found = measure_thickness(heart, ventricles, right, to_lv, to_rv);
  const auto mean = static_cast<float>(mean_of(found));
  found.sum = image::gaussian(found.sum, thickness_smoothing_mm);
  found.weight = image::gaussian(found.weight, thickness_smoothing_mm);
  Mask left(heart.owner.grid);
  for (std::size_t v = 0; v < left.voxels.size(); ++v) {
    if (!ventricles.voxels[v] || heart.chambers.voxels[v]) continue;
    const float thickness = (found.sum.voxels[v] + weight_of_mean * mean) / (found.weight.voxels[v] + weight_of_mean);
    left.voxels[v] = to_lv.voxels[v] < to_rv.voxels[v] || to_lv.voxels[v] <= thickness;
  }
  return left;
}

}  // namespace heartgen::anatomy
