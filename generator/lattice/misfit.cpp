#include "generator/lattice/misfit.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "generator/lattice/feature.hpp"
#include "generator/parallel/threads.hpp"

namespace heart::lattice {
namespace {

// How far from a point a region (0: the outside) is found, in steps; a little beyond the last one where it is not. To
// first order, distances say nothing of this: where a region ends in a tail, both sides are as near beyond its end.
double reach_of(const Materials& materials, int region, const Vec3& from, double edge) {
  constexpr std::array steps{0.05, 0.1, 0.15, 0.2, 0.25, 0.28, 0.31, 0.4, 0.55, 0.75, 1.0, 1.4};  // edges
  constexpr double beyond = 2;
  if (materials.label_at(from) == region) return 0;
  for (const double step : steps)
    for (int k = -1; k <= 1; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          if (i == 0 && j == 0 && k == 0) continue;
          const Vec3 way{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          if (materials.label_at(from + step * edge / norm(way) * way) == region) return step * edge;
        }
  return beyond * edge;
}

double reach_of_all(const Materials& materials, LabelBits labels, const Vec3& from, double edge) {
  double farthest = 0;
  for (int region = 0; region < first_side; ++region)
    if ((labels & bit_of(region)) != 0) farthest = std::max(farthest, reach_of(materials, region, from, edge));
  return farthest;
}

// Of nodes on surfaces and curves, to the farthest of those surfaces, or of the regions that meet there; 0 of others.
double distance_of_node(const Complex& c, const Materials& materials, std::int32_t node) {
  const LabelBits labels = c.bits(node), regions = labels & ~side_bits & ~bit_of(0);
  if (!is_constrained(labels)) return 0;
  const double distance = distance_to(feature_at(materials, labels, c.at(node)));
  if (!is_constrained(regions)) return distance;
  return std::max(distance, reach_of_all(materials, regions, c.at(node),
                                         static_cast<double>(c.spacing_mm[static_cast<std::size_t>(node)])));
}

// Distance of a face's centre or, if that is greater, of its nodes from their surfaces and regions, in its mean edges.
template <class DistanceOfNode>
double error_of(const Complex& c, const Materials& materials, const SurfaceFace& face,
                const DistanceOfNode& distance_of) {
  constexpr double aside = 0.15;  // of the edge
  const Vec3 a = c.at(face.nodes[0]), b = c.at(face.nodes[1]), d = c.at(face.nodes[2]);
  const double edge = (norm(b - a) + norm(d - b) + norm(a - d)) / 3;
  const Vec3 center = (a + b + d) / 3;
  double farthest = distance_to(feature_at(materials, face.labels, center));
  for (const auto n : face.nodes) farthest = std::max(farthest, distance_of(n));
  const Vec3 way = aside * edge * normalized(cross(b - a, d - a));
  const LabelBits found = bit_of(materials.label_at(center + way)) | bit_of(materials.label_at(center - way));
  return std::max(farthest, reach_of_all(materials, face.labels & ~found, center, edge)) / edge;
}

}  // namespace

Face sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

std::vector<Face> misfits(const Complex& c, const Materials& materials, const FitSettings& settings,
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
    if (error[f] > settings.aim && (faces[f].labels & settings.labels) != 0)
      found.emplace_back(-error[f], sorted(faces[f].nodes));
  std::sort(found.begin(), found.end());
  std::vector<Face> worst;
  worst.reserve(found.size());
  for (const auto& [error_below_0, face] : found) worst.push_back(face);
  return worst;
}

Fitness fitness_of(const Complex& part, const Materials& materials, const FitSettings& settings) {
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
    if (is_cut || (face.labels & settings.labels) == 0) continue;
    const double error = error_of(part, materials, face, distance_of);
    if (error > found.error) {
      found.worst = face.nodes;
      found.error = error;
    }
    const double beyond = std::max(0.0, error - settings.aim);
    found.misery += beyond * beyond;
    found.misfits += beyond > 0;
  }
  return found;
}

}  // namespace heart::lattice
