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

Box box_of(const Complex& c, const Face& face) {
  return box_around(std::array{c.at(face[0]), c.at(face[1]), c.at(face[2])});
}

std::size_t MarkedCubes::place(const Vec3& p, int axis) const {
  const double share = (p[axis] - all_.low[axis]) / std::max(all_.high[axis] - all_.low[axis], 1e-9);
  return static_cast<std::size_t>(std::clamp(share * side, 0.0, side - 1.0));
}

template <class Visit>
void MarkedCubes::for_cubes(const Box& box, const Visit& visit) const {
  for (auto k = place(box.low, 2); k <= place(box.high, 2); ++k)
    for (auto j = place(box.low, 1); j <= place(box.high, 1); ++j)
      for (auto i = place(box.low, 0); i <= place(box.high, 0); ++i) visit((k * side + j) * side + i);
}

MarkedCubes::MarkedCubes(std::span<const Box> boxes) {
  if (boxes.empty()) return;
  all_ = boxes.front();
  for (const auto& box : boxes) {
    all_.add(box.low);
    all_.add(box.high);
  }
  marked_.resize(side * side * side);
  for (const auto& box : boxes) for_cubes(box, [&](std::size_t cube) { marked_[cube] = 1; });
}

bool MarkedCubes::may_meet(const Box& box) const {
  if (marked_.empty() || !all_.meets(box)) return false;
  bool is_marked = false;
  for_cubes(box, [&](std::size_t cube) { is_marked = is_marked || marked_[cube] != 0; });
  return is_marked;
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
