#include "generator/fibers/carry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/atlas/coordinates.hpp"
#include "generator/atlas/distance_map.hpp"
#include "generator/atlas/register.hpp"
#include "generator/fibers/frame.hpp"
#include "generator/fibers/inpaint.hpp"
#include "generator/fibers/local_angles.hpp"
#include "generator/fibers/push_forward.hpp"
#include "generator/fibers/rule.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heart::fibers {
namespace {

using atlas::AxisTensor;
using atlas::Part;
using atlas::WallCoordinates;
using atlas::WallPoint;

constexpr double blend_mm = 2;           // the ventricles' fields are blended this far on either side of their junction
constexpr double reach_of_atlas_mm = 8;  // farther from every sample, a carried axis counts as inpainted

/// One value per ventricle.
template <class T>
struct Both {
  T lv, rv;
};

struct Hearts {
  atlas::Ventricles patient;
  atlas::AtlasImage atlas;
  Both<AngleSamples> samples;
  atlas::Registration registration;
  Both<WallCoordinates> patient_walls;
};

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

/// Share of the left ventricle in the field at a node: 1 in its wall, 0 in the right one's, linear between.
std::vector<double> left_shares(const atlas::Ventricles& patient, const TetMesh& mesh) {
  const auto to_lv = atlas::distance_to(atlas::mask_where(patient.parts, [](auto v) { return is(v, Part::lv_wall); }));
  const auto to_rv = atlas::distance_to(atlas::mask_where(patient.parts, [](auto v) { return is(v, Part::rv_wall); }));
  std::vector<double> share(mesh.nodes_mm.size());
  for (std::size_t n = 0; n < share.size(); ++n) {
    const Vec3 index = index_from_lps(to_lv.grid, mesh.nodes_mm[n]);
    const double difference = sample_linear(to_rv, index) - sample_linear(to_lv, index);
    share[n] = std::clamp(0.5 + 0.5 * difference / blend_mm, 0.0, 1.0);
  }
  return share;
}

/// Wall depth and normal per node, from the ventricle that has the larger share and is known there.
struct NodeWalls {
  std::vector<double> left_share;  ///< 0 or 1 where only one ventricle's wall is near
  std::vector<std::uint8_t> known;
  std::vector<WallPoint> lv, rv;
};

NodeWalls node_walls(const Hearts& hearts, const TetMesh& mesh, const NodeKinds& kinds) {
  const std::size_t count = mesh.nodes_mm.size();
  NodeWalls walls{left_shares(hearts.patient, mesh), std::vector<std::uint8_t>(count), std::vector<WallPoint>(count),
                  std::vector<WallPoint>(count)};
  parallel::parallel_for(0, static_cast<std::int64_t>(count), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      if (!kinds.ventricle[n]) continue;
      const auto lv = wall_point(hearts.patient_walls.lv, hearts.patient.frame, mesh.nodes_mm[n]);
      const auto rv = wall_point(hearts.patient_walls.rv, hearts.patient.frame, mesh.nodes_mm[n]);
      if (!lv && !rv) continue;
      walls.known[n] = 1;
      if (!lv) walls.left_share[n] = 0;
      if (!rv) walls.left_share[n] = 1;
      if (lv) walls.lv[n] = *lv;
      if (rv) walls.rv[n] = *rv;
    }
  });
  return walls;
}

const WallPoint& main_wall(const NodeWalls& walls, std::size_t n) {
  return walls.left_share[n] >= 0.5 ? walls.lv[n] : walls.rv[n];
}

