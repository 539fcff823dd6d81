#include "validation/reference_fibers.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/corners.hpp"
#include "model/labels.hpp"

namespace heart::validation {
namespace {

/// Mean axis of the known voxels around a point, weighted as in trilinear interpolation, their signs turned to that of
/// the nearest voxel; zero where the nearest voxel is not known. Voxels whose axis differs from that one's by more than
/// a wall's fibres turn within a voxel lie in another wall and do not count.
Vec3 reference_at(const ReferenceFibers& reference, const Vec3& lps_mm) {
  constexpr double same_wall_cosine = 0.5;
  const Grid& grid = reference.x.grid;
  const Vec3 index = index_from_lps(grid, lps_mm);
  const auto axis_at = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return grid.contains(i, j, k) ? normalized({reference.x(i, j, k), reference.y(i, j, k), reference.z(i, j, k)})
                                  : Vec3{};
  };
  const Vec3 nearest = axis_at(std::llround(index.x), std::llround(index.y), std::llround(index.z));
  if (norm(nearest) < 0.5) return {};
  Vec3 sum;
  for_corners(index, [&](double weight, std::int64_t i, std::int64_t j, std::int64_t k) {
    const Vec3 axis = axis_at(i, j, k);
    const double cosine = dot(axis, nearest);
    if (std::abs(cosine) >= same_wall_cosine) sum += (cosine < 0 ? -weight : weight) * axis;
  });
  return normalized(sum);
}

Vec3 cell_center(const TetMesh& mesh, const Cell& cell) {
  Vec3 sum;
  for (const auto node : cell) sum += mesh.nodes_mm[static_cast<std::size_t>(node)];
  return sum / 4;
}

double axis_angle_deg(const Vec3& a, const Vec3& b) {
  return std::acos(std::min(1.0, std::abs(dot(a, b)))) * 180 / std::numbers::pi;
}

void add_rows(Report& report, const std::string& scope, std::vector<double> errors_deg, std::size_t cells) {
  const auto row = [&](const char* metric, double value, const char* unit) {
    report.push_back({"fibers", scope, metric, value, unit, {}, {}});
  };
  row("compared_fraction", cells ? static_cast<double>(errors_deg.size()) / static_cast<double>(cells) : 0, "1");
  if (errors_deg.empty()) return;
  double sum = 0;
  for (const double error : errors_deg) sum += error;
  std::sort(errors_deg.begin(), errors_deg.end());
  row("axis_error_mean", sum / static_cast<double>(errors_deg.size()), "deg");
  row("axis_error_p95", errors_deg[(errors_deg.size() - 1) * 95 / 100], "deg");
}

}  // namespace

Report compare_fibers(const TetMesh& mesh, const ReferenceFibers& reference) {
  Report report;
  if (mesh.cell_fibers.fiber.size() != mesh.cells.size()) return report;
  std::vector<double> both_deg;
  std::size_t both_cells = 0;
  for (const Region region : {Region::lv_myocardium, Region::rv_myocardium}) {
    std::vector<double> errors_deg;
    std::size_t cells = 0;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      if (mesh.region[c] != tag(region)) continue;
      ++cells;
      const Vec3 known = reference_at(reference, cell_center(mesh, mesh.cells[c]));
      if (norm(known) > 0.5) errors_deg.push_back(axis_angle_deg(known, normalized(mesh.cell_fibers.fiber[c])));
    }
    both_deg.insert(both_deg.end(), errors_deg.begin(), errors_deg.end());
    both_cells += cells;
    add_rows(report, region_name(tag(region)), std::move(errors_deg), cells);
  }
  add_rows(report, "ventricles", std::move(both_deg), both_cells);
  return report;
}

}  // namespace heart::validation
