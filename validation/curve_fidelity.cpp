// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/curve_fidelity.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <numeric>
#include <span>

#include "generator/parallel/threads.hpp"
#include "model/crop.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"
#include "model/mesh_queries/face_tree.hpp"
#include "model/mesh_queries/feature_curves.hpp"
#include "validation/quantiles.hpp"

namespace heartgen::validation {
namespace {

using Regions = std::uint32_t;  // bit R: region R, 0 the outside

constexpr double reach_edges = 2;
constexpr std::size_t min_edges = 10;

Regions bit_of(int region) { return Regions{1} << region; }

bool has_heart(Regions regions) {
  for (int r = 1; r < 32; ++r)
    if ((regions & bit_of(r)) != 0 && (is_myocardium(static_cast<Region>(r)) || is_blood(static_cast<Region>(r))))
      return true;
  return false;
}

/// An edge of a curve, and the regions around it.
struct CurveEdge {
  mesh_queries::NodePair nodes;
  std::size_t curve = 0;
  Regions regions = 0;
};

void add_regions(std::vector<CurveEdge>& edges, const std::vector<std::uint8_t>& on_curve, std::int32_t a,
                 std::int32_t b, int region) {
  if (on_curve[static_cast<std::size_t>(a)] == 0 || on_curve[static_cast<std::size_t>(b)] == 0) return;
  const mesh_queries::NodePair key{std::min(a, b), std::max(a, b)};
  const auto found = std::ranges::lower_bound(edges, key, {}, &CurveEdge::nodes);
  if (found != edges.end() && found->nodes == key) found->regions |= bit_of(region);
}

/// Edges around which three regions or more meet, one of the heart among them.
std::vector<CurveEdge> edges_of_heart(const TetMesh& mesh, const std::vector<MeshFace>& faces,
                                      const std::vector<mesh_queries::FeatureCurve>& curves) {
  std::vector<CurveEdge> edges;
  std::vector<std::uint8_t> on_curve(mesh.nodes_mm.size(), 0);
  for (std::size_t c = 0; c < curves.size(); ++c)
    for (const auto& nodes : curves[c].edges) {
      edges.push_back({nodes, c, 0});
      for (const auto n : nodes) on_curve[static_cast<std::size_t>(n)] = 1;
    }
  std::ranges::sort(edges, {}, &CurveEdge::nodes);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        add_regions(edges, on_curve, mesh.cells[c][i], mesh.cells[c][j], mesh.region[c]);
  for (const auto& face : faces)
    for (std::size_t i = 0; i < 3 && face.other < 0; ++i)
      add_regions(edges, on_curve, face.nodes[i], face.nodes[(i + 1) % 3], 0);
  std::erase_if(edges, [](const CurveEdge& e) { return std::popcount(e.regions) < 3 || !has_heart(e.regions); });
  return edges;
}

struct Sample {
  std::size_t curve = 0;
  double edges = 0;  // distance
};

/// Least radius around a place, across an edge, at which all regions are found.
double radius_of_regions(const LabelAt& label_at, Regions wanted, const Vec3& place, const Vec3& along,
                         double edge_mm) {
  constexpr int steps_per_edge = 25, directions = 24;
  const Vec3 other = std::abs(along.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalized(cross(along, other)), v = cross(along, u);
  Regions missing = wanted & ~bit_of(label_at(place));
  for (int step = 1; step < static_cast<int>(reach_edges) * steps_per_edge; ++step) {
    const double radius = static_cast<double>(step) / steps_per_edge;
    for (int d = 0; d < directions && missing != 0; ++d) {
      const double angle = 2 * std::numbers::pi * d / directions;
      const Vec3 way = math::cos(angle) * u + math::sin(angle) * v;
      missing &= ~bit_of(label_at(place + radius * edge_mm * way));
    }
    if (missing == 0) return radius;
  }
  return reach_edges;
}

std::vector<Sample> samples_to_labels(const TetMesh& mesh, const std::vector<CurveEdge>& edges,
                                      const LabelAt& label_at) {
  std::vector<Sample> samples(2 * edges.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(samples.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      const auto& edge = edges[s / 2];
      const Vec3 a = mesh.nodes_mm[static_cast<std::size_t>(edge.nodes[0])];
      const Vec3 b = mesh.nodes_mm[static_cast<std::size_t>(edge.nodes[1])];
      const Vec3 place = s % 2 == 0 ? a : 0.5 * (a + b);
      samples[s] = {edge.curve, radius_of_regions(label_at, edge.regions, place, normalized(b - a), norm(b - a))};
    }
  });
  return samples;
}

/// A place where three labels meet.
struct Meeting {
  Vec3 place_mm;
  Regions regions;
};

/// The regions at the corners of a cube: corner c at (c & 1, c >> 1 & 1, c >> 2).
using Corners = std::array<Regions, 8>;

Vec3 corner_at(unsigned c) {
  return {static_cast<double>(c & 1U), static_cast<double>(c >> 1U & 1U), static_cast<double>(c >> 2U)};
}

/// Halves a cube (low corner and width in voxels) until it is small; those in which three labels or more meet are kept.
void find_meetings(const Grid& grid, const LabelAt& label_at, const Vec3& low, double width, const Corners& corners,
                   std::vector<Meeting>& meetings) {
  constexpr double smallest = 0.25;
  const Regions found = std::accumulate(corners.begin(), corners.end(), Regions{0}, std::bit_or<>());
  if (std::popcount(found) < 2) return;
  if (width <= smallest) {
    const Vec3 middle = low + 0.5 * width * Vec3{1, 1, 1};
    if (std::popcount(found) > 2 && has_heart(found)) meetings.push_back({lps_from_index(grid, middle), found});
    return;
  }
  std::array<Regions, 27> halves;  // at the corners, and halfway between them
  for (unsigned h = 0; h < 27; ++h) {
    const unsigned x = h % 3, y = h / 3 % 3, z = h / 9;
    const bool is_corner = x != 1 && y != 1 && z != 1;
    const Vec3 at{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    halves[h] = is_corner ? corners[x / 2 + y / 2 * 2 + z / 2 * 4]
                          : bit_of(label_at(lps_from_index(grid, low + 0.5 * width * at)));
  }
  for (unsigned child = 0; child < 8; ++child) {
    const unsigned first = (child & 1U) + (child >> 1U & 1U) * 3 + (child >> 2U) * 9;
    Corners of_child;
    for (unsigned c = 0; c < 8; ++c) of_child[c] = halves[first + (c & 1U) + (c >> 1U & 1U) * 3 + (c >> 2U) * 9];
    find_meetings(grid, label_at, low + 0.5 * width * corner_at(child), 0.5 * width, of_child, meetings);
  }
}

/// Whether three labels or more, one of the heart among them, occur around a cube of voxel centres.
bool may_meet(const LabelVolume& labels, const Index3& low) {
  Regions found = 0;
  for (auto k = low[2] - 1; k <= low[2] + 2; ++k)
    for (auto j = low[1] - 1; j <= low[1] + 2; ++j)
      for (auto i = low[0] - 1; i <= low[0] + 2; ++i) found |= bit_of(labels(i, j, k));
  return std::popcount(found) > 2 && has_heart(found);
}

std::vector<Meeting> meetings_of(const LabelVolume& whole, const LabelAt& label_at) {
  const auto labels = crop(whole, bounding_box(whole, 3, [](auto label) { return has_heart(bit_of(label)); }));
  const auto& size = labels.grid.size;
  if (size[2] < 4) return {};
  std::vector<std::vector<Meeting>> of_slice(static_cast<std::size_t>(size[2]));
  parallel::parallel_for(1, size[2] - 2, [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 1; j + 2 < size[1]; ++j)
        for (std::int64_t i = 1; i + 2 < size[0]; ++i) {
          if (!may_meet(labels, {i, j, k})) continue;
          const Vec3 low{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          Corners corners;
          for (unsigned c = 0; c < 8; ++c)
            corners[c] = bit_of(label_at(lps_from_index(labels.grid, low + corner_at(c))));
          find_meetings(labels.grid, label_at, low, 1, corners, of_slice[static_cast<std::size_t>(k)]);
        }
  });
  std::vector<Meeting> all;
  for (const auto& slice : of_slice) all.insert(all.end(), slice.begin(), slice.end());
  return all;
}

/// Edges as triangles without area, of which the tree finds the nearest.
std::vector<Sample> samples_from_labels(const TetMesh& mesh, const std::vector<CurveEdge>& edges,
                                        const std::vector<Meeting>& meetings) {
  std::vector<Face> lines;
  double mean_mm = 0;
  for (const auto& edge : edges) {
    lines.push_back({edge.nodes[0], edge.nodes[1], edge.nodes[1]});
    mean_mm += norm(mesh.nodes_mm[static_cast<std::size_t>(edge.nodes[1])] -
                    mesh.nodes_mm[static_cast<std::size_t>(edge.nodes[0])]) /
               static_cast<double>(edges.size());
  }
  const auto tree = mesh_queries::make_face_tree(mesh.nodes_mm, lines);
  std::vector<Sample> samples(meetings.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(samples.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      const Regions regions = meetings[s].regions;
      const auto nearest = mesh_queries::nearest_face(
          tree, meetings[s].place_mm, reach_edges * mean_mm,
          [&](std::int32_t e) { return (regions & ~edges[static_cast<std::size_t>(e)].regions) == 0; });
      samples[s] = {SIZE_MAX, reach_edges};
      if (nearest.face < 0) continue;
      samples[s] = {edges[static_cast<std::size_t>(nearest.face)].curve,
                    std::min(nearest.distance_mm / mean_mm, reach_edges)};
    }
  });
  return samples;
}

void add_distances(Report& rows, const std::string& scope, const std::string& metric,
                   const std::vector<Sample>& samples, const std::size_t* curve) {
  std::vector<double> edges;
  for (const auto& sample : samples)
    if (curve == nullptr || sample.curve == *curve) edges.push_back(sample.edges);
  if (edges.empty()) return;
  rows.push_back({"mesh", scope, metric + "_p50_in_edges", quantile(edges, 0.5), "edges", {}, {}});
  rows.push_back({"mesh", scope, metric + "_p99_in_edges", quantile(edges, 0.99), "edges", {}, {}});
}

double length_of(const TetMesh& mesh, const mesh_queries::FeatureCurve& curve) {
  double sum = 0;
  for (const auto& [a, b] : curve.edges)
    sum += norm(mesh.nodes_mm[static_cast<std::size_t>(b)] - mesh.nodes_mm[static_cast<std::size_t>(a)]);
  return sum;
}

}  // namespace

Report check_curves(const std::string& mesh_name, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                    const LabelVolume& labels, const LabelAt& label_at) {
  const auto curves = mesh_queries::feature_curves(mesh);
  const auto edges = edges_of_heart(mesh, faces, curves);
  if (edges.empty()) return {};
  const auto to_labels = samples_to_labels(mesh, edges, label_at);
  const auto from_labels = samples_from_labels(mesh, edges, meetings_of(labels, label_at));
  Report rows;
  add_distances(rows, mesh_name, "curve_to_level_set", to_labels, nullptr);
  add_distances(rows, mesh_name, "curve_from_level_set", from_labels, nullptr);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const auto count = std::ranges::count(edges, c, &CurveEdge::curve);
    if (static_cast<std::size_t>(count) < min_edges) continue;
    const std::string scope = mesh_name + "/" + mesh_queries::curve_name(curves[c]);
    rows.push_back({"mesh", scope, "curve_length", length_of(mesh, curves[c]), "mm", {}, {}});
    add_distances(rows, scope, "curve_to_level_set", to_labels, &c);
    add_distances(rows, scope, "curve_from_level_set", from_labels, &c);
  }
  return rows;
}

}  // namespace heartgen::validation
