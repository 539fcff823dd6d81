// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/spinal_canal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "generator/image/morphology.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"
#include "model/priors.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double lattice_mm = 2;          // between the places tried for the canal's line
constexpr int directions = 16;            // in which bone is looked for, in the slice
constexpr int min_hits = 10;              // met in so many of them; fewer only between two arches
constexpr int blocked = -3 * directions;  // bone on the way: an end plate outweighs the marrow on one side of it

/// Every so many voxels a place.
struct Lattice {
  Index3 stride{}, size{};

  explicit Lattice(const Grid& grid) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double voxels = lattice_mm / grid.spacing_mm[static_cast<int>(axis)];
      stride[axis] = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::ceil(voxels)), 1, grid.size[axis]);
      size[axis] = grid.size[axis] / stride[axis];
    }
  }
  Index3 voxel(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return {i * stride[0] + stride[0] / 2, j * stride[1] + stride[1] / 2, k * stride[2] + stride[2] / 2};
  }
  std::size_t offset(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>((k * size[1] + j) * size[0] + i);
  }
};

using Ray = std::vector<std::array<std::int64_t, 2>>;  // offsets i, j in the slice, outwards

std::vector<Ray> make_rays(const Vec3& spacing_mm) {
  const double step_mm = std::min(spacing_mm.x, spacing_mm.y);
  std::vector<Ray> rays(directions);
  for (int d = 0; d < directions; ++d) {
    const double angle = 2 * std::numbers::pi * d / directions;
    const double x = math::cos(angle) / spacing_mm.x, y = math::sin(angle) / spacing_mm.y;
    for (int n = 1; n * step_mm <= priors::spinal_canal_to_bone_max_mm; ++n)
      rays[static_cast<std::size_t>(d)].push_back({std::lround(n * step_mm * x), std::lround(n * step_mm * y)});
  }
  return rays;
}

/// How many of the rays meet the wall.
int wall_hits(const Mask& wall, const Index3& at, const std::vector<Ray>& rays) {
  return static_cast<int>(std::count_if(rays.begin(), rays.end(), [&](const Ray& ray) {
    return std::any_of(ray.begin(), ray.end(), [&](const auto& step) {
      const std::int64_t i = at[0] + step[0], j = at[1] + step[1];
      return wall.grid.contains(i, j, at[2]) && wall(i, j, at[2]);
    });
  }));
}

std::vector<int> score_places(const Lattice& lattice, const Mask& wide, const Mask& wall, double front_mm) {
  const auto rays = make_rays(wall.grid.spacing_mm);
  std::vector<int> score(lattice.offset(0, 0, lattice.size[2]), blocked);
  parallel::parallel_for(0, lattice.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < lattice.size[1]; ++j)
        for (std::int64_t i = 0; i < lattice.size[0]; ++i) {
          const Index3 v = lattice.voxel(i, j, k);
          const Vec3 index{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
          if (wide(v[0], v[1], v[2]) && lps_from_index(wall.grid, index).y > front_mm)
            score[lattice.offset(i, j, k)] = wall_hits(wall, v, rays) - min_hits;
        }
  });
  return score;
}

/// The way up, one place a slice of the lattice, whose scores have the largest sum; it rises by 45 degrees at least.
std::vector<Index3> best_way(const Lattice& lattice, const Grid& grid, std::vector<int> score) {
  const double rise_mm = static_cast<double>(lattice.stride[2]) * grid.spacing_mm.z;
  const double aside_mm = static_cast<double>(lattice.stride[0]) * grid.spacing_mm.x;
  const auto aside = std::max<std::int64_t>(std::lround(rise_mm / aside_mm), 1);
  constexpr std::int64_t none = -1;
  std::vector<std::int64_t> below(score.size(), none);
  std::int64_t top = 0;
  for (std::int64_t k = 0; k < lattice.size[2]; ++k)
    for (std::int64_t j = 0; j < lattice.size[1]; ++j)
      for (std::int64_t i = 0; i < lattice.size[0]; ++i) {
        const std::size_t here = lattice.offset(i, j, k);
        int most = 0;
        for (std::int64_t b = std::max<std::int64_t>(j - aside, 0);
             k > 0 && b <= std::min(j + aside, lattice.size[1] - 1); ++b)
          for (std::int64_t a = std::max<std::int64_t>(i - aside, 0); a <= std::min(i + aside, lattice.size[0] - 1);
               ++a)
            if (const std::size_t from = lattice.offset(a, b, k - 1); score[from] > most) {
              most = score[from];
              below[here] = static_cast<std::int64_t>(from);
            }
        score[here] += most;
        if (score[here] > score[static_cast<std::size_t>(top)]) top = static_cast<std::int64_t>(here);
      }
  std::vector<Index3> way;
  for (std::int64_t at = top; at != none; at = below[static_cast<std::size_t>(at)])
    way.push_back(lattice.voxel(at % lattice.size[0], at / lattice.size[0] % lattice.size[1],
                                at / (lattice.size[0] * lattice.size[1])));
  std::reverse(way.begin(), way.end());
  return way;
}

