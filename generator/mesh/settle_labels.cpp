#include "generator/mesh/settle_labels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "generator/parallel/threads.hpp"

namespace heart::mesh {
namespace {

struct Star {
  std::vector<std::int32_t> first;  // per node: where its cells begin
  std::vector<std::int32_t> cells;
  std::span<const std::int32_t> of(std::int32_t node) const {
    const auto n = static_cast<std::size_t>(node);
    return {cells.data() + first[n], static_cast<std::size_t>(first[n + 1] - first[n])};
  }
};

constexpr std::array<std::array<std::size_t, 3>, 4> face_corners{{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

struct Tetrahedra {
  const std::vector<Vec3>* nodes;
  const std::vector<Cell>* cells;
  std::vector<std::int32_t>* label;
  std::vector<std::array<std::int32_t, 4>> neighbours;  // across the face opposite to each corner; -1: the hull
  Star star;

  std::int32_t label_of(std::int32_t cell) const { return (*label)[static_cast<std::size_t>(cell)]; }
  const std::array<std::int32_t, 4>& around(std::int32_t cell) const {
    return neighbours[static_cast<std::size_t>(cell)];
  }
  const Cell& cell(std::int32_t c) const { return (*cells)[static_cast<std::size_t>(c)]; }
  const Vec3& corner(std::int32_t c, std::size_t i) const { return (*nodes)[static_cast<std::size_t>(cell(c)[i])]; }
  double volume(std::int32_t c) const {
    const Vec3& o = corner(c, 0);
    return std::abs(dot(corner(c, 1) - o, cross(corner(c, 2) - o, corner(c, 3) - o))) / 6;
  }
  double face_area(std::int32_t c, std::size_t opposite) const {
    const auto& [i, j, k] = face_corners[opposite];
    return norm(cross(corner(c, j) - corner(c, i), corner(c, k) - corner(c, i))) / 2;
  }
};

Star star_of(std::size_t nodes, const std::vector<Cell>& cells) {
  Star star;
  star.first.assign(nodes + 1, 0);
  for (const auto& cell : cells)
    for (const auto n : cell) ++star.first[static_cast<std::size_t>(n) + 1];
  for (std::size_t n = 0; n < nodes; ++n) star.first[n + 1] += star.first[n];
  star.cells.resize(4 * cells.size());
  auto next = star.first;
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const auto n : cells[c])
      star.cells[static_cast<std::size_t>(next[static_cast<std::size_t>(n)]++)] = static_cast<std::int32_t>(c);
  return star;
}

/// A face of a cell, by the two nodes besides its smallest.
struct HalfFace {
  std::int32_t middle, last, cell;
  std::size_t corner;
};

// The faces whose smallest node is `node`.
void collect_half_faces(const Tetrahedra& t, std::int32_t node, std::vector<HalfFace>& halves) {
  halves.clear();
  for (const auto c : t.star.of(node)) {
    const Cell& cell = t.cell(c);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      if (cell[corner] == node) continue;
      const auto& [i, j, k] = face_corners[corner];
      const auto least = std::min({cell[i], cell[j], cell[k]});
      if (least != node) continue;
      const auto most = std::max({cell[i], cell[j], cell[k]});
      halves.push_back({cell[i] ^ cell[j] ^ cell[k] ^ least ^ most, most, c, corner});
    }
  }
}

// Every face has one smallest node; around that node its two cells are found among few.
void connect_neighbours(Tetrahedra& t) {
  t.neighbours.assign(t.cells->size(), {-1, -1, -1, -1});
  parallel::parallel_for(0, static_cast<std::int64_t>(t.nodes->size()), [&](std::int64_t begin, std::int64_t end) {
    std::vector<HalfFace> halves;
    for (auto node = begin; node < end; ++node) {
      collect_half_faces(t, static_cast<std::int32_t>(node), halves);
      for (std::size_t h = 0; h < halves.size(); ++h)
        for (std::size_t g = h + 1; g < halves.size(); ++g) {
          if (halves[g].middle != halves[h].middle || halves[g].last != halves[h].last) continue;
          t.neighbours[static_cast<std::size_t>(halves[h].cell)][halves[h].corner] = halves[g].cell;
          t.neighbours[static_cast<std::size_t>(halves[g].cell)][halves[g].corner] = halves[h].cell;
          break;
        }
    }
  });
}

Tetrahedra connect(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells, std::vector<std::int32_t>& label) {
  Tetrahedra t{&nodes, &cells, &label, {}, star_of(nodes.size(), cells)};
  connect_neighbours(t);
  return t;
}

// The label across the most area of the group's outer faces, among those that `accept` takes; -1 if there is none.
std::int32_t most_touched(const Tetrahedra& t, const std::vector<std::int32_t>& group, const auto& accept) {
  std::array<double, 64> area{};
  for (const auto cell : group)
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const auto other = t.around(cell)[corner];
      const std::int32_t label = other < 0 ? 0 : t.label_of(other);
      if (accept(label)) area[static_cast<std::size_t>(label)] += t.face_area(cell, corner);
    }
  const auto most = std::max_element(area.begin(), area.end());
  return *most > 0 ? static_cast<std::int32_t>(most - area.begin()) : -1;
}

/// Per node, whether a cell around it has changed.
using Changes = std::vector<std::uint8_t>;

void note_change(const Tetrahedra& t, const std::vector<std::int32_t>& cells, Changes& changes) {
  for (const auto cell : cells)
    for (const auto corner : t.cell(cell)) changes[static_cast<std::size_t>(corner)] = 1;
}

std::int64_t absorb_crumbs(Tetrahedra& t, std::int64_t crumb_cells, Changes& made) {
  std::int64_t changed = 0;
  std::vector<bool> seen(t.cells->size(), false);
  for (std::size_t seed = 0; seed < t.cells->size(); ++seed) {
    if (seen[seed]) continue;
    std::vector<std::int32_t> piece{static_cast<std::int32_t>(seed)};
    const auto label = t.label_of(piece[0]);
    seen[seed] = true;
    bool on_hull = false;
    for (std::size_t next = 0; next < piece.size(); ++next)
      for (const auto other : t.around(piece[next])) {
        on_hull |= other < 0;
        if (other < 0 || seen[static_cast<std::size_t>(other)] || t.label_of(other) != label) continue;
        seen[static_cast<std::size_t>(other)] = true;
        piece.push_back(other);
      }
    if (static_cast<std::int64_t>(piece.size()) > crumb_cells || (label == 0 && on_hull)) continue;
    const auto other = most_touched(t, piece, [&](std::int32_t l) { return l != label; });
    if (other < 0) continue;
    for (const auto cell : piece) (*t.label)[static_cast<std::size_t>(cell)] = other;
    note_change(t, piece, made);
    changed += static_cast<std::int64_t>(piece.size());
  }
  return changed;
}

/// Cells of one star that hang together through faces at the vertex and are on the same side of a set.
struct Part {
  bool inside = false;
  double volume = 0;
  std::vector<std::int32_t> cells;
};

std::vector<Part> parts_of_star(const Tetrahedra& t, std::int32_t node, const LabelSet& set) {
  const auto star = t.star.of(node);
  const auto inside = [&](std::int32_t cell) { return set[static_cast<std::size_t>(t.label_of(cell))]; };
  std::vector<bool> seen(star.size(), false);
  const auto place = [&](std::int32_t cell) {
    return static_cast<std::size_t>(std::lower_bound(star.begin(), star.end(), cell) - star.begin());
  };
  std::vector<Part> parts;
  Part beyond_hull{false, std::numeric_limits<double>::max(), {}};  // all outer cells on the hull hang together
  bool has_hull = false;
  for (std::size_t seed = 0; seed < star.size(); ++seed) {
    if (seen[seed]) continue;
    Part part{inside(star[seed]), 0, {star[seed]}};
    seen[seed] = true;
    bool on_hull = false;
    for (std::size_t next = 0; next < part.cells.size(); ++next) {
      part.volume += t.volume(part.cells[next]);
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const auto cell = part.cells[next];
        if (t.cell(cell)[corner] == node) continue;  // the face opposite to the node
        const auto neighbour = t.around(cell)[corner];
        on_hull |= neighbour < 0;
        if (neighbour < 0 || inside(neighbour) != part.inside) continue;
        const auto other = place(neighbour);
        if (seen[other]) continue;
        seen[other] = true;
        part.cells.push_back(neighbour);
      }
    }
    has_hull |= on_hull;
    if (!on_hull || part.inside) parts.push_back(std::move(part));
  }
  if (has_hull) parts.push_back(std::move(beyond_hull));
  return parts;
}

