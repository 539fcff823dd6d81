#include "generator/lattice/marked_cubes.hpp"

#include <algorithm>

namespace heart::lattice {

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

}  // namespace heart::lattice
