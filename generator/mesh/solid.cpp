#include "generator/mesh/solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/parallel/threads.hpp"
#include "generator/segment/distance.hpp"
#include "generator/segment/morphology.hpp"

namespace heart::mesh {
namespace {

// The grid of the domain with each voxel divided into parts of about `voxel_mm`.
Grid finer_grid(const Grid& grid, double voxel_mm) {
  Grid finer = grid;
  Vec3 first;
  for (int axis = 0; axis < 3; ++axis) {
    const double parts = std::max(1.0, std::round(grid.spacing_mm[axis] / voxel_mm));
    first[axis] = 0.5 / parts - 0.5;
    finer.spacing_mm[axis] /= parts;
    finer.size[static_cast<std::size_t>(axis)] *= static_cast<std::int64_t>(parts);
  }
  finer.origin_mm = lps_from_index(grid, first);
  return finer;
}

Mask mask_of(const MeshDomain& domain, bool (*belongs)(Region), double voxel_mm) {
  Mask mask(finer_grid(domain.grid, voxel_mm));
  const Grid& grid = mask.grid;
  const Vec3 origin = index_from_lps(domain.grid, grid.origin_mm);
  const Vec3 step{grid.spacing_mm.x / domain.grid.spacing_mm.x, grid.spacing_mm.y / domain.grid.spacing_mm.y,
                  grid.spacing_mm.z / domain.grid.spacing_mm.z};
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          const Vec3 index = origin + Vec3{static_cast<double>(i) * step.x, static_cast<double>(j) * step.y,
                                           static_cast<double>(k) * step.z};
          mask(i, j, k) = belongs(static_cast<Region>(region_at(domain, index)));
        }
  });
  return mask;
}

/// The cube of a volume in which a position lies, beyond the border the one on it, and the place in the cube.
struct Cube {
  const float* first;
  std::array<std::int64_t, 3> step;
  Vec3 fraction;
};

Cube cube_at(const LevelSet& volume, const Vec3& position) {
  const auto& size = volume.grid.size;
  std::array<std::int64_t, 3> base;
  Cube cube{nullptr, {1, size[0], size[0] * size[1]}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double index = position[axis] / volume.grid.spacing_mm[axis];
    const double inside = std::clamp(index, 0.0, static_cast<double>(size[a] - 1));
    base[a] = std::min(static_cast<std::int64_t>(inside), std::max<std::int64_t>(size[a] - 2, 0));
    if (size[a] < 2) cube.step[a] = 0;
    cube.fraction[axis] = inside - static_cast<double>(base[a]);
  }
  cube.first = &volume(base[0], base[1], base[2]);
  return cube;
}

/// A row of a cube: the value at the place in it, and the rise along it.
struct Row {
  double value = 0, rise = 0;
};

Row row_of(const Cube& cube, std::size_t row) {
  const float* q = cube.first + static_cast<std::int64_t>(row & 1U) * cube.step[1] +
                   static_cast<std::int64_t>(row >> 1U) * cube.step[2];
  const double rise = static_cast<double>(q[cube.step[0]]) - static_cast<double>(q[0]);
  return {static_cast<double>(q[0]) + cube.fraction.x * rise, rise};
}

/// A trilinear value and its gradient (per mm along the axes).
struct Sample {
  double value = 0;
  Vec3 gradient;
};

Sample sample(const LevelSet& volume, const Vec3& position) {
  const auto cube = cube_at(volume, position);
  const Vec3& f = cube.fraction;
  const std::array rows{row_of(cube, 0), row_of(cube, 1), row_of(cube, 2), row_of(cube, 3)};
  const double over_low = rows[1].value - rows[0].value, over_high = rows[3].value - rows[2].value;
  const double low = rows[0].value + f.y * over_low, high = rows[2].value + f.y * over_high;
  const double rise_low = rows[0].rise + f.y * (rows[1].rise - rows[0].rise);
  const double rise_high = rows[2].rise + f.y * (rows[3].rise - rows[2].rise);
  const auto& spacing = volume.grid.spacing_mm;
  return {low + f.z * (high - low),
          {(rise_low + f.z * (rise_high - rise_low)) / spacing.x, (over_low + f.z * (over_high - over_low)) / spacing.y,
           (high - low) / spacing.z}};
}

// The same value; most of the time nobody asks for more.
double value_at(const LevelSet& volume, const Vec3& position) {
  const auto cube = cube_at(volume, position);
  const auto across = [&](std::size_t row) {
    const double value = row_of(cube, row).value;
    return value + cube.fraction.y * (row_of(cube, row + 1).value - value);
  };
  const double low = across(0);
  return low + cube.fraction.z * (across(2) - low);
}

}  // namespace

LevelSet solid_level_set(const MeshDomain& domain, bool (*belongs)(Region), double voxel_mm, double smoothing_mm,
                         double thinnest_mm) {
  constexpr double least_smoothing_voxels = 1.3;  // less follows the stairs
  const auto mask = mask_of(domain, belongs, voxel_mm);
  auto level_set = segment::signed_distance(segment::open(segment::close(mask, thinnest_mm / 2), thinnest_mm / 2));
  Vec3 sigma;
  for (int axis = 0; axis < 3; ++axis)
    sigma[axis] = std::max(smoothing_mm / level_set.grid.spacing_mm[axis], least_smoothing_voxels);
  smooth(level_set, sharp_kernels(sigma));
  return level_set;
}

lattice::Materials materials_of(const LevelSet& solid, double edge_mm, double growth) {
  const Grid& grid = solid.grid;
  lattice::Materials materials;
  for (int axis = 0; axis < 3; ++axis) {
    materials.box_min_mm[axis] = -0.5 * grid.spacing_mm[axis];
    materials.box_max_mm[axis] =
        (static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5) * grid.spacing_mm[axis];
  }
  materials.finest_edge_mm = edge_mm;
  materials.label_at = [&solid](const Vec3& p) { return value_at(solid, p) < 0 ? 1 : 0; };
  materials.edge_mm = [&solid, edge_mm, growth](const Vec3& p) {
    return edge_mm + growth * std::max(0.0, std::abs(value_at(solid, p)) - edge_mm);
  };
  materials.equations_at = [&solid](lattice::LabelBits, const Vec3& p, std::span<lattice::Equation> equations) {
    const auto found = sample(solid, p);
    equations[0] = {found.value, found.gradient};
    return 1;
  };
  return materials;
}

}  // namespace heart::mesh