bool is_mixed(const Tetrahedra& t, std::int32_t node, const LabelSet& set) {
  const auto star = t.star.of(node);
  const auto inside = [&](std::int32_t cell) { return set[static_cast<std::size_t>(t.label_of(cell))]; };
  return std::any_of(star.begin(), star.end(), [&](std::int32_t c) { return inside(c) != inside(star.front()); });
}

// The smallest part that is not the largest on its side; null where both sides hang together. With `only_inner`, a
// smallest inner part instead, be it the only one.
const Part* part_to_change(const std::vector<Part>& parts, bool only_inner) {
  std::array<const Part*, 2> largest{};
  std::array<int, 2> count{};
  for (const auto& part : parts) {
    ++count[part.inside];
    if (auto& best = largest[part.inside]; !best || part.volume > best->volume) best = &part;
  }
  if (count[0] < 2 && count[1] < 2) return nullptr;
  const Part* smallest = nullptr;
  for (const auto& part : parts) {
    const bool may_change = only_inner ? part.inside : &part != largest[part.inside];
    if (may_change && (!smallest || part.volume < smallest->volume)) smallest = &part;
  }
  return smallest;
}

// As many parts as parts_of_star finds, without their cells. `star` has at most 64.
int count_parts(const Tetrahedra& t, std::int32_t node, std::span<const std::int32_t> star, const LabelSet& set) {
  constexpr std::uint8_t none = 64;
  std::array<std::array<std::uint8_t, 3>, 64> beside;  // places in the star of the cells across three faces
  std::array<bool, 64> inside, seen{}, on_hull{};
  for (std::size_t i = 0; i < star.size(); ++i) inside[i] = set[static_cast<std::size_t>(t.label_of(star[i]))];
  for (std::size_t i = 0; i < star.size(); ++i) {
    const Cell& cell = t.cell(star[i]);
    const auto& around = t.around(star[i]);
    std::size_t count = 0;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      if (cell[corner] == node) continue;  // the face opposite to the node
      const auto neighbour = around[corner];
      on_hull[i] = on_hull[i] || neighbour < 0;
      const auto found = neighbour < 0 ? star.end() : std::lower_bound(star.begin(), star.end(), neighbour);
      const auto place = static_cast<std::size_t>(found - star.begin());
      beside[i][count++] = neighbour < 0 || inside[place] != inside[i] ? none : static_cast<std::uint8_t>(place);
    }
  }
  int parts = 0;
  bool has_hull = false;
  std::array<std::uint8_t, 64> queue;
  for (std::size_t seed = 0; seed < star.size(); ++seed) {
    if (seen[seed]) continue;
    std::size_t end = 0;
    queue[end++] = static_cast<std::uint8_t>(seed);
    seen[seed] = true;
    bool is_on_hull = false;
    for (std::size_t next = 0; next < end; ++next) {
      is_on_hull = is_on_hull || on_hull[queue[next]];
      for (const auto other : beside[queue[next]])
        if (other != none && !seen[other]) {
          seen[other] = true;
          queue[end++] = other;
        }
    }
    has_hull = has_hull || is_on_hull;
    if (!is_on_hull || inside[seed]) ++parts;
  }
  return parts + (has_hull ? 1 : 0);
}

