// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/label_repair.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "generator/mesh/connected_cells.hpp"
#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/shared_marks.hpp"

namespace heartgen::mesh {
namespace {

// The label across the most area of the group's outer faces, among those that `accept` takes; -1 if there is none.
std::int32_t max_touched(const Tetrahedra& t, const std::vector<std::int32_t>& group, const auto& accept) {
  std::array<double, 64> area{};
  for (const auto cell : group)
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const std::int32_t label = t.label_across(cell, corner);
      if (accept(label)) area[static_cast<std::size_t>(label)] += t.face_area(cell, corner);
    }
  const auto most = std::max_element(area.begin(), area.end());
  return *most > 0 ? static_cast<std::int32_t>(most - area.begin()) : -1;
}

void note_change(Tetrahedra& t, const std::vector<std::int32_t>& cells, Changes& changes) {
  for (const auto cell : cells)
    for (const auto corner : t.cell(cell))
      changes[static_cast<std::size_t>(corner)] = t.is_mixed[static_cast<std::size_t>(corner)] = 1;
}

/// Of each cell: whether the piece that it belongs to has been looked at, or just now is.
enum class Look : std::uint8_t { unseen, seen, now };

/// What is known of pieces: cells of one label that hang together through faces.
struct Looks {
  std::vector<Look> cell;
  std::vector<std::uint8_t> stays;  // per node: whether the piece around it is one and known to be no crumb
};

// Whether the cells around a node and one beside it are of one label, and more than `crumb_cells`.
bool is_in_great_piece(const Tetrahedra& t, std::int32_t node, std::int64_t crumb_cells) {
  const auto is_mixed = [&](std::int32_t n) { return t.is_mixed[static_cast<std::size_t>(n)] != 0; };
  if (is_mixed(node)) return false;
  const auto star = t.stars.of(node);
  for (const auto c : star)
    for (const auto other : t.cell(c)) {
      if (other == node || is_mixed(other)) continue;
      const auto shared = std::ranges::count_if(star, [&](std::int32_t s) { return has(t.cell(s), other); });
      return std::ssize(star) + std::ssize(t.stars.of(other)) - shared > crumb_cells;
    }
  return false;
}

bool has_changed(const Tetrahedra& t, std::int32_t cell, const Changes& changes) {
  return std::ranges::any_of(t.cell(cell), [&](std::int32_t n) { return changes[static_cast<std::size_t>(n)] != 0; });
}

// Of cells that have changed it is quickly told whether their pieces are great ones.
Looks first_looks(const Tetrahedra& t, std::int64_t crumb_cells, const Changes& changes) {
  Looks looks{std::vector(t.cells->size(), Look::unseen), std::vector<std::uint8_t>(t.nodes->size(), 0)};
  Changes is_asked(t.nodes->size(), 0);
  parallel::parallel_for(0, std::ssize(*t.cells), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::int32_t>(begin); c < end; ++c)
      if (has_changed(t, c, changes))
        for (const auto n : t.cell(c)) tetmesh::set_to(is_asked[static_cast<std::size_t>(n)], std::uint8_t{1});
  });
  parallel::parallel_for(0, std::ssize(looks.stays), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      looks.stays[n] = is_asked[n] != 0 && is_in_great_piece(t, static_cast<std::int32_t>(n), crumb_cells);
  });
  return looks;
}

bool is_known_to_stay(const Tetrahedra& t, std::int32_t cell, const Looks& looks) {
  return std::ranges::any_of(t.cell(cell),
                             [&](std::int32_t n) { return looks.stays[static_cast<std::size_t>(n)] != 0; });
}

