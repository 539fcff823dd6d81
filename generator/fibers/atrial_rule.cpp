// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/atrial_rule.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "generator/fibers/harmonic.hpp"
#include "model/priors.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::fibers {
namespace {

constexpr double patch_share = 0.015;  // of the wall's nodes, where a vein or an appendage's tip has to be guessed
const Vec3 to_left{1, 0, 0}, to_back{0, 1, 0}, to_head{0, 0, 1};

/// An edge of the endocardium that lies on the outer surface too.
struct RimEdge {
  std::int32_t a, b;  ///< rows
};

/// Edges of faces with the given surface, ascending, each once.
std::vector<std::pair<std::int32_t, std::int32_t>> edges_of(const TetMesh& mesh, std::int32_t surface) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (mesh.surface[f] == surface)
      for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::minmax(mesh.faces[f][k], mesh.faces[f][(k + 1) % 3]));
  sort_unique(edges);
  return edges;
}

std::vector<RimEdge> rim_edges(const Wall& wall, bool left) {
  const auto inner = edges_of(*wall.mesh, *surface_from_name(left ? "la_endocardium" : "ra_endocardium"));
  const auto outer = edges_of(*wall.mesh, *surface_from_name("epicardium"));
  std::vector<std::pair<std::int32_t, std::int32_t>> both;
  std::set_intersection(inner.begin(), inner.end(), outer.begin(), outer.end(), std::back_inserter(both));
  std::vector<RimEdge> rim;
  for (const auto& [a, b] : both) {
    const auto ra = wall.row[static_cast<std::size_t>(a)], rb = wall.row[static_cast<std::size_t>(b)];
    if (ra >= 0 && rb >= 0) rim.push_back({ra, rb});
  }
  return rim;
}

/// A hole in a chamber's wall.
struct Opening {
  Rows rows;
  double perimeter_mm = 0;
  Vec3 middle_mm;
};

/// Connected curves, in the order of their smallest rows.
std::vector<Opening> openings_of(const Wall& wall, bool left) {
  const auto rim = rim_edges(wall, left);
  std::vector<std::int32_t> root(wall.matrix.nodes.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](std::int32_t r) {
    while (root[static_cast<std::size_t>(r)] != r) r = root[static_cast<std::size_t>(r)];
    return r;
  };
  for (const auto& [a, b] : rim) {
    const auto ra = find(a), rb = find(b);
    root[static_cast<std::size_t>(std::max(ra, rb))] = std::min(ra, rb);
  }
  std::vector<std::pair<std::int32_t, RimEdge>> sorted;
  sorted.reserve(rim.size());
  for (const auto& edge : rim) sorted.emplace_back(find(edge.a), edge);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Opening> openings;
  for (std::size_t e = 0; e < sorted.size(); ++e) {
    if (e == 0 || sorted[e].first != sorted[e - 1].first) openings.emplace_back();
    const auto [a, b] = sorted[e].second;
    openings.back().rows.insert(openings.back().rows.end(), {a, b});
    openings.back().perimeter_mm += norm(wall.at(a) - wall.at(b));
  }
  for (Opening& opening : openings) {
    sort_unique(opening.rows);
    opening.middle_mm = middle_of(wall, opening.rows);
  }
  return openings;
}

/// Rows of the large openings on one side of the chamber; else of the wall's part farthest along `guess`.
Rows veins(const Wall& wall, const std::vector<Opening>& openings, const Vec3& middle, const Vec3& side,
           const Vec3& guess) {
  constexpr double min_share = 0.5;  // of the largest on this side: less is a hole in a wall
  double largest = 0;
  const auto on_side = [&](const Opening& o) { return dot(o.middle_mm - middle, side) > 0; };
  for (const Opening& o : openings)
    if (on_side(o)) largest = std::max(largest, o.perimeter_mm);
  if (largest < priors::vein_perimeter_min_mm) return farthest_rows(wall, all_rows(wall), guess, patch_share);
  Rows rows;
  for (const Opening& o : openings)
    if (on_side(o) && o.perimeter_mm >= std::max<double>(priors::vein_perimeter_min_mm, min_share * largest))
      rows = joined(rows, o.rows);
  return rows;
}

Vec3 middle_of_region(const TetMesh& mesh, Region region) {
  Vec3 sum;
  double count = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (mesh.region[c] != tag(region)) continue;
    for (const auto n : mesh.cells[c]) sum += 0.25 * mesh.nodes_mm[static_cast<std::size_t>(n)];
    ++count;
  }
  return count > 0 ? sum / count : sum;
}

Rows valve_of(const Wall& wall, bool left) {
  if (auto ring = rows_of_valve(wall, left ? "mitral" : "tricuspid"); !ring.empty()) return ring;
  if (auto contact = rows_on(wall, {"atrioventricular_junction"}); !contact.empty()) return contact;
  const Vec3 ventricle = middle_of_region(*wall.mesh, left ? Region::lv_myocardium : Region::rv_myocardium);
  return farthest_rows(wall, all_rows(wall), ventricle - middle_of(wall, all_rows(wall)), 2 * patch_share);
}

