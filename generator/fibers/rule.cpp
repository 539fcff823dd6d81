#include "generator/fibers/rule.hpp"

#include <array>
#include <cmath>

#include "generator/atlas/axis_tensor.hpp"
#include "generator/atlas/distance_map.hpp"
#include "generator/atlas/point_tree.hpp"
#include "generator/atlas/resample.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"

namespace heart::fibers {
namespace {

using atlas::AxisTensor;
using atlas::PointCloud;

Vec3 orthogonal_part(const Vec3& v, const Vec3& unit) { return v - dot(v, unit) * unit; }

Vec3 any_orthogonal(const Vec3& unit) {
  return normalized(cross(unit, std::abs(unit.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
}

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) { return norm(v) > 1e-6 ? normalized(v) : otherwise; }

PointCloud papillary_cells(const TetMesh& mesh) {
  PointCloud cloud;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (mesh.region[c] != tag(Region::papillary)) continue;
    Vec3 sum;
    for (const auto n : mesh.cells[c]) sum += mesh.nodes_mm[static_cast<std::size_t>(n)];
    cloud.points.push_back(0.25 * sum);
  }
  return cloud;
}

RuleAxis local_muscle_axis(const PointCloud& cloud, const atlas::PointTree& tree, const Vec3& at,
                           const Vec3& long_axis) {
  constexpr double reach_mm = 6, long_axis_share = 0.05;
  std::vector<std::pair<std::size_t, double>> near;
  const std::array<double, 3> query{at.x, at.y, at.z};
  tree.radiusSearch(query.data(), reach_mm * reach_mm, near, nanoflann::SearchParams(32, 0, true));
  Vec3 middle;
  for (const auto& [cell, distance] : near) middle += cloud.points[cell];
  if (!near.empty()) middle = middle / static_cast<double>(near.size());
  AxisTensor spread = (long_axis_share * reach_mm * reach_mm) * atlas::axis_tensor(long_axis);
  for (const auto& [cell, distance] : near)
    spread += (1 / static_cast<double>(near.size())) * atlas::axis_tensor(cloud.points[cell] - middle);
  const Vec3 fiber = atlas::leading_axis(spread);
  return {fiber, unit_or(orthogonal_part(at - middle, fiber), any_orthogonal(fiber))};
}

/// The atrium's blood on a grid of its own.
struct Chamber {
  LevelSet distance;
  Vec3 middle_mm, valve_mm;
};

Chamber chamber_of(const LabelVolume& labels, const Landmarks& landmarks, bool left) {
  constexpr double spacing_mm = 2, margin_mm = 12, smoothing_voxels = 2;
  const auto blood = tag(left ? Region::la_blood : Region::ra_blood);
  const auto wall = tag(left ? Region::la_wall : Region::ra_wall);
  const auto ventricle = tag(left ? Region::lv_blood : Region::rv_blood);
  const auto local =
      atlas::resampled(labels, atlas::isotropic_grid_around(
                                   labels, [&](auto v) { return v == blood || v == wall; }, spacing_mm, margin_mm));
  Chamber chamber;
  const Mask mask = atlas::mask_where(local, [&](auto v) { return v == blood; });
  chamber.distance = atlas::signed_distance(mask, smoothing_voxels);
  const auto to_ventricle = atlas::distance_to(atlas::mask_where(local, [&](auto v) { return v == ventricle; }));
  Vec3 sum, contact;
  double count = 0, contacts = 0;
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) {
    if (!mask.voxels[v]) continue;
    const Vec3 p = atlas::voxel_center(local.grid, static_cast<std::int64_t>(v));
    sum += p;
    ++count;
    if (to_ventricle.voxels[v] > 1.5 * spacing_mm) continue;
    contact += p;
    ++contacts;
  }
  chamber.middle_mm = count > 0 ? sum / count : lps_from_index(local.grid, {0, 0, 0});
  const auto valve = landmarks.valves.find(left ? "mitral" : "tricuspid");
  chamber.valve_mm = valve != landmarks.valves.end() ? valve->second.center_mm
                     : contacts > 0                  ? contact / contacts
                                                     : chamber.middle_mm - Vec3{0, 0, 1};
  return chamber;
}

Vec3 outward(const Chamber& chamber, const Vec3& at) {
  const Vec3 index = index_from_lps(chamber.distance.grid, at);
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 low = index, high = index;
    low[axis] -= 0.5;
    high[axis] += 0.5;
    slope[axis] = sample_linear(chamber.distance, high) - sample_linear(chamber.distance, low);
  }
  return unit_or(slope, unit_or(at - chamber.middle_mm, {0, 0, 1}));
}

}  // namespace

std::vector<RuleAxis> papillary_axes(const TetMesh& mesh, const std::vector<std::int32_t>& nodes,
                                     const Vec3& long_axis) {
  const PointCloud cloud = papillary_cells(mesh);
  std::vector<RuleAxis> result(nodes.size());
  if (nodes.empty()) return result;
  const atlas::PointTree tree(3, cloud, atlas::tree_leaves);
  parallel::parallel_for(0, static_cast<std::int64_t>(nodes.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      result[n] = local_muscle_axis(cloud, tree, mesh.nodes_mm[static_cast<std::size_t>(nodes[n])], long_axis);
  });
  return result;
}

std::vector<RuleAxis> atrial_axes(const LabelVolume& labels, const Landmarks& landmarks, bool left,
                                  const std::vector<Vec3>& points_mm) {
  std::vector<RuleAxis> result(points_mm.size());
  if (points_mm.empty()) return result;
  const Chamber chamber = chamber_of(labels, landmarks, left);
  const Vec3 to_roof = unit_or(chamber.middle_mm - chamber.valve_mm, {0, 0, 1});
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    const Vec3 transmural = outward(chamber, points_mm[n]);
    result[n] = {unit_or(cross(transmural, to_roof), any_orthogonal(transmural)), transmural};
  }
  return result;
}

}  // namespace heart::fibers
