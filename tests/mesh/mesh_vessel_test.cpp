// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/mesh_vessel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "mesh/shapes.hpp"
#include "model/error.hpp"
#include "validation/mesh_checks.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
  return norm(p - a - t * (b - a));
}

constexpr Vec3 fork{0, 0, 0};
constexpr std::array<Vec3, 3> tips{Vec3{-10, -2, 20}, Vec3{11, 3, 18}, Vec3{0, 0, -22}};  // cranial to caudal

Mask y_tube() {
  return label_cube(60, 0.8, [](const Vec3& p) {
    const bool inside = distance_to_segment(p, fork, tips[0]) < 3 || distance_to_segment(p, fork, tips[1]) < 2.5 ||
                        distance_to_segment(p, fork, tips[2]) < 4;
    return inside ? Region::carotid : Region::none;
  });
}

Mask as_mask(LabelVolume labels) {
  for (auto& voxel : labels.voxels) voxel = voxel != 0;
  return labels;
}

double angle_deg(const Vec3& a, const Vec3& b) {
  return std::acos(std::clamp(dot(normalized(a), normalized(b)), -1.0, 1.0)) * 180 / std::numbers::pi;
}

TEST(VesselEnds, ForkedTubeHasThreeEndsAcrossItsAxes) {
  const auto ends = mesh::find_vessel_ends(as_mask(y_tube()));
  ASSERT_EQ(ends.size(), 3U);
  for (std::size_t e = 0; e < 3; ++e) {
    EXPECT_LT(norm(ends[e].center_mm - tips[e]), 4) << e;
    EXPECT_LT(angle_deg(ends[e].normal, tips[e] - fork), 8) << e;
  }
}

TEST(VesselEnds, BumpIsNoEnd) {
  const auto mask = as_mask(label_cube(50, 1, [](const Vec3& p) {
    const bool inside = distance_to_segment(p, {0, 0, -18}, {0, 0, 18}) < 5 || norm(p - Vec3{5, 0, 0}) < 3;
    return inside ? Region::trachea : Region::none;
  }));
  EXPECT_EQ(mesh::find_vessel_ends(mask).size(), 2U);
}

class MeshVesselBy : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Backends, MeshVesselBy, ::testing::Values("lattice", "cgal"),
                         [](const auto& backend) { return std::string(backend.param); });

TEST_P(MeshVesselBy, ForkedTubeIsCutByPlanes) {
  MeshSettings settings;
  settings.backend = GetParam();
  settings.carotid_edge_mm = 1.6;
  const auto mesh = mesh::mesh_vessel(as_mask(y_tube()), Region::carotid, settings);
  const auto report = validation::check_mesh("carotid", mesh, ValidationSettings{});
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  EXPECT_EQ(row_value(report, "carotid", "boundary_euler_characteristic"), 2);
  EXPECT_EQ(surface_counts(mesh).size(), 4U);
  EXPECT_EQ(mesh.rims.size(), 3U);
  for (int number = 1; number <= 3; ++number) {
    const auto surface = end_surface_tag(Region::carotid, number);
    Vec3 area, center;
    double count = 0, flat_area = 0;
    std::vector<Vec3> points;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      if (mesh.surface[f] != surface) continue;
      const auto p = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(mesh.faces[f][i])]; };
      const Vec3 face = 0.5 * cross(p(1) - p(0), p(2) - p(0));
      area += face;
      flat_area += norm(face);
      for (std::size_t i = 0; i < 3; ++i) points.push_back(p(i));
    }
    ASSERT_GT(points.size(), 10U);
    for (const auto& p : points) center += p, ++count;
    center = center / count;
    const Vec3 normal = normalized(area);
    for (const auto& p : points) EXPECT_NEAR(dot(p - center, normal), 0, 0.02) << "end " << number << " is flat";
    EXPECT_LT(angle_deg(normal, tips[static_cast<std::size_t>(number - 1)] - fork), 8);
    EXPECT_NEAR(norm(area), flat_area, 1e-3 * flat_area);
    const double radius = number == 1 ? 3 : number == 2 ? 2.5 : 4;
    EXPECT_NEAR(flat_area, std::numbers::pi * radius * radius, 0.15 * std::numbers::pi * radius * radius);
  }
}

