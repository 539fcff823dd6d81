// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/seeds.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "generator/image/box_around.hpp"
#include "model/error.hpp"
#include "model/quantile.hpp"

namespace heartgen::anatomy {
namespace {

std::string place(const std::string& name, const Vec3& p) {
  return fmt::format("landmarks: seed {} at ({:.1f}, {:.1f}, {:.1f}) mm", name, p.x, p.y, p.z);
}

Index3 nearest_index(const Grid& grid, const Vec3& position_mm) {
  const Vec3 index = index_from_lps(grid, position_mm);
  return {std::lround(index.x), std::lround(index.y), std::lround(index.z)};
}

/// What coordinates outside the image may have been meant as.
std::string likely_mistake(const Grid& grid, const Vec3& p) {
  if (grid.contains(std::lround(p.x), std::lround(p.y), std::lround(p.z))) return "; these may be voxel indices";
  const Index3 turned = nearest_index(grid, {-p.x, -p.y, p.z});
  if (grid.contains(turned[0], turned[1], turned[2]))
    return "; if these are RAS, as 3D Slicer shows them, change the signs of x and y";
  return "";
}

/// Calls visit(i, j, k, distance_mm) for the voxels within the ball, in memory order.
template <class Visit>
void for_ball(const Grid& grid, const Vec3& center_mm, double radius_mm, Visit visit) {
  const Box box = image::box_around(grid, center_mm, radius_mm);
  for (std::int64_t k = box.begin[2]; k < box.end[2]; ++k)
    for (std::int64_t j = box.begin[1]; j < box.end[1]; ++j)
      for (std::int64_t i = box.begin[0]; i < box.end[0]; ++i) {
        const Vec3 at = lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const double distance = norm(at - center_mm);
        if (distance <= radius_mm) visit(i, j, k, distance);
      }
}

}  // namespace

Index3 seed_voxel(const Grid& grid, const std::string& name, const Vec3& position_mm) {
  const Index3 voxel = nearest_index(grid, position_mm);
  if (grid.contains(voxel[0], voxel[1], voxel[2])) return voxel;
  const Vec3 first = lps_from_index(grid, {0, 0, 0});
  const Vec3 last = lps_from_index(grid, {static_cast<double>(grid.size[0] - 1), static_cast<double>(grid.size[1] - 1),
                                          static_cast<double>(grid.size[2] - 1)});
  throw UserError("the seed lies outside the image", place(name, position_mm),
                  fmt::format("give LPS coordinates between ({:.1f}, {:.1f}, {:.1f}) and ({:.1f}, {:.1f}, {:.1f}) mm{}",
                              first.x, first.y, first.z, last.x, last.y, last.z, likely_mistake(grid, position_mm)));
}

Index3 seed_in_mask(const CtVolume& ct, const Mask& mask, const std::string& name, const Vec3& position_mm,
                    double tolerance_mm, const std::string& what) {
  const Index3 voxel = seed_voxel(ct.grid, name, position_mm);
  if (mask(voxel[0], voxel[1], voxel[2])) return voxel;
  Index3 best = voxel;
  double best_distance = tolerance_mm * 2;
  for_ball(ct.grid, position_mm, tolerance_mm, [&](auto i, auto j, auto k, double distance) {
    if (!mask(i, j, k) || distance >= best_distance) return;
    best = {i, j, k};
    best_distance = distance;
  });
  if (best_distance > tolerance_mm)
    throw UserError(
        fmt::format("the seed is not in {}: the grey value there is {} HU", what, ct(voxel[0], voxel[1], voxel[2])),
        place(name, position_mm), fmt::format("move the seed into the middle of {}", name));
  return best;
}

double median_around(const CtVolume& ct, const Vec3& position_mm, double radius_mm, double least) {
  std::vector<std::int16_t> values;
  for_ball(ct.grid, position_mm, radius_mm, [&](auto i, auto j, auto k, double) {
    if (ct(i, j, k) > least) values.push_back(ct(i, j, k));
  });
  return values.empty() ? least : lower_median(values);
}

}  // namespace heartgen::anatomy