Harmonic depth_of(const Wall& wall, bool left) {
  const Rows inner = rows_on(wall, {left ? "la_endocardium" : "ra_endocardium"});
  const Rows outer = rows_on(wall, {"epicardium", "interatrial_junction", "aorta_wall", "pulmonary_artery_wall"});
  return harmonics(wall, {{{0, inner}, {1, outer}}})[0];
}

/// Fibres along the wall, across `rise`; any direction in the wall where that is not defined.
RuleAxis across(const Vec3& depth_slope, const Vec3& rise) {
  constexpr double min_tangent = 1e-9;
  const Vec3 n = norm(depth_slope) > min_tangent ? normalized(depth_slope) : to_head;
  const Vec3 along = rise - dot(rise, n) * n;
  if (norm(along) > min_tangent) return {cross(normalized(along), n), n};
  return {normalized(cross(n, std::abs(n.x) < 0.8 ? to_left : to_back)), n};
}

/// Which function the bundle at a row follows; the functions in the order of left_functions.
std::size_t left_bundle(const std::vector<Harmonic>& f, std::size_t r, const RuleSettings& s) {
  enum : std::size_t { between_all, between_veins, from_valve };
  if (f[from_valve].value[r] >= s.la_mitral) return from_valve;
  const double v = f[between_veins].value[r];
  return v <= s.la_left_veins || v >= s.la_right_veins ? between_veins : between_all;
}

std::vector<Harmonic> left_functions(const Wall& wall) {
  const Vec3 middle = middle_of(wall, all_rows(wall));
  const auto openings = openings_of(wall, true);
  const Rows valve = valve_of(wall, true);
  const Rows left_veins = veins(wall, openings, middle, to_left, normalized(2 * to_left + to_back + to_head));
  const Rows right_veins = veins(wall, openings, middle, -to_left, normalized(-2 * to_left + to_back + to_head));
  const Rows tip = farthest_rows(wall, all_rows(wall), normalized(to_left - to_back), patch_share);
  return harmonics(wall, {{{1, valve}, {2, right_veins}, {0, left_veins}, {-1, tip}},
                          {{1, right_veins}, {0, left_veins}},
                          {{1, valve}, {0, left_veins}, {0, right_veins}, {0, tip}}});
}

/// In the order of right_functions.
std::size_t right_bundle(const std::vector<Harmonic>& f, std::size_t r, const RuleSettings& s) {
  enum : std::size_t { between_all, between_cavae, from_valve, across_septum };
  const double from = f[from_valve].value[r], w = f[across_septum].value[r], v = f[between_cavae].value[r];
  if (from >= s.ra_tricuspid) return from_valve;
  const bool cava = v >= s.ra_inferior_cava || v <= s.ra_superior_cava;
  if (from >= s.ra_wall) return cava ? between_cavae : w >= 0 ? from_valve : between_all;
  if (w >= s.ra_crista_low && w <= s.ra_crista_high) return across_septum;
  if (cava) return between_cavae;
  if (w < s.ra_crista_low) return between_all;
  if (w <= s.ra_intercaval) return between_cavae;
  return w >= s.ra_septum ? from_valve : across_septum;
}

std::vector<Harmonic> right_functions(const Wall& wall) {
  const Vec3 middle = middle_of(wall, all_rows(wall));
  const auto openings = openings_of(wall, false);
  const Rows valve = valve_of(wall, false);
  const Rows above = veins(wall, openings, middle, to_head, to_head);
  const Rows below = veins(wall, openings, middle, -to_head, normalized(to_back - 2 * to_head));
  const Rows tip = farthest_rows(wall, all_rows(wall), normalized(to_head - 2 * to_back), patch_share);
  const auto& regions = wall.mesh->region;
  const bool has_left = std::find(regions.begin(), regions.end(), tag(Region::la_wall)) != regions.end();
  const Vec3 ring_middle = middle_of(wall, valve);
  const Vec3 to_septum = middle_of_region(*wall.mesh, has_left ? Region::la_wall : Region::lv_myocardium) - middle;
  Rows septal, free;
  for (const auto r : valve) (dot(wall.at(r) - ring_middle, to_septum) > 0 ? septal : free).push_back(r);
  return harmonics(wall, {{{1, valve}, {2, below}, {0, above}, {-1, tip}},
                          {{1, below}, {0, above}, {0, tip}},
                          {{1, valve}, {0, above}, {0, below}, {0, tip}},
                          {{1, septal}, {-1, free}}});
}

}  // namespace

RuleField atrial_rule(const TetMesh& mesh, bool left, const RuleSettings& settings) {
  const Wall wall = make_wall(mesh, {left ? Region::la_wall : Region::ra_wall});
  if (wall.matrix.nodes.empty()) return {};
  const Harmonic depth = depth_of(wall, left);
  const auto functions = left ? left_functions(wall) : right_functions(wall);
  RuleField field{wall.matrix.nodes, std::vector<RuleAxis>(wall.matrix.nodes.size())};
  for (std::size_t r = 0; r < field.nodes.size(); ++r) {
    const auto followed = left ? left_bundle(functions, r, settings) : right_bundle(functions, r, settings);
    field.axes[r] = across(depth.slope[r], functions[followed].slope[r]);
  }
  return field;
}

}  // namespace heartgen::fibers
