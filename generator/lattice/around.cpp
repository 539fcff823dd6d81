#include "generator/lattice/around.hpp"

#include <algorithm>
#include <utility>

#include "generator/lattice/separate.hpp"

namespace heart::lattice {

FacesByHeight by_height(const Complex& c, const std::vector<Face>& faces) {
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

Around faces_around(const Complex& whole, const FacesByHeight& outer, const Place& place) {
  const auto box = box_around(place.part.nodes_mm);
  Around around;
  for (Face face : outer.between(box.low.z, box.high.z)) {
    if (!box.meets(box_of(whole, face))) continue;
    bool is_part = false;
    for (auto& n : face) {
      const auto found = std::lower_bound(place.nodes.begin(), place.nodes.end(), n);
      if (found != place.nodes.end() && *found == n) {
        const auto own = static_cast<std::int32_t>(found - place.nodes.begin());
        is_part = is_part || !place.part.is_frozen(own);
        n = -1 - own;
      } else {
        around.nodes_mm.push_back(whole.at(n));
        n = static_cast<std::int32_t>(around.nodes_mm.size()) - 1;
      }
    }
    if (!is_part) around.faces.push_back(face);
  }
  return around;
}

std::size_t count_meeting(const Complex& part, const Around& around) {
  auto faces = outer_faces(part);
  if (faces.empty()) return 0;
  auto nodes_mm = part.nodes_mm;
  const auto offset = static_cast<std::int32_t>(nodes_mm.size());
  nodes_mm.insert(nodes_mm.end(), around.nodes_mm.begin(), around.nodes_mm.end());
  for (Face face : around.faces) {
    for (auto& n : face) n = n < 0 ? -1 - n : n + offset;
    faces.push_back(face);
  }
  return meeting_faces(nodes_mm, faces).size();
}

}  // namespace heart::lattice
