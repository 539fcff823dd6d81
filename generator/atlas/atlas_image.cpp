// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/atlas/atlas_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/atlas/standard_pose.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/resample.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/ventricles/base_extrapolation.hpp"
#include "model/axis_tensor.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"
#include "model/mesh_queries/voxels_in_cell.hpp"
#include "model/priors.hpp"
#include "model/quantile.hpp"

namespace heartgen::atlas {
namespace {

constexpr double margin_mm = 12;

struct Box {
  Vec3 low, high;
};

Box box_of(const std::vector<Vec3>& points) {
  Box box{points.front(), points.front()};
  for (const Vec3& p : points)
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], p[axis]);
      box.high[axis] = std::max(box.high[axis], p[axis]);
    }
  return box;
}

Grid grid_around(const std::vector<Vec3>& points, double spacing_mm, double margin) {
  const Box box = box_of(points);
  Grid grid;
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  for (int axis = 0; axis < 3; ++axis) {
    grid.origin_mm[axis] = box.low[axis] - margin;
    grid.size[static_cast<std::size_t>(axis)] =
        static_cast<std::int64_t>(std::ceil((box.high[axis] - box.low[axis] + 2 * margin) / spacing_mm)) + 1;
  }
  return grid;
}

template <class Visit>
void for_voxels_in_mesh(const Grid& grid, const FiberAtlas& atlas, Visit&& visit) {
  for (std::size_t c = 0; c < atlas.cells.size(); ++c) {
    std::array<Vec3, 4> p;
    for (std::size_t n = 0; n < 4; ++n) p[n] = atlas.points_mm[static_cast<std::size_t>(atlas.cells[c][n])];
    mesh_queries::for_voxels_in_cell(
        grid, p, [&](std::int64_t v, const std::array<double, 4>& weights) { visit(v, weights, c); });
  }
}

Mask occupancy(const FiberAtlas& atlas, const Grid& grid) {
  Mask mask(grid);
  for_voxels_in_mesh(grid, atlas,
                     [&](std::int64_t v, const auto&, std::size_t) { mask.voxels[static_cast<std::size_t>(v)] = 1; });
  return mask;
}

/// Pixels of slice k that the wall (mask) does not hold and the border of the slice cannot reach: 1, else 0.
std::vector<std::uint8_t> enclosed_in_slice(const Mask& mask, std::int64_t k) {
  const auto nx = mask.grid.size[0], ny = mask.grid.size[1];
  const auto* wall = mask.voxels.data() + k * nx * ny;
  std::vector<std::uint8_t> enclosed(static_cast<std::size_t>(nx * ny));
  for (std::size_t p = 0; p < enclosed.size(); ++p) enclosed[p] = wall[p] ? 0 : 1;
  std::vector<std::int64_t> queue;
  const auto reach = [&](std::int64_t i, std::int64_t j) {
    if (i < 0 || j < 0 || i >= nx || j >= ny || !enclosed[static_cast<std::size_t>(j * nx + i)]) return;
    enclosed[static_cast<std::size_t>(j * nx + i)] = 0;
    queue.push_back(j * nx + i);
  };
  for (std::int64_t i = 0; i < nx; ++i) reach(i, 0), reach(i, ny - 1);
  for (std::int64_t j = 0; j < ny; ++j) reach(0, j), reach(nx - 1, j);
  while (!queue.empty()) {
    const auto p = queue.back();
    queue.pop_back();
    const auto i = p % nx, j = p / nx;
    reach(i - 1, j), reach(i + 1, j), reach(i, j - 1), reach(i, j + 1);
  }
  return enclosed;
}

Mask enclosed_cavities(const Mask& wall) {
  Mask cavity(wall.grid);
  const auto slice = wall.grid.size[0] * wall.grid.size[1];
  for (std::int64_t k = 0; k < wall.grid.size[2]; ++k) {
    const auto enclosed = enclosed_in_slice(wall, k);
    std::copy(enclosed.begin(), enclosed.end(), cavity.voxels.begin() + k * slice);
  }
  return cavity;
}

