// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/walls.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

#include "generator/mesh/border.hpp"
#include "generator/mesh/level_set_at.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/mesh/open_labels.hpp"
#include "generator/mesh/own_edges.hpp"
#include "generator/mesh/size_field.hpp"
#include "generator/mesh/sort_cells.hpp"
#include "generator/mesh/surfaces.hpp"
#include "generator/parallel/threads.hpp"
#include "model/crop.hpp"
#include "model/error.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::mesh {
namespace {

constexpr double voxel_mm = 0.5;        // of the solid
constexpr double junction_edges = 1.5;  // junctions of walls are smoothed by so much
// A wall that ends in a wedge between two others, or in a skin over one, cannot be followed there: it ends as wide as
// this, and its junctions are smoothed again.
constexpr double narrowest_part_edges = 1, blunt_junction_edges = 1;
// Sheets nearer than these could pass through each other. The end of a gap is as round as the gap is wide: in narrower
// ones than an edge or so, between papillary muscles and at the grooves' bottoms, no face fits.
constexpr double narrowest_voxels_mm = 1, thinnest_wall_edges = 0.8, narrowest_gap_edges = 1.6;
constexpr std::int64_t margin = 8;  // voxels around the walls
constexpr std::int64_t crumb_cells = 30;

bool is_wall(std::uint8_t label) { return is_myocardium(static_cast<Region>(label)); }

LevelSet distance_of(const MeshDomain& domain, std::uint8_t label, double smoothing_mm) {
  Mask mask(domain.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) mask.voxels[v] = domain.voxels[v] == label;
  return smooth_distance(mask, smoothing_mm);
}

/// Place of the nearest wall in `labels`.
template <class ValueOf>
std::size_t nearest(const WallLevelSets& walls, const ValueOf& value_of) {
  std::size_t best = 0;
  auto least = value_of(walls.distances[0]);
  for (std::size_t i = 1; i < walls.distances.size(); ++i)
    if (const auto value = value_of(walls.distances[i]); value < least) {
      least = value;
      best = i;
    }
  return best;
}

// Distances are trilinear in a cube: what is nearest at its eight corners is nearest in it.
std::vector<std::uint8_t> find_cubes(const WallLevelSets& walls) {
  const Grid& grid = walls.domain.grid;
  Volume<std::uint8_t> at(grid), cubes(grid);
  const auto each_slice = [&](const auto& work) { parallel::parallel_for(0, grid.size[2], work); };
  each_slice([&](std::int64_t begin, std::int64_t end) {
    for (auto v = grid.offset(0, 0, begin); v < grid.offset(0, 0, end); ++v) {
      const auto voxel = static_cast<std::size_t>(v);
      at.voxels[voxel] = walls.labels[nearest(walls, [&](const LevelSet& d) { return d.voxels[voxel]; })];
    }
  });
  each_slice([&](std::int64_t begin, std::int64_t end) {
    const auto& last = grid.size;
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < last[1]; ++j)
        for (std::int64_t i = 0; i < last[0]; ++i) {
          bool is_one = true;
          for (int corner = 1; corner < 8 && is_one; ++corner)
            is_one = at(std::min(i + (corner & 1), last[0] - 1), std::min(j + (corner >> 1 & 1), last[1] - 1),
                        std::min(k + (corner >> 2), last[2] - 1)) == at(i, j, k);
          cubes(i, j, k) = is_one ? at(i, j, k) : MeshDomain::mixed;
        }
  });
  return std::move(cubes.voxels);
}

/// In mm along the axes of a grid, voxel (0, 0, 0) at the origin.
Vec3 position_of(const Grid& grid, const Vec3& lps_mm) {
  const Vec3 index = index_from_lps(grid, lps_mm);
  return {index.x * grid.spacing_mm.x, index.y * grid.spacing_mm.y, index.z * grid.spacing_mm.z};
}

