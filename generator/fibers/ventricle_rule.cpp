// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/ventricle_rule.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "generator/fibers/harmonic.hpp"
#include "generator/parallel/threads.hpp"
#include "model/axis_tensor.hpp"
#include "model/mathematics.hpp"
#include "model/priors.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::fibers {
namespace {

/// Where functions are held.
struct Borders {
  Rows lv_endo, rv_endo, epicardium;
  Rows base, apex;       ///< of both ventricles: where they end, and their lowest places
  Rows inflow, outflow;  ///< rings of the valves; outflow is empty where no such valve is known
};

/// Feet of papillary muscles belong to the endocardium around them: the nodes of their faces take the side of their
/// neighbours, from the rims inwards.
void add_papillary_feet(const Wall& wall, Rows& lv_endo, Rows& rv_endo) {
  enum Side : std::uint8_t { unknown, left, right };
  std::vector<std::uint8_t> side(wall.matrix.nodes.size(), unknown);
  for (const auto r : lv_endo) side[static_cast<std::size_t>(r)] = left;
  for (const auto r : rv_endo) side[static_cast<std::size_t>(r)] = right;
  const auto foot = *surface_from_name("papillary_base");
  for (bool again = true; again;) {
    again = false;
    const auto before = side;
    for (std::size_t f = 0; f < wall.mesh->faces.size(); ++f) {
      if (wall.mesh->surface[f] != foot) continue;
      std::uint8_t known = unknown;
      for (const auto n : wall.mesh->faces[f])
        if (const auto r = wall.row[static_cast<std::size_t>(n)]; r >= 0)
          known = std::max(known, before[static_cast<std::size_t>(r)]);
      for (const auto n : wall.mesh->faces[f]) {
        const auto r = wall.row[static_cast<std::size_t>(n)];
        if (r < 0 || known == unknown || before[static_cast<std::size_t>(r)] != unknown) continue;
        side[static_cast<std::size_t>(r)] = known;
        again = true;
      }
    }
  }
  lv_endo.clear();
  rv_endo.clear();
  for (std::size_t r = 0; r < side.size(); ++r)
    if (side[r] != unknown) (side[r] == left ? lv_endo : rv_endo).push_back(static_cast<std::int32_t>(r));
}

/// Rows on faces of the epicardium that lie in the flat cut at the base.
Rows rows_of_cut(const Wall& wall, const ventricles::HeartFrame& frame) {
  constexpr double min_cosine = 0.8;
  const auto epicardium = *surface_from_name("epicardium");
  Rows rows;
  double highest = std::numeric_limits<double>::max();
  for (const auto r : all_rows(wall)) highest = std::min(highest, depth_below_base_mm(frame, wall.at(r)));
  for (std::size_t f = 0; f < wall.mesh->faces.size(); ++f) {
    if (wall.mesh->surface[f] != epicardium) continue;
    std::array<std::int32_t, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = wall.row[static_cast<std::size_t>(wall.mesh->faces[f][k])];
    if (*std::min_element(corner.begin(), corner.end()) < 0) continue;
    const Vec3 &a = wall.at(corner[0]), &b = wall.at(corner[1]), &c = wall.at(corner[2]);
    const Vec3 normal = normalized(cross(b - a, c - a));
    if (std::abs(dot(normal, frame.base_normal)) < min_cosine) continue;
    if (depth_below_base_mm(frame, (a + b + c) / 3) < highest + priors::base_cut_mm)
      rows.insert(rows.end(), corner.begin(), corner.end());
  }
  sort_unique(rows);
  return rows;
}

/// The epicardium around the place of one ventricle that lies farthest from the base along the axis.
Rows apex_rows(const Wall& wall, Region ventricle, const Rows& epicardium, const ventricles::HeartFrame& frame) {
  std::vector<std::uint8_t> own(wall.matrix.nodes.size());
  for (std::size_t c = 0; c < wall.matrix.cells.size(); ++c)
    if (wall.mesh->region[static_cast<std::size_t>(wall.matrix.cells[c])] == tag(ventricle))
      for (const auto r : wall.matrix.corners[c]) own[static_cast<std::size_t>(r)] = 1;
  Vec3 apex;
  double lowest = -std::numeric_limits<double>::max();
  for (const auto r : epicardium) {
    const double depth = dot(wall.at(r) - frame.base_point_mm, frame.long_axis);
    if (own[static_cast<std::size_t>(r)] && depth > lowest) lowest = depth, apex = wall.at(r);
  }
  Rows rows;
  for (const auto r : epicardium)
    if (own[static_cast<std::size_t>(r)] && norm(wall.at(r) - apex) < priors::apex_radius_mm) rows.push_back(r);
  return rows;
}

Rows without(const Rows& rows, const Rows& taken) {
  Rows rest;
  std::set_difference(rows.begin(), rows.end(), taken.begin(), taken.end(), std::back_inserter(rest));
  return rest;
}

Borders borders_of(const Wall& wall, const ventricles::HeartFrame& frame) {
  Borders b;
  b.lv_endo = rows_on(wall, {"lv_endocardium"});
  b.rv_endo = rows_on(wall, {"rv_endocardium"});
  add_papillary_feet(wall, b.lv_endo, b.rv_endo);
  b.epicardium = rows_on(wall, {"epicardium"});
  b.inflow = joined(rows_of_valve(wall, "mitral"), rows_of_valve(wall, "tricuspid"));
  b.outflow = joined(rows_of_valve(wall, "aortic"), rows_of_valve(wall, "pulmonary"));
  b.base = joined(rows_on(wall, {"atrioventricular_junction", "aorta_wall", "pulmonary_artery_wall"}),
                  joined(b.inflow, b.outflow));
  if (b.base.empty()) {
    b.base = rows_of_cut(wall, frame);
    b.epicardium = without(b.epicardium, b.base);
  }
  b.apex = joined(apex_rows(wall, Region::lv_myocardium, b.epicardium, frame),
                  apex_rows(wall, Region::rv_myocardium, b.epicardium, frame));
  return b;
}

/// Values at the left endocardium, the right one, and the epicardium of either ventricle, at one place.
struct Prescribed {
  double lv_endo, rv_endo, lv_epi, rv_epi;
};

/// Seen from one ventricle; the other one's endocardium is seen from behind, where angles count the other way.
double seen_from(bool left, const Prescribed& angle, double lv_share, double rv_share) {
  const double epi_share = 1 - lv_share - rv_share;
  return left ? lv_share * angle.lv_endo + epi_share * angle.lv_epi - rv_share * angle.rv_endo
              : rv_share * angle.rv_endo + epi_share * angle.rv_epi - lv_share * angle.lv_endo;
}

struct SideAxes {
  Vec3 fiber, sheet;
};

/// Zero where the wall runs across the apex-base direction.
SideAxes turned(const Vec3& outward, const Vec3& to_base, double helix_deg, double sheet_deg) {
  constexpr double min_tangent = 1e-6, radians = std::numbers::pi / 180;
  const Vec3 n = normalized(outward), along = to_base - dot(to_base, n) * n;
  if (norm(along) < min_tangent) return {};
  const Vec3 up = normalized(along), around = cross(up, n);
  const double a = helix_deg * radians, b = sheet_deg * radians;
  const Vec3 fiber = math::cos(a) * around + math::sin(a) * up;
  return {fiber, math::cos(b) * n + math::sin(b) * cross(fiber, n)};
}

/// The harmonic functions of the ventricles.
struct Coordinates {
  Harmonic lv, rv;        ///< shares of the endocardia
  Harmonic from_apex;     ///< rises to the base
  Harmonic inflow_share;  ///< 1 at the apex and the inflow valves, 0 at the outflow valves; empty without those
};

Coordinates coordinates_of(const Wall& wall, const Borders& b) {
  std::vector<std::vector<Held>> problems = {{{1, b.lv_endo}, {0, b.rv_endo}, {0, b.epicardium}},
                                             {{1, b.rv_endo}, {0, b.lv_endo}, {0, b.epicardium}},
                                             {{1, b.base}, {0, b.apex}}};
  if (!b.outflow.empty()) problems.push_back({{0, b.outflow}, {1, b.inflow}, {1, b.apex}});
  auto found = harmonics(wall, problems);
  Coordinates c{std::move(found[0]), std::move(found[1]), std::move(found[2]), {}};
  if (!b.outflow.empty()) c.inflow_share = std::move(found[3]);
  return c;
}

/// The functions at one place; without outflow valves the share of the inflow is 1.
struct Local {
  double lv = 0, rv = 0, inflow_share = 1;
  Vec3 lv_slope, rv_slope, to_base;
};

Local at_row(const Coordinates& c, std::size_t r) {
  const double share = c.inflow_share.value.empty() ? 1 : std::clamp(c.inflow_share.value[r], 0.0, 1.0);
  return {c.lv.value[r], c.rv.value[r], share, c.lv.slope[r], c.rv.slope[r], normalized(c.from_apex.slope[r])};
}

/// Mean over the corners of a cell.
Local at_cell(const Coordinates& c, const std::array<std::int32_t, 4>& corners) {
  Local mean;
  mean.inflow_share = 0;
  for (const auto r : corners) {
    const Local at = at_row(c, static_cast<std::size_t>(r));
    mean.lv += 0.25 * at.lv, mean.rv += 0.25 * at.rv, mean.inflow_share += 0.25 * at.inflow_share;
    mean.lv_slope += 0.25 * at.lv_slope, mean.rv_slope += 0.25 * at.rv_slope;
    mean.to_base += 0.25 * at.to_base;
  }
  return mean;
}

RuleAxis axes_at(const Local& at, const RuleSettings& s) {
  const double w = at.inflow_share;
  const auto mixed = [w](double far, double at_artery) { return w * far + (1 - w) * at_artery; };
  const Prescribed helix{
      mixed(s.lv_helix_endo_deg, s.outflow_helix_endo_deg), mixed(s.rv_helix_endo_deg, s.outflow_helix_endo_deg),
      mixed(s.lv_helix_epi_deg, s.outflow_helix_epi_deg), mixed(s.rv_helix_epi_deg, s.outflow_helix_epi_deg)};
  const Prescribed sheet{s.lv_sheet_endo_deg, s.rv_sheet_endo_deg, s.lv_sheet_epi_deg, s.rv_sheet_epi_deg};
  AxisTensor fibers, sheets;
  for (const bool left : {true, false}) {
    const Vec3& slope = left ? at.lv_slope : at.rv_slope;
    const SideAxes axes =
        turned(-slope, at.to_base, seen_from(left, helix, at.lv, at.rv), seen_from(left, sheet, at.lv, at.rv));
    fibers += dot(slope, slope) * axis_tensor(axes.fiber);
    sheets += dot(slope, slope) * axis_tensor(axes.sheet);
  }
  return {leading_axis(fibers), leading_axis(sheets)};
}

}  // namespace

RuleField ventricle_rule(const TetMesh& mesh, const ventricles::HeartFrame& frame, const RuleSettings& settings) {
  const Wall wall = make_wall(mesh, {Region::lv_myocardium, Region::rv_myocardium});
  const Borders borders = borders_of(wall, frame);
  if (borders.lv_endo.empty() || borders.epicardium.empty() || borders.base.empty()) return {};
  const Coordinates coordinates = coordinates_of(wall, borders);
  RuleField field{wall.matrix.nodes, std::vector<RuleAxis>(wall.matrix.nodes.size()), wall.matrix.cells,
                  std::vector<RuleAxis>(wall.matrix.cells.size())};
  parallel::parallel_for(0, static_cast<std::int64_t>(field.nodes.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto r = static_cast<std::size_t>(begin); r < static_cast<std::size_t>(end); ++r)
      field.axes[r] = axes_at(at_row(coordinates, r), settings);
  });
  parallel::parallel_for(0, static_cast<std::int64_t>(field.cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c)
      field.cell_axes[c] = axes_at(at_cell(coordinates, wall.matrix.corners[c]), settings);
  });
  return field;
}

}  // namespace heartgen::fibers
