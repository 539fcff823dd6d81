// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/ventricles/trabeculae.hpp"

#include <algorithm>
#include <array>

#include "generator/adapters/point_tree.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/resample.hpp"
#include "generator/parallel/threads.hpp"
#include "model/priors.hpp"
#include "model/quantile.hpp"

namespace heartgen::ventricles {
namespace {

constexpr double surface_smoothing_voxels = 1.5;
constexpr double low_quantile = 0.05, high_quantile = 0.85;  // not the extremes: single voxels must not decide

Part cavity_of(Part wall) { return wall == Part::lv_wall ? Part::lv_cavity : Part::rv_cavity; }

/// Where trabeculae are looked for: 1 clear of the base.
Mask trabeculated(const Volume<std::uint8_t>& parts, double base_mm) {
  const auto to_other = image::distance_to(image::mask_where(parts, [](auto v) { return is(v, Part::other); }));
  Mask mask(parts.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) mask.voxels[v] = to_other.voxels[v] >= base_mm;
  return mask;
}

/// Points of the endocardium (centres of cavity voxels that touch the wall) with the wall's thickness there.
struct Endocardium {
  adapters::PointCloud cloud;
  std::vector<float> thickness_mm;
};

Volume<float> distance_to_outer_surface(const Volume<std::uint8_t>& parts, Part wall) {
  if (wall == Part::rv_wall)
    return image::distance_to(image::mask_where(parts, [](auto v) { return is(v, Part::outside); }));
  return image::distance_to(image::mask_where(
      parts, [](auto v) { return is(v, Part::outside) || is(v, Part::rv_wall) || is(v, Part::rv_cavity); }));
}

Endocardium endocardium_of(const Volume<std::uint8_t>& parts, Part wall, const Volume<float>& to_outside,
                           const Mask& where) {
  const auto to_cavity = image::signed_distance(
      image::mask_where(parts, [&](auto v) { return is(v, cavity_of(wall)); }), surface_smoothing_voxels);
  const Grid& g = parts.grid;
  Endocardium surface;
  const auto is_wall_at = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return g.contains(i, j, k) && is(parts(i, j, k), wall);
  };
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        if (!is(parts(i, j, k), cavity_of(wall)) || !where(i, j, k)) continue;
        if (!is_wall_at(i - 1, j, k) && !is_wall_at(i + 1, j, k) && !is_wall_at(i, j - 1, k) &&
            !is_wall_at(i, j + 1, k) && !is_wall_at(i, j, k - 1) && !is_wall_at(i, j, k + 1))
          continue;
        surface.cloud.points.push_back(image::voxel_center(g, g.offset(i, j, k)));
        surface.thickness_mm.push_back(to_outside(i, j, k) + std::min(to_cavity(i, j, k), 0.0F));
      }
  return surface;
}

/// Per point the quantile of `values` over the points within reach.
std::vector<float> local_quantile(const adapters::PointCloud& cloud, const adapters::PointTree& tree,
                                  const std::vector<float>& values, double share) {
  std::vector<float> result(values.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(values.size()), [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::pair<std::size_t, double>> near;
    std::vector<float> around;
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const std::array<double, 3> at{cloud.points[n].x, cloud.points[n].y, cloud.points[n].z};
      tree.radiusSearch(at.data(), priors::trabecula_max_mm * priors::trabecula_max_mm, near,
                        nanoflann::SearchParams(32, 0, false));
      around.clear();
      for (const auto& [point, squared] : near) around.push_back(values[point]);
      result[n] = quantile(around, share);
    }
  });
  return result;
}

}  // namespace

void give_trabeculae_to_cavity(Volume<std::uint8_t>& parts, Part wall) {
  const auto to_outside = distance_to_outer_surface(parts, wall);
  Mask where = trabeculated(parts, priors::trabeculae_off_base_mm);
  Endocardium surface = endocardium_of(parts, wall, to_outside, where);
  if (surface.cloud.points.empty()) return;
  // Nearer to the base than a wall is thick, the outside is nearest over its end, and the wall would look thin.
  auto thicknesses_mm = surface.thickness_mm;
  if (const double thickness_mm = upper_median(thicknesses_mm); thickness_mm > priors::trabeculae_off_base_mm) {
    where = trabeculated(parts, thickness_mm);
    surface = endocardium_of(parts, wall, to_outside, where);
    if (surface.cloud.points.empty()) return;
  }
  const adapters::PointTree tree(3, surface.cloud, adapters::tree_leaves);
  const auto opened = local_quantile(
      surface.cloud, tree, local_quantile(surface.cloud, tree, surface.thickness_mm, low_quantile), high_quantile);
  parallel::parallel_for(0, parts.grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t v = begin; v < end; ++v) {
      auto& part = parts.voxels[static_cast<std::size_t>(v)];
      if (!is(part, wall) || !where.voxels[static_cast<std::size_t>(v)]) continue;
      const Vec3 p = image::voxel_center(parts.grid, v);
      const std::array<double, 3> at{p.x, p.y, p.z};
      std::size_t nearest = 0;
      double squared = 0;
      tree.knnSearch(at.data(), 1, &nearest, &squared);
      if (to_outside.voxels[static_cast<std::size_t>(v)] > opened[nearest]) part = tag(cavity_of(wall));
    }
  });
}

}  // namespace heartgen::ventricles
