// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/surface_fit/marked_cubes.hpp"

#include <algorithm>

namespace heartgen::surface_fit {

MarkedCubes::Range MarkedCubes::range_of(const tetmesh::Box& box) const {
  const auto place = [&](const Vec3& p, int axis) {
    return static_cast<std::size_t>(std::clamp((p[axis] - all_.low[axis]) * per_mm_[axis], 0.0, side - 1.0));
  };
  Range range;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    range[a] = {place(box.low, axis), place(box.high, axis)};
  }
  return range;
}

template <class Visit>
void MarkedCubes::for_cubes(const tetmesh::Box& box, const Visit& visit) const {
  const auto [x, y, z] = range_of(box);
  for (auto k = z[0]; k <= z[1]; ++k)
    for (auto j = y[0]; j <= y[1]; ++j)
      for (auto i = x[0]; i <= x[1]; ++i) visit((k * side + j) * side + i);
}

MarkedCubes::MarkedCubes(std::span<const tetmesh::Box> boxes) {
  if (boxes.empty()) return;
  all_ = boxes.front();
  for (const auto& box : boxes) {
    all_.add(box.low);
    all_.add(box.high);
  }
  for (int axis = 0; axis < 3; ++axis) per_mm_[axis] = side / std::max(all_.high[axis] - all_.low[axis], 1e-9);
  marked_.resize(side * side * side);
  for (const auto& box : boxes) for_cubes(box, [&](std::size_t cube) { marked_[cube] = 1; });
}

bool MarkedCubes::may_meet(const tetmesh::Box& box) const {
  if (marked_.empty() || !all_.meets(box)) return false;
  bool is_marked = false;
  for_cubes(box, [&](std::size_t cube) { is_marked = is_marked || marked_[cube] != 0; });
  return is_marked;
}

}  // namespace heartgen::surface_fit
