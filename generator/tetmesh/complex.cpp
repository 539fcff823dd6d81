// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/complex.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/quality.hpp"
#include "generator/tetmesh/shared_marks.hpp"
#include "generator/tetmesh/stars.hpp"
#include "model/contract.hpp"

namespace heartgen::tetmesh {
namespace {

constexpr std::uint16_t room = 4;  // for more cells at each node before its list has to move

void append_to_star(Complex& complex, std::int32_t node, std::int32_t cell) {
  const auto n = static_cast<std::size_t>(node);
  auto& c = complex;
  if (c.count[n] == c.capacity[n]) {
    const auto next = static_cast<std::int32_t>(c.pool.size());
    c.capacity[n] = static_cast<std::uint16_t>(c.capacity[n] + c.capacity[n] / 2 + room);
    c.pool.resize(c.pool.size() + c.capacity[n]);
    std::copy_n(c.pool.begin() + c.first[n], c.count[n], c.pool.begin() + next);
    c.first[n] = next;
  }
  c.pool[static_cast<std::size_t>(c.first[n]) + c.count[n]++] = cell;
}

void erase_from_star(Complex& complex, std::int32_t node, std::int32_t cell) {
  const auto n = static_cast<std::size_t>(node);
  auto* begin = complex.pool.data() + complex.first[n];
  auto* found = std::find(begin, begin + complex.count[n], cell);
  *found = begin[--complex.count[n]];
}

// Calls found(i, quality) for each cell in turn, until it returns false; all must be alive. Whether it never did.
template <class Found>
bool rate(const Complex& c, std::span<const std::int32_t> cells, const Found& found) {
  CellBatch batch;
  for (std::size_t first = 0; first < cells.size(); first += CellBatch::size) {
    const std::size_t end = std::min(first + CellBatch::size, cells.size());
    for (std::size_t i = first; i < first + CellBatch::size; ++i) {  // beyond the end, something to compute with
      const Cell& cell = c.cell(cells[std::min(i, end - 1)]);
      for (std::size_t corner = 0; corner < 4; ++corner) batch.set(i - first, corner, c.at(cell[corner]));
    }
    const auto quality = cell_qualities(batch);
    for (std::size_t i = first; i < end; ++i)
      if (!found(i, quality[i - first])) return false;
  }
  return true;
}

// Moves a node where no cell around it falls below the bound.
bool try_position(Complex& c, std::int32_t node, const Vec3& position, double bound) {
  constexpr std::size_t typical_cells = 64;
  std::array<float, typical_cells> found;
  auto& place = c.nodes_mm[static_cast<std::size_t>(node)];
  const Vec3 old = place;
  place = position;
  const auto star = c.star(node);
  const bool is_good = rate(c, star, [&](std::size_t i, double here) {
    if (i < typical_cells) found[i] = static_cast<float>(here);
    return here >= bound;
  });
  if (!is_good) {
    place = old;
    return false;
  }
  for (std::size_t i = 0; i < std::min(star.size(), typical_cells); ++i)
    c.quality[static_cast<std::size_t>(star[i])] = found[i];
  if (star.size() > typical_cells) update_qualities(c, star.subspan(typical_cells));
  return true;
}

}  // namespace

double quality(const Complex& complex, const Cell& cell) {
  return cell_quality(complex.at(cell[0]), complex.at(cell[1]), complex.at(cell[2]), complex.at(cell[3]));
}

void connect_stars(Complex& c) {
  HEARTGEN_EXPECTS(c.label.size() == c.cells.size());
  HEARTGEN_EXPECTS(std::all_of(c.cells.begin(), c.cells.end(), [](const Cell& cell) { return cell[0] >= 0; }));
  c.first.resize(c.nodes_mm.size());
  c.capacity.resize(c.nodes_mm.size());
  c.count.resize(c.nodes_mm.size());
  auto places = count_corners(c.nodes_mm.size(), c.cells);
  std::int32_t next = 0;
  for (std::size_t n = 0; n < c.first.size(); ++n) {
    c.first[n] = next;
    c.count[n] = static_cast<std::uint16_t>(lay_out(places, n, next) - next);
    c.capacity[n] = static_cast<std::uint16_t>(c.count[n] + room);
    next += c.capacity[n];
  }
  c.free_cells.clear();
  c.pool.assign(static_cast<std::size_t>(next), -1);
  collect_stars(c.cells, places, c.pool);
}

void connect(Complex& complex) {
  auto& c = complex;
  connect_stars(c);
  c.quality.resize(c.cells.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(c.cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto i = begin; i < end; ++i) update_quality(complex, static_cast<std::int32_t>(i));
  });
}

