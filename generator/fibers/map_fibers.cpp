// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/map_fibers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <string_view>

#include "generator/fibers/atrial_rule.hpp"
#include "generator/fibers/even_junction.hpp"
#include "generator/fibers/frame.hpp"
#include "generator/fibers/high_gradient_cells.hpp"
#include "generator/fibers/inpaint.hpp"
#include "generator/fibers/registered_pair.hpp"
#include "generator/fibers/rule.hpp"
#include "generator/fibers/ventricle_rule.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "generator/parallel/tasks.hpp"
#include "generator/parallel/threads.hpp"
#include "model/contract.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"

namespace heartgen::fibers {
namespace {

constexpr double atlas_search_mm = 8;  // farther from every sample, a carried axis counts as inpainted

/// What each node of the mesh belongs to.
struct NodeKinds {
  std::vector<std::uint8_t> ventricle, papillary, left_atrium, right_atrium;
};

NodeKinds node_kinds(const TetMesh& mesh) {
  const std::vector<std::uint8_t> none(mesh.nodes_mm.size());
  NodeKinds kinds{none, none, none, none};
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto region = static_cast<Region>(mesh.region[c]);
    auto& kind = region == Region::papillary ? kinds.papillary
                 : region == Region::la_wall ? kinds.left_atrium
                 : region == Region::ra_wall ? kinds.right_atrium
                                             : kinds.ventricle;
    for (const auto n : mesh.cells[c]) kind[static_cast<std::size_t>(n)] = 1;
  }
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    if (kinds.ventricle[n]) kinds.papillary[n] = kinds.left_atrium[n] = kinds.right_atrium[n] = 0;
    if (kinds.papillary[n]) kinds.left_atrium[n] = kinds.right_atrium[n] = 0;
    if (kinds.left_atrium[n]) kinds.right_atrium[n] = 0;
  }
  return kinds;
}

std::vector<std::int32_t> chosen(const std::vector<std::uint8_t>& kind) {
  std::vector<std::int32_t> nodes;
  for (std::size_t n = 0; n < kind.size(); ++n)
    if (kind[n]) nodes.push_back(static_cast<std::int32_t>(n));
  return nodes;
}

/// Distance in the atlas from each node's warped position to the nearest voxel with a fibre.
void set_atlas_distances(const RegisteredPair& hearts, const NodeKinds& kinds, const std::vector<Vec3>& atlas_mm,
                         FiberResult& result) {
  Mask with_fiber(hearts.atlas.fiber.grid);
  for (std::size_t v = 0; v < with_fiber.voxels.size(); ++v)
    with_fiber.voxels[v] = norm(hearts.atlas.fiber.voxels[v]) > 0.5;
  const auto distance = image::distance_to(with_fiber);
  result.atlas_distance_mm.assign(atlas_mm.size(), -1);
  for (std::size_t n = 0; n < atlas_mm.size(); ++n)
    if (kinds.ventricle[n])
      result.atlas_distance_mm[n] =
          static_cast<float>(sample_linear(distance, index_from_lps(distance.grid, atlas_mm[n])));
}

struct NodeDirections {
  std::vector<Vec3> fiber, transmural;
};

Vec3 radial(const ventricles::HeartFrame& frame, const Vec3& point_mm) {
  const Vec3 d = point_mm - frame.base_point_mm;
  const Vec3 r = d - dot(d, frame.long_axis) * frame.long_axis;
  return norm(r) > 1e-6 ? normalized(r) : frame.rv_side;
}

/// Fibre axes and wall normals of the ventricles' nodes; what could not be carried is inpainted along the mesh's edges,
/// and where the two walls are blended the axes turn evenly from the one's to the other's.
void set_ventricles(const RegisteredPair& hearts, const TetMesh& mesh, const NodeKinds& kinds, const PointWalls& walls,
                    std::vector<AxisTensor> axes, int iterations, NodeDirections& directions, FiberResult& result) {
  std::vector<std::uint8_t> missing(axes.size()), use(mesh.cells.size());
  for (std::size_t n = 0; n < axes.size(); ++n) {
    if (!kinds.ventricle[n]) continue;
    missing[n] = trace(axes[n]) <= 0;
    const bool far = missing[n] || result.atlas_distance_mm[n] > atlas_search_mm;
    result.source[n] = static_cast<std::uint8_t>(far ? FiberSource::inpainted : FiberSource::atlas);
    if (walls.known[n]) result.wall_depth[n] = static_cast<float>(walls.main(n).depth);
    directions.transmural[n] = walls.known[n] ? walls.main(n).normal : radial(hearts.patient.frame, mesh.nodes_mm[n]);
  }
  for (std::size_t c = 0; c < use.size(); ++c)
    use[c] = mesh.region[c] == tag(Region::lv_myocardium) || mesh.region[c] == tag(Region::rv_myocardium);
  const auto edges = edge_graph(mesh, use);
  if (std::find(missing.begin(), missing.end(), 1) != missing.end()) inpaint_axes(edges, iterations, axes, missing);
  turn_evenly(edges, walls.from_junction_mm, axes);
  parallel::parallel_for(0, static_cast<std::int64_t>(axes.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      if (kinds.ventricle[n]) directions.fiber[n] = leading_axis(axes[n]);
  });
}