std::uint8_t nearest_at(const WallLevelSets& walls, const Vec3& position) {
  const Grid& grid = walls.domain.grid;
  Index3 cube;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double index = position[axis] / grid.spacing_mm[axis];
    cube[a] = static_cast<std::int64_t>(std::clamp(index, 0.0, static_cast<double>(grid.size[a] - 1)));
  }
  const auto label = walls.cubes[static_cast<std::size_t>(grid.offset(cube[0], cube[1], cube[2]))];
  if (label != MeshDomain::mixed) return label;
  return walls.labels[nearest(walls, [&](const LevelSet& d) { return value_at(d, position); })];
}

int equations_at(const WallLevelSets& walls, const Vec3& shift, tetmesh::LabelBits labels, const Vec3& position,
                 std::span<tetmesh::Equation> equations) {
  std::size_t count = 0;
  const auto add = [&](const Sample& s) {
    if (count < equations.size()) equations[count++] = {s.value, s.gradient};
  };
  if ((labels & tetmesh::bit_of(0)) != 0) add(sample(walls.solid, position + shift));
  const auto regions = labels & ~tetmesh::bit_of(0);
  if (std::popcount(regions) < 2) return static_cast<int>(count);  // most nodes: no interface
  bool has_first = false;
  Sample first;
  for (std::size_t i = 0; i < walls.labels.size(); ++i) {
    if ((regions & tetmesh::bit_of(walls.labels[i])) == 0) continue;
    const auto here = sample(walls.distances[i], position);
    if (has_first) add({here.value - first.value, here.gradient - first.gradient});
    if (!std::exchange(has_first, true)) first = here;
  }
  return static_cast<int>(count);
}

tetmesh::Materials materials_of(const WallLevelSets& walls, const Volume<float>& sizes) {
  auto materials = materials_of(walls.domain, sizes);
  const Vec3 shift = position_of(walls.solid.grid, walls.domain.grid.origin_mm);
  materials.label_at = [&walls, shift](const Vec3& p) {
    return is_negative_at(walls.solid, walls.signs, p + shift) ? nearest_at(walls, p) : 0;
  };
  materials.equations_at = [&walls, shift](tetmesh::LabelBits labels, const Vec3& p,
                                           std::span<tetmesh::Equation> equations) {
    return equations_at(walls, shift, labels, p, equations);
  };
  return materials;
}

/// The region beyond an outer face, whose normal points outwards: the first that is no wall, at most a few edges away.
Region region_beyond(const MeshDomain& domain, const std::array<Vec3, 3>& p) {
  const Vec3 area = cross(p[1] - p[0], p[2] - p[0]), center = (p[0] + p[1] + p[2]) / 3;
  const double edge = std::sqrt(norm(area));
  for (const double way : {0.3, 0.7, 1.2, 2.0}) {
    const auto region = region_at(domain, index_from_lps(domain.grid, center + way * edge / norm(area) * area));
    if (!is_wall(region)) return static_cast<Region>(region);
  }
  return Region::none;
}

std::array<Vec3, 3> corners(const TetMesh& mesh, const Face& face) {
  return {mesh.nodes_mm[static_cast<std::size_t>(face[0])], mesh.nodes_mm[static_cast<std::size_t>(face[1])],
          mesh.nodes_mm[static_cast<std::size_t>(face[2])]};
}

/// A side of an outer face, and the region beyond that face.
struct Side {
  std::pair<std::int32_t, std::int32_t> edge;
  Region beyond;
};

/// Where the outer faces around each node have different pools of blood beyond them. `beyond` is per face.
std::vector<std::uint8_t> is_between_pools(const TetMesh& mesh, const std::vector<Region>& beyond) {
  std::vector<Region> pool(mesh.nodes_mm.size(), Region::none);
  std::vector<std::uint8_t> is_between(mesh.nodes_mm.size(), 0);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (!is_blood(beyond[f])) continue;
    for (const auto n : mesh.faces[f]) {
      auto& first = pool[static_cast<std::size_t>(n)];
      if (first == Region::none) first = beyond[f];
      if (first != beyond[f]) is_between[static_cast<std::size_t>(n)] = 1;
    }
  }
  return is_between;
}

