// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/size_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "generator/image/distance.hpp"
#include "generator/mesh/thin_walls.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/stuffing/octree.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::mesh {
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
  Vec3 first;  // centre of the first block of voxels
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto factor = std::max<std::int64_t>(1, std::llround(sample_mm / grid.spacing_mm[axis]));
    coarse.size[a] = (grid.size[a] + factor - 1) / factor;
    coarse.spacing_mm[axis] *= static_cast<double>(factor);
    first[axis] = 0.5 * static_cast<double>(factor - 1);
  }
  coarse.origin_mm = lps_from_index(grid, first);
  return coarse;
}

/// The finest of the walls' edge and of those that the user wants.
double finest_edge_mm(const MeshSettings& settings, std::span<const float> own_edges_mm) {
  double finest = settings.heart_edge_mm;
  for (const float edge : own_edges_mm)
    if (edge > 0) finest = std::min(finest, static_cast<double>(edge));
  return finest;
}

// The finest edge of the voxels around each coarse sample.
Volume<float> finest_edges(const MeshDomain& domain, const MeshSettings& settings, double sample_distance,
                           std::span<const float> own_edges_mm) {
  Volume<float> sizes(coarse_grid(domain.grid, sample_distance * finest_edge_mm(settings, own_edges_mm)),
                      std::numeric_limits<float>::max());
  const auto edge = edge_of_region(settings);
  std::array<std::int64_t, 3> factor;
  for (int axis = 0; axis < 3; ++axis)
    factor[static_cast<std::size_t>(axis)] = std::llround(sizes.grid.spacing_mm[axis] / domain.grid.spacing_mm[axis]);
  const auto& size = domain.grid.size;
  const auto lower_slice = [&](std::int64_t k) {
    auto voxel = static_cast<std::size_t>(domain.grid.offset(0, 0, k));
    for (std::int64_t j = 0; j < size[1]; ++j) {
      float* row = &sizes(0, j / factor[1], k / factor[2]);
      for (std::int64_t i = 0; i < size[0]; ++i, ++voxel) {
        float& value = row[i / factor[0]];
        const float own = own_edges_mm.empty() ? 0 : own_edges_mm[voxel];
        value = std::min(value, own > 0 ? own : edge[domain.voxels[voxel]]);
      }
    }
  };
  parallel::parallel_for(0, sizes.grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin * factor[2]; k < std::min(end * factor[2], size[2]); ++k) lower_slice(k);
  });
  return sizes;
}

// value[i] = min(value[i], from[i + d] + rise of the way) for d = -1, 0, 1.
void lower_by_row(float* value, const float* from, std::int64_t count, float straight, float oblique) {
  for (std::int64_t i = 0; i < count; ++i) value[i] = std::min(value[i], from[i] + straight);
  for (std::int64_t i = 1; i < count; ++i) value[i] = std::min(value[i], from[i - 1] + oblique);
  for (std::int64_t i = 0; i + 1 < count; ++i) value[i] = std::min(value[i], from[i + 1] + oblique);
}

// Unlike what would mend it, this needs no neighbour's result: a vector at a time.
bool grows_too_fast(const float* value, std::int64_t count, float along) {
  int found = 0;
  for (std::int64_t i = 1; i < count; ++i)
    found |= static_cast<int>(value[i] > value[i - 1] + along) | static_cast<int>(value[i - 1] > value[i] + along);
  return found != 0;
}

// A sweep over the rows in memory order (sign 1) or against it (sign -1): from the four neighbouring rows that come
// earlier, then along the row both ways. Two sweeps there and back propagate along straight lines, which is exact for
// chamfer distances around convex sources and close enough for an edge length.
void limit_growth(Volume<float>& sizes, double growth, int sign) {
  const auto& [count, rows, slices] = sizes.grid.size;
  const Vec3& spacing = sizes.grid.spacing_mm;
  const auto rise = [&](double x, double y, double z) { return static_cast<float>(growth * norm(Vec3{x, y, z})); };
  const float along = rise(spacing.x, 0, 0);
  for (std::int64_t step = 0; step < rows * slices; ++step) {
    const std::int64_t row = sign > 0 ? step : rows * slices - 1 - step;
    const std::int64_t j = row % rows, k = row / rows;
    float* value = &sizes(0, j, k);
    for (const auto& [dj, dk] : {std::pair{-1, -1}, {0, -1}, {1, -1}, {-1, 0}}) {
      const std::int64_t nj = j + sign * dj, nk = k + sign * dk;
      if (nj < 0 || nj >= rows || nk < 0 || nk >= slices) continue;
      const double y = dj * spacing.y, z = dk * spacing.z;
      lower_by_row(value, &sizes(0, nj, nk), count, rise(0, y, z), rise(spacing.x, y, z));
    }
    if (!grows_too_fast(value, count, along)) continue;
    for (std::int64_t i = 1; i < count; ++i) value[i] = std::min(value[i], value[i - 1] + along);
    for (std::int64_t i = count - 1; i > 0; --i) value[i - 1] = std::min(value[i - 1], value[i] + along);
  }
}

