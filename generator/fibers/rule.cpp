// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/rule.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "generator/adapters/point_tree.hpp"
#include "generator/parallel/threads.hpp"
#include "model/axis_tensor.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"
#include "model/priors.hpp"

namespace heartgen::fibers {
namespace {

using adapters::PointCloud;

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

RuleAxis local_muscle_axis(const PointCloud& cloud, const adapters::PointTree& tree, const Vec3& at,
                           const Vec3& long_axis) {
  constexpr double long_axis_share = 0.05;
  std::vector<std::pair<std::size_t, double>> near;
  const std::array<double, 3> query{at.x, at.y, at.z};
  tree.radiusSearch(query.data(), priors::papillary_radius_mm * priors::papillary_radius_mm, near,
                    nanoflann::SearchParams(32, 0, true));
  Vec3 middle;
  for (const auto& [cell, distance] : near) middle += cloud.points[cell];
  if (!near.empty()) middle = middle / static_cast<double>(near.size());
  AxisTensor spread =
      (long_axis_share * priors::papillary_radius_mm * priors::papillary_radius_mm) * axis_tensor(long_axis);
  for (const auto& [cell, distance] : near)
    spread += (1 / static_cast<double>(near.size())) * axis_tensor(cloud.points[cell] - middle);
  const Vec3 fiber = leading_axis(spread);
  return {fiber, unit_or(orthogonal_part(at - middle, fiber), any_orthogonal(fiber))};
}

}  // namespace

std::vector<float> differences_deg(const std::vector<Vec3>& cell_axes, const RuleField& rule) {
  std::vector<float> result(cell_axes.size(), -1.0F);
  parallel::parallel_for(0, static_cast<std::int64_t>(rule.cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const auto c = static_cast<std::size_t>(rule.cells[n]);
      const Vec3 &ours = cell_axes[c], &rules = rule.cell_axes[n].fiber;
      if (ours == Vec3{} || rules == Vec3{}) continue;
      result[c] = static_cast<float>(math::atan2(norm(cross(ours, rules)), std::abs(dot(ours, rules))) * 180 /
                                     std::numbers::pi);
    }
  });
  return result;
}

std::vector<RuleAxis> papillary_axes(const TetMesh& mesh, const std::vector<std::int32_t>& nodes,
                                     const Vec3& long_axis) {
  const PointCloud cloud = papillary_cells(mesh);
  std::vector<RuleAxis> result(nodes.size());
  if (nodes.empty()) return result;
  const adapters::PointTree tree(3, cloud, adapters::tree_leaves);
  parallel::parallel_for(0, static_cast<std::int64_t>(nodes.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      result[n] = local_muscle_axis(cloud, tree, mesh.nodes_mm[static_cast<std::size_t>(nodes[n])], long_axis);
  });
  return result;
}

}  // namespace heartgen::fibers