/// Right-handed rows with the third along `axis`.
Mat3 rotation_to_z(const Vec3& axis) {
  const Vec3 helper = std::abs(axis.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 first = normalized(cross(helper, axis));
  return {{first, cross(axis, first), axis}};
}

/// The wall seen along `axis`: voxel (i, j, k) of a cube with k along the axis.
Mask turned(const Mask& wall, const Vec3& axis, double spacing_mm) {
  const Mat3 to_file = transposed(rotation_to_z(axis));
  const Vec3 middle = lps_from_index(
      wall.grid, 0.5 * Vec3{static_cast<double>(wall.grid.size[0] - 1), static_cast<double>(wall.grid.size[1] - 1),
                            static_cast<double>(wall.grid.size[2] - 1)});
  const double radius = norm(middle - wall.grid.origin_mm);
  Grid grid;
  const auto n = static_cast<std::int64_t>(2 * radius / spacing_mm) + 2;
  grid.size = {n, n, n};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  grid.origin_mm = -0.5 * spacing_mm * static_cast<double>(n - 1) * Vec3{1, 1, 1};
  Mask result(grid);
  const auto index_of = [&](const Vec3& at) {
    return index_from_lps(wall.grid, middle + to_file * lps_from_index(grid, at));
  };
  const Vec3 first = index_of({0, 0, 0});
  const Vec3 along_i = index_of({1, 0, 0}) - first, along_j = index_of({0, 1, 0}) - first,
             along_k = index_of({0, 0, 1}) - first;
  const auto& size = wall.grid.size;
  const Vec3 end{static_cast<double>(size[0]) - 0.5, static_cast<double>(size[1]) - 0.5,
                 static_cast<double>(size[2]) - 0.5};
  for (std::int64_t k = 0; k < n; ++k)
    for (std::int64_t j = 0; j < n; ++j) {
      const Vec3 row = first + static_cast<double>(j) * along_j + static_cast<double>(k) * along_k;
      for (std::int64_t i = 0; i < n; ++i) {
        const Vec3 at = row + static_cast<double>(i) * along_i;
        if (at.x < -0.5 || at.y < -0.5 || at.z < -0.5 || at.x >= end.x || at.y >= end.y || at.z >= end.z) continue;
        result(i, j, k) =
            wall(static_cast<std::int64_t>(std::floor(at.x + 0.5)), static_cast<std::int64_t>(std::floor(at.y + 0.5)),
                 static_cast<std::int64_t>(std::floor(at.z + 0.5)));
      }
    }
  return result;
}

std::int64_t enclosed_volume(const Mask& wall, const Vec3& axis, double spacing_mm) {
  const Mask cavity = enclosed_cavities(turned(wall, axis, spacing_mm));
  return std::count(cavity.voxels.begin(), cavity.voxels.end(), std::uint8_t{1});
}

/// The first of the candidates that encloses most.
Vec3 best_of(const Mask& wall, const std::vector<Vec3>& candidates, double spacing_mm) {
  std::vector<std::int64_t> volume(candidates.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(candidates.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      volume[n] = enclosed_volume(wall, candidates[n], spacing_mm);
  });
  return candidates[static_cast<std::size_t>(std::max_element(volume.begin(), volume.end()) - volume.begin())];
}

/// The direction across whose slices the walls enclose most: that of the opening at the base. Sign arbitrary.
Vec3 opening_direction(const Mask& wall, double spacing_mm) {
  constexpr int directions = 160;
  const double golden = math::acos(-1.0) * (3 - std::sqrt(5.0));
  std::vector<Vec3> candidates;
  for (int n = 0; n < directions; ++n) {
    const double z = (n + 0.5) / directions, r = std::sqrt(1 - z * z);
    candidates.push_back({r * math::cos(golden * n), r * math::sin(golden * n), z});
  }
  Vec3 best = best_of(wall, candidates, spacing_mm);
  for (const double step : {0.10, 0.05, 0.025}) {
    const Mat3 frame = rotation_to_z(best);
    candidates.assign(1, best);
    for (int n = 0; n < 8; ++n) {
      const double angle = n * math::acos(-1.0) / 4;
      candidates.push_back(normalized(best + step * (math::cos(angle) * frame[0] + math::sin(angle) * frame[1])));
    }
    best = best_of(wall, candidates, spacing_mm);
  }
  return best;
}

Vec3 mean_position(const Mask& mask) {
  Vec3 sum;
  double count = 0;
  for (std::int64_t k = 0; k < mask.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < mask.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < mask.grid.size[0]; ++i)
        if (mask(i, j, k)) {
          sum += Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          ++count;
        }
  return count > 0 ? lps_from_index(mask.grid, sum / count) : Vec3{};
}

/// The atlas turned so that the base looks to +z.
FiberAtlas upright(const FiberAtlas& atlas) {
  constexpr double spacing_mm = 2;
  const Mask wall = occupancy(atlas, grid_around(atlas.points_mm, spacing_mm, 2 * spacing_mm));
  Vec3 axis = opening_direction(wall, 1.25 * spacing_mm);
  const Mask seen = turned(wall, axis, 1.25 * spacing_mm);
  if (mean_position(enclosed_cavities(seen)).z < mean_position(seen).z) axis = -axis;
  const Mat3 rotation = rotation_to_z(axis);
  FiberAtlas result = atlas;
  for (Vec3& p : result.points_mm) p = rotation * p;
  for (Vec3& f : result.fiber) f = rotation * f;
  for (Vec3& f : result.cell_fiber) f = rotation * f;
  return result;
}

/// Numbers the 6-connected components of mask, largest first, from 1; returns their sizes.
std::vector<std::int64_t> label_components(const Mask& mask, Volume<std::int32_t>& label) {
  label = Volume<std::int32_t>(mask.grid);
  std::vector<std::int64_t> sizes;
  std::vector<std::array<std::int64_t, 3>> queue;
  const auto& g = mask.grid;
  const auto visit = [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int32_t number) {
    if (!g.contains(i, j, k) || !mask(i, j, k) || label(i, j, k)) return;
    label(i, j, k) = number;
    queue.push_back({i, j, k});
  };
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        if (!mask(i, j, k) || label(i, j, k)) continue;
        const auto number = static_cast<std::int32_t>(sizes.size() + 1);
        std::int64_t size = 0;
        visit(i, j, k, number);
        while (!queue.empty()) {
          const auto [a, b, c] = queue.back();
          queue.pop_back();
          ++size;
          visit(a - 1, b, c, number), visit(a + 1, b, c, number), visit(a, b - 1, c, number);
          visit(a, b + 1, c, number), visit(a, b, c - 1, number), visit(a, b, c + 1, number);
        }
        sizes.push_back(size);
      }
  return sizes;
}

