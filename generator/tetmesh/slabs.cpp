// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/slabs.hpp"

#include <algorithm>
#include <array>

#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/box.hpp"

namespace heartgen::tetmesh {
namespace {

/// The greatest extent of a cell along each axis.
Vec3 widest_cell(const Complex& c) {
  std::vector<Vec3> of_piece(static_cast<std::size_t>(parallel::thread_count()));
  parallel::parallel_for(
      0, static_cast<std::int64_t>(c.cells.size()), [&](std::int64_t begin, std::int64_t end, int piece) {
        Vec3 widest;
        for (auto i = begin; i < end; ++i) {
          const Cell& cell = c.cell(static_cast<std::int32_t>(i));
          if (cell[0] < 0) continue;
          const Box box = box_around(std::array{c.at(cell[0]), c.at(cell[1]), c.at(cell[2]), c.at(cell[3])});
          for (int axis = 0; axis < 3; ++axis) widest[axis] = std::max(widest[axis], box.high[axis] - box.low[axis]);
        }
        of_piece[static_cast<std::size_t>(piece)] = widest;
      });
  Vec3 widest;
  for (const auto& of_one : of_piece)
    for (int axis = 0; axis < 3; ++axis) widest[axis] = std::max(widest[axis], of_one[axis]);
  return widest;
}

}  // namespace

std::size_t Slabs::of(const Vec3& p) const {
  const double number = (p[axis] - low_mm) / step_mm;
  return number <= 0 ? 0 : std::min(static_cast<std::size_t>(number), count - 1);
}

Slabs slabs_across(const Complex& complex, int cells, std::size_t max_slabs) {
  constexpr double rounding = 1.01;
  constexpr std::size_t default_slabs = 12;
  Slabs slabs;
  const auto wanted = static_cast<double>(std::min(max_slabs, default_slabs));
  if (complex.nodes_mm.empty() || wanted < 2) return slabs;
  Vec3 low = complex.nodes_mm[0], high = low;
  for (const auto& p : complex.nodes_mm)
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  const Vec3 widest = widest_cell(complex);
  double most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = high[axis] - low[axis], width = std::max(rounding * cells * widest[axis], extent / wanted);
    if (!(width > 0) || extent <= most) continue;
    most = extent;
    slabs = {axis, low[axis], width, static_cast<std::size_t>(extent / width) + 1};
  }
  return slabs;
}

}  // namespace heartgen::tetmesh