/// Adds share × carried dyad to the tensors of the nodes where this ventricle has a share.
void add_carried(const AngleSamples& samples, const NodeWalls& walls, const std::vector<Vec3>& atlas_mm, bool left,
                 std::vector<AxisTensor>& axes) {
  std::vector<AngleQuery> queries;
  std::vector<std::size_t> nodes;
  for (std::size_t n = 0; n < axes.size(); ++n) {
    const double share = left ? walls.left_share[n] : 1 - walls.left_share[n];
    if (!walls.known[n] || share <= 0) continue;
    queries.push_back({atlas_mm[n], left ? walls.lv[n] : walls.rv[n]});
    nodes.push_back(n);
  }
  const auto carried = carry_local_angles(samples, queries);
  for (std::size_t q = 0; q < nodes.size(); ++q) {
    const double share = left ? walls.left_share[nodes[q]] : 1 - walls.left_share[nodes[q]];
    axes[nodes[q]] += share * carried[q];
  }
}

double helix_of(const AxisTensor& local) {
  const Vec3 axis = atlas::leading_axis(local);
  return std::atan2(axis.x < 0 ? -axis.y : axis.y, std::abs(axis.x)) * 180 / std::acos(-1.0);
}

/// A heart's fibres climb from a right-handed helix inside to a left-handed one outside; a mirrored atlas's do not.
void check_handedness(const AngleSamples& lv, const std::string& name) {
  constexpr double clearly_deg = 15;
  AxisTensor inside, outside;
  for (std::size_t n = 0; n < lv.depth.size(); ++n) {
    if (lv.depth[n] < 0.3) inside += lv.tensor[n];
    if (lv.depth[n] > 0.7) outside += lv.tensor[n];
  }
  const double inner = helix_of(inside), outer = helix_of(outside);
  if (inner < outer - clearly_deg)
    throw UserError(fmt::format("the fibres of the atlas turn the wrong way: helix angle {:.0f} deg inside, {:.0f} deg "
                                "outside; it is mirrored",
                                inner, outer),
                    name, "change the sign of one coordinate of its points and of its vectors");
}

Both<AngleSamples> checked_samples(const atlas::AtlasImage& image, const std::string& name) {
  Both<AngleSamples> samples{angle_samples(image, Part::lv_wall), angle_samples(image, Part::rv_wall)};
  if (samples.lv.depth.empty() || samples.rv.depth.empty())
    throw UserError("the atlas has no fibres in one of the ventricles", name,
                    "a fibre atlas is a mesh of both ventricles with one vector per point or per cell");
  check_handedness(samples.lv, name);
  return samples;
}

/// Axes of the ventricles' nodes; zero tensors where nothing could be carried.
std::vector<AxisTensor> carried_axes(const Hearts& hearts, const NodeWalls& walls, const std::vector<Vec3>& atlas_mm,
                                     const TetMesh& mesh, const FiberSettings& settings) {
  if (settings.method == "jacobian") return push_forward(hearts.atlas, hearts.registration, mesh.nodes_mm);
  std::vector<AxisTensor> axes(mesh.nodes_mm.size());
  add_carried(hearts.samples.lv, walls, atlas_mm, true, axes);
  add_carried(hearts.samples.rv, walls, atlas_mm, false, axes);
  return axes;
}

/// Distance in the atlas from each node's warped position to the nearest voxel with a fibre.
void set_atlas_distances(const Hearts& hearts, const NodeKinds& kinds, const std::vector<Vec3>& atlas_mm,
                         FiberResult& result) {
  Mask with_fiber(hearts.atlas.fiber.grid);
  for (std::size_t v = 0; v < with_fiber.voxels.size(); ++v)
    with_fiber.voxels[v] = norm(hearts.atlas.fiber.voxels[v]) > 0.5;
  const auto distance = atlas::distance_to(with_fiber);
  result.atlas_distance_mm.assign(atlas_mm.size(), -1);
  for (std::size_t n = 0; n < atlas_mm.size(); ++n)
    if (kinds.ventricle[n])
      result.atlas_distance_mm[n] =
          static_cast<float>(sample_linear(distance, index_from_lps(distance.grid, atlas_mm[n])));
}

struct NodeDirections {
  std::vector<Vec3> fiber, transmural;
};

