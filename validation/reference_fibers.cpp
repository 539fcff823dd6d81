// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/reference_fibers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "model/labels.hpp"
#include "model/mathematics.hpp"
#include "model/mesh_queries/voxels_in_cell.hpp"

namespace heartgen::validation {
namespace {

/// Axis of the mesh in one of its cells: its nodes' axes weighted, their signs turned to that of the greatest weight's.
Vec3 mesh_axis(const TetMesh& mesh, const Cell& cell, const std::array<double, 4>& weights) {
  const auto fiber = [&](std::size_t n) { return mesh.node_fibers.fiber[static_cast<std::size_t>(cell[n])]; };
  const auto main = static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
  Vec3 sum;
  for (std::size_t n = 0; n < 4; ++n) sum += (dot(fiber(n), fiber(main)) < 0 ? -weights[n] : weights[n]) * fiber(n);
  return normalized(sum);
}

double axis_angle_deg(const Vec3& a, const Vec3& b) {
  return math::acos(std::min(1.0, std::abs(dot(a, b)))) * 180 / std::numbers::pi;
}

/// Of the voxel centres within a part of the mesh.
struct Errors {
  std::vector<double> known_deg;  ///< where the field is known
  std::size_t voxels = 0;         ///< all
};

void add_rows(Report& report, const std::string& scope, Errors errors) {
  const auto row = [&](const char* metric, double value, const char* unit) {
    report.push_back({"fibers", scope, metric, value, unit, {}, {}});
  };
  auto& deg = errors.known_deg;
  row("compared_fraction", errors.voxels ? static_cast<double>(deg.size()) / static_cast<double>(errors.voxels) : 0,
      "1");
  if (deg.empty()) return;
  double sum = 0;
  for (const double error : deg) sum += error;
  std::sort(deg.begin(), deg.end());
  row("axis_error_mean", sum / static_cast<double>(deg.size()), "deg");
  row("axis_error_p95", deg[(deg.size() - 1) * 95 / 100], "deg");
}

}  // namespace

Report compare_fibers(const TetMesh& mesh, const ReferenceFibers& reference) {
  Report report;
  if (mesh.node_fibers.fiber.size() != mesh.nodes_mm.size()) return report;
  const Grid& grid = reference.x.grid;
  std::vector<std::uint8_t> seen(reference.x.voxels.size());  // centres on a face belong to the first of its cells
  Errors lv, rv;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto region = static_cast<Region>(mesh.region[c]);
    if (region != Region::lv_myocardium && region != Region::rv_myocardium) continue;
    Errors& errors = region == Region::lv_myocardium ? lv : rv;
    const Cell& cell = mesh.cells[c];
    std::array<Vec3, 4> corners_mm;
    for (std::size_t n = 0; n < 4; ++n) corners_mm[n] = mesh.nodes_mm[static_cast<std::size_t>(cell[n])];
    mesh_queries::for_voxels_in_cell(grid, corners_mm, [&](std::int64_t voxel, const std::array<double, 4>& weights) {
      const auto v = static_cast<std::size_t>(voxel);
      if (seen[v]) return;
      seen[v] = 1;
      ++errors.voxels;
      const Vec3 known = normalized({reference.x.voxels[v], reference.y.voxels[v], reference.z.voxels[v]});
      if (norm(known) > 0.5) errors.known_deg.push_back(axis_angle_deg(known, mesh_axis(mesh, cell, weights)));
    });
  }
  Errors both = lv;
  both.voxels += rv.voxels;
  both.known_deg.insert(both.known_deg.end(), rv.known_deg.begin(), rv.known_deg.end());
  add_rows(report, "lv_myocardium", std::move(lv));
  add_rows(report, "rv_myocardium", std::move(rv));
  add_rows(report, "ventricles", std::move(both));
  return report;
}

}  // namespace heartgen::validation