/// Two masks: the two largest enclosed cavities. Top slices are left out until there are two.
std::array<Mask, 2> two_cavities(const Mask& wall, const std::string& name) {
  Mask cavity = enclosed_cavities(wall);
  const auto slice = wall.grid.size[0] * wall.grid.size[1];
  for (std::int64_t top = wall.grid.size[2]; top > wall.grid.size[2] / 3; --top) {
    Volume<std::int32_t> label;
    const auto sizes = label_components(cavity, label);
    std::vector<std::int32_t> order(sizes.size());
    for (std::size_t n = 0; n < order.size(); ++n) order[n] = static_cast<std::int32_t>(n);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
      return sizes[static_cast<std::size_t>(a)] > sizes[static_cast<std::size_t>(b)];
    });
    const double voxel_ml = wall.grid.voxel_volume_mm3() / 1000;
    if (order.size() >= 2 &&
        static_cast<double>(sizes[static_cast<std::size_t>(order[1])]) * voxel_ml > priors::cavity_min_ml) {
      std::array<Mask, 2> result{Mask(wall.grid), Mask(wall.grid)};
      for (std::size_t v = 0; v < label.voxels.size(); ++v)
        for (std::size_t c = 0; c < 2; ++c) result[c].voxels[v] = label.voxels[v] == order[c] + 1;
      return result;
    }
    std::fill_n(cavity.voxels.begin() + (top - 1) * slice, slice, std::uint8_t{0});
  }
  throw UserError("the atlas does not enclose two cavities", name,
                  "a fibre atlas is a mesh of both ventricles, open at the base, with walls of at least 2 mm");
}

