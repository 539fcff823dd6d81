// SPDX-License-Identifier: GPL-3.0-or-later
// The stand-in fibre atlas: two idealised ventricles as a structured mesh. The left ventricle is a stack of
// confocal-like ellipsoids (index i around, j from apex to base, k through the wall). The right ventricle is a second
// stack of sheets over the left one's outer surface. Where a sheet ends it meets that surface in nodes that lie on the
// left ventricle's but are its own: fibres jump there, from the left epicardium's to those of the right wall. Every box
// of the index grid is split into Kuhn's six tetrahedra; those that lose a corner to a shared node are dropped.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "datasets/phantom/phantom.hpp"
#include "model/mathematics.hpp"

namespace heartgen::phantom {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr int around_count = 52, along_count = 22, lv_layers = 4, rv_layers = 4;

// Sizes in mm: a heart a little smaller and thicker than the phantom's.
constexpr double lv_radius = 22, lv_length = 55, lv_wall = 10.5, lv_apex_wall = 7.5, base_height = 22;
constexpr double rv_reach = 25, rv_wall = 4.2, rv_height = 74, rv_half_angle = 1.15;

/// A point of the atlas with its material frame; local frame: z from apex to base, x towards the right ventricle.
struct AtlasNode {
  Vec3 at, outward, around;
  double depth = 0;
};

Vec3 left_point(double angle, double share, double depth) {
  const double radius = lv_radius + lv_wall * depth, length = lv_length + lv_apex_wall * depth;
  const double polar = math::acos(-base_height / length) * share;
  const double r = radius * math::sin(polar);
  return {r * math::cos(angle), r * math::sin(angle), -length * math::cos(polar)};
}

/// How far a sheet of the right ventricle stands off the left one's outer surface; 0 outside its rim.
double full_offset(double angle, double share, double depth) {
  const double grow = 0.13 * depth;
  const double across = angle / (rv_half_angle + grow);
  const double down = (base_height - left_point(angle, share, 1).z) / (rv_height + 8 * depth);
  const double rest = 1 - across * across - down * down * std::abs(down);
  return rest > 0 ? (rv_reach + rv_wall * depth) * std::sqrt(rest) : 0;
}

/// The sheet ends where it would come too close to the left ventricle for cells of a good shape.
bool is_attached(double angle, double share, double depth) {
  return full_offset(angle, share, depth) < 2.2 + 2.2 * depth;
}

Vec3 right_point(double angle, double share, double depth) {
  const double offset = full_offset(angle, share, depth);
  return left_point(angle, share, 1) + Vec3{offset * math::cos(0.8 * angle), offset * math::sin(0.8 * angle), 0};
}

/// Depth of the sheet whose rim passes through a point of the attachment: 0 at the cavity's edge, 1 at the outer one.
double depth_at_attachment(double angle, double share) {
  if (is_attached(angle, share, 1)) return 1;
  double attached = 0, free = 1;
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = 0.5 * (attached + free);
    (is_attached(angle, share, middle) ? attached : free) = middle;
  }
  return free;
}

/// Position and frame by central differences of the sheet's parametrisation.
template <class Point>
AtlasNode node_on_sheet(const Point& point, double angle, double share, double depth) {
  constexpr double h = 1e-4;
  AtlasNode node;
  node.depth = depth;
  node.at = point(angle, share, depth);
  const Vec3 around = point(angle + h, share, depth) - point(angle - h, share, depth);
  const Vec3 along = point(angle, share + h, depth) - point(angle, share - h, depth);
  node.outward = normalized(cross(around, along));
  const Vec3 up = Vec3{0, 0, 1} - node.outward.z * node.outward;
  node.around = normalized(cross(up, node.outward));
  return node;
}

struct AtlasBuilder {
  TetMesh mesh;
  std::map<std::array<int, 4>, std::int32_t> ids;  // wall, i, j, k to node

  std::int32_t add(const std::array<int, 4>& key, const AtlasNode& node) {
    const auto [entry, is_new] = ids.try_emplace(key, static_cast<std::int32_t>(mesh.nodes_mm.size()));
    if (is_new) {
      const double helix = pi / 3 * (1 - 2 * node.depth);
      const Vec3 along = cross(node.outward, node.around);
      mesh.nodes_mm.push_back(node.at);
      mesh.node_fibers.fiber.push_back(math::cos(helix) * node.around + math::sin(helix) * along);
      mesh.node_fibers.sheet.push_back(node.outward);
    }
    return entry->second;
  }

  std::int32_t left(int i, int j, int k) {
    const double depth = static_cast<double>(k) / lv_layers;
    i = j == 0 ? 0 : i % around_count;  // the apex is one node per layer
    AtlasNode node =
        node_on_sheet(left_point, 2 * pi * i / around_count, std::max(j, 1) / static_cast<double>(along_count), depth);
    if (j == 0) {
      node.at = {0, 0, -lv_length - lv_apex_wall * depth};
      node.outward = {0, 0, -1};
      node.around = {0, 1, 0};
    }
    return add({0, i, j, k}, node);
  }

