// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mesh_queries/feature_curves.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "model/labels.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::mesh_queries {
namespace {

/// An edge of a labelled face.
struct Side {
  NodePair nodes;
  std::int32_t surface;
  bool operator==(const Side&) const = default;
  bool operator<(const Side& side) const { return std::tie(nodes, surface) < std::tie(side.nodes, side.surface); }
};

std::vector<Side> sides_of_faces(const TetMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax(mesh.faces[f][i], mesh.faces[f][(i + 1) % 3]);
      sides.push_back({{a, b}, mesh.surface[f]});
    }
  sort_unique(sides);
  return sides;
}

}  // namespace

std::vector<FeatureCurve> feature_curves(const TetMesh& mesh) {
  const auto sides = sides_of_faces(mesh);
  std::map<std::vector<std::int32_t>, std::vector<NodePair>> found;
  std::vector<std::int32_t> surfaces;
  for (std::size_t s = 0; s < sides.size();) {
    surfaces.clear();
    std::size_t next = s;
    for (; next < sides.size() && sides[next].nodes == sides[s].nodes; ++next) surfaces.push_back(sides[next].surface);
    if (surfaces.size() > 1) found[surfaces].push_back(sides[s].nodes);
    s = next;
  }
  std::vector<FeatureCurve> curves;
  curves.reserve(found.size());
  for (auto& [tags, edges] : found) curves.push_back({tags, std::move(edges)});
  return curves;
}

std::string curve_name(const FeatureCurve& curve) {
  std::vector<std::string> names;
  for (const auto tag : curve.surfaces) names.push_back(surface_name(tag));
  return fmt::format("{}", fmt::join(names, "+"));
}

}  // namespace heartgen::mesh_queries
