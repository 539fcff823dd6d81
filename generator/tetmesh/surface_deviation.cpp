// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/surface_deviation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/feature.hpp"

namespace heartgen::tetmesh {
namespace {

constexpr double nowhere = 2;  // edges: where a region is not found

// How far from a point a region (0: the outside) is found in one of 26 directions, in edges; `nowhere` where it is not,
// or not within the limit. To first order, distances say nothing of this: where a region ends in a tail, both sides are
// as near beyond its end.
double reach_of(const Materials& materials, int region, const Vec3& from, double edge_mm, double limit) {
  constexpr std::array steps{0.05, 0.1, 0.15, 0.2, 0.25, 0.28, 0.31, 0.4, 0.55, 0.75, 1.0, 1.4};  // edges
  constexpr int halvings = 3;                                                                     // of the last step
  if (materials.label_at(from) == region) return 0;
  double before = 0;
  for (std::size_t s = 0; s < steps.size() && before < limit; before = steps[s++])
    for (int k = -1; k <= 1; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          if (i == 0 && j == 0 && k == 0) continue;
          const Vec3 way =
              edge_mm * normalized(Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          double low = before, high = std::min(steps[s], limit);
          if (materials.label_at(from + high * way) != region) continue;
          for (int h = 0; h < halvings; ++h) {
            const double middle = 0.5 * (low + high);
            (materials.label_at(from + middle * way) == region ? high : low) = middle;
          }
          return high;
        }
  return nowhere;
}

double reach_of_all(const Materials& materials, LabelBits labels, const Vec3& from, double edge_mm, double limit) {
  double farthest = 0;
  for (int region = 0; region < first_side; ++region)
    if ((labels & bit_of(region)) != 0)
      farthest = std::max(farthest, reach_of(materials, region, from, edge_mm, limit));
  return farthest;
}

// The labels on both sides of a feature's surfaces, `aside_mm` from a place on it.
LabelBits labels_beside(const Materials& materials, const Feature& feature, const Vec3& place, double aside_mm) {
  LabelBits found = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(feature.count); ++i) {
    const Vec3 way = aside_mm * normalized(feature.equations[i].gradient);
    found |= bit_of(materials.label_at(place + way)) | bit_of(materials.label_at(place - way));
  }
  return found;
}

// Of nodes on surfaces and curves, to the farthest of those surfaces, or of the regions that meet there; 0 of others.
double distance_of_node(const Complex& c, const Materials& materials, std::int32_t node) {
  constexpr double aside = 0.05;  // of the lattice's width
  const LabelBits labels = c.bits(node);
  if (!is_constrained(labels)) return 0;
  const auto feature = feature_at(materials, labels, c.at(node));
  const double spacing = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(node)]);
  const LabelBits missing = labels & ~side_bits & ~labels_beside(materials, feature, c.at(node), aside * spacing);
  return std::max(distance_to(feature), spacing * reach_of_all(materials, missing, c.at(node), spacing, nowhere));
}

double mean_edge(const std::array<Vec3, 3>& p) {
  return (norm(p[1] - p[0]) + norm(p[2] - p[1]) + norm(p[0] - p[2])) / 3;
}

// Distance of a face's centre from its surface or, if that is greater, from the regions that should be on its two
// sides, in its mean edges; `nowhere` where that is beyond the limit.
double error_of_center(const Materials& materials, LabelBits labels, const std::array<Vec3, 3>& corners, double limit) {
  constexpr double aside = 0.15;  // of the edge
  const double edge = mean_edge(corners);
  const Vec3 center = (corners[0] + corners[1] + corners[2]) / 3;
  const double error = distance_to(feature_at(materials, labels, center)) / edge;
  if (error > limit) return nowhere;
  const Vec3 way = aside * edge * normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
  const LabelBits found = bit_of(materials.label_at(center + way)) | bit_of(materials.label_at(center - way));
  return std::max(error, reach_of_all(materials, labels & ~found, center, edge, limit));
}

