// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/contour_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/labels.hpp"
#include "support/synthetic_heart.hpp"
#include "validation/distance_map.hpp"
#include "validation/report/report_tables.hpp"

namespace heartgen::validation {
namespace {

constexpr Vec3 sphere_center{30, 30, 30};

Grid cube_grid(std::int64_t n, double spacing) {
  Grid grid;
  grid.size = {n, n, n};
  grid.spacing_mm = {spacing, spacing, spacing};
  return grid;
}

/// A smooth edge from 300 to 0 HU at `radius_mm`, 2 mm wide.
CtVolume sphere_image(double radius_mm) {
  CtVolume ct(cube_grid(61, 1));
  for (std::int64_t k = 0; k < 61; ++k)
    for (std::int64_t j = 0; j < 61; ++j)
      for (std::int64_t i = 0; i < 61; ++i) {
        const double d = norm(Vec3{double(i), double(j), double(k)} - sphere_center) - radius_mm;
        ct(i, j, k) = static_cast<std::int16_t>(std::lround(150 - 150 * std::tanh(d / 1.5)));
      }
  return ct;
}

/// Voxel tetrahedra of a ball, their boundary nodes moved to the sphere.
TetMesh ball(double radius_mm) {
  LabelVolume labels(cube_grid(21, 3));
  for (std::int64_t k = 0; k < 21; ++k)
    for (std::int64_t j = 0; j < 21; ++j)
      for (std::int64_t i = 0; i < 21; ++i)
        labels(i, j, k) = norm(Vec3{3.0 * i, 3.0 * j, 3.0 * k} - sphere_center) < radius_mm ? tag(Region::lv_blood) : 0;
  TetMesh mesh = heartgen::testing::voxel_mesh(labels, [](Region r) { return r == Region::lv_blood; });
  for (const Face& face : mesh.faces)
    for (const auto n : face) {
      Vec3& p = mesh.nodes_mm[static_cast<std::size_t>(n)];
      p = sphere_center + radius_mm * normalized(p - sphere_center);
    }
  return mesh;
}

double fit(const Report& report, const char* metric) {
  return report::row_value(report, "fit", report.front().scope, metric).value();
}

TEST(ContourFit, FindsAKnownOffset) {
  const CtVolume ct = sphere_image(20);
  const Report outside = check_contour_fit(ball(21), ct);
  // Faces are chords: their centres lie up to 0.2 mm inside the sphere.
  EXPECT_NEAR(fit(outside, "edge_distance_median"), -0.9, 0.15);
  EXPECT_NEAR(fit(outside, "edge_distance_median_voxels"), fit(outside, "edge_distance_median"), 1e-12);
  EXPECT_EQ(fit(outside, "edge_found"), 1);
  EXPECT_LT(fit(outside, "edge_distance_max"), 1.5);
  const Report inside = check_contour_fit(ball(18), ct);
  EXPECT_NEAR(fit(inside, "edge_distance_median"), 2.1, 0.15);
  const auto verdict = [](const Report& report) {
    return std::ranges::find(report, "edge_distance_median", &ReportRow::metric)->verdict();
  };
  EXPECT_EQ(verdict(outside), Verdict::passed);
  EXPECT_EQ(verdict(inside), Verdict::warned);
  EXPECT_EQ(verdict(check_contour_fit(ball(16), ct)), Verdict::failed);
}

TEST(ContourFit, DoesNotDependOnTheOrderOfAFacesNodes) {
  const CtVolume ct = sphere_image(20);
  TetMesh mesh = ball(21);
  const Report before = check_contour_fit(mesh, ct);
  for (std::size_t f = 0; f < mesh.faces.size(); f += 2) std::swap(mesh.faces[f][0], mesh.faces[f][1]);
  EXPECT_EQ(fit(check_contour_fit(mesh, ct), "edge_distance_median"), fit(before, "edge_distance_median"));
}

TEST(ContourFit, SaysWhereThereIsNoEdge) {
  const Report report = check_contour_fit(ball(21), CtVolume(cube_grid(61, 1), 40));
  ASSERT_EQ(report.size(), 1u);
  EXPECT_EQ(report[0].metric, "edge_found");
  EXPECT_EQ(report[0].value, 0);
}

/// A shell between two spheres: blood inside of it, `wall_hu` in it, lung outside.
CtVolume shell_image(double inner_mm, double outer_mm, double blood_hu, double wall_hu) {
  CtVolume ct(cube_grid(61, 1));
  for (std::int64_t k = 0; k < 61; ++k)
    for (std::int64_t j = 0; j < 61; ++j)
      for (std::int64_t i = 0; i < 61; ++i) {
        const double d = norm(Vec3{double(i), double(j), double(k)} - sphere_center);
        const auto step = [&](double radius_mm) { return 0.5 - 0.5 * std::tanh((d - radius_mm) / 0.8); };
        ct(i, j, k) = static_cast<std::int16_t>(
            std::lround(-800 + (wall_hu + 800) * step(outer_mm) + (blood_hu - wall_hu) * step(inner_mm)));
      }
  return ct;
}

/// Boundary of a shell of muscle: its inner sphere is the left endocardium, its outer one the epicardium.
TetMesh shell(double inner_mm, double outer_mm) {
  LabelVolume labels(cube_grid(41, 1.5));
  for (std::int64_t k = 0; k < 41; ++k)
    for (std::int64_t j = 0; j < 41; ++j)
      for (std::int64_t i = 0; i < 41; ++i) {
        const double d = norm(Vec3{1.5 * i, 1.5 * j, 1.5 * k} - sphere_center);
        labels(i, j, k) = d >= inner_mm && d < outer_mm ? tag(Region::lv_myocardium) : std::uint8_t{0};
      }
  TetMesh mesh = heartgen::testing::voxel_mesh(labels, [](Region r) { return r == Region::lv_myocardium; });
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const bool is_inner =
        norm(mesh.nodes_mm[static_cast<std::size_t>(mesh.faces[f][0])] - sphere_center) < (inner_mm + outer_mm) / 2;
    mesh.surface[f] = surface_from_name(is_inner ? "lv_endocardium" : "epicardium").value();
    for (const auto n : mesh.faces[f]) {
      Vec3& p = mesh.nodes_mm[static_cast<std::size_t>(n)];
      p = sphere_center + (is_inner ? inner_mm : outer_mm) * normalized(p - sphere_center);
    }
  }
  return mesh;
}

TEST(ContourFit, TheOtherSideOfAThinWallIsNotItsEdge) {
  const TetMesh mesh = shell(16, 19);
  const auto median = [](const Report& report, const char* scope) {
    return report::row_value(report, "fit", scope, "edge_distance_median");
  };
  const Report bright = check_contour_fit(mesh, shell_image(16, 19, 300, 100));
  EXPECT_NEAR(median(bright, "lv_endocardium").value(), 0, 0.3);
  EXPECT_NEAR(median(bright, "epicardium").value(), 0, 0.3);
  // Blood as grey as muscle: the inner side has no edge, and the step to the lung is not taken for it.
  const Report faint = check_contour_fit(mesh, shell_image(16, 19, 105, 100));
  EXPECT_LT(report::row_value(faint, "fit", "lv_endocardium", "edge_found").value(), 0.05);
  EXPECT_NEAR(median(faint, "epicardium").value(), 0, 0.3);
  // Drawn 2 mm inside of the blood's edge, it is seen.
  EXPECT_GT(std::abs(median(check_contour_fit(shell(14, 19), shell_image(16, 19, 300, 100)), "lv_endocardium").value()),
            1.5);
}

LabelVolume box_labels(const Grid& grid, Index3 low, Index3 high) {
  LabelVolume labels(grid);
  for (auto k = low[2]; k < high[2]; ++k)
    for (auto j = low[1]; j < high[1]; ++j)
      for (auto i = low[0]; i < high[0]; ++i) labels(i, j, k) = tag(Region::lv_blood);
  return labels;
}

double agreement(const Report& report, const char* metric) {
  return report::row_value(report, "fit", "lv_blood", metric).value();
}

TEST(LabelAgreement, ClosedFormsForAShiftedBox) {
  Grid grid;
  grid.size = {30, 12, 12};
  grid.spacing_mm = {2, 1, 1};
  const auto ours = box_labels(grid, {4, 2, 2}, {14, 10, 10}), reference = box_labels(grid, {7, 2, 2}, {17, 10, 10});
  const Report report = compare_labels(ours, reference);
  EXPECT_NEAR(agreement(report, "dice"), 2.0 * 7 / 20, 1e-12);
  EXPECT_NEAR(agreement(report, "surface_distance_max"), 6, 1e-12);  // three voxels of 2 mm
  EXPECT_GT(agreement(report, "surface_distance_mean"), 0.5);
  EXPECT_LE(agreement(report, "surface_distance_p95"), 6);
}

TEST(LabelAgreement, IsPerfectWithItself) {
  const auto labels = heartgen::testing::synthetic_labels(5);
  for (const auto& row : compare_labels(labels, labels))
    EXPECT_EQ(row.value, row.metric == "dice" ? 1 : 0) << row.metric;
}

TEST(LabelAgreement, ResamplesAnotherGrid) {
  const auto coarse = heartgen::testing::synthetic_labels(2.5), fine = heartgen::testing::synthetic_labels(1.5);
  const Report report = compare_labels(coarse, fine);
  EXPECT_GT(agreement(report, "dice"), 0.93);
  EXPECT_LT(agreement(report, "surface_distance_mean"), 1.3);
}

TEST(LabelAgreement, AMissingRegionHasNoDistance) {
  Grid grid = cube_grid(8, 1);
  const Report report = compare_labels(LabelVolume(grid), box_labels(grid, {2, 2, 2}, {5, 5, 5}));
  ASSERT_EQ(report.size(), 1u);
  EXPECT_EQ(report[0].metric, "dice");
  EXPECT_EQ(report[0].value, 0);
}

TEST(DistanceMap, EqualsTheSlowSearch) {
  Grid grid;
  grid.size = {9, 7, 6};
  grid.spacing_mm = {0.7, 1.3, 2.1};
  std::vector<std::uint8_t> feature(static_cast<std::size_t>(grid.voxel_count()), 0);
  for (std::size_t v = 0; v < feature.size(); ++v) feature[v] = v * 2654435761u % 37 == 0;
  const auto distance = distance_to(grid, feature);
  std::vector<Vec3> points;
  std::vector<std::size_t> set;
  for (std::int64_t k = 0; k < 6; ++k)
    for (std::int64_t j = 0; j < 7; ++j)
      for (std::int64_t i = 0; i < 9; ++i) {
        if (feature[points.size()]) set.push_back(points.size());
        points.push_back({0.7 * double(i), 1.3 * double(j), 2.1 * double(k)});
      }
  ASSERT_GT(set.size(), 3u);
  for (std::size_t v = 0; v < points.size(); ++v) {
    double best = 1e300;
    for (const auto f : set) best = std::min(best, norm(points[v] - points[f]));
    EXPECT_NEAR(distance[v], best, 1e-9);
  }
}

}  // namespace
}  // namespace heartgen::validation