  std::int32_t right(int i, int j, int k) {
    const double angle = 2 * pi * i / around_count, share = j / static_cast<double>(along_count);
    const double depth = static_cast<double>(k) / rv_layers;
    if (!is_attached(angle, share, depth)) return add({1, i, j, k}, node_on_sheet(right_point, angle, share, depth));
    const double rim = depth_at_attachment(angle, share);
    AtlasNode node = is_attached(angle, share, rim) ? node_on_sheet(left_point, angle, share, 1)
                                                    : node_on_sheet(right_point, angle, share, rim);
    node.at = left_point(angle, share, 1);
    node.depth = rim;
    return add({2, i, j, 0}, node);
  }

  /// Splits a box with corners numbered by bits (1: around, 2: along, 4: through).
  void add_box(const std::array<std::int32_t, 8>& corner, Region region) {
    constexpr std::array<std::array<int, 2>, 6> paths = {{{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}}};
    for (const auto& path : paths) {
      Cell cell = {corner[0], corner[static_cast<std::size_t>(path[0])], corner[static_cast<std::size_t>(path[1])],
                   corner[7]};
      Cell sorted = cell;
      std::sort(sorted.begin(), sorted.end());
      if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) continue;
      if (cell_volume_mm3(mesh, cell) < 0) std::swap(cell[2], cell[3]);
      mesh.cells.push_back(cell);
      mesh.region.push_back(tag(region));
    }
  }
};

void add_left(AtlasBuilder& builder) {
  for (int k = 0; k < lv_layers; ++k)
    for (int j = 0; j < along_count; ++j)
      for (int i = 0; i < around_count; ++i) {
        std::array<std::int32_t, 8> corner;
        for (int c = 0; c < 8; ++c)
          corner[static_cast<std::size_t>(c)] = builder.left(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2));
        builder.add_box(corner, Region::lv_myocardium);
      }
}

void add_right(AtlasBuilder& builder) {
  constexpr int half = around_count / 4 + 2;  // columns on either side of the septum's middle
  for (int k = 0; k < rv_layers; ++k)
    for (int j = 1; j < along_count; ++j)
      for (int i = -half; i < half; ++i) {
        std::array<std::int32_t, 8> corner;
        for (int c = 0; c < 8; ++c)
          corner[static_cast<std::size_t>(c)] = builder.right(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2));
        builder.add_box(corner, Region::rv_myocardium);
      }
}

/// Nodes of boxes that vanished whole go.
void drop_unused_nodes(TetMesh& mesh) {
  std::vector<std::int32_t> number(mesh.nodes_mm.size(), -1);
  for (const Cell& cell : mesh.cells)
    for (const auto node : cell) number[static_cast<std::size_t>(node)] = 0;
  std::int32_t kept = 0;
  auto& fibers = mesh.node_fibers;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] < 0) continue;
    const auto to = static_cast<std::size_t>(kept);
    mesh.nodes_mm[to] = mesh.nodes_mm[n];
    fibers.fiber[to] = fibers.fiber[n];
    fibers.sheet[to] = fibers.sheet[n];
    number[n] = kept++;
  }
  mesh.nodes_mm.resize(static_cast<std::size_t>(kept));
  fibers.fiber.resize(mesh.nodes_mm.size());
  fibers.sheet.resize(mesh.nodes_mm.size());
  for (Cell& cell : mesh.cells)
    for (auto& node : cell) node = number[static_cast<std::size_t>(node)];
}

/// A pose of the atlas's own: not the phantom's, not axis-aligned.
void place(TetMesh& mesh) {
  const Vec3 to_base = normalized({-0.52, 0.66, 0.54}), guess{-0.75, -0.62, 0.0};
  const Vec3 to_right = normalized(guess - dot(guess, to_base) * to_base);
  const Mat3 turn = transposed(Mat3{{to_right, cross(to_base, to_right), to_base}});
  for (auto& p : mesh.nodes_mm) p = Vec3{12, -25, 40} + turn * p;
  auto& fibers = mesh.node_fibers;
  for (auto* field : {&fibers.fiber, &fibers.sheet})
    for (auto& v : *field) v = normalized(turn * v);
  for (std::size_t n = 0; n < fibers.fiber.size(); ++n)
    fibers.sheet_normal.push_back(normalized(cross(fibers.fiber[n], fibers.sheet[n])));
}

}  // namespace

TetMesh make_standin_atlas() {
  AtlasBuilder builder;
  add_left(builder);
  add_right(builder);
  drop_unused_nodes(builder.mesh);
  place(builder.mesh);
  builder.mesh.fiber_source.assign(builder.mesh.nodes_mm.size(), static_cast<std::uint8_t>(FiberSource::rule));
  return std::move(builder.mesh);
}

}  // namespace heartgen::phantom