// Whether the set or its complement falls apart at a node.
bool falls_apart(const Tetrahedra& t, std::int32_t node, const LabelSet& set) {
  if (!is_mixed(t, node, set)) return false;
  const auto star = t.star.of(node);
  if (star.size() <= 64) return count_parts(t, node, star, set) > 2;
  return parts_of_star(t, node, set).size() > 2;
}

// Gives the part of the star that is to change its side to the set, or away from it; returns its cells.
std::vector<std::int32_t> mend(Tetrahedra& t, std::int32_t node, const LabelSet& set, bool only_inner) {
  if (!is_mixed(t, node, set)) return {};
  auto parts = parts_of_star(t, node, set);
  const Part* part = parts.size() > 2 ? part_to_change(parts, only_inner) : nullptr;
  if (!part) return {};
  const auto other =
      most_touched(t, part->cells, [&](std::int32_t l) { return set[static_cast<std::size_t>(l)] != part->inside; });
  if (other < 0) return {};
  for (const auto cell : part->cells) (*t.label)[static_cast<std::size_t>(cell)] = other;
  return part->cells;
}

// Per node, whether it has to be mended: only those that have changed can. Threads tell before anything changes.
std::vector<std::uint8_t> nodes_to_mend(const Tetrahedra& t, const LabelSet& set, const Changes& changes) {
  std::vector<std::uint8_t> wanted(t.nodes->size());
  parallel::parallel_for(0, static_cast<std::int64_t>(wanted.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      wanted[n] = changes[n] != 0 && falls_apart(t, static_cast<std::int32_t>(n), set);
  });
  return wanted;
}

