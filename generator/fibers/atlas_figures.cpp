// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/atlas_figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "model/mathematics.hpp"
#include "model/mesh_queries/mesh_edges.hpp"
#include "model/quantile.hpp"

namespace heartgen::fibers {
namespace {

constexpr std::size_t max_samples = 20000;

double helix_of(const AxisTensor& local) {
  ventricles::WallPoint own;  // the tensors' frame
  own.normal = {0, 0, 1}, own.longitudinal = {0, 1, 0}, own.circumferential = {1, 0, 0};
  return helix_angle_deg(own, leading_axis(local));
}

void add(DepthSamples& samples, double depth, double helix_deg) {
  samples.depth.push_back(static_cast<float>(depth));
  samples.helix_deg.push_back(static_cast<float>(helix_deg));
}

/// Every so-manieth voxel: they are all of one volume.
DepthSamples of_atlas(const AngleSamples& samples, const std::vector<double>& depth) {
  DepthSamples result;
  for (std::size_t n = 0; n < depth.size(); n += depth.size() / max_samples + 1)
    add(result, depth[n], helix_of(samples.tensor[n]));
  return result;
}

/// A quarter of the cells around each node.
std::vector<double> node_volumes(const TetMesh& mesh) {
  std::vector<double> volume(mesh.nodes_mm.size());
  for (const Cell& cell : mesh.cells) {
    const Vec3& o = mesh.nodes_mm[static_cast<std::size_t>(cell[0])];
    const auto edge = [&](std::size_t n) { return mesh.nodes_mm[static_cast<std::size_t>(cell[n])] - o; };
    const double share = dot(edge(1), cross(edge(2), edge(3))) / 24;
    for (const auto n : cell) volume[static_cast<std::size_t>(n)] += share;
  }
  return volume;
}

/// 1: in this ventricle alone and carried there.
bool counts(const CarriedAxes& c, bool left, std::size_t n) {
  return c.use[n] && c.walls.known[n] && c.walls.left_share[n] == (left ? 1 : 0);
}

/// Nodes of one ventricle, evenly by volume: a mesh has more nodes at surfaces and in thin walls than elsewhere. A node
/// may come more than once.
std::vector<std::size_t> places(const CarriedAxes& c, bool left) {
  const auto volume = node_volumes(c.mesh);
  double total = 0;
  std::size_t count = 0;
  for (std::size_t n = 0; n < volume.size(); ++n)
    if (counts(c, left, n)) total += volume[n], ++count;
  const double step = total / static_cast<double>(std::min(count, max_samples));
  std::vector<std::size_t> result;
  double passed = 0;
  for (std::size_t n = 0; n < volume.size(); ++n) {
    if (!counts(c, left, n)) continue;
    passed += volume[n];
    while (passed > (static_cast<double>(result.size()) + 0.5) * step && result.size() < max_samples)
      result.push_back(n);
  }
  return result;
}

void add_carried(const RegisteredPair& hearts, const CarriedAxes& c, bool left, AtlasFigures& figures) {
  const AngleSamples& samples = left ? hearts.by_place.lv : hearts.by_place.rv;
  const auto& depth = left ? hearts.atlas_depth.lv : hearts.atlas_depth.rv;
  auto& carried = left ? figures.carried.lv : figures.carried.rv;
  auto& there = left ? figures.there.lv : figures.there.rv;
  std::vector<WallFeature> features;
  for (const auto n : places(c, left)) {
    const auto& at = left ? c.walls.lv[n] : c.walls.rv[n];
    add(carried, at.depth, helix_angle_deg(at, c.fiber[n]));
    features.push_back(feature_in_atlas(hearts, left, c.atlas_mm[n], at));
  }
  for (const auto n : nearest_samples(samples, features)) add(there, depth[n], helix_of(samples.tensor[n]));
}

double angle_deg(const Vec3& f, const Vec3& g) {
  return math::atan2(norm(cross(f, g)), std::abs(dot(f, g))) * 180 / std::numbers::pi;
}

double quantile_or_0(std::vector<double> values, double share) { return values.empty() ? 0 : quantile(values, share); }

double p99(std::vector<double> values) { return quantile_or_0(std::move(values), 0.99); }

/// Along the edges of the atlas's own cells.
void set_edge_turns(const FiberAtlas& atlas, AtlasFigures& figures) {
  std::vector<double> jumps, turns, lengths;
  for (const auto& [first, second] : mesh_queries::edges_of_cells(atlas.cells, atlas.points_mm.size())) {
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    const double length = norm(atlas.points_mm[a] - atlas.points_mm[b]);
    if (atlas.fiber[a] == Vec3{} || atlas.fiber[b] == Vec3{} || length <= 0) continue;
    jumps.push_back(angle_deg(atlas.fiber[a], atlas.fiber[b]));
    turns.push_back(jumps.back() / length);
    lengths.push_back(length);
  }
  figures.jump_p99_deg = p99(std::move(jumps));
  figures.turn_p99_deg_per_mm = p99(std::move(turns));
  figures.edge_p50_mm = quantile_or_0(std::move(lengths), 0.5);
}

double carried_turn_per_wall(const CarriedAxes& c) {
  std::vector<double> turns;
  for (const auto& [first, second] : mesh_queries::edges_of_cells(c.mesh.cells, c.mesh.nodes_mm.size())) {
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    for (const bool left : {true, false}) {
      if (!counts(c, left, a) || !counts(c, left, b)) continue;
      const auto& walls = left ? c.walls.lv : c.walls.rv;
      const double length = std::max(norm(c.mesh.nodes_mm[a] - c.mesh.nodes_mm[b]), 1e-9);
      const double thickness = 0.5 * (walls[a].thickness_mm + walls[b].thickness_mm);
      turns.push_back(angle_deg(c.fiber[a], c.fiber[b]) * thickness / length);
    }
  }
  return p99(std::move(turns));
}

/// Per voxel of the atlas's image: its wall's thickness where it is a sample, else 0.
Volume<float> thickness_of_samples(const RegisteredPair& hearts) {
  Volume<float> thickness(hearts.atlas.fiber.grid);
  for (const bool left : {true, false}) {
    const auto& samples = left ? hearts.by_place.lv : hearts.by_place.rv;
    const auto& values = left ? hearts.atlas_thickness_mm.lv : hearts.atlas_thickness_mm.rv;
    for (std::size_t n = 0; n < values.size(); ++n) {
      const Vec3 index = index_from_lps(thickness.grid, place_of(samples.feature[n]));
      thickness(std::llround(index.x), std::llround(index.y), std::llround(index.z)) = static_cast<float>(values[n]);
    }
  }
  return thickness;
}

/// Between neighbouring voxels of the atlas's image: over the walls' thickness within one wall, per mm from one wall to
/// the other.
void set_voxel_turns(const RegisteredPair& hearts, AtlasFigures& figures) {
  const auto& parts = hearts.atlas.ventricles.parts;
  const auto& fiber = hearts.atlas.fiber;
  const auto thickness = thickness_of_samples(hearts);
  const Grid& g = fiber.grid;
  std::vector<double> per_wall, junction;
  const auto add_pair = [&](std::size_t a, std::size_t b) {
    if (!ventricles::is_wall(parts.voxels[a]) || !ventricles::is_wall(parts.voxels[b])) return;
    if (fiber.voxels[a] == Vec3{} || fiber.voxels[b] == Vec3{}) return;
    const double turn = angle_deg(fiber.voxels[a], fiber.voxels[b]) / g.spacing_mm.x;
    if (parts.voxels[a] != parts.voxels[b]) return junction.push_back(turn);
    if (thickness.voxels[a] > 0 && thickness.voxels[b] > 0)
      per_wall.push_back(turn * 0.5 * double{thickness.voxels[a] + thickness.voxels[b]});
  };
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        const auto v = static_cast<std::size_t>(g.offset(i, j, k));
        if (i + 1 < g.size[0]) add_pair(v, v + 1);
        if (j + 1 < g.size[1]) add_pair(v, v + static_cast<std::size_t>(g.size[0]));
        if (k + 1 < g.size[2]) add_pair(v, v + static_cast<std::size_t>(g.size[0] * g.size[1]));
      }
  figures.atlas_turn_p99_deg_per_wall = p99(std::move(per_wall));
  figures.atlas_junction_turn_p99_deg_per_mm = p99(std::move(junction));
}

}  // namespace

AtlasFigures atlas_figures(const RegisteredPair& hearts, const FiberAtlas& atlas, const CarriedAxes& carried) {
  AtlasFigures figures;
  figures.atlas = {of_atlas(hearts.by_place.lv, hearts.atlas_depth.lv),
                   of_atlas(hearts.by_place.rv, hearts.atlas_depth.rv)};
  for (const bool left : {true, false}) add_carried(hearts, carried, left, figures);
  set_edge_turns(atlas, figures);
  figures.carried_turn_p99_deg_per_wall = carried_turn_per_wall(carried);
  set_voxel_turns(hearts, figures);
  return figures;
}

}  // namespace heartgen::fibers