std::int32_t add_node(Complex& complex, const Vec3& position, LabelBits touches, float spacing_mm) {
  complex.nodes_mm.push_back(position);
  complex.touches.push_back(touches);
  complex.spacing_mm.push_back(spacing_mm);
  if (!complex.frozen.empty()) complex.frozen.push_back(0);
  complex.first.push_back(static_cast<std::int32_t>(complex.pool.size()));
  complex.count.push_back(0);
  complex.capacity.push_back(0);
  return static_cast<std::int32_t>(complex.nodes_mm.size()) - 1;
}

std::int32_t add_unrated_cell(Complex& complex, const Cell& cell, int label) {
  auto id = static_cast<std::int32_t>(complex.cells.size());
  if (complex.free_cells.empty()) {
    complex.cells.push_back(cell);
    complex.label.push_back(static_cast<std::uint8_t>(label));
    complex.quality.push_back(0);
  } else {
    id = complex.free_cells.back();
    complex.free_cells.pop_back();
    complex.cells[static_cast<std::size_t>(id)] = cell;
    complex.label[static_cast<std::size_t>(id)] = static_cast<std::uint8_t>(label);
  }
  for (const auto n : cell) append_to_star(complex, n, id);
  return id;
}

std::int32_t add_cell(Complex& complex, const Cell& cell, int label) {
  const auto id = add_unrated_cell(complex, cell, label);
  update_quality(complex, id);
  return id;
}

void remove_cell(Complex& complex, std::int32_t cell) {
  HEARTGEN_EXPECTS(complex.cells[static_cast<std::size_t>(cell)][0] >= 0);
  auto& nodes = complex.cells[static_cast<std::size_t>(cell)];
  for (const auto n : nodes) erase_from_star(complex, n, cell);
  nodes[0] = -1;
  complex.quality[static_cast<std::size_t>(cell)] = 9;
  complex.free_cells.push_back(cell);
}

void update_quality(Complex& complex, std::int32_t cell) {
  complex.quality[static_cast<std::size_t>(cell)] = static_cast<float>(quality(complex, complex.cell(cell)));
}

void update_qualities(Complex& c, std::span<const std::int32_t> cells) {
  HEARTGEN_INVARIANT(std::all_of(cells.begin(), cells.end(), [&](std::int32_t id) { return c.cell(id)[0] >= 0; }));
  rate(c, cells, [&](std::size_t i, double quality) {
    c.quality[static_cast<std::size_t>(cells[i])] = static_cast<float>(quality);
    return true;
  });
}

double worst_quality(const Complex& complex, std::span<const std::int32_t> cells) {
  double worst = 9;
  for (const auto c : cells) worst = std::min(worst, complex.quality_of(c));
  return worst;
}

bool move_node(Complex& c, std::int32_t node, const Vec3& position, double min_quality) {
  return try_position(c, node, position, std::min(min_quality, worst_quality(c, c.star(node))));
}

bool shift_node(Complex& c, std::int32_t node, Vec3 way_mm, int tries, double min_quality) {
  const Vec3 old = c.at(node);
  const double bound = std::min(min_quality, worst_quality(c, c.star(node)));
  for (int i = 0; i < tries; ++i, way_mm *= 0.5)
    if (try_position(c, node, old + way_mm, bound)) return true;
  return false;
}

void derive_touches(Complex& complex) {
  auto& c = complex;
  parallel::parallel_for(0, static_cast<std::int64_t>(c.touches.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      c.touches[n] = (c.touches[n] & side_bits) | ((c.touches[n] & hull_bit) != 0 ? bit_of(0) : 0);
  });
  parallel::parallel_for(0, static_cast<std::int64_t>(c.cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t)
      if (c.cells[t][0] >= 0)
        for (const auto n : c.cells[t]) set_bits(c.touches[static_cast<std::size_t>(n)], bit_of(c.label[t]));
  });
}

bool has_derived_touches(const Complex& complex) {
  Complex derived = complex;
  derive_touches(derived);
  const auto is_same = [](LabelBits a, LabelBits b) { return ((a ^ b) & ~(bit_of(0) | hull_bit)) == 0; };
  return std::equal(derived.touches.begin(), derived.touches.end(), complex.touches.begin(), is_same);
}

bool touches_hold_labels(const Complex& complex) {
  for (std::size_t t = 0; t < complex.cells.size(); ++t)
    if (complex.cells[t][0] >= 0)
      for (const auto n : complex.cells[t])
        if ((complex.bits(n) & bit_of(complex.label[t])) == 0) return false;
  return true;
}