/// Ascending by edge.
std::vector<Side> sides_between_pools(const TetMesh& mesh, const std::vector<Region>& beyond) {
  const auto is_between = is_between_pools(mesh, beyond);
  std::vector<Side> sides;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t i = 0; i < 3 && is_blood(beyond[f]); ++i) {
      const auto [a, b] = std::minmax(mesh.faces[f][i], mesh.faces[f][(i + 1) % 3]);
      if (is_between[static_cast<std::size_t>(a)] != 0 && is_between[static_cast<std::size_t>(b)] != 0)
        sides.push_back({{a, b}, beyond[f]});
    }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.edge < b.edge; });
  return sides;
}

/// Where two pools of blood meet at the wall.
std::vector<Rim> rims_of(const TetMesh& mesh, const std::vector<Region>& beyond) {
  const auto sides = sides_between_pools(mesh, beyond);
  std::map<std::int32_t, std::vector<std::int32_t>> nodes;
  for (std::size_t s = 0; s + 1 < sides.size(); ++s) {
    const Side &one = sides[s], &other = sides[s + 1];
    if (one.edge == other.edge && one.beyond != other.beyond) {
      auto& rim = nodes[surface_between(one.beyond, other.beyond)];
      rim.insert(rim.end(), {one.edge.first, one.edge.second});
    }
  }
  std::vector<Rim> rims;
  for (auto& [surface, rim] : nodes) {
    if (!surface_name(surface).ends_with("_orifice")) continue;
    sort_unique(rim);
    rims.push_back(rim_of(mesh, surface));  // for its name
    rims.back().nodes = std::move(rim);
  }
  return rims;
}

constexpr std::int32_t unnamed = -1;  // and less: minus the tag of the wall

/// Names the outer faces and finds the rims between them.
void name_outer_faces(const MeshDomain& domain, TetMesh& mesh) {
  std::vector<Region> beyond(mesh.faces.size(), Region::none);
  parallel::parallel_for(0, static_cast<std::int64_t>(beyond.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      auto& surface = mesh.surface[f];
      if (surface > unnamed) continue;
      beyond[f] = region_beyond(domain, corners(mesh, mesh.faces[f]));
      surface = surface_between(static_cast<Region>(-surface), beyond[f]);
    }
  });
  mesh.rims = rims_of(mesh, beyond);
}

}  // namespace

std::uint8_t nearest_wall(const WallLevelSets& walls, const Vec3& lps_mm) {
  return nearest_at(walls, position_of(walls.domain.grid, lps_mm));
}

int wall_at(const WallLevelSets& walls, const Vec3& lps_mm) {
  const Vec3 position = position_of(walls.solid.grid, lps_mm);
  return is_negative_at(walls.solid, walls.signs, position) ? nearest_wall(walls, lps_mm) : 0;
}

namespace {

LabelVolume labels_on(const Grid& grid, const WallLevelSets& walls) {
  LabelVolume labels(grid);
  const auto& size = labels.grid.size;
  parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j)
        for (std::int64_t i = 0; i < size[0]; ++i)
          labels(i, j, k) = static_cast<std::uint8_t>(wall_at(
              walls,
              lps_from_index(labels.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})));
  });
  return labels;
}

// To one of the labels, on its grid around it.
LevelSet distance_around(const LabelVolume& labels, std::uint8_t label, double smoothing_mm) {
  const auto& spacing = labels.grid.spacing_mm;
  const double margin_mm = 3 * smoothing_mm, finest = std::min({spacing.x, spacing.y, spacing.z});
  const auto box = bounding_box(labels, static_cast<std::int64_t>(std::ceil(margin_mm / finest)),
                                [&](std::uint8_t other) { return other == label; });
  auto mask = crop(labels, box);
  for (auto& voxel : mask.voxels) voxel = voxel == label;
  return box.empty() ? LevelSet{} : smooth_distance(mask, smoothing_mm);
}

