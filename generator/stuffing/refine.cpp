// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/refine.hpp"

#include <algorithm>
#include <cmath>

#include "generator/parallel/gather.hpp"
#include "generator/tetmesh/feature.hpp"

namespace heartgen::stuffing {
namespace {

constexpr int max_halvings = 3;

int halvings_at(const std::vector<tetmesh::FineSpot>& spots, const Vec3& position) {
  int most = 0;
  for (const auto& spot : spots)
    if (const Vec3 way = position - spot.center_mm; dot(way, way) < spot.radius_mm * spot.radius_mm)
      most = std::max(most, spot.halvings);
  return most;
}

Vec3 center_of(const tetmesh::Complex& c, const Cell& cell) {
  return 0.25 * (c.at(cell[0]) + c.at(cell[1]) + c.at(cell[2]) + c.at(cell[3]));
}

bool is_found_beside(const tetmesh::Materials& materials, int label, const Vec3& p, double way) {
  return materials.label_at(p + Vec3{way, 0, 0}) == label || materials.label_at(p - Vec3{way, 0, 0}) == label ||
         materials.label_at(p + Vec3{0, way, 0}) == label || materials.label_at(p - Vec3{0, way, 0}) == label ||
         materials.label_at(p + Vec3{0, 0, way}) == label || materials.label_at(p - Vec3{0, 0, way}) == label;
}

}  // namespace

bool has_free_node(const tetmesh::Complex& c, std::int32_t id) {
  const Cell& cell = c.cell(id);
  return std::any_of(cell.begin(), cell.end(), [&](std::int32_t n) { return !tetmesh::is_constrained(c.bits(n)); });
}

int label_if_mislabelled(const tetmesh::Complex& c, const tetmesh::Materials& materials, std::int32_t id) {
  constexpr double to_corner = 0.8;  // of the way
  const Cell& cell = c.cell(id);
  const int own = c.label_of(id);
  const Vec3 center = center_of(c, cell);
  const int there = materials.label_at(center);
  if (there == own) return own;
  const auto is_own = [&](std::int32_t n) {
    return materials.label_at(center + to_corner * (c.at(n) - center)) == own;
  };
  return std::any_of(cell.begin(), cell.end(), is_own) ? own : there;
}

std::vector<Vec3> far_mislabelled_cells(const tetmesh::Complex& c, const tetmesh::Materials& materials,
                                        tetmesh::LabelBits labels, const std::vector<std::uint8_t>& is_changed) {
  constexpr double far = 0.3;  // of the lattice's width
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Vec3>& centers) {
    for (auto t = begin; t < end; ++t) {
      const auto id = static_cast<std::int32_t>(t);
      if (!c.is_alive(id) || (is_changed[static_cast<std::size_t>(id)] == 0 && has_free_node(c, id))) continue;
      const int own = c.label_of(id), there = label_if_mislabelled(c, materials, id);
      if (there == own || ((tetmesh::bit_of(own) | tetmesh::bit_of(there)) & labels & ~tetmesh::bit_of(0)) == 0)
        continue;
      const Vec3 center = center_of(c, c.cell(id));
      const double width = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(c.cell(id)[0])]);
      if (!is_found_beside(materials, own, center, far * width)) centers.push_back(center);
    }
  };
  return parallel::gather<Vec3>(0, static_cast<std::int64_t>(c.cells.size()), find);
}

bool add_spots(tetmesh::Materials& materials, const std::vector<Vec3>& positions_mm, int halvings) {
  constexpr double radius_edges = 3.2;
  constexpr double well_inside = 0.5;  // of the radius
  constexpr std::size_t max_spots = 100;
  const auto& before = materials.spots;
  auto all = before;
  for (const auto& p : positions_mm) {
    tetmesh::FineSpot spot{p, 0, std::min(max_halvings, halvings + halvings_at(before, p))};
    spot.radius_mm = radius_edges * std::ldexp(materials.edge_mm(p), 1 - spot.halvings);
    const auto covers = [&](const tetmesh::FineSpot& other) {
      return other.halvings == spot.halvings && norm(other.center_mm - p) < well_inside * other.radius_mm;
    };
    if (std::none_of(all.begin(), all.end(), covers)) all.push_back(spot);
  }
  if (all.size() == before.size() || all.size() > max_spots) return false;
  materials.spots = std::move(all);
  return true;
}

}  // namespace heartgen::stuffing
