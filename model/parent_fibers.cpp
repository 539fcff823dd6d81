// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/parent_fibers.hpp"

#include "model/error.hpp"

namespace heartgen {
namespace {

template <class T>
std::vector<T> scattered(const std::vector<T>& values, const std::vector<std::int32_t>& ids, std::size_t count) {
  if (values.empty()) return {};
  std::vector<T> result(count);
  for (std::size_t i = 0; i < ids.size(); ++i) result[static_cast<std::size_t>(ids[i])] = values[i];
  return result;
}

FiberField scattered(const FiberField& fibers, const std::vector<std::int32_t>& ids, std::size_t count) {
  return {scattered(fibers.fiber, ids, count), scattered(fibers.sheet, ids, count),
          scattered(fibers.sheet_normal, ids, count)};
}

void check_ids(const std::vector<std::int32_t>& ids, std::size_t own_count, std::size_t count) {
  bool fits = ids.size() == own_count;
  for (const auto id : ids) fits = fits && id >= 0 && static_cast<std::size_t>(id) < count;
  if (!fits) throw UserError("the parent ids are not those of the larger mesh", "fibres", "is the bundle whole?");
}

}  // namespace

void carry_fibers_to_parent(const TetMesh& part, TetMesh& whole) {
  if (part.parent_cell.empty() || part.cell_fibers.fiber.empty()) return;
  check_ids(part.parent_cell, part.cells.size(), whole.cells.size());
  check_ids(part.parent_node, part.nodes_mm.size(), whole.nodes_mm.size());
  whole.cell_fibers = scattered(part.cell_fibers, part.parent_cell, whole.cells.size());
  whole.node_fibers = scattered(part.node_fibers, part.parent_node, whole.nodes_mm.size());
  whole.fiber_source = scattered(part.fiber_source, part.parent_node, whole.nodes_mm.size());
}

}  // namespace heartgen