// Sets the piece to which a cell belongs; false where it is known to stay: has more than `crumb_cells` cells, or is the
// outside.
bool find_crumb(const Tetrahedra& t, std::int32_t seed, std::int64_t crumb_cells, Looks& looks,
                std::vector<std::int32_t>& piece) {
  const auto label = t.label_of(seed);
  piece.assign(1, seed);
  looks.cell[static_cast<std::size_t>(seed)] = Look::now;
  const auto is_too_large = [&] { return std::ssize(piece) > crumb_cells; };
  bool does_stay = is_too_large();
  for (std::size_t next = 0; next < piece.size() && !does_stay; ++next) {
    does_stay = is_known_to_stay(t, piece[next], looks);
    for (std::size_t corner = 0; corner < 4 && !does_stay; ++corner) {
      const auto other = t.across(piece[next], corner);
      if (other == hull) {
        does_stay = label == 0;
        continue;
      }
      auto& look = looks.cell[static_cast<std::size_t>(other)];
      if (t.label_of(other) != label || look == Look::now) continue;
      piece.push_back(other);
      does_stay = look == Look::seen || is_too_large();
      look = Look::now;
    }
  }
  for (const auto cell : piece) looks.cell[static_cast<std::size_t>(cell)] = Look::seen;
  return !does_stay;
}