// Sets a distance where another one, on voxels of its own, is known.
void replace(LevelSet& distance, const LevelSet& known) {
  const auto& size = distance.grid.size;
  const auto is_inside = [&](const Vec3& index) {
    for (int axis = 0; axis < 3; ++axis)
      if (index[axis] < 0 || index[axis] > static_cast<double>(known.grid.size[static_cast<std::size_t>(axis)] - 1))
        return false;
    return true;
  };
  parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j)
        for (std::int64_t i = 0; i < size[0]; ++i) {
          const Vec3 index{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          const Vec3 there = index_from_lps(known.grid, lps_from_index(distance.grid, index));
          if (is_inside(there)) distance(i, j, k) = static_cast<float>(sample_linear(known, there));
        }
  });
}

void blunt_wedges(WallLevelSets& walls, double edge_mm) {
  auto labels = labels_on(walls.solid.grid, walls);
  open_labels(labels, walls.labels, 0.5 * narrowest_part_edges * edge_mm);
  for (std::size_t i = 0; i < walls.labels.size(); ++i) {
    const auto known = distance_around(labels, walls.labels[i], blunt_junction_edges * edge_mm);
    if (!known.voxels.empty()) replace(walls.distances[i], known);
  }
}

}  // namespace

LabelVolume labels_of(const WallLevelSets& walls) { return labels_on(walls.domain.grid, walls); }

WallLevelSets wall_level_sets(const LabelVolume& labels, const MeshSettings& settings) {
  const auto box = bounding_box(labels, margin, is_wall);
  if (box.empty()) throw UserError("the label map has no wall of the heart", "mesh", "give one with walls");
  WallLevelSets walls;
  walls.domain = make_domain(crop(labels, box), settings);
  walls.solid = wall_level_set(walls.domain, voxel_mm,
                               {.wall_mm = std::max(narrowest_voxels_mm, thinnest_wall_edges * settings.heart_edge_mm),
                                .gap_mm = std::max(narrowest_voxels_mm, narrowest_gap_edges * settings.heart_edge_mm)});
  walls.signs = signs_of(walls.solid);
  for (const auto& share : walls.domain.shares) {
    if (!is_wall(share.label)) continue;
    walls.labels.push_back(share.label);
    walls.distances.push_back(distance_of(walls.domain, share.label,
                                          std::max(settings.smoothing_mm, junction_edges * settings.heart_edge_mm)));
  }
  walls.cubes = find_cubes(walls);
  blunt_wedges(walls, settings.heart_edge_mm);
  walls.cubes = find_cubes(walls);
  return walls;
}

TetMesh mesh_walls(const WallLevelSets& walls, const MeshSettings& settings, LatticeReport* report,
                   const Volume<float>* own_edges_mm) {
  check_settings(settings);
  const auto own = own_edges_mm == nullptr ? std::vector<float>{} : own_edges_on(*own_edges_mm, walls.domain.grid);
  LabelSet inside{};
  for (const auto label : walls.labels) inside[label] = true;
  const auto sizes = size_field(walls.domain, settings, inside, own);
  auto cells =
      collect(lattice_complex(materials_of(walls, sizes), std::span(&inside, 1), crumb_cells, report, one_material),
              walls.domain.grid);
  sort_cells(cells.nodes_mm, cells.cells, cells.label);
  auto mesh = assemble(
      cells, [](std::int32_t label) { return label > 0; },
      [](std::int32_t label, std::int32_t other) {
        return other == 0 ? -label : surface_between(static_cast<Region>(label), static_cast<Region>(other));
      });
  label_border_faces(mesh, walls.domain.grid);
  name_outer_faces(walls.domain, mesh);
  return mesh;
}

}  // namespace heartgen::mesh
