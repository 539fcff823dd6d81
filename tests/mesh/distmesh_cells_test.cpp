// SPDX-License-Identifier: GPL-3.0-or-later
// The DistMesh back end for label maps, through the same door as the others.
#include <gtest/gtest.h>

#include "generator/mesh/mesh_heart.hpp"
#include "mesh/shapes.hpp"
#include "model/error.hpp"
#include "validation/mesh_checks.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

MeshSettings distmesh_settings() {
  MeshSettings settings;
  settings.backend = "distmesh";
  settings.heart_edge_mm = 3;
  settings.blood_edge_mm = 4;
  settings.torso_edge_mm = 6;
  return settings;
}

/// Two cavities side by side, each in a wall of its own, a lung that touches nothing, all in a body cut by the image.
Region two_chambers(const Vec3& p) {
  const double left = norm(p - Vec3{-6, 0, 0}), right = norm(p - Vec3{10, 0, 0});
  if (left < 8) return Region::lv_blood;
  if (right < 6) return Region::rv_blood;
  if (left < 13) return Region::lv_myocardium;
  if (right < 9) return Region::rv_myocardium;
  if (norm(p - Vec3{-10, -20, 10}) < 5) return Region::lung;
  return Region::torso;
}

TEST(DistMeshBackend, MeshesChambersWallsAndBody) {
  const auto labels = label_cube(32, 1.8, two_chambers);
  mesh::LatticeReport steps;
  const auto mesh = mesh::mesh_labels(labels, distmesh_settings(), &steps);
  const auto report = validation::check_mesh("mesh", mesh, {});
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  EXPECT_GE(row_value(report, "mesh", "dihedral_min"), 20);
  EXPECT_LE(row_value(report, "mesh", "dihedral_max"), 150);
  EXPECT_GE(steps.seconds.size(), 4U);
  for (const auto region :
       {Region::lv_blood, Region::rv_blood, Region::lv_myocardium, Region::rv_myocardium, Region::torso}) {
    const double wanted = region_volume_mm3(labels, region);
    EXPECT_NEAR(region_volume_mm3(mesh, region), wanted, 0.06 * wanted) << region_name(tag(region));
  }
  const double box = std::pow(32 * 1.8, 3);
  double volume = 0;
  for (const auto& cell : mesh.cells) volume += cell_volume_mm3(mesh, cell);
  EXPECT_NEAR(volume, box, 1e-6 * box);
  auto surfaces = surface_counts(mesh);
  for (const auto* name : {"lv_endocardium", "rv_endocardium", "epicardium", "fov_cut"})
    EXPECT_GT(surfaces[name], 20) << name;
}

TEST(DistMeshBackend, TheSameInputGivesTheSameBits) {
  const auto labels = label_cube(20, 2, [](const Vec3& p) { return norm(p) < 12 ? Region::lv_blood : Region::none; });
  const auto one = mesh::mesh_labels(labels, distmesh_settings()),
             other = mesh::mesh_labels(labels, distmesh_settings());
  EXPECT_EQ(one.nodes_mm, other.nodes_mm);
  EXPECT_EQ(one.cells, other.cells);
}

TEST(DistMeshBackend, AMapWithoutRegionsIsRefused) {
  const auto labels = label_cube(8, 2, [](const Vec3&) { return Region::none; });
  EXPECT_THROW(mesh::mesh_labels(labels, distmesh_settings()), UserError);
}

}  // namespace