// `changes` since this was last done.
std::int64_t absorb_crumbs(Tetrahedra& t, std::int64_t crumb_cells, const Changes& changes, Changes& made) {
  auto looks = first_looks(t, crumb_cells, changes);
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<std::int32_t>& found) {
    for (auto c = static_cast<std::int32_t>(begin); c < end; ++c)
      if (has_changed(t, c, changes) && !is_known_to_stay(t, c, looks)) found.push_back(c);
  };
  std::int64_t changed = 0;
  std::vector<std::int32_t> piece;
  for (const auto seed : parallel::gather<std::int32_t>(0, std::ssize(*t.cells), find)) {
    if (looks.cell[static_cast<std::size_t>(seed)] != Look::unseen || !find_crumb(t, seed, crumb_cells, looks, piece))
      continue;
    const auto label = t.label_of(seed);
    const auto other = max_touched(t, piece, [&](std::int32_t l) { return l != label; });
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
  const auto star = t.stars.of(node);
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
        const auto neighbour = t.across_among(star, cell, corner);
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
  const auto star = t.stars.of(node);
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

/// The triangles opposite to a node in its cells, inside a set or outside.
class Link {
 public:
  // False where there are too many nodes.
  bool add(const Cell& cell, std::int32_t node, bool inside) {
    std::array<std::size_t, 3> places;
    std::size_t i = 0;
    for (const auto n : cell) {
      if (n == node) continue;
      places[i] = extract_cavity(n);
      if (places[i++] == slots) return false;
    }
    auto& open = open_[inside ? 1 : 0];
    for (std::size_t k = 0; k < 3; ++k) open[places[k]] ^= bit(places[(k + 1) % 3]) | bit(places[(k + 2) % 3]);
    return true;
  }
  // Whether the edges that part inside and outside make one simple closed line: it parts the sphere around the node in
  // two. Not on the hull.
  bool is_parted_by_one_line() const {
    if (open_[0] != open_[1]) return false;
    const auto& open = open_[1];
    std::size_t count = 0, start = 0;
    for (std::size_t p = 0; p < slots; ++p) {
      if (open[p] == 0) continue;
      const auto but_one = open[p] & (open[p] - 1);
      if (but_one == 0 || (but_one & (but_one - 1)) != 0) return false;  // not two
      ++count;
      start = p;
    }
    if (count == 0) return false;
    std::size_t length = 0;
    auto before = std::uint64_t{0};
    for (std::size_t at = start; length == 0 || at != start; ++length) {
      const auto next = open[at] & ~before;
      before = bit(at);
      at = static_cast<std::size_t>(std::countr_zero(next));
    }
    return length == count;
  }

 private:
  static constexpr std::size_t slots = 64, max_nodes = 48;
  static std::uint64_t bit(std::size_t place) { return std::uint64_t{1} << place; }

  std::size_t extract_cavity(std::int32_t n) {
    auto place = static_cast<std::size_t>(n) % slots;
    while (nodes_[place] != n) {
      if (nodes_[place] == none) {
        if (++count_ > max_nodes) return slots;
        nodes_[place] = n;
        break;
      }
      place = (place + 1) % slots;
    }
    return place;
  }

  static constexpr std::int32_t none = -1;
  std::size_t count_ = 0;
  std::array<std::int32_t, slots> nodes_ = [] {
    std::array<std::int32_t, slots> nodes;
    nodes.fill(none);
    return nodes;
  }();
  // Of each node around, to which others it has an edge that one triangle has, not two: inside the set and outside.
  std::array<std::array<std::uint64_t, slots>, 2> open_{};
};

bool is_parted_by_one_line(const Tetrahedra& t, std::int32_t node, const LabelSet& set) {
  Link link;
  for (const auto c : t.stars.of(node))
    if (!link.add(t.cell(c), node, set[static_cast<std::size_t>(t.label_of(c))])) return false;
  return link.is_parted_by_one_line();
}

// Whether the set or its complement falls apart at a node.
bool falls_apart(const Tetrahedra& t, std::int32_t node, const LabelSet& set) {
  if (!is_mixed(t, node, set)) return false;
  if (is_parted_by_one_line(t, node, set)) return false;
  return parts_of_star(t, node, set).size() > 2;
}

// Gives the part of the star that is to change its side to the set, or away from it; returns its cells.
std::vector<std::int32_t> mend(Tetrahedra& t, std::int32_t node, const LabelSet& set, bool only_inner) {
  if (!is_mixed(t, node, set)) return {};
  auto parts = parts_of_star(t, node, set);
  const Part* part = parts.size() > 2 ? part_to_change(parts, only_inner) : nullptr;
  if (!part) return {};
  const auto other =
      max_touched(t, part->cells, [&](std::int32_t l) { return set[static_cast<std::size_t>(l)] != part->inside; });
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

// `changes` since this was last done for the set; those made here go to `made`. Changes to and fro could repeat for
// ever: from round `shrinking_from` on the set may only shrink, which must come to an end.
std::int64_t make_manifold(Tetrahedra& t, const LabelSet& set, int shrinking_from, const Changes& changes,
                           Changes& made) {
  constexpr int max_rounds = 60;
  auto wanted = nodes_to_mend(t, set, changes);
  std::int64_t changed = 0;
  for (int round = 0; round < max_rounds; ++round) {
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

std::int64_t repair_labels(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                           std::vector<std::int32_t>& label, std::span<const LabelSet> manifold_sets,
                           std::int64_t crumb_cells) {
  constexpr int max_rounds = 8, crumb_rounds = 2, usually_shrinking_from = 8;
  constexpr int quarrel_rounds = 4;  // what one set has filled until then, another one takes away again
  auto t = connect(nodes_mm, cells, label);
  std::int64_t total = 0;
  const auto nodes = nodes_mm.size();
  // Since crumbs and each set were last looked at; at first, where anything can be wrong.
  Changes for_crumbs = t.is_mixed;
  std::vector<Changes> changes(manifold_sets.size(), t.is_mixed);
  const auto add = [](const Changes& made, Changes& to) {
    std::transform(made.begin(), made.end(), to.begin(), to.begin(), std::bit_or<std::uint8_t>());
  };
  const auto spread = [&](const Changes& made) {
    add(made, for_crumbs);
    for (auto& of_set : changes) add(made, of_set);
  };
  for (int round = 0; round < max_rounds; ++round) {
    // The two steps can undo each other's work for ever; a manifold boundary matters more than a crumb.
    std::int64_t changed = 0;
    Changes made(nodes, 0);
    if (round < crumb_rounds) changed += absorb_crumbs(t, crumb_cells, for_crumbs, made);
    for_crumbs.assign(nodes, 0);
    spread(made);
    for (std::size_t s = 0; s < manifold_sets.size(); ++s) {
      made.assign(nodes, 0);
      const int shrinking_from = round < quarrel_rounds ? usually_shrinking_from : 0;
      changed += make_manifold(t, manifold_sets[s], shrinking_from, changes[s], made);
      changes[s].assign(nodes, 0);
      spread(made);
    }
    total += changed;
    if (changed == 0) break;
  }
  return total;
}

}  // namespace heartgen::mesh