Vec3 radial(const atlas::HeartFrame& frame, const Vec3& point_mm) {
  const Vec3 d = point_mm - frame.base_point_mm;
  const Vec3 r = d - dot(d, frame.long_axis) * frame.long_axis;
  return norm(r) > 1e-6 ? normalized(r) : frame.rv_side;
}

/// Fibre axes and wall normals of the ventricles' nodes; what could not be carried is inpainted along the mesh's
/// edges, and what even that cannot reach circles the long axis.
void set_ventricles(const Hearts& hearts, const TetMesh& mesh, const NodeKinds& kinds, const NodeWalls& walls,
                    std::vector<AxisTensor> axes, int iterations, NodeDirections& directions, FiberResult& result) {
  std::vector<std::uint8_t> missing(axes.size()), use(mesh.cells.size());
  for (std::size_t n = 0; n < axes.size(); ++n) {
    if (!kinds.ventricle[n]) continue;
    missing[n] = trace(axes[n]) <= 0;
    const bool far = missing[n] || result.atlas_distance_mm[n] > reach_of_atlas_mm;
    result.source[n] = static_cast<std::uint8_t>(far ? FiberSource::inpainted : FiberSource::atlas);
    if (walls.known[n]) result.wall_depth[n] = static_cast<float>(main_wall(walls, n).depth);
    directions.transmural[n] =
        walls.known[n] ? main_wall(walls, n).normal : radial(hearts.patient.frame, mesh.nodes_mm[n]);
  }
  for (std::size_t c = 0; c < use.size(); ++c)
    use[c] = mesh.region[c] == tag(Region::lv_myocardium) || mesh.region[c] == tag(Region::rv_myocardium);
  if (std::find(missing.begin(), missing.end(), 1) != missing.end())
    inpaint_axes(edge_graph(mesh, use), iterations, axes, missing);
  for (std::size_t n = 0; n < axes.size(); ++n) {
    if (!kinds.ventricle[n]) continue;
    directions.fiber[n] = atlas::leading_axis(axes[n]);
    if (norm(directions.fiber[n]) > 0.5) continue;
    directions.fiber[n] = cross(hearts.patient.frame.long_axis, radial(hearts.patient.frame, mesh.nodes_mm[n]));
    result.source[n] = static_cast<std::uint8_t>(FiberSource::rule);
  }
}

void set_rule(const std::vector<std::int32_t>& nodes, const std::vector<RuleAxis>& axes, NodeDirections& directions,
              FiberResult& result) {
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto node = static_cast<std::size_t>(nodes[n]);
    directions.fiber[node] = axes[n].fiber;
    directions.transmural[node] = axes[n].transmural;
    result.source[node] = static_cast<std::uint8_t>(FiberSource::rule);
  }
}

void set_by_rule(const TetMesh& mesh, const NodeKinds& kinds, const LabelVolume& labels, const Landmarks& landmarks,
                 const Vec3& long_axis, NodeDirections& directions, FiberResult& result) {
  const auto papillary = chosen(kinds.papillary);
  set_rule(papillary, papillary_axes(mesh, papillary, long_axis), directions, result);
  for (const bool left : {true, false}) {
    const auto nodes = chosen(left ? kinds.left_atrium : kinds.right_atrium);
    std::vector<Vec3> points;
    for (const auto n : nodes) points.push_back(mesh.nodes_mm[static_cast<std::size_t>(n)]);
    set_rule(nodes, atrial_axes(labels, landmarks, left, points), directions, result);
  }
}

