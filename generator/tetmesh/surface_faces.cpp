// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/surface_faces.hpp"

#include <algorithm>
#include <bit>
#include <iterator>

#include "generator/parallel/gather.hpp"
#include "generator/tetmesh/feature.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::tetmesh {
namespace {

void add_faces_of(const Complex& c, std::int32_t t, std::vector<SurfaceFace>& faces) {
  const Cell& cell = c.cell(t);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto a = cell[(i + 1) % 4], b = cell[(i + 2) % 4], d = cell[(i + 3) % 4];
    const LabelBits shared = c.bits(a) & c.bits(b) & c.bits(d);
    if ((shared & side_bits) != 0 || !is_constrained(shared)) continue;
    const auto pair = cells_at_face(c, a, b, d);
    const auto other = pair[0] == t ? pair[1] : pair[0];
    if (other >= 0 && other < t) continue;  // seen from there
    const LabelBits labels = bit_of(c.label_of(t)) | (other < 0 ? bit_of(0) : bit_of(c.label_of(other)));
    if (std::popcount(labels) > 1) faces.push_back({{a, b, d}, labels});
  }
}

}  // namespace

std::vector<SurfaceFace> surface_faces(const Complex& complex) {
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<SurfaceFace>& faces) {
    for (auto t = begin; t < end; ++t)
      if (complex.is_alive(static_cast<std::int32_t>(t))) add_faces_of(complex, static_cast<std::int32_t>(t), faces);
  };
  return parallel::gather<SurfaceFace>(0, static_cast<std::int64_t>(complex.cells.size()), find);
}

std::vector<SurfaceFace> surface_faces_at(const Complex& complex, std::int32_t node) {
  std::vector<SurfaceFace> faces;
  for (const auto t : complex.star(node)) add_faces_of(complex, t, faces);
  std::erase_if(faces,
                [&](const SurfaceFace& face) { return std::ranges::find(face.nodes, node) == face.nodes.end(); });
  return faces;
}

void renew_faces(std::vector<SurfaceFace>& faces, const Complex& complex, std::span<const std::int32_t> nodes) {
  std::vector<std::uint8_t> is_changed(complex.nodes_mm.size(), 0);
  std::vector<std::int32_t> cells;
  for (const auto n : nodes) {
    is_changed[static_cast<std::size_t>(n)] = 1;
    const auto star = complex.star(n);
    cells.insert(cells.end(), star.begin(), star.end());
  }
  sort_unique(cells);
  const auto at_changed = [&](const SurfaceFace& face) {
    return std::any_of(face.nodes.begin(), face.nodes.end(),
                       [&](std::int32_t n) { return is_changed[static_cast<std::size_t>(n)] != 0; });
  };
  std::erase_if(faces, at_changed);
  std::vector<SurfaceFace> found;
  for (const auto t : cells) add_faces_of(complex, t, found);
  std::copy_if(found.begin(), found.end(), std::back_inserter(faces), at_changed);
}

}  // namespace heartgen::tetmesh