/// The label map on the grid of the sizes: the middle voxel of each block.
LabelVolume coarse_labels(const MeshDomain& domain, const Grid& coarse) {
  LabelVolume labels(coarse);
  std::array<std::int64_t, 3> factor;
  for (int axis = 0; axis < 3; ++axis)
    factor[static_cast<std::size_t>(axis)] = std::llround(coarse.spacing_mm[axis] / domain.grid.spacing_mm[axis]);
  std::size_t sample = 0;
  for (std::int64_t k = 0; k < coarse.size[2]; ++k)
    for (std::int64_t j = 0; j < coarse.size[1]; ++j)
      for (std::int64_t i = 0; i < coarse.size[0]; ++i, ++sample) {
        Index3 at{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis)
          at[axis] = std::min(at[axis] * factor[axis] + factor[axis] / 2, domain.grid.size[axis] - 1);
        labels.voxels[sample] = domain.voxels[static_cast<std::size_t>(domain.grid.offset(at[0], at[1], at[2]))];
      }
  return labels;
}

/// Samples next to one of another label; the ends of the image are no such place.
Mask interface_of(const LabelVolume& labels) {
  Mask mask(labels.grid, 0);
  const auto& size = labels.grid.size;
  const std::array<std::int64_t, 3> step{1, size[0], size[0] * size[1]};
  std::size_t sample = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++sample) {
        const Index3 at{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto next = sample + static_cast<std::size_t>(step[axis]);
          if (at[axis] + 1 < size[axis] && labels.voxels[sample] != labels.voxels[next])
            mask.voxels[sample] = mask.voxels[next] = 1;
        }
      }
  return mask;
}

// Parts of a region in which no ball of the radius fits get the edge `edge_mm`. The balls' centres are the places
// farther than the radius from every interface; what is farther than that from all of them is thin. (A place in one
// region is always farther from the balls of another.) Corners of thick parts are spared by the factor.
void lower_in_thin_parts(Volume<float>& sizes, const LabelVolume& labels, const LabelSet& resolved,
                         const Volume<float>& from_interface_mm, double radius_mm, double edge_mm) {
  constexpr double beyond_corners = 2;
  Mask centers(sizes.grid, 0);
  for (std::size_t v = 0; v < centers.voxels.size(); ++v)
    centers.voxels[v] = static_cast<double>(from_interface_mm.voxels[v]) >= radius_mm;
  const auto distance = image::distance_to(centers);
  for (std::size_t v = 0; v < sizes.voxels.size(); ++v)
    if (resolved[labels.voxels[v]] && static_cast<double>(distance.voxels[v]) > beyond_corners * radius_mm)
      sizes.voxels[v] = std::min(sizes.voxels[v], static_cast<float>(edge_mm));
}

bool have_longer_edges(const Volume<float>& sizes, const LabelVolume& labels, const LabelSet& regions, float edge_mm) {
  for (std::size_t v = 0; v < sizes.voxels.size(); ++v)
    if (regions[labels.voxels[v]] && sizes.voxels[v] > edge_mm) return true;
  return false;
}

// Whether any edge may have become shorter.
bool resolve_thin_parts(Volume<float>& sizes, const MeshDomain& domain, const MeshSettings& settings,
                        const LabelSet& resolved) {
  const double finest = finest_body_edge_mm(settings);
  const auto labels = coarse_labels(domain, sizes.grid);
  if (!have_longer_edges(sizes, labels, resolved, static_cast<float>(finest))) return false;
  const auto from_interface = image::distance_to(interface_of(labels));
  // The sample beside an interface is half a sample away from it.
  const Vec3& spacing = sizes.grid.spacing_mm;
  const double half_sample = 0.5 * std::min({spacing.x, spacing.y, spacing.z});
  const double coarsest = std::max(settings.torso_edge_mm, settings.heart_edge_mm);
  double edge = coarsest;
  while (edge > finest) {
    const double radius = std::max(0.4 * edge - half_sample, half_sample);
    lower_in_thin_parts(sizes, labels, resolved, from_interface, radius, std::max(0.5 * edge, finest));
    edge /= 2;
  }
  return true;
}