Hearts prepare(const LabelVolume& labels, const Landmarks& landmarks, const atlas::FiberAtlas& atlas,
               const FiberSettings& settings) {
  const double spacing_mm = settings.depth_grid_mm;
  Hearts hearts;
  hearts.atlas = atlas::image_of_atlas(atlas, spacing_mm);
  hearts.samples = checked_samples(hearts.atlas, atlas.name);
  hearts.patient = atlas::ventricles_of_labels(labels, landmarks, spacing_mm);
  hearts.registration = register_atlas(hearts.patient, hearts.atlas.ventricles, settings);
  hearts.patient_walls.lv = wall_coordinates(hearts.patient, Part::lv_wall);
  hearts.patient_walls.rv = wall_coordinates(hearts.patient, Part::rv_wall);
  return hearts;
}

void check_settings(const TetMesh& mesh, const FiberSettings& settings) {
  if (settings.method != "local_angles" && settings.method != "jacobian")
    throw UserError(fmt::format("unknown method \"{}\"", settings.method), "fibers.method",
                    "use \"local_angles\" or \"jacobian\"");
  if (!(settings.grid_mm >= 0.3 && settings.grid_mm <= 6) || !(settings.depth_grid_mm >= 0.3) ||
      settings.depth_grid_mm > settings.grid_mm)
    throw UserError("the grids of the fibre stage are out of range", "fibers.grid_mm, fibers.depth_grid_mm",
                    "use 0.3 <= depth_grid_mm <= grid_mm <= 6");
  if (mesh.region.size() != mesh.cells.size()) throw std::invalid_argument("carry_fibers: cells without regions");
}

std::vector<std::string> warnings_of(const Hearts& hearts) {
  std::vector<std::string> warnings;
  const auto& r = hearts.registration;
  if (r.pose.rms_mm > 3)
    warnings.push_back(fmt::format("the atlas fits only to {:.1f} mm before the warp", r.pose.rms_mm));
  if (r.wall_overlap < 0.6)
    warnings.push_back(
        fmt::format("warped atlas and patient share only {:.0f} % of their walls", 100 * r.wall_overlap));
  if (r.min_jacobian <= 0) warnings.push_back(fmt::format("the warp folds (smallest Jacobian {:.3f})", r.min_jacobian));
  if (hearts.patient.frame.rv_side.x > 0.3)
    warnings.push_back("the right ventricle lies to the left of the left one: the image may be mirrored");
  return warnings;
}

}  // namespace

FiberResult carry_fibers(const TetMesh& mesh, const LabelVolume& patient_labels, const Landmarks& landmarks,
                         const atlas::FiberAtlas& atlas, const FiberSettings& settings) {
  check_settings(mesh, settings);
  const Hearts hearts = prepare(patient_labels, landmarks, atlas, settings);
  const NodeKinds kinds = node_kinds(mesh);
  const NodeWalls walls = node_walls(hearts, mesh, kinds);
  const std::size_t count = mesh.nodes_mm.size();
  std::vector<Vec3> atlas_mm(count);
  for (std::size_t n = 0; n < count; ++n) atlas_mm[n] = atlas_position(hearts.registration, mesh.nodes_mm[n]);

  FiberResult result;
  result.source.assign(count, static_cast<std::uint8_t>(FiberSource::none));
  result.wall_depth.assign(count, -1);
  set_atlas_distances(hearts, kinds, atlas_mm, result);
  NodeDirections directions{std::vector<Vec3>(count, {1, 0, 0}), std::vector<Vec3>(count, {0, 0, 1})};
  set_ventricles(hearts, mesh, kinds, walls, carried_axes(hearts, walls, atlas_mm, mesh, settings),
                 settings.inpainting_iterations, directions, result);
  set_by_rule(mesh, kinds, patient_labels, landmarks, hearts.patient.frame.long_axis, directions, result);
  result.node = node_frames(directions.fiber, directions.transmural);
  result.cell = cell_frames(mesh, result.node);
  result.min_jacobian = hearts.registration.min_jacobian;
  result.affine_rms_mm = hearts.registration.pose.rms_mm;
  result.atlas_overlap = hearts.registration.wall_overlap;
  result.warnings = warnings_of(hearts);
  return result;
}

}  // namespace heart::fibers