// Of its centre or, if that is greater, of its nodes from their surfaces and regions.
template <class DistanceOfNode>
double error_of(const Complex& c, const Materials& materials, const SurfaceFace& face,
                const DistanceOfNode& distance_of) {
  const std::array corners{c.at(face.nodes[0]), c.at(face.nodes[1]), c.at(face.nodes[2])};
  double farthest = 0;
  for (const auto n : face.nodes) farthest = std::max(farthest, distance_of(n));
  return std::max(error_of_center(materials, face.labels, corners, std::numeric_limits<double>::infinity()),
                  farthest / mean_edge(corners));
}

}  // namespace

bool fits(const Materials& materials, LabelBits labels, const std::array<Vec3, 3>& corners, double limit) {
  return error_of_center(materials, labels, corners, limit) <= limit;
}

bool makes_face_deviate(const Complex& c, const Materials& materials, std::int32_t node, const Vec3& position,
                        std::int32_t merged, double limit) {
  if (std::isinf(limit)) return false;
  const auto faces = surface_faces_at(c, node);
  return std::any_of(faces.begin(), faces.end(), [&](const SurfaceFace& face) {
    if (std::ranges::find(face.nodes, merged) != face.nodes.end()) return false;
    const auto fits_with_node_at = [&](const Vec3& place) {
      std::array<Vec3, 3> corners;
      for (std::size_t i = 0; i < 3; ++i) corners[i] = face.nodes[i] == node ? place : c.at(face.nodes[i]);
      return fits(materials, face.labels, corners, limit);
    };
    return !fits_with_node_at(position) && fits_with_node_at(c.at(node));
  });
}

Face sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

std::vector<Face> deviating_faces(const Complex& c, const Materials& materials, double aim, LabelBits labels,
                                  const std::vector<SurfaceFace>& faces) {
  std::vector<double> error(faces.size()), off(c.nodes_mm.size(), 0);
  std::vector<std::uint8_t> is_asked(off.size(), 0);
  for (const auto& face : faces)
    for (const auto n : face.nodes) is_asked[static_cast<std::size_t>(n)] = 1;
  parallel::parallel_for(0, static_cast<std::int64_t>(off.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = begin; n < end; ++n)
      if (is_asked[static_cast<std::size_t>(n)] != 0)
        off[static_cast<std::size_t>(n)] = distance_of_node(c, materials, static_cast<std::int32_t>(n));
  });
  parallel::parallel_for(0, static_cast<std::int64_t>(faces.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f)
      error[f] = error_of(c, materials, faces[f], [&](std::int32_t n) { return off[static_cast<std::size_t>(n)]; });
  });
  std::vector<std::pair<double, Face>> found;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (error[f] > aim && (faces[f].labels & labels) != 0) found.emplace_back(-error[f], sorted(faces[f].nodes));
  std::sort(found.begin(), found.end());
  std::vector<Face> worst;
  worst.reserve(found.size());
  for (const auto& [error_below_0, face] : found) worst.push_back(face);
  return worst;
}

Fitness fitness_of(const Complex& part, const Materials& materials, double aim, LabelBits labels) {
  Fitness found;
  std::vector<double> off(part.nodes_mm.size(), -1);  // of the nodes that were asked for
  const auto distance_of = [&](std::int32_t n) {
    auto& distance = off[static_cast<std::size_t>(n)];
    if (distance < 0) distance = distance_of_node(part, materials, n);
    return distance;
  };
  for (const auto& face : surface_faces(part)) {
    const bool is_still = std::all_of(face.nodes.begin(), face.nodes.end(), [&](auto n) { return part.is_frozen(n); });
    const bool is_cut = is_still && (face.labels & bit_of(0)) != 0;
    if (is_cut || (face.labels & labels) == 0) continue;
    const double error = error_of(part, materials, face, distance_of);
    if (error > found.error) {
      found.worst = face.nodes;
      found.error = error;
    }
    const double beyond = std::max(0.0, error - aim);
    found.penalty += beyond * beyond;
    found.deviating_faces += beyond > 0;
  }
  return found;
}

}  // namespace heartgen::tetmesh