/// At the wanted nodes where the rule has an axis.
void set_rule(const RuleField& rule, const std::vector<std::uint8_t>& wanted, NodeDirections& directions,
              FiberResult& result) {
  for (std::size_t n = 0; n < rule.nodes.size(); ++n) {
    const auto node = static_cast<std::size_t>(rule.nodes[n]);
    if (!wanted[node] || rule.axes[n].fiber == Vec3{}) continue;
    directions.fiber[node] = rule.axes[n].fiber;
    directions.transmural[node] = rule.axes[n].transmural;
    result.source[node] = static_cast<std::uint8_t>(FiberSource::rule);
  }
}

void set_cells(const RuleField& rule, FiberField& cell) {
  for (std::size_t n = 0; n < rule.cells.size(); ++n) {
    const auto c = static_cast<std::size_t>(rule.cells[n]);
    if (rule.cell_axes[n].fiber == Vec3{}) continue;
    const auto axes = material_axes(rule.cell_axes[n].fiber, rule.cell_axes[n].transmural);
    cell.fiber[c] = axes.fiber;
    cell.sheet[c] = axes.sheet;
    cell.sheet_normal[c] = axes.sheet_normal;
  }
}

struct RuleFields {
  RuleField ventricles, papillary, left_atrium, right_atrium;
};

RuleFields rule_fields(const TetMesh& mesh, const NodeKinds& kinds, const ventricles::HeartFrame& frame,
                       const RuleSettings& settings) {
  RuleFields rules;
  rules.ventricles = ventricle_rule(mesh, frame, settings);
  parallel::run_tasks(std::vector<std::function<void()>>{
      [&] { rules.left_atrium = atrial_rule(mesh, true, settings); },
      [&] { rules.right_atrium = atrial_rule(mesh, false, settings); },
      [&] {
        rules.papillary.nodes = chosen(kinds.papillary);
        rules.papillary.axes = papillary_axes(mesh, rules.papillary.nodes, frame.long_axis);
      }});
  return rules;
}

/// Papillary muscles, atria, and what the atlas reached in no way; where the rule knows none either, fibres circle the
/// long axis.
void set_by_rule(const TetMesh& mesh, const NodeKinds& kinds, const RuleFields& rules,
                 const ventricles::HeartFrame& frame, NodeDirections& directions, FiberResult& result) {
  set_rule(rules.papillary, kinds.papillary, directions, result);
  set_rule(rules.left_atrium, kinds.left_atrium, directions, result);
  set_rule(rules.right_atrium, kinds.right_atrium, directions, result);
  auto unreached = kinds.ventricle;
  for (std::size_t n = 0; n < unreached.size(); ++n) unreached[n] &= norm(directions.fiber[n]) < 0.5;
  set_rule(rules.ventricles, unreached, directions, result);
  for (std::size_t n = 0; n < unreached.size(); ++n) {
    if (norm(directions.fiber[n]) > 0.5) continue;
    directions.fiber[n] = cross(frame.long_axis, radial(frame, mesh.nodes_mm[n]));
    result.source[n] = static_cast<std::uint8_t>(FiberSource::rule);
  }
}

void set_frames(const TetMesh& mesh, const NodeDirections& directions, FiberResult& result) {
  result.node = node_frames(directions.fiber, directions.transmural);
  result.cell = cell_frames(mesh, result.node);
}