/// Median distance from the outer surface to cavity `mine`, over surface voxels nearer to it than to `other`.
double wall_thickness(const Mask& wall, const Mask& outside, const Volume<float>& mine, const Volume<float>& other) {
  const auto to_outside = image::distance_to(outside);
  const auto reach = static_cast<float>(1.5 * wall.grid.spacing_mm.x);
  std::vector<float> values;
  for (std::size_t v = 0; v < wall.voxels.size(); ++v)
    if (wall.voxels[v] && to_outside.voxels[v] < reach && mine.voxels[v] < other.voxels[v])
      values.push_back(mine.voxels[v]);
  return values.empty() ? 0 : upper_median(values);
}

/// Upper face of the highest slice in which the cavity still has a good part of its largest cross-section.
double top_of(const Mask& cavity) {
  constexpr double share = 0.4;
  const auto slice = cavity.grid.size[0] * cavity.grid.size[1];
  std::vector<std::int64_t> area(static_cast<std::size_t>(cavity.grid.size[2]));
  for (std::size_t k = 0; k < area.size(); ++k) {
    const auto* begin = cavity.voxels.data() + static_cast<std::int64_t>(k) * slice;
    area[k] = std::count(begin, begin + slice, std::uint8_t{1});
  }
  const auto largest = static_cast<double>(*std::max_element(area.begin(), area.end()));
  std::size_t top = area.size() - 1;
  while (top > 0 && static_cast<double>(area[top]) < share * largest) --top;
  return cavity.grid.origin_mm.z + (static_cast<double>(top) + 0.5) * cavity.grid.spacing_mm.z;
}

/// Whether a straight way from a voxel meets the left cavity before it leaves the heart.
bool leads_to_left_cavity(const Volume<std::uint8_t>& parts, Vec3 index, const Vec3& direction) {
  constexpr double step = 0.7;  // voxels
  while (direction != Vec3{}) {
    index += step * direction;
    const auto i = std::llround(index.x), j = std::llround(index.y), k = std::llround(index.z);
    if (!parts.grid.contains(i, j, k) || ventricles::is(parts(i, j, k), ventricles::Part::outside)) return false;
    if (ventricles::is(parts(i, j, k), ventricles::Part::lv_cavity)) return true;
  }
  return false;
}

/// A wall voxel is the right ventricle's where the left cavity is farther than the right one, the outside, and the
/// left wall is thick, and where the way on from the right cavity leads out of the heart; so the septum, also where it
/// is thicker than the left free wall, and the inside of the junction stay with the left ventricle.
void split_walls(Volume<std::uint8_t>& parts, double lv_thickness_mm) {
  const auto lv = image::distance_to(
      image::mask_where(parts, [](auto v) { return ventricles::is(v, ventricles::Part::lv_cavity); }));
  const auto rv = image::distance_to(
      image::mask_where(parts, [](auto v) { return ventricles::is(v, ventricles::Part::rv_cavity); }));
  const auto out =
      image::distance_to(image::mask_where(parts, [](auto v) { return ventricles::is(v, ventricles::Part::outside); }));
  const auto even_rv = image::smoothed(rv, 1);
  const auto& g = parts.grid;
  const auto whole = parts;
  parallel::parallel_for(0, g.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < g.size[1]; ++j)
        for (std::int64_t i = 0; i < g.size[0]; ++i) {
          if (!ventricles::is_wall(parts(i, j, k))) continue;
          const float d = lv(i, j, k);
          const bool outer = d > rv(i, j, k) && d > out(i, j, k) && d > lv_thickness_mm;
          const Vec3 at{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          const bool right =
              outer && !leads_to_left_cavity(whole, at, normalized(image::gradient_at(even_rv, i, j, k)));
          parts(i, j, k) = ventricles::tag(right ? ventricles::Part::rv_wall : ventricles::Part::lv_wall);
        }
  });
}

