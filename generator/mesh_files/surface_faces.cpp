// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh_files/surface_faces.hpp"

#include <algorithm>
#include <tuple>

namespace heartgen::mesh_files {
namespace {

/// Corners of the face opposite to each corner, turned to the outside.
constexpr int corners_of_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

struct HalfFace {
  Face sorted;
  std::int32_t cell;
  std::int8_t opposite;
  friend bool operator<(const HalfFace& a, const HalfFace& b) {
    return std::tie(a.sorted, a.cell) < std::tie(b.sorted, b.cell);
  }
};

Face face_of(const Cell& cell, std::int8_t opposite) {
  Face face;
  for (std::size_t i = 0; i < 3; ++i) face[i] = cell[static_cast<std::size_t>(corners_of_face[opposite][i])];
  return face;
}

std::vector<HalfFace> half_faces(const std::vector<Cell>& cells) {
  std::vector<HalfFace> halves;
  halves.reserve(4 * cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::int8_t opposite = 0; opposite < 4; ++opposite) {
      HalfFace half{face_of(cells[c], opposite), static_cast<std::int32_t>(c), opposite};
      std::sort(half.sorted.begin(), half.sorted.end());
      halves.push_back(half);
    }
  std::sort(halves.begin(), halves.end());
  return halves;
}

}  // namespace

std::vector<SurfaceFace> surface_faces(const std::vector<Cell>& cells, const std::vector<std::int32_t>& region) {
  const auto region_of = [&](const HalfFace& half) {
    return region.empty() ? 0 : region[static_cast<std::size_t>(half.cell)];
  };
  const auto halves = half_faces(cells);
  std::vector<SurfaceFace> faces;
  for (std::size_t h = 0; h < halves.size();) {
    const bool is_shared = h + 1 < halves.size() && halves[h + 1].sorted == halves[h].sorted;
    const HalfFace *first = &halves[h], *second = is_shared ? &halves[h + 1] : nullptr;
    h += is_shared ? 2 : 1;
    if (second && region_of(*first) == region_of(*second)) continue;
    if (second && region_of(*second) < region_of(*first)) std::swap(first, second);
    faces.push_back({face_of(cells[static_cast<std::size_t>(first->cell)], first->opposite), first->cell,
                     second ? second->cell : -1});
  }
  return faces;
}

}  // namespace heartgen::mesh_files