// Between samples of the size everything is interpolated: all eight around a place are lowered.
void lower_around(Volume<float>& sizes, const Vec3& lps_mm, float edge_mm) {
  const Vec3 index = index_from_lps(sizes.grid, lps_mm);
  Index3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto last = sizes.grid.size[a] - 1;
    low[a] = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(index[axis])), 0, last);
    high[a] = std::min(low[a] + 1, last);
  }
  for (auto k = low[2]; k <= high[2]; ++k)
    for (auto j = low[1]; j <= high[1]; ++j)
      for (auto i = low[0]; i <= high[0]; ++i) sizes(i, j, k) = std::min(sizes(i, j, k), edge_mm);
}

constexpr double max_cells = 2e7;

void refuse_too_many_cells(double thin_mm3, double edge_mm, int layers) {
  const double cells = stuffing::cells_per_cube * thin_mm3 / (edge_mm * edge_mm * edge_mm);
  if (cells <= max_cells) return;
  throw UserError(fmt::format("{} layers would put about {:.0f} million cells into thin walls", layers, cells / 1e6),
                  "recipe, [mesh] wall_layers", "ask for fewer layers or a longer heart_edge_mm");
}

void refine_thin_walls(Volume<float>& sizes, const MeshDomain& domain, const MeshSettings& settings) {
  // A shell of the lattice has so many layers over 95 % of its area (measured on spherical shells; tests).
  constexpr double edges_per_layer = 0.9;
  const double edge = settings.heart_edge_mm / 2;
  const auto& spacing = domain.grid.spacing_mm;
  const double sample_mm = std::max(settings.heart_edge_mm / 3, 0.5 * std::min({spacing.x, spacing.y, spacing.z}));
  const auto thin = thin_walls(domain, edges_per_layer * settings.wall_layers * settings.heart_edge_mm, sample_mm);
  const auto count = std::count(thin.voxels.begin(), thin.voxels.end(), std::uint8_t{1});
  refuse_too_many_cells(static_cast<double>(count) * sample_mm * sample_mm * sample_mm, edge, settings.wall_layers);
  const auto& size = thin.grid.size;
  std::size_t at = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++at) {
        if (thin.voxels[at] == 0) continue;
        const Vec3 index{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        lower_around(sizes, lps_from_index(thin.grid, index), static_cast<float>(edge));
      }
}

void refuse_too_many_own_cells(const Volume<float>& sizes, const MeshDomain& domain) {
  const auto labels = coarse_labels(domain, sizes.grid);
  const Vec3& spacing = sizes.grid.spacing_mm;
  double cubes = 0;  // of the edge
  for (std::size_t v = 0; v < sizes.voxels.size(); ++v)
    if (labels.voxels[v] != 0) cubes += spacing.x * spacing.y * spacing.z / math::pow(sizes.voxels[v], 3);
  const double cells = stuffing::cells_per_cube * cubes;
  if (cells <= max_cells) return;
  throw UserError(fmt::format("it asks for about {:.0f} million cells", cells / 1e6), "size field of the mesh",
                  "wish longer edges, or the short ones in a smaller part of the image");
}

}  // namespace

LabelSet regions_with_shape() {
  LabelSet regions;
  regions.fill(true);
  regions[0] = regions[tag(Region::torso)] = false;
  return regions;
}

Volume<float> size_field(const MeshDomain& domain, const MeshSettings& settings, const LabelSet& resolved,
                         std::span<const float> own_edges_mm) {
  constexpr double growth_around_thin_parts = 1;
  // Between samples, in heart edges. Distances to interfaces need fewer samples than edges do.
  const bool is_any_resolved = std::ranges::find(resolved, true) != resolved.end();
  const double sample_distance = is_any_resolved && settings.wall_layers <= 1 ? 1.5 : 1;
  auto sizes = finest_edges(domain, settings, sample_distance, own_edges_mm);
  const auto limit = [&](double growth) {
    for (int repeat = 0; repeat < 2; ++repeat)
      for (const int sign : {1, -1}) limit_growth(sizes, growth, sign);
  };
  limit(settings.growth);
  if (!own_edges_mm.empty()) refuse_too_many_own_cells(sizes, domain);
  bool is_lowered = settings.wall_layers > 1;  // one layer is always there
  if (is_lowered) refine_thin_walls(sizes, domain, settings);
  if (is_any_resolved) is_lowered = resolve_thin_parts(sizes, domain, settings, resolved) || is_lowered;
  if (is_lowered) limit(is_any_resolved ? std::max(growth_around_thin_parts, settings.growth) : settings.growth);
  return sizes;
}

double finest_body_edge_mm(const MeshSettings& settings) {
  constexpr double min_share = 0.25;  // of the torso's edge: details far from the heart may cost so much, not more
  return std::max(settings.heart_edge_mm, min_share * settings.torso_edge_mm);
}

double edge_at(const Volume<float>& sizes, const Vec3& lps_mm) {
  return sample_linear(sizes, index_from_lps(sizes.grid, lps_mm));
}

}  // namespace heartgen::mesh
