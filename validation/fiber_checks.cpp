// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/fiber_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "model/mathematics.hpp"
#include "model/mesh_queries/mesh_edges.hpp"
#include "validation/criteria.hpp"
#include "validation/heart_frame.hpp"
#include "validation/quantiles.hpp"
#include "validation/wall_depth.hpp"

namespace heartgen::validation {
namespace {

constexpr double degrees = 57.29577951308232;

ReportRow row(std::string scope, std::string metric, double value, std::string unit) {
  return {"fibers", std::move(scope), std::move(metric), value, std::move(unit), {}, {}};
}

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Largest deviation from unit length and from right angles; NaN counts as 1.
double frame_error(const FiberField& field, std::size_t n) {
  const Vec3 &f = field.fiber[n], &s = field.sheet[n], &t = field.sheet_normal[n];
  if (!finite(f) || !finite(s) || !finite(t)) return 1;
  return std::max({std::abs(norm(f) - 1), std::abs(norm(s) - 1), std::abs(norm(t) - 1), std::abs(dot(f, s)),
                   std::abs(dot(f, t)), std::abs(dot(s, t))});
}

bool complete(const FiberField& field, std::size_t count) {
  return field.fiber.size() == count && field.sheet.size() == count && field.sheet_normal.size() == count;
}

void add_frame_rows(const FiberField& field, std::size_t count, const std::string& where, Report& report) {
  std::size_t missing = complete(field, count) ? 0 : count;
  double worst = 0;
  for (std::size_t n = 0; n < count && missing != count; ++n) {
    missing += !finite(field.fiber[n]) || norm(field.fiber[n]) < 0.5;
    worst = std::max(worst, frame_error(field, n));
  }
  report.push_back(row("myocardium", "missing_" + where, static_cast<double>(missing), "count"));
  report.push_back(row("myocardium", "orthonormality_error_" + where, worst, "1"));
}

bool ventricular(std::int32_t region) {
  return region == tag(Region::lv_myocardium) || region == tag(Region::rv_myocardium);
}

double axis_angle_deg(const Vec3& a, const Vec3& b) {
  return degrees * math::atan2(norm(cross(a, b)), std::abs(dot(a, b)));
}

/// Angles between the fibre axes at the ends of edges of the ventricles' cells.
struct EdgeTurns {
  std::vector<double> jump_deg, turn_deg_per_mm, length_mm;