namespace {

// Moves what is kept of some arrays of one size to their beginning, in its order: threads inside blocks, then blocks.
template <class IsKept, class... T>
void keep(const IsKept& is_kept, std::vector<T>&... arrays) {
  constexpr std::size_t block = 1 << 14;
  const std::size_t size = std::min({arrays.size()...}), blocks = (size + block - 1) / block;
  std::vector<std::size_t> count(blocks, 0);
  parallel::parallel_for(0, static_cast<std::int64_t>(blocks), [&](std::int64_t begin, std::int64_t end) {
    for (auto b = static_cast<std::size_t>(begin); b < static_cast<std::size_t>(end); ++b) {
      std::size_t next = b * block;
      for (std::size_t i = b * block; i < std::min(size, (b + 1) * block); ++i) {
        if (!is_kept(i)) continue;
        ((arrays[next] = arrays[i]), ...);
        ++next;
      }
      count[b] = next - b * block;
    }
  });
  std::size_t kept = 0;
  for (std::size_t b = 0; b < blocks; kept += count[b++]) {
    const auto from = static_cast<std::ptrdiff_t>(b * block), to = static_cast<std::ptrdiff_t>(kept);
    if (from != to) (std::copy_n(arrays.begin() + from, count[b], arrays.begin() + to), ...);
  }
  (arrays.resize(kept), ...);
}

}  // namespace

void drop_unused(Complex& complex) {
  auto& c = complex;
  std::vector<std::int32_t> id(c.nodes_mm.size(), -1);
  const auto is_kept = [&](std::size_t t) {
    const Cell& cell = c.cells[t];
    if (cell[0] < 0 || c.label[t] == 0) return false;
    for (const auto n : cell) set_to(id[static_cast<std::size_t>(n)], 0);
    return true;
  };
  if (c.quality.size() == c.cells.size())
    keep(is_kept, c.cells, c.label, c.quality);
  else
    keep(is_kept, c.cells, c.label);
  std::size_t next = 0;
  for (std::size_t n = 0; n < id.size(); ++n) {
    if (id[n] < 0) continue;
    c.nodes_mm[next] = c.nodes_mm[n];
    c.touches[next] = c.touches[n];
    c.spacing_mm[next] = c.spacing_mm[n];
    if (!c.frozen.empty()) c.frozen[next] = c.frozen[n];
    id[n] = static_cast<std::int32_t>(next++);
  }
  c.nodes_mm.resize(next);
  c.touches.resize(next);
  c.spacing_mm.resize(next);
  if (!c.frozen.empty()) c.frozen.resize(next);
  parallel::parallel_for(0, static_cast<std::int64_t>(c.cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t)
      for (auto& n : c.cells[t]) n = id[static_cast<std::size_t>(n)];
  });
}

void compress(Complex& complex) {
  drop_unused(complex);
  connect(complex);
}

std::pair<std::int32_t, std::int32_t> others(const Cell& cell, std::int32_t a, std::int32_t b) {
  std::size_t i = 0, j = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (cell[k] == a) i = k;
    if (cell[k] == b) j = k;
  }
  // The other two places, ascending, make an even permutation of (0, 1, 2, 3) for these pairs.
  constexpr bool even[4][4] = {
      {false, true, false, true}, {false, false, true, false}, {true, false, false, true}, {false, true, false, false}};
  std::size_t k = 0;
  while (k == i || k == j) ++k;
  const std::size_t l = 6 - i - j - k;
  return even[i][j] ? std::pair{cell[k], cell[l]} : std::pair{cell[l], cell[k]};
}

bool is_edge(const Complex& complex, std::int32_t a, std::int32_t b) {
  const auto star = complex.star(a);
  return std::any_of(star.begin(), star.end(), [&](std::int32_t c) { return has(complex.cell(c), b); });
}

std::array<std::int32_t, 2> cells_at_face(const Complex& complex, std::int32_t a, std::int32_t b, std::int32_t c) {
  std::array<std::int32_t, 2> found{-1, -1};
  std::size_t count = 0;
  for (const auto cell : complex.star(a)) {
    if (!has(complex.cell(cell), b) || !has(complex.cell(cell), c)) continue;
    found[count++] = cell;
    if (count == found.size()) break;
  }
  return found;
}

LabelBits beyond_face(const Complex& complex, std::int32_t a, std::int32_t b, std::int32_t c) {
  const LabelBits sides = complex.bits(a) & complex.bits(b) & complex.bits(c) & side_bits;
  return sides != 0 ? sides & (~sides + 1) : bit_of(0);
}

}  // namespace heartgen::tetmesh
