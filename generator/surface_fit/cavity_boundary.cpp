// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/surface_fit/cavity_boundary.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "generator/surface_fit/self_intersections.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::surface_fit {

FacesByHeight by_height(const tetmesh::Complex& c, const std::vector<Face>& faces) {
  FacesByHeight result;
  std::vector<std::pair<double, Face>> order;
  order.reserve(faces.size());
  for (const auto& face : faces) {
    const auto [low, high] = std::minmax({c.at(face[0]).z, c.at(face[1]).z, c.at(face[2]).z});
    order.emplace_back(low, face);
    result.tallest_mm = std::max(result.tallest_mm, high - low);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [low, face] : order) {
    result.faces.push_back(face);
    result.low_z_mm.push_back(low);
  }
  return result;
}

namespace {

// Place of a number in an ascending list; -1 where it is not there.
std::int32_t place_in(const std::vector<std::int32_t>& list, std::int32_t number) {
  const auto found = std::ranges::lower_bound(list, number);
  return found != list.end() && *found == number ? static_cast<std::int32_t>(found - list.begin()) : -1;
}

}  // namespace

tetmesh::Box reach_of(const tetmesh::Cavity& place) {
  auto box = tetmesh::box_around(place.part.nodes_mm);
  const auto width = static_cast<double>(std::ranges::max(place.part.spacing_mm));
  box.low -= Vec3{width, width, width};
  box.high += Vec3{width, width, width};
  return box;
}

CavityBoundary faces_around(const tetmesh::Complex& whole, const FacesByHeight& outer, const tetmesh::Cavity& place) {
  CavityBoundary around{reach_of(place), {}, {}};
  const auto moves_with_part = [&](std::int32_t n) {
    const auto own = place_in(place.nodes, n);
    return own >= 0 && !place.part.is_frozen(own);
  };
  std::vector<std::int32_t> others;  // nodes of the whole
  for (const Face& face : outer.between(around.reach.low.z, around.reach.high.z)) {
    if (!around.reach.meets(tetmesh::box_of(whole, face)) || std::ranges::any_of(face, moves_with_part)) continue;
    around.faces.push_back(face);
    std::ranges::copy_if(face, std::back_inserter(others), [&](auto n) { return place_in(place.nodes, n) < 0; });
  }
  sort_unique(others);
  for (const auto n : others) around.nodes_mm.push_back(whole.at(n));
  for (Face& face : around.faces)
    for (auto& n : face) {
      const auto own = place_in(place.nodes, n);
      n = own >= 0 ? -1 - own : place_in(others, n);
    }
  return around;
}

bool is_within_reach(const tetmesh::Complex& part, const CavityBoundary& around) {
  return std::ranges::all_of(part.nodes_mm, [&](const Vec3& p) { return around.reach.contains(p); });
}

std::size_t count_meeting(const tetmesh::Complex& part, const CavityBoundary& around) {
  auto faces = outer_faces(part);
  if (faces.empty()) return 0;
  auto nodes_mm = part.nodes_mm;
  const auto offset = static_cast<std::int32_t>(nodes_mm.size());
  nodes_mm.insert(nodes_mm.end(), around.nodes_mm.begin(), around.nodes_mm.end());
  for (Face face : around.faces) {
    for (auto& n : face) n = n < 0 ? -1 - n : n + offset;
    faces.push_back(face);
  }
  return self_intersecting_faces(nodes_mm, faces).size();
}

}  // namespace heartgen::surface_fit
