#include "generator/mesh/settle_labels.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "generator/mesh/connected_cells.hpp"
#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"

namespace heart::mesh {
namespace {

// The label across the most area of the group's outer faces, among those that `accept` takes; -1 if there is none.
std::int32_t most_touched(const Tetrahedra& t, const std::vector<std::int32_t>& group, const auto& accept) {
  std::array<double, 64> area{};
  for (const auto cell : group)
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const std::int32_t label = t.label_across(cell, corner);
      if (accept(label)) area[static_cast<std::size_t>(label)] += t.face_area(cell, corner);
    }
  const auto most = std::max_element(area.begin(), area.end());
  return *most > 0 ? static_cast<std::int32_t>(most - area.begin()) : -1;
}

void note_change(const Tetrahedra& t, const std::vector<std::int32_t>& cells, Changes& changes) {
  for (const auto cell : cells)
    for (const auto corner : t.cell(cell)) changes[static_cast<std::size_t>(corner)] = 1;
}

// Cells with a changed node that lie beside one of another label, ascending.
std::vector<std::int32_t> cells_at_interfaces(const Tetrahedra& t, const Changes& changes) {
  const auto is_at_interface = [&](std::int32_t cell) {
    const auto& nodes = t.cell(cell);
    if (std::none_of(nodes.begin(), nodes.end(),
                     [&](std::int32_t n) { return changes[static_cast<std::size_t>(n)] != 0; }))
      return false;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      // What was not connected has the same label on both sides, unless that has changed.
      if (t.neighbours[static_cast<std::size_t>(cell)][corner] == unknown &&
          std::all_of(face_corners[corner].begin(), face_corners[corner].end(),
                      [&](std::size_t i) { return changes[static_cast<std::size_t>(nodes[i])] == 0; }))
        continue;
      if (t.label_across(cell, corner) != t.label_of(cell)) return true;
    }
    return false;
  };
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<std::int32_t>& found) {
    for (auto cell = begin; cell < end; ++cell)
      if (is_at_interface(static_cast<std::int32_t>(cell))) found.push_back(static_cast<std::int32_t>(cell));
  };
  return parallel::gather<std::int32_t>(0, static_cast<std::int64_t>(t.cells->size()), find);
}

/// Of each cell: whether the piece that it belongs to has been looked at, or just now is.
enum class Look : std::uint8_t { unseen, seen, now };
using Looks = std::vector<Look>;

// Sets the piece of one label to which a cell belongs; false where it stays: has more than `crumb_cells` cells, or is
// the outside.
bool find_crumb(const Tetrahedra& t, std::int32_t seed, std::int64_t crumb_cells, Looks& looks,
                std::vector<std::int32_t>& piece) {
  const auto label = t.label_of(seed);
  piece.assign(1, seed);
  looks[static_cast<std::size_t>(seed)] = Look::now;
  bool does_stay = false;
  const auto most = static_cast<std::size_t>(crumb_cells);
  for (std::size_t next = 0; next < piece.size() && piece.size() <= most && !does_stay; ++next)
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const auto other = t.across(piece[next], corner);
      if (other == hull) {
        does_stay = does_stay || label == 0;
        continue;
      }
      auto& look = looks[static_cast<std::size_t>(other)];
      if (t.label_of(other) != label || look == Look::now) continue;
      does_stay = does_stay || look == Look::seen;
      look = Look::now;
      piece.push_back(other);
    }
  for (const auto cell : piece) looks[static_cast<std::size_t>(cell)] = Look::seen;
  return !does_stay && piece.size() <= most;
}

// `changes` since this was last done.
std::int64_t absorb_crumbs(Tetrahedra& t, std::int64_t crumb_cells, const Changes& changes, Changes& made) {
  std::int64_t changed = 0;
  Looks looks(t.cells->size(), Look::unseen);
  std::vector<std::int32_t> piece;
  for (const auto seed : cells_at_interfaces(t, changes)) {
    if (looks[static_cast<std::size_t>(seed)] != Look::unseen || !find_crumb(t, seed, crumb_cells, looks, piece))
      continue;
    const auto label = t.label_of(seed);
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
        const auto neighbour = t.across(cell, corner);
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

/// Some faces at a node that part a set from its complement, by their two other nodes.
struct Rim {
  std::array<std::array<std::int32_t, 2>, 24> edges;
  std::size_t count = 0;
};

// False where they are too many, or the node lies on the hull.
bool collect_rim(const Tetrahedra& t, std::int32_t node, const LabelSet& set, Rim& rim) {
  const auto inside = [&](std::int32_t cell) { return set[static_cast<std::size_t>(t.label_of(cell))]; };
  for (const auto c : t.stars.of(node)) {
    if (!inside(c)) continue;
    const Cell& cell = t.cell(c);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      if (cell[corner] == node) continue;  // the face opposite to the node
      const auto other = t.across(c, corner);
      if (other == hull) return false;
      if (inside(other)) continue;
      if (rim.count == rim.edges.size()) return false;
      auto& edge = rim.edges[rim.count++];
      std::size_t i = 0;
      for (const auto at : face_corners[corner])
        if (cell[at] != node) edge[i++] = cell[at];
    }
  }
  return true;
}

// Whether the edges make one simple closed line: then it parts the sphere around the node in two.
bool is_one_line(Rim& rim) {
  if (rim.count < 3) return false;
  auto at = rim.edges[0][1];
  for (std::size_t done = 1; done < rim.count; ++done) {
    std::size_t next = rim.count;
    for (std::size_t e = done; e < rim.count; ++e) {
      if (rim.edges[e][0] != at && rim.edges[e][1] != at) continue;
      if (next != rim.count) return false;
      next = e;
    }
    if (next == rim.count) return false;
    std::swap(rim.edges[done], rim.edges[next]);
    at = rim.edges[done][0] == at ? rim.edges[done][1] : rim.edges[done][0];
  }
  return at == rim.edges[0][0];
}

// Whether the set or its complement falls apart at a node.
bool falls_apart(const Tetrahedra& t, std::int32_t node, const LabelSet& set) {
  if (!is_mixed(t, node, set)) return false;
  if (Rim rim; collect_rim(t, node, set, rim) && is_one_line(rim)) return false;
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

// `changes` since this was last done for the set; those made here go to `made`. Changes to and fro could repeat for
// ever: from round `shrinking_from` on the set may only shrink, which must come to an end.
std::int64_t make_manifold(Tetrahedra& t, const LabelSet& set, int shrinking_from, const Changes& changes,
                           Changes& made) {
  constexpr int most_rounds = 60;
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
  constexpr int most_rounds = 8, crumb_rounds = 2, usually_shrinking_from = 8;
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
  for (int round = 0; round < most_rounds; ++round) {
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

}  // namespace heart::mesh