TEST(MeshVessel, TheLatticeKeepsItsAngles) {
  for (const double edge_mm : {1.1, 1.7}) {
    MeshSettings settings;
    settings.carotid_edge_mm = edge_mm;
    const auto mesh = mesh::mesh_vessel(as_mask(y_tube()), Region::carotid, settings);
    const auto report = validation::check_mesh("carotid", mesh, ValidationSettings{});
    EXPECT_GE(row_value(report, "carotid", "dihedral_min"), 25) << edge_mm;
    EXPECT_LE(row_value(report, "carotid", "dihedral_max"), 145) << edge_mm;
  }
}

/// The boundary layer: edges at the wall are about half as long as those at the axis.
TEST(MeshVessel, TheCarotidIsFinerAtItsWall) {
  MeshSettings settings;
  settings.carotid_edge_mm = 1.6;
  const auto mesh = mesh::mesh_vessel(as_mask(label_cube(40, 0.8,
                                                         [](const Vec3& p) {
                                                           const bool inside = std::hypot(p.x, p.y) < 6;
                                                           return inside ? Region::carotid : Region::none;
                                                         })),
                                      Region::carotid, settings);
  double wall = 0, axis = 0, at_wall = 0, at_axis = 0;
  for (const auto& cell : mesh.cells)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3 a = mesh.nodes_mm[static_cast<std::size_t>(cell[i])];
        const Vec3 b = mesh.nodes_mm[static_cast<std::size_t>(cell[j])];
        const double inner = std::min(std::hypot(a.x, a.y), std::hypot(b.x, b.y));
        const double outer = std::max(std::hypot(a.x, a.y), std::hypot(b.x, b.y));
        if (inner > 5) wall += norm(a - b), ++at_wall;
        if (outer < 3) axis += norm(a - b), ++at_axis;
      }
  ASSERT_GT(at_wall, 100);
  ASSERT_GT(at_axis, 100);
  EXPECT_NEAR((wall / at_wall) / (axis / at_axis), 0.5, 0.15);
}

TEST(MeshVessel, TracheaThatLeavesTheImageIsCutInside) {
  const auto mask = as_mask(
      label_cube(30, 1.5, [](const Vec3& p) { return std::hypot(p.x, p.y) < 8 ? Region::trachea : Region::none; }));
  MeshSettings settings;
  settings.trachea_edge_mm = 2.5;
  const auto mesh = mesh::mesh_vessel(mask, Region::trachea, settings);
  const auto report = validation::check_mesh("trachea", mesh, ValidationSettings{});
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  const auto surfaces = surface_counts(mesh);
  for (const auto* name : {"trachea_wall", "trachea_end_1", "trachea_end_2"})
    EXPECT_EQ(surfaces.count(name), 1U) << name;
  EXPECT_EQ(surfaces.size(), 3U);
}

TEST(MeshVessel, BranchesThinnerThanItsCellsAreLeftOut) {
  const Mask tree = as_mask(label_cube(60, 0.8, [](const Vec3& p) {
    const bool inside = distance_to_segment(p, {0, 0, -22}, {0, 0, 22}) < 6 ||
                        distance_to_segment(p, {0, 0, -8}, {17, 0, -16}) < 1.4 ||
                        distance_to_segment(p, {0, 0, 4}, {16, 3, -7}) < 1.4 ||  // a wedge of outside between the two
                        distance_to_segment(p, {0, 0, 0}, {-23, 0, 12}) < 4;
    return inside ? Region::trachea : Region::none;
  }));
  MeshSettings settings;
  settings.trachea_edge_mm = 1.6;
  const auto mesh = mesh::mesh_vessel(tree, Region::trachea, settings);
  EXPECT_EQ(mesh.rims.size(), 3U);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.surface[f] == surface_from_name("trachea_wall")) continue;
    Vec3 middle;
    for (const auto n : mesh.faces[f]) middle += (1.0 / 3) * mesh.nodes_mm[static_cast<std::size_t>(n)];
    // Every face of an end lies at an end.
    EXPECT_TRUE(std::abs(middle.z) > 14 || middle.x < -10) << middle.x << ' ' << middle.y << ' ' << middle.z;
  }
  settings.trachea_edge_mm = 0.6;
  EXPECT_GT(mesh::mesh_vessel(tree, Region::trachea, settings).rims.size(), 3U);
}

TEST(MeshVessel, RefusesWhatIsNoTube) {
  Mask empty(label_cube(10, 1, [](const Vec3&) { return Region::none; }).grid);
  EXPECT_THROW(mesh::mesh_vessel(empty, Region::trachea, MeshSettings{}), UserError);
  MeshSettings settings;
  settings.trachea_edge_mm = -1;
  EXPECT_THROW(mesh::mesh_vessel(as_mask(y_tube()), Region::trachea, settings), UserError);
}

}  // namespace