/// Marks what of `core` in slice k hangs together with the voxels near `centre`, within
/// priors::spinal_canal_to_bone_max_mm of it.
void mark_section(const Mask& core, const Index3& centre, std::int64_t k, Mask& canal) {
  const auto distance_mm = [&](const std::array<std::int64_t, 2>& p) {
    return math::hypot(static_cast<double>(p[0] - centre[0]) * core.grid.spacing_mm.x,
                       static_cast<double>(p[1] - centre[1]) * core.grid.spacing_mm.y);
  };
  std::vector<std::array<std::int64_t, 2>> front;
  const auto visit = [&](const std::array<std::int64_t, 2>& p, double within_mm) {
    if (!core.grid.contains(p[0], p[1], k) || !core(p[0], p[1], k) || canal(p[0], p[1], k)) return;
    if (distance_mm(p) > within_mm) return;
    canal(p[0], p[1], k) = 1;
    front.push_back(p);
  };
  const auto near_i = static_cast<std::int64_t>(priors::spinal_canal_radius_min_mm / core.grid.spacing_mm.x);
  const auto near_j = static_cast<std::int64_t>(priors::spinal_canal_radius_min_mm / core.grid.spacing_mm.y);
  for (std::int64_t j = centre[1] - near_j; j <= centre[1] + near_j; ++j)
    for (std::int64_t i = centre[0] - near_i; i <= centre[0] + near_i; ++i)
      visit({i, j}, priors::spinal_canal_radius_min_mm);
  while (!front.empty()) {
    const auto [i, j] = front.back();
    front.pop_back();
    for (const auto& p : {std::array{i - 1, j}, std::array{i + 1, j}, std::array{i, j - 1}, std::array{i, j + 1}})
      visit(p, priors::spinal_canal_to_bone_max_mm);
  }
}

}  // namespace

Mask find_spinal_canal(const Mask& filled, const Mask& wall, double front_mm) {
  const Grid& grid = filled.grid;
  Mask free(grid);
  for (std::size_t v = 0; v < free.voxels.size(); ++v) free.voxels[v] = wall.voxels[v] == 0;
  const Mask wide = image::erode(free, priors::spinal_canal_radius_min_mm);
  const Lattice lattice(grid);
  const auto way = best_way(lattice, grid, score_places(lattice, wide, wall, front_mm));
  Mask canal(grid);
  const double length_mm = static_cast<double>(way.size()) * static_cast<double>(lattice.stride[2]) * grid.spacing_mm.z;
  if (length_mm < priors::spinal_canal_length_min_mm) return canal;
  const Mask core = image::intersect(filled, wide);
  for (const Index3& place : way) {
    const std::int64_t first = place[2] - lattice.stride[2] / 2;
    for (std::int64_t k = first; k < std::min(first + lattice.stride[2], grid.size[2]); ++k)
      mark_section(core, place, k, canal);
  }
  const double rim_mm = std::max(grid.spacing_mm.x, grid.spacing_mm.y);
  return image::intersect(image::dilate(canal, priors::spinal_canal_radius_min_mm + rim_mm), filled);
}

}  // namespace heartgen::anatomy
