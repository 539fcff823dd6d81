// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/connected_cells.hpp"

#include <algorithm>

#include "generator/parallel/threads.hpp"

namespace heartgen::mesh {
namespace {

Changes mixed_nodes(const Tetrahedra& t) {
  Changes is_mixed(t.nodes->size());
  parallel::parallel_for(0, static_cast<std::int64_t>(is_mixed.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = begin; n < end; ++n) {
      const auto star = t.stars.of(static_cast<std::int32_t>(n));
      is_mixed[static_cast<std::size_t>(n)] =
          std::any_of(star.begin(), star.end(), [&](std::int32_t c) { return t.label_of(c) != t.label_of(star[0]); });
    }
  });
  return is_mixed;
}

}  // namespace

std::int32_t Tetrahedra::across_among(std::span<const std::int32_t> star, std::int32_t c, std::size_t corner) const {
  const auto& [i, j, k] = face_corners[corner];
  const Cell& own = cell(c);
  for (const auto other : star)
    if (other != c && has(cell(other), own[i]) && has(cell(other), own[j]) && has(cell(other), own[k])) return other;
  return hull;
}

Tetrahedra connect(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells, std::vector<std::int32_t>& label) {
  Tetrahedra t{&nodes, &cells, &label, tetmesh::stars_of(nodes.size(), cells), {}};
  t.is_mixed = mixed_nodes(t);
  return t;
}

}  // namespace heartgen::mesh
