#include "generator/mesh/size_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace heart::mesh {
namespace {

std::array<float, 256> edge_of_region(const MeshSettings& settings) {
  std::array<float, 256> edge;
  edge.fill(static_cast<float>(settings.torso_edge_mm));
  for (const auto& row : region_table()) {
    const auto region = static_cast<Region>(row.tag);
    auto& value = edge[static_cast<std::size_t>(row.tag)];
    if (is_myocardium(region)) value = static_cast<float>(settings.heart_edge_mm);
    if (is_blood(region)) value = static_cast<float>(std::min(settings.blood_edge_mm, settings.torso_edge_mm));
  }
  return edge;
}

Grid coarse_grid(const Grid& grid, double sample_mm) {
  Grid coarse = grid;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto factor = std::max<std::int64_t>(1, std::llround(sample_mm / grid.spacing_mm[axis]));
    coarse.size[a] = (grid.size[a] + factor - 1) / factor;
    coarse.spacing_mm[axis] *= static_cast<double>(factor);
  }
  return coarse;
}

// The finest edge of the voxels around each coarse sample.
Volume<float> finest_edges(const MeshDomain& domain, const MeshSettings& settings) {
  Volume<float> sizes(coarse_grid(domain.grid, settings.heart_edge_mm), std::numeric_limits<float>::max());
  const auto edge = edge_of_region(settings);
  std::array<std::int64_t, 3> factor;
  for (int axis = 0; axis < 3; ++axis)
    factor[static_cast<std::size_t>(axis)] = std::llround(sizes.grid.spacing_mm[axis] / domain.grid.spacing_mm[axis]);
  const auto& size = domain.grid.size;
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j) {
      float* row = &sizes(0, j / factor[1], k / factor[2]);
      for (std::int64_t i = 0; i < size[0]; ++i, ++voxel) {
        float& value = row[i / factor[0]];
        value = std::min(value, edge[domain.voxels[voxel]]);
      }
    }
  return sizes;
}

struct Neighbour {
  std::int64_t di, dj, dk;
  float rise_mm;
};

// The 13 neighbours that come earlier in memory order, with the growth allowed on the way from them.
std::array<Neighbour, 13> earlier_neighbours(const Vec3& spacing, double growth) {
  std::array<Neighbour, 13> result;
  std::size_t count = 0;
  for (int dk = -1; dk <= 0; ++dk)
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (dk == 0 && (dj > 0 || (dj == 0 && di >= 0))) continue;
        const double length = norm(Vec3{di * spacing.x, dj * spacing.y, dk * spacing.z});
        result[count++] = {di, dj, dk, static_cast<float>(growth * length)};
      }
  return result;
}

// A sweep in memory order (sign 1) or against it (sign -1); the two together propagate along straight lines, which is
// exact for chamfer distances around convex sources and close enough for an edge length.
void limit_growth(Volume<float>& sizes, double growth, int sign) {
  const auto& grid = sizes.grid;
  const auto neighbours = earlier_neighbours(grid.spacing_mm, growth);
  const std::int64_t count = grid.voxel_count();
  for (std::int64_t step = 0; step < count; ++step) {
    const std::int64_t at = sign > 0 ? step : count - 1 - step;
    const std::int64_t i = at % grid.size[0], j = at / grid.size[0] % grid.size[1],
                       k = at / (grid.size[0] * grid.size[1]);
    float& value = sizes.voxels[static_cast<std::size_t>(at)];
    for (const auto& n : neighbours) {
      const std::int64_t ni = i + sign * n.di, nj = j + sign * n.dj, nk = k + sign * n.dk;
      if (grid.contains(ni, nj, nk)) value = std::min(value, sizes(ni, nj, nk) + n.rise_mm);
    }
  }
}

}  // namespace

Volume<float> size_field(const MeshDomain& domain, const MeshSettings& settings) {
  auto sizes = finest_edges(domain, settings);
  for (int repeat = 0; repeat < 2; ++repeat)
    for (const int sign : {1, -1}) limit_growth(sizes, settings.growth, sign);
  return sizes;
}

double edge_at(const Volume<float>& sizes, const Vec3& lps_mm) {
  return sample_linear(sizes, index_from_lps(sizes.grid, lps_mm));
}

}  // namespace heart::mesh