// `changes` since this was last done for the set; those made here go to `made`.
std::int64_t make_manifold(Tetrahedra& t, const LabelSet& set, const Changes& changes, Changes& made) {
  // Changes to and fro could repeat for ever. From some round on the set may only shrink, which must come to an end.
  constexpr int most_rounds = 60, shrinking_from = 8;
  auto wanted = nodes_to_mend(t, set, changes);
  std::int64_t changed = 0;
  for (int round = 0; round < most_rounds; ++round) {
    std::vector<std::uint8_t> next(wanted.size(), 0);
    bool any = false;
    for (std::size_t n = 0; n < wanted.size(); ++n) {
      if (wanted[n] == 0) continue;
      const auto cells = mend(t, static_cast<std::int32_t>(n), set, round >= shrinking_from);
      changed += static_cast<std::int64_t>(cells.size());
      any |= !cells.empty();
      note_change(t, cells, made);
      for (const auto cell : cells)
        for (const auto corner : t.cell(cell)) {
          wanted[static_cast<std::size_t>(corner)] = 1;  // in this round too, if its turn is to come
          next[static_cast<std::size_t>(corner)] = 1;
        }
    }
    if (!any) break;
    wanted = std::move(next);
  }
  return changed;
}

}  // namespace

std::int64_t settle_labels(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                           std::vector<std::int32_t>& label, std::span<const LabelSet> manifold_sets,
                           std::int64_t crumb_cells) {
  constexpr int most_rounds = 8, crumb_rounds = 2;
  auto t = connect(nodes_mm, cells, label);
  std::int64_t total = 0;
  const auto nodes = nodes_mm.size();
  std::vector<Changes> changes(manifold_sets.size(), Changes(nodes, 1));  // since each set was last looked at
  const auto spread = [&](const Changes& made) {
    for (auto& of_set : changes)
      for (std::size_t n = 0; n < nodes; ++n) of_set[n] |= made[n];
  };
  for (int round = 0; round < most_rounds; ++round) {
    // The two steps can undo each other's work for ever; a manifold boundary matters more than a crumb.
    std::int64_t changed = 0;
    Changes made(nodes, 0);
    if (round < crumb_rounds) changed += absorb_crumbs(t, crumb_cells, made);
    spread(made);
    for (std::size_t s = 0; s < manifold_sets.size(); ++s) {
      made.assign(nodes, 0);
      changed += make_manifold(t, manifold_sets[s], changes[s], made);
      changes[s].assign(nodes, 0);
      spread(made);
    }
    total += changed;
    if (changed == 0) break;
  }
  return total;
}

}  // namespace heart::mesh
