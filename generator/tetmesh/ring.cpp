// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/ring.hpp"

#include <algorithm>

namespace heartgen::tetmesh {
namespace {

struct Link {
  std::int32_t cell, from, to;
};

// The links in order, from `start` on; false where they do not form one chain.
bool chain(std::array<Link, longest_ring>& links, std::size_t count, std::size_t start) {
  std::swap(links[0], links[start]);
  for (std::size_t i = 1; i < count; ++i) {
    std::size_t next = i;
    while (next < count && links[next].from != links[i - 1].to) ++next;
    if (next == count) return false;
    std::swap(links[i], links[next]);
  }
  return true;
}

std::size_t start_of(const Complex& c, const std::array<Link, longest_ring>& links, std::size_t count, bool& is_open) {
  std::size_t start = 0, where_label_starts = count;
  is_open = false;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t before = 0;
    while (before < count && links[before].to != links[i].from) ++before;
    if (before == count) {
      is_open = true;
      start = i;
    } else if (c.label_of(links[before].cell) != c.label_of(links[i].cell) && where_label_starts == count) {
      where_label_starts = i;
    }
  }
  return is_open || where_label_starts == count ? start : where_label_starts;
}

}  // namespace

Ring ring_around(const Complex& c, std::int32_t a, std::int32_t b) {
  std::array<Link, longest_ring> links;
  std::size_t count = 0;
  for (const auto t : c.star(a)) {
    if (!has(c.cell(t), b)) continue;
    if (count == longest_ring) return {};
    const auto [from, to] = others(c.cell(t), a, b);
    links[count++] = {t, from, to};
  }
  Ring ring;
  if (count == 0 || !chain(links, count, start_of(c, links, count, ring.is_open))) return {};
  ring.size = count;
  for (std::size_t i = 0; i < count; ++i) {
    ring.cells[i] = links[i].cell;
    ring.nodes[i] = links[i].from;
    if (i > 0 && c.label_of(links[i].cell) == c.label_of(links[i - 1].cell)) continue;
    if (ring.arc_count < 3) ring.arcs[ring.arc_count++] = i;
  }
  ring.nodes[count] = links[count - 1].to;
  if (!ring.is_open && ring.nodes[count] != ring.nodes[0]) return {};
  return ring;
}

}  // namespace heartgen::tetmesh