/// Where the walls join, a mesh with one vector per node mixes their directions within its cells, about two edges far,
/// and for an edge more its sheets bend into the junction, so that depths between its surfaces are not its own.
double mixing_reach_mm(const FiberAtlas& atlas) {
  constexpr double edges = 3;
  double sum = 0, count = 0;
  for (const Cell& cell : atlas.cells)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) {
        sum += norm(atlas.points_mm[static_cast<std::size_t>(cell[a])] -
                    atlas.points_mm[static_cast<std::size_t>(cell[b])]);
        ++count;
      }
  return count > 0 ? std::min<double>(edges * sum / count, priors::atlas_mixing_max_mm) : 0;
}

Volume<Vec3> voxel_fibers(const FiberAtlas& atlas, const Grid& grid) {
  Volume<Vec3> fiber(grid);
  for_voxels_in_mesh(grid, atlas, [&](std::int64_t v, const std::array<double, 4>& weights, std::size_t c) {
    AxisTensor sum;
    if (!atlas.cell_fiber.empty())
      sum = axis_tensor(atlas.cell_fiber[c]);
    else
      for (std::size_t n = 0; n < 4; ++n)
        sum += std::max(weights[n], 0.0) * axis_tensor(atlas.fiber[static_cast<std::size_t>(atlas.cells[c][n])]);
    fiber.voxels[static_cast<std::size_t>(v)] = leading_axis(sum);
  });
  return fiber;
}

}  // namespace

ventricles::AtlasImage image_of_atlas(const FiberAtlas& atlas, double spacing_mm) {
  const FiberAtlas standing = upright(in_standard_pose(atlas));
  const Grid grid = grid_around(standing.points_mm, spacing_mm, margin_mm);
  const Mask wall = occupancy(standing, grid);
  const auto cavities = two_cavities(wall, atlas.name);
  Mask outside(grid);
  for (std::size_t v = 0; v < outside.voxels.size(); ++v)
    outside.voxels[v] = !wall.voxels[v] && !cavities[0].voxels[v] && !cavities[1].voxels[v];
  const auto to_first = image::distance_to(cavities[0]), to_second = image::distance_to(cavities[1]);
  const double first = wall_thickness(wall, outside, to_first, to_second);
  const double second = wall_thickness(wall, outside, to_second, to_first);
  const std::size_t lv = first >= second ? 0 : 1;

  ventricles::AtlasImage image;
  auto& parts = image.ventricles.parts;
  parts = Volume<std::uint8_t>(grid);
  for (std::size_t v = 0; v < parts.voxels.size(); ++v)
    parts.voxels[v] = wall.voxels[v]               ? ventricles::tag(ventricles::Part::lv_wall)
                      : cavities[lv].voxels[v]     ? ventricles::tag(ventricles::Part::lv_cavity)
                      : cavities[1 - lv].voxels[v] ? ventricles::tag(ventricles::Part::rv_cavity)
                                                   : ventricles::tag(ventricles::Part::outside);
  const Vec3 down{0, 0, -1};
  const Vec3 base{0, 0, std::min(top_of(cavities[0]), top_of(cavities[1]))};
  ventricles::extrapolate_above_base(parts, {base, down}, down);
  split_walls(parts, std::max(first, second));
  image.ventricles.frame = ventricles::heart_frame(parts, base, down);
  image.fiber = voxel_fibers(standing, grid);
  const auto to_lv =
      image::distance_to(image::mask_where(parts, [](auto v) { return ventricles::is(v, ventricles::Part::lv_wall); }));
  const auto to_rv =
      image::distance_to(image::mask_where(parts, [](auto v) { return ventricles::is(v, ventricles::Part::rv_wall); }));
  const double reach_mm = mixing_reach_mm(standing);
  image.mixed = Mask(grid);
  for (std::size_t v = 0; v < parts.voxels.size(); ++v) {
    image.mixed.voxels[v] = std::max(to_lv.voxels[v], to_rv.voxels[v]) < reach_mm;
    if (image::voxel_center(grid, static_cast<std::int64_t>(v)).z > base.z) image.fiber.voxels[v] = {};
  }
  return image;
}

}  // namespace heartgen::atlas