/// Angles between the carried axes and those of the second best method, at most 20,000 nodes evenly chosen: where two
/// good methods disagree by much, the atlas fits badly and neither is to be trusted.
void compare_with_second(const RegisteredPair& hearts, const PointWalls& walls, const std::vector<Vec3>& nodes_mm,
                         const std::vector<Vec3>& atlas_mm, const std::vector<AxisTensor>& axes,
                         const std::string& method, FiberResult& result) {
  constexpr std::size_t max_nodes = 20000;
  PointWalls chosen;
  std::vector<Vec3> points, positions, first;
  const std::size_t step = nodes_mm.size() / max_nodes + 1;
  for (std::size_t n = 0; n < nodes_mm.size(); n += step) {
    if (!walls.known[n] || trace(axes[n]) <= 0) continue;
    chosen.left_share.push_back(walls.left_share[n]);
    chosen.known.push_back(1);
    chosen.lv.push_back(walls.lv[n]);
    chosen.rv.push_back(walls.rv[n]);
    points.push_back(nodes_mm[n]);
    positions.push_back(atlas_mm[n]);
    first.push_back(leading_axis(axes[n]));
  }
  const auto second =
      carried_axes(hearts, chosen, points, positions, method == "coordinates" ? "local_angles" : "coordinates").axes;
  std::vector<double> angles_deg;
  for (std::size_t n = 0; n < points.size(); ++n)
    if (trace(second[n]) > 0)
      angles_deg.push_back(math::acos(std::min(1.0, std::abs(dot(first[n], leading_axis(second[n]))))) * 180 /
                           math::acos(-1.0));
  if (angles_deg.empty()) return;
  double sum = 0;
  for (const double a : angles_deg) sum += a;
  std::sort(angles_deg.begin(), angles_deg.end());
  result.second_mean_deg = sum / static_cast<double>(angles_deg.size());
  result.second_p95_deg = angles_deg[(angles_deg.size() - 1) * 95 / 100];
}

std::vector<Warning> warnings_of(const RegisteredPair& hearts, const FiberResult& result) {
  constexpr double doubtful_deg = 5;  // beyond, the true errors averaged 11 to 24 degrees in trials on known fields
  std::vector<Warning> warnings;
  const auto warn = [&](const char* code, std::string text) {
    warnings.push_back({code, WarningLevel::warning, std::move(text)});
  };
  const auto& r = hearts.registration;
  if (r.pose.rms_mm > 3)
    warn("fibers.atlas_pose", fmt::format("The atlas fits only to {:.1f} mm before the warp.", r.pose.rms_mm));
  if (r.wall_overlap < 0.6)
    warn("fibers.atlas_overlap",
         fmt::format("Warped atlas and patient share only {:.0f} % of their walls.", 100 * r.wall_overlap));
  if (r.min_jacobian <= 0)
    warn("fibers.warp_folds", fmt::format("The warp folds (smallest Jacobian {:.3f}).", r.min_jacobian));
  if (result.second_mean_deg > doubtful_deg)
    warn("fibers.methods_differ",
         fmt::format("Two ways of carrying the atlas differ by {:.1f} degrees on average: the fibres are doubtful.",
                     result.second_mean_deg));
  if (hearts.patient.frame.rv_side.x > 0.3)
    warn("fibers.mirrored", "The right ventricle lies to the left of the left one: the image may be mirrored.");
  return warnings;
}

Warning no_rule() {
  return {"fibers.no_rule", WarningLevel::warning,
          "The mesh lacks surfaces of the ventricles, so that there are no rule-based fibres."};
}

}  // namespace

void check_settings(const FiberSettings& settings) {
  if (settings.method != "local_angles" && settings.method != "coordinates" && settings.method != "jacobian" &&
      settings.method != "rule")
    throw UserError(fmt::format("unknown method \"{}\"", settings.method), "fibers.method",
                    "use \"local_angles\", \"coordinates\", \"jacobian\" or \"rule\"");
  if (!(settings.grid_mm >= 0.3 && settings.grid_mm <= 6) || !(settings.depth_grid_mm >= 0.3) ||
      settings.depth_grid_mm > settings.grid_mm)
    throw UserError("the grids of the fibre stage are out of range", "fibers.grid_mm, fibers.depth_grid_mm",
                    "use 0.3 <= depth_grid_mm <= grid_mm <= 6");
  if (settings.demons_iterations.empty())
    throw UserError("no level of the registration", "fibers.demons_iterations", "name the iterations of one at least");
  const auto check_angle = [](const char* key, double value, const char*) {
    if (std::string_view(key).ends_with("_deg") && !(std::abs(value) <= 90))
      throw UserError(fmt::format("an angle of {:g} degrees", value), std::string("fibers.rule.") + key,
                      "give one between -90 and 90");
  };
  RuleSettings::describe(check_angle, settings.rule);
}

