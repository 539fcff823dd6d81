#include "generator/mesh/settle_labels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "generator/mesh/surfaces.hpp"

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

struct Neighbour {
  std::int32_t cell = -1;  // -1: the hull
  double area_mm2 = 0;
  Face nodes{};
};

struct Tetrahedra {
  const std::vector<Vec3>* nodes;
  const std::vector<Cell>* cells;
  std::vector<std::int32_t>* label;
  std::vector<std::array<Neighbour, 4>> neighbours;
  Star star;

  std::int32_t label_of(std::int32_t cell) const { return (*label)[static_cast<std::size_t>(cell)]; }
  const std::array<Neighbour, 4>& around(std::int32_t cell) const { return neighbours[static_cast<std::size_t>(cell)]; }
  double volume(std::int32_t cell) const {
    const auto& c = (*cells)[static_cast<std::size_t>(cell)];
    const auto p = [&](std::size_t i) { return (*nodes)[static_cast<std::size_t>(c[i])]; };
    return std::abs(dot(p(1) - p(0), cross(p(2) - p(0), p(3) - p(0)))) / 6;
  }
};

Tetrahedra connect(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells, std::vector<std::int32_t>& label) {
  Tetrahedra t{&nodes, &cells, &label, std::vector<std::array<Neighbour, 4>>(cells.size()), {}};
  std::vector<std::uint8_t> filled(cells.size(), 0);
  for (const auto& face : cell_faces(cells)) {
    const auto p = [&](std::size_t i) { return nodes[static_cast<std::size_t>(face.nodes[i])]; };
    const double area = norm(cross(p(1) - p(0), p(2) - p(0))) / 2;
    const auto put = [&](std::int32_t cell, std::int32_t other) {
      const auto c = static_cast<std::size_t>(cell);
      t.neighbours[c][filled[c]++] = {other, area, face.nodes};
    };
    put(face.cell, face.other);
    if (face.other >= 0) put(face.other, face.cell);
  }
  t.star.first.assign(nodes.size() + 1, 0);
  for (const auto& cell : cells)
    for (const auto n : cell) ++t.star.first[static_cast<std::size_t>(n) + 1];
  for (std::size_t n = 0; n < nodes.size(); ++n) t.star.first[n + 1] += t.star.first[n];
  t.star.cells.resize(4 * cells.size());
  auto next = t.star.first;
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const auto n : cells[c])
      t.star.cells[static_cast<std::size_t>(next[static_cast<std::size_t>(n)]++)] = static_cast<std::int32_t>(c);
  return t;
}

// The label across the most area of the group's outer faces, among those that `accept` takes; -1 if there is none.
std::int32_t most_touched(const Tetrahedra& t, const std::vector<std::int32_t>& group, const auto& accept) {
  std::array<double, 64> area{};
  for (const auto cell : group)
    for (const auto& n : t.around(cell)) {
      const std::int32_t label = n.cell < 0 ? 0 : t.label_of(n.cell);
      if (accept(label)) area[static_cast<std::size_t>(label)] += n.area_mm2;
    }
  const auto most = std::max_element(area.begin(), area.end());
  return *most > 0 ? static_cast<std::int32_t>(most - area.begin()) : -1;
}

std::int64_t absorb_crumbs(Tetrahedra& t, std::int64_t crumb_cells) {
  std::int64_t changed = 0;
  std::vector<bool> seen(t.cells->size(), false);
  for (std::size_t seed = 0; seed < t.cells->size(); ++seed) {
    if (seen[seed]) continue;
    std::vector<std::int32_t> piece{static_cast<std::int32_t>(seed)};
    const auto label = t.label_of(piece[0]);
    seen[seed] = true;
    bool on_hull = false;
    for (std::size_t next = 0; next < piece.size(); ++next)
      for (const auto& n : t.around(piece[next])) {
        on_hull |= n.cell < 0;
        if (n.cell < 0 || seen[static_cast<std::size_t>(n.cell)] || t.label_of(n.cell) != label) continue;
        seen[static_cast<std::size_t>(n.cell)] = true;
        piece.push_back(n.cell);
      }
    if (static_cast<std::int64_t>(piece.size()) > crumb_cells || (label == 0 && on_hull)) continue;
    const auto other = most_touched(t, piece, [&](std::int32_t l) { return l != label; });
    if (other < 0) continue;
    for (const auto cell : piece) (*t.label)[static_cast<std::size_t>(cell)] = other;
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
  const auto at_node = [&](const Neighbour& n) {
    return n.nodes[0] == node || n.nodes[1] == node || n.nodes[2] == node;
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
      for (const auto& n : t.around(part.cells[next])) {
        if (!at_node(n)) continue;
        on_hull |= n.cell < 0;
        if (n.cell < 0 || inside(n.cell) != part.inside) continue;
        const auto other = place(n.cell);
        if (seen[other]) continue;
        seen[other] = true;
        part.cells.push_back(n.cell);
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

std::int64_t make_manifold(Tetrahedra& t, const LabelSet& set) {
  // Changes to and fro could repeat for ever. From some round on the set may only shrink, which must come to an end.
  constexpr int most_rounds = 60, shrinking_from = 8;
  std::vector<std::int32_t> nodes(t.nodes->size());
  for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = static_cast<std::int32_t>(n);
  std::int64_t changed = 0;
  for (int round = 0; round < most_rounds && !nodes.empty(); ++round) {
    std::vector<std::int32_t> touched;
    for (const auto node : nodes) {
      if (!is_mixed(t, node, set)) continue;
      const auto parts = parts_of_star(t, node, set);
      const Part* part = parts.size() > 2 ? part_to_change(parts, round >= shrinking_from) : nullptr;
      if (!part) continue;
      const auto other = most_touched(t, part->cells,
                                      [&](std::int32_t l) { return set[static_cast<std::size_t>(l)] != part->inside; });
      if (other < 0) continue;
      for (const auto cell : part->cells) {
        (*t.label)[static_cast<std::size_t>(cell)] = other;
        const auto& corners = (*t.cells)[static_cast<std::size_t>(cell)];
        touched.insert(touched.end(), corners.begin(), corners.end());
        ++changed;
      }
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    nodes = std::move(touched);
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
  for (int round = 0; round < most_rounds; ++round) {
    // The two steps can undo each other's work for ever; a manifold boundary matters more than a crumb.
    std::int64_t changed = round < crumb_rounds ? absorb_crumbs(t, crumb_cells) : 0;
    for (const auto& set : manifold_sets) changed += make_manifold(t, set);
    total += changed;
    if (changed == 0) break;
  }
  return total;
}

}  // namespace heart::mesh
