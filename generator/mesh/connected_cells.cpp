#include "generator/mesh/connected_cells.hpp"

#include <algorithm>

#include "generator/parallel/threads.hpp"

namespace heart::mesh {
namespace {

/// A face of a cell, by the two nodes besides its smallest.
struct HalfFace {
  std::int32_t middle, last, cell;
  std::size_t corner;
};

// The faces with several labels at one of their nodes whose smallest node is `node`.
void collect_half_faces(const Tetrahedra& t, std::int32_t node, std::vector<HalfFace>& halves) {
  halves.clear();
  const auto is_mixed = [&](std::int32_t n) { return t.is_mixed[static_cast<std::size_t>(n)] != 0; };
  for (const auto c : t.stars.of(node)) {
    const Cell& cell = t.cell(c);
    if (std::none_of(cell.begin(), cell.end(), is_mixed)) continue;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      if (cell[corner] == node) continue;
      const auto& [i, j, k] = face_corners[corner];
      const auto least = std::min({cell[i], cell[j], cell[k]});
      if (least != node || (!is_mixed(cell[i]) && !is_mixed(cell[j]) && !is_mixed(cell[k]))) continue;
      const auto most = std::max({cell[i], cell[j], cell[k]});
      halves.push_back({cell[i] ^ cell[j] ^ cell[k] ^ least ^ most, most, c, corner});
    }
  }
}

// Every face has one smallest node; around that node its two cells are found among few.
void connect_neighbours(Tetrahedra& t) {
  t.neighbours.assign(t.cells->size(), {unknown, unknown, unknown, unknown});
  const auto across = [&](const HalfFace& half) -> std::int32_t& {
    return t.neighbours[static_cast<std::size_t>(half.cell)][half.corner];
  };
  parallel::parallel_for(0, static_cast<std::int64_t>(t.nodes->size()), [&](std::int64_t begin, std::int64_t end) {
    std::vector<HalfFace> halves;
    for (auto node = begin; node < end; ++node) {
      collect_half_faces(t, static_cast<std::int32_t>(node), halves);
      while (!halves.empty()) {
        const HalfFace half = halves.back();
        halves.pop_back();
        const auto other = std::find_if(halves.begin(), halves.end(), [&](const HalfFace& h) {
          return h.middle == half.middle && h.last == half.last;
        });
        across(half) = other == halves.end() ? hull : other->cell;
        if (other == halves.end()) continue;
        across(*other) = half.cell;
        *other = halves.back();
        halves.pop_back();
      }
    }
  });
}

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

std::int32_t Tetrahedra::find_across(std::int32_t c, std::size_t corner) const {
  const auto& [i, j, k] = face_corners[corner];
  const Cell& own = cell(c);
  const auto has = [&](const Cell& other, std::int32_t n) {
    return other[0] == n || other[1] == n || other[2] == n || other[3] == n;
  };
  for (const auto other : stars.of(own[i]))
    if (other != c && has(cell(other), own[j]) && has(cell(other), own[k])) return other;
  return hull;
}

Tetrahedra connect(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells, std::vector<std::int32_t>& label) {
  Tetrahedra t{&nodes, &cells, &label, lattice::stars_of(nodes.size(), cells), {}, {}};
  t.is_mixed = mixed_nodes(t);
  connect_neighbours(t);
  return t;
}

}  // namespace heart::mesh