FiberResult map_fibers(const TetMesh& mesh, const LabelVolume& patient_labels, const Landmarks& landmarks,
                       const FiberAtlas& atlas, const FiberSettings& settings) {
  check_settings(settings);
  HEARTGEN_EXPECTS(settings.method != "rule");
  HEARTGEN_EXPECTS(mesh.region.size() == mesh.cells.size());
  PartClock clock;
  const RegisteredPair hearts = register_pair(patient_labels, landmarks, atlas, settings);
  clock.done("alignment");
  const NodeKinds kinds = node_kinds(mesh);
  const PointWalls walls = point_walls(hearts, mesh.nodes_mm, kinds.ventricle);
  const std::size_t count = mesh.nodes_mm.size();
  const auto atlas_mm = atlas_positions(hearts, mesh.nodes_mm);
  clock.done("depth and place");

  FiberResult result;
  result.source.assign(count, static_cast<std::uint8_t>(FiberSource::none));
  result.wall_depth.assign(count, -1);
  set_atlas_distances(hearts, kinds, atlas_mm, result);
  NodeDirections directions{std::vector<Vec3>(count, {1, 0, 0}), std::vector<Vec3>(count, {0, 0, 1})};
  const std::string& method = settings.method;
  auto carried = carried_axes(hearts, walls, mesh.nodes_mm, atlas_mm, method);
  clock.done("carrying");
  compare_with_second(hearts, walls, mesh.nodes_mm, atlas_mm, carried.axes, method, result);
  clock.done("second method");
  set_ventricles(hearts, mesh, kinds, walls, std::move(carried.axes), settings.inpainting_iterations, directions,
                 result);
  auto from_atlas = kinds.ventricle;
  for (std::size_t n = 0; n < count; ++n)
    from_atlas[n] &= result.source[n] == static_cast<std::uint8_t>(FiberSource::atlas);
  result.figures = atlas_figures(hearts, atlas, {mesh, walls, atlas_mm, directions.fiber, from_atlas});
  clock.done("inpainting, figures");
  const auto rules = rule_fields(mesh, kinds, hearts.patient.frame, settings.rule);
  const RuleField& rule = rules.ventricles;
  clock.done("rules");
  set_by_rule(mesh, kinds, rules, hearts.patient.frame, directions, result);
  set_frames(mesh, directions, result);
  carry_to_steep_cells(hearts, mesh, result.node, carried, method, result.cell);
  result.rule_difference_deg = differences_deg(result.cell.fiber, rule);
  clock.done("frames");
  result.part_times = std::move(clock.times);
  result.min_jacobian = hearts.registration.min_jacobian;
  result.affine_rms_mm = hearts.registration.pose.rms_mm;
  result.atlas_overlap = hearts.registration.wall_overlap;
  result.atlas_array = atlas.array;
  result.warnings = warnings_of(hearts, result);
  if (rule.nodes.empty()) result.warnings.push_back(no_rule());
  return result;
}

FiberResult rule_fibers(const TetMesh& mesh, const LabelVolume& patient_labels, const Landmarks& landmarks,
                        const FiberSettings& settings) {
  check_settings(settings);
  HEARTGEN_EXPECTS(mesh.region.size() == mesh.cells.size());
  PartClock clock;
  const auto patient = ventricles::ventricles_of_labels(patient_labels, landmarks, settings.depth_grid_mm);
  refuse_mirrored_patient(patient_labels, landmarks, patient.frame);
  clock.done("ventricles");
  const NodeKinds kinds = node_kinds(mesh);
  const auto rules = rule_fields(mesh, kinds, patient.frame, settings.rule);
  clock.done("rules");
  const std::size_t count = mesh.nodes_mm.size();
  FiberResult result;
  result.source.assign(count, static_cast<std::uint8_t>(FiberSource::none));
  result.atlas_distance_mm.assign(count, -1);
  result.wall_depth.assign(count, -1);
  NodeDirections directions{std::vector<Vec3>(count, {1, 0, 0}), std::vector<Vec3>(count, {0, 0, 1})};
  for (std::size_t n = 0; n < count; ++n)
    if (kinds.ventricle[n]) {
      directions.fiber[n] = {};
      directions.transmural[n] = radial(patient.frame, mesh.nodes_mm[n]);
    }
  set_by_rule(mesh, kinds, rules, patient.frame, directions, result);
  set_frames(mesh, directions, result);
  set_cells(rules.ventricles, result.cell);
  clock.done("frames");
  result.part_times = std::move(clock.times);
  if (rules.ventricles.nodes.empty()) result.warnings.push_back(no_rule());
  return result;
}

}  // namespace heartgen::fibers