  void add(const TetMesh& mesh, std::int32_t a, std::int32_t b) {
    const auto m = static_cast<std::size_t>(a), n = static_cast<std::size_t>(b);
    jump_deg.push_back(axis_angle_deg(mesh.node_fibers.fiber[m], mesh.node_fibers.fiber[n]));
    length_mm.push_back(norm(mesh.nodes_mm[m] - mesh.nodes_mm[n]));
    turn_deg_per_mm.push_back(jump_deg.back() / std::max(length_mm.back(), 1e-9));
  }
};

/// Of all edges, and of those with an end where the two ventricles' muscle meets.
struct VentricleTurns {
  EdgeTurns all, junction;
};

VentricleTurns edge_turns(const TetMesh& mesh) {
  std::vector<std::uint8_t> sides(mesh.nodes_mm.size()), use(mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (!ventricular(mesh.region[c])) continue;
    use[c] = 1;
    for (const auto n : mesh.cells[c])
      sides[static_cast<std::size_t>(n)] |= mesh.region[c] == tag(Region::lv_myocardium) ? 1 : 2;
  }
  VentricleTurns turns;
  for (const auto& [a, b] : mesh_queries::edges_of_cells(mesh.cells, mesh.nodes_mm.size(), use)) {
    turns.all.add(mesh, a, b);
    if (sides[static_cast<std::size_t>(a)] == 3 || sides[static_cast<std::size_t>(b)] == 3)
      turns.junction.add(mesh, a, b);
  }
  return turns;
}

/// Longer edges jump more: the atlas's jumps say something beside the mesh's only with both lengths.
void add_atlas_jump_rows(const RegistrationFigures& figures, Report& report) {
  if (figures.atlas_jump_p99_deg)
    report.push_back(row("atlas", "neighbour_jump_p99", *figures.atlas_jump_p99_deg, "deg"));
  if (figures.atlas_edge_p50_mm) report.push_back(row("atlas", "edge_p50", *figures.atlas_edge_p50_mm, "mm"));
}

void add_jump_rows(const TetMesh& mesh, const RegistrationFigures& figures, Report& report) {
  const auto [all, junction] = edge_turns(mesh);
  if (all.jump_deg.empty()) return;
  report.push_back(row("ventricles", "neighbour_jump_p50", quantile(all.jump_deg, 0.5), "deg"));
  report.push_back(row("ventricles", "neighbour_jump_p99", quantile(all.jump_deg, 0.99), "deg"));
  report.push_back(
      row("ventricles", "neighbour_jump_max", *std::max_element(all.jump_deg.begin(), all.jump_deg.end()), "deg"));
  report.push_back(row("ventricles", "neighbour_turn_p99", quantile(all.turn_deg_per_mm, 0.99), "deg/mm"));
  report.push_back(row("ventricles", "edge_p50", quantile(all.length_mm, 0.5), "mm"));
  add_atlas_jump_rows(figures, report);
  if (figures.atlas_turn_p99_deg_per_mm)
    report.push_back(row("atlas", "neighbour_turn_p99", *figures.atlas_turn_p99_deg_per_mm, "deg/mm"));
  if (figures.carried_turn_p99_deg_per_wall && figures.atlas_turn_p99_deg_per_wall) {
    report.push_back(row("ventricles", "turn_per_wall_p99", *figures.carried_turn_p99_deg_per_wall, "deg/thickness"));
    report.push_back(row("atlas", "turn_per_wall_p99", *figures.atlas_turn_p99_deg_per_wall, "deg/thickness"));
  }
  if (figures.atlas_junction_turn_p99_deg_per_mm)
    report.push_back(row("atlas", "septum_junction_turn_p99", *figures.atlas_junction_turn_p99_deg_per_mm, "deg/mm"));
  if (junction.jump_deg.empty()) return;
  report.push_back(row("septum_junction", "neighbour_jump_p99", quantile(junction.jump_deg, 0.99), "deg"));
  report.push_back(row("septum_junction", "neighbour_turn_p99", quantile(junction.turn_deg_per_mm, 0.99), "deg/mm"));
}

/// How far the cells' fibres are from those of the rule.
void add_rule_rows(const TetMesh& mesh, Report& report) {
  if (mesh.rule_difference_deg.size() != mesh.cells.size()) return;
  for (const Region region : {Region::lv_myocardium, Region::rv_myocardium}) {
    std::vector<double> known;
    double sum = 0;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      if (mesh.region[c] != tag(region) || mesh.rule_difference_deg[c] < 0) continue;
      known.push_back(double{mesh.rule_difference_deg[c]});
      sum += known.back();
    }
    if (known.empty()) continue;
    const std::string scope = region_name(tag(region));
    report.push_back(row(scope, "rule_difference_mean", sum / static_cast<double>(known.size()), "deg"));
    report.push_back(row(scope, "rule_difference_p95", quantile(known, 0.95), "deg"));
  }
}

/// Shares of the ventricles' nodes by source.
void add_source_rows(const TetMesh& mesh, Report& report) {
  if (mesh.fiber_source.size() != mesh.nodes_mm.size()) {
    report.push_back(row("myocardium", "nodes_without_source", static_cast<double>(mesh.nodes_mm.size()), "count"));
    return;
  }
  std::vector<std::uint8_t> in_ventricle(mesh.nodes_mm.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (ventricular(mesh.region[c]))
      for (const auto n : mesh.cells[c]) in_ventricle[static_cast<std::size_t>(n)] = 1;
  double ventricle = 0, other = 0, none = 0;
  for (std::size_t n = 0; n < in_ventricle.size(); ++n) {
    const auto source = static_cast<FiberSource>(mesh.fiber_source[n]);
    none += source == FiberSource::none;
    ventricle += in_ventricle[n];
    other += in_ventricle[n] && source != FiberSource::atlas;
  }
  report.push_back(row("myocardium", "nodes_without_source", none, "count"));
  report.push_back(row("ventricles", "inpainted_fraction", ventricle > 0 ? other / ventricle : 0, "1"));
}

struct HelixSamples {
  std::vector<double> depth, helix_deg;
};

/// Helix angle at the centroid of every cell of the ventricle, away from the apex, where "around" means nothing.
HelixSamples helix_samples(const TetMesh& mesh, Region ventricle) {
  constexpr double min_tangent = 0.3;
  HelixSamples samples;
  if (mesh.cell_fibers.fiber.size() != mesh.cells.size()) return samples;
  const WallDepth wall = wall_depth(mesh, ventricle);
  const Vec3 axis = heart_frame(mesh).axis;
  for (std::size_t w = 0; w < wall.cells.size(); ++w) {
    const Vec3 n = wall.normal[w];
    const Vec3 along = axis - dot(axis, n) * n;
    const Vec3 fiber = mesh.cell_fibers.fiber[static_cast<std::size_t>(wall.cells[w])];
    if (norm(n) < 0.5 || norm(along) < min_tangent || !finite(fiber)) continue;
    const Vec3 up = normalized(along);
    double rise = dot(fiber, up), turn = dot(fiber, cross(up, n));
    if (turn < 0) rise = -rise, turn = -turn;
    samples.depth.push_back(wall.depth[w]);
    samples.helix_deg.push_back(degrees * math::atan2(rise, turn));
  }
  return samples;
}

/// Median of angles that are only known up to 180 degrees: taken within ±90 of their mean direction.
double axis_quantile(const std::vector<double>& angles_deg, double q) {
  double c = 0, s = 0;
  for (const double a : angles_deg) {
    c += math::cos(2 * a / degrees);
    s += math::sin(2 * a / degrees);
  }
  const double mean = 0.5 * degrees * math::atan2(s, c);
  std::vector<double> around;
  around.reserve(angles_deg.size());
  for (const double a : angles_deg) around.push_back(mean + std::remainder(a - mean, 180.0));
  return quantile(std::move(around), q);
}

std::vector<std::vector<double>> binned(const HelixSamples& samples, int bins) {
  std::vector<std::vector<double>> bin(static_cast<std::size_t>(bins));
  for (std::size_t n = 0; n < samples.depth.size(); ++n) {
    const int b = std::clamp(static_cast<int>(samples.depth[n] * bins), 0, bins - 1);
    bin[static_cast<std::size_t>(b)].push_back(samples.helix_deg[n]);
  }
  return bin;
}

HelixSamples doubled(const DepthSamples& samples) {
  return {{samples.depth.begin(), samples.depth.end()}, {samples.helix_deg.begin(), samples.helix_deg.end()}};
}

HelixProfile profile_of(const HelixSamples& samples, int bins) {
  const auto bin = binned(samples, bins);
  HelixProfile profile;
  if (std::all_of(bin.begin(), bin.end(), [](const auto& b) { return b.empty(); })) return profile;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t b = 0; b < bin.size(); ++b) {
    profile.depth.push_back((static_cast<double>(b) + 0.5) / bins);
    profile.median_deg.push_back(bin[b].empty() ? nan : axis_quantile(bin[b], 0.5));
    profile.p10_deg.push_back(bin[b].empty() ? nan : axis_quantile(bin[b], 0.1));
    profile.p90_deg.push_back(bin[b].empty() ? nan : axis_quantile(bin[b], 0.9));
  }
  return profile;
}

/// Median helix angle at depths from `low` to `high`.
std::optional<double> helix_between(const DepthSamples& samples, double low, double high) {
  std::vector<double> angles;
  for (std::size_t n = 0; n < samples.depth.size(); ++n)
    if (samples.depth[n] >= low && samples.depth[n] <= high) angles.push_back(double{samples.helix_deg[n]});
  if (angles.empty()) return std::nullopt;
  return axis_quantile(angles, 0.5);
}

/// Near the wall's two surfaces: the atlas's helix, and by how much what was carried from it differs, over the whole of
/// both walls and over corresponding places. The outermost twentieth is left out: there, samples of a grid and nodes of
/// a mesh do not lie alike.
void add_atlas_rows(const std::string& scope, const DepthSamples& atlas, const DepthSamples& there,
                    const DepthSamples& carried, Report& report) {
  struct End {
    const char* name;
    double low, high;
  };
  for (const End& end : {End{"endocardium", 0.05, 0.2}, End{"epicardium", 0.8, 0.95}}) {
    const auto whole = helix_between(atlas, end.low, end.high), ours = helix_between(carried, end.low, end.high);
    if (!whole || !ours) continue;
    const auto add_difference = [&](const char* against, double own) {
      report.push_back(row(scope, std::string("helix_") + end.name + "_off_atlas" + against,
                           std::abs(std::remainder(*ours - own, 180.0)), "deg"));
    };
    report.push_back(row(scope, std::string("atlas_helix_") + end.name, *whole, "deg"));
    add_difference("", *whole);
    if (const auto own = helix_between(there, end.low, end.high)) add_difference("_at_same_places", *own);
  }
}

/// Medians near the endocardium, in the middle and near the epicardium, and how far the helix falls between the two.
void add_helix_rows(const TetMesh& mesh, Region ventricle, Report& report) {
  const auto bins = binned(helix_samples(mesh, ventricle), 5);
  const std::string scope = region_name(tag(ventricle));
  const auto add = [&](std::size_t bin, const char* metric) {
    if (!bins[bin].empty()) report.push_back(row(scope, metric, axis_quantile(bins[bin], 0.5), "deg"));
  };
  add(0, "helix_endocardium_median");
  add(2, "helix_midwall_median");
  add(4, "helix_epicardium_median");
  if (!bins[0].empty() && !bins[4].empty())
    report.push_back(row(scope, "helix_fall", axis_quantile(bins[0], 0.5) - axis_quantile(bins[4], 0.5), "deg"));
}

/// Median angles between neighbours within one wall: at the ends of edges, and between cells and their nodes.
void add_wall_jump_rows(const TetMesh& mesh, Report& report) {
  for (const Region wall : {Region::lv_myocardium, Region::rv_myocardium, Region::la_wall, Region::ra_wall}) {
    std::vector<std::uint8_t> use(mesh.cells.size());
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) use[c] = mesh.region[c] == tag(wall);
    std::vector<double> jump_deg;
    for (const auto& [a, b] : mesh_queries::edges_of_cells(mesh.cells, mesh.nodes_mm.size(), use))
      jump_deg.push_back(axis_angle_deg(mesh.node_fibers.fiber[static_cast<std::size_t>(a)],
                                        mesh.node_fibers.fiber[static_cast<std::size_t>(b)]));
    if (jump_deg.empty()) continue;
    const std::string scope = region_name(tag(wall));
    report.push_back(row(scope, "neighbour_jump_p50", quantile(jump_deg, 0.5), "deg"));
    std::vector<double> cell_deg;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      if (use[c])
        for (const auto n : mesh.cells[c])
          cell_deg.push_back(
              axis_angle_deg(mesh.cell_fibers.fiber[c], mesh.node_fibers.fiber[static_cast<std::size_t>(n)]));
    report.push_back(row(scope, "cell_jump_p50", quantile(cell_deg, 0.5), "deg"));
  }
}

void add_registration_rows(const RegistrationFigures& figures, Report& report) {
  if (figures.min_jacobian) report.push_back(row("registration", "jacobian_min", *figures.min_jacobian, "1"));
  if (figures.affine_rms_mm) report.push_back(row("registration", "affine_misfit_rms", *figures.affine_rms_mm, "mm"));
  if (figures.atlas_overlap) report.push_back(row("registration", "wall_overlap_dice", *figures.atlas_overlap, "1"));
  if (figures.second_mean_deg)
    report.push_back(row("ventricles", "second_method_difference_mean", *figures.second_mean_deg, "deg"));
  if (figures.second_p95_deg)
    report.push_back(row("ventricles", "second_method_difference_p95", *figures.second_p95_deg, "deg"));
}

}  // namespace

HelixProfile helix_profile(const TetMesh& myocardium, Region ventricle, int bins) {
  return profile_of(helix_samples(myocardium, ventricle), bins);
}

HelixProfile helix_profile(const DepthSamples& samples, int bins) { return profile_of(doubled(samples), bins); }

Report check_fibers(const TetMesh& myocardium, const RegistrationFigures& figures, const ValidationSettings& settings) {
  Report report;
  add_frame_rows(myocardium.node_fibers, myocardium.nodes_mm.size(), "nodes", report);
  add_frame_rows(myocardium.cell_fibers, myocardium.cells.size(), "cells", report);
  add_source_rows(myocardium, report);
  add_registration_rows(figures, report);
  if (!complete(myocardium.node_fibers, myocardium.nodes_mm.size()) ||
      !complete(myocardium.cell_fibers, myocardium.cells.size()))
    return judged(std::move(report), settings);
  add_jump_rows(myocardium, figures, report);
  add_wall_jump_rows(myocardium, report);
  for (const Region ventricle : {Region::lv_myocardium, Region::rv_myocardium})
    add_helix_rows(myocardium, ventricle, report);
  add_atlas_rows("lv_myocardium", figures.atlas_lv, figures.there_lv, figures.carried_lv, report);
  add_atlas_rows("rv_myocardium", figures.atlas_rv, figures.there_rv, figures.carried_rv, report);
  add_rule_rows(myocardium, report);
  return judged(std::move(report), settings);
}

std::string remark_on_jumps(const Report& rows) {
  const auto value_of = [&](std::string_view scope, std::string_view metric) {
    for (const auto& r : rows)
      if (r.group == "fibers" && r.scope == scope && r.metric == metric) return r.value;
    return std::numeric_limits<double>::quiet_NaN();
  };
  const double jump_deg = value_of("ventricles", "neighbour_jump_p99");
  const double atlas_deg = value_of("atlas", "neighbour_jump_p99");
  if (!(jump_deg > atlas_deg)) return {};
  return fmt::format(
      "Fibres of neighbouring nodes differ by up to {:.0f} degrees (99th percentile), those of the atlas by {:.0f}: "
      "edges of {:.1f} mm are too long for how fast they turn through thin walls. wall_layers = 2 in [mesh], or a "
      "shorter heart_edge_mm, lowers it.",
      jump_deg, atlas_deg, value_of("ventricles", "edge_p50"));
}

}  // namespace heartgen::validation
