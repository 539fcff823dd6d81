// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/mesh_heart.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "mesh/shapes.hpp"
#include "model/error.hpp"
#include "validation/mesh_checks.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

MeshSettings coarse() {
  MeshSettings s;
  s.heart_edge_mm = 3;
  s.blood_edge_mm = 5;
  s.torso_edge_mm = 8;
  return s;
}

Report check(const TetMesh& mesh) { return validation::check_mesh("mesh", mesh, ValidationSettings{}); }

// Left ventricle and right ventricle as shells around blood, side by side, in a block of torso that the image cuts.
Region small_heart(const Vec3& p) {
  const double left = norm(p - Vec3{9, 0, 0}), right = norm(p - Vec3{-10, 0, 0});
  if (left < 10) return Region::lv_blood;
  if (left < 15) return Region::lv_myocardium;
  if (right < 10) return Region::rv_blood;
  if (right < 13) return Region::rv_myocardium;
  return p.x * p.x + p.y * p.y < 29 * 29 ? Region::torso : Region::none;
}

TEST(MeshLabels, BallHasItsVolumeAndOneClosedSurface) {
  const auto labels = label_cube(24, 1.5, [](const Vec3& p) { return norm(p) < 13 ? Region::lv_blood : Region::none; });
  const auto mesh = mesh::mesh_labels(labels, coarse());
  const double exact = 4.0 / 3 * std::numbers::pi * 13 * 13 * 13;
  EXPECT_NEAR(region_volume_mm3(mesh, Region::lv_blood), exact, 0.05 * exact);
  EXPECT_EQ(surface_counts(mesh).size(), 1U);
  EXPECT_EQ(surface_counts(mesh).begin()->first, "lv_endocardium");
  const auto report = check(mesh);
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  EXPECT_EQ(row_value(report, "mesh", "boundary_euler_characteristic"), 2);
}

TEST(MeshLabels, SurfaceIsSmoothNotVoxelStairs) {
  const auto labels = label_cube(24, 1.5, [](const Vec3& p) { return norm(p) < 13 ? Region::lv_blood : Region::none; });
  auto settings = coarse();
  settings.blood_edge_mm = 3;  // so that chords err less than the voxels
  const auto mesh = mesh::mesh_labels(labels, settings);
  constexpr double half_voxel_mm = 0.75;
  for (const auto& face : mesh.faces)
    for (const auto n : face) EXPECT_NEAR(norm(mesh.nodes_mm[static_cast<std::size_t>(n)]), 13, half_voxel_mm);
}

TEST(MeshLabels, ThinShellKeepsItsTopology) {
  // A wall of 2 mm on voxels of 1.5 mm: in places one voxel thick.
  const auto labels = label_cube(26, 1.5, [](const Vec3& p) {
    return norm(p) < 13 ? Region::rv_blood : norm(p) < 15 ? Region::rv_myocardium : Region::none;
  });
  auto settings = coarse();
  settings.heart_edge_mm = 1.8;
  const auto mesh = mesh::mesh_labels(labels, settings);
  const auto report = check(mesh);
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  EXPECT_EQ(row_value(report, "mesh/rv_myocardium", "components"), 1);
  EXPECT_EQ(row_value(report, "mesh/rv_myocardium", "boundary_euler_characteristic"), 4) << "two spheres: no hole";
  const auto surfaces = surface_counts(mesh);
  EXPECT_EQ(surfaces.size(), 2U);
  EXPECT_GT(surfaces.at("epicardium"), 100);
  EXPECT_GT(surfaces.at("rv_endocardium"), 100);
  const double exact = 4.0 / 3 * std::numbers::pi * (15 * 15 * 15 - 13 * 13 * 13);
  EXPECT_NEAR(region_volume_mm3(mesh, Region::rv_myocardium), exact, 0.06 * exact);
}

TEST(MeshLabels, TouchingBloodPoolsShareAnOrificeWithARim) {
  const auto labels = label_cube(28, 1.5, [](const Vec3& p) {
    if (norm(p) >= 18) return Region::none;
    if (norm(p) >= 14) return p.z < 0 ? Region::lv_myocardium : Region::la_wall;
    return p.z < 0 ? Region::lv_blood : Region::la_blood;
  });
  const auto mesh = mesh::mesh_labels(labels, coarse());
  const auto report = check(mesh);
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  const auto surfaces = surface_counts(mesh);
  for (const auto* name :
       {"mitral_orifice", "lv_endocardium", "la_endocardium", "epicardium", "atrioventricular_junction"})
    EXPECT_GT(surfaces.count(name) ? surfaces.at(name) : 0, 5) << name;
  ASSERT_EQ(mesh.rims.size(), 1U);
  EXPECT_EQ(mesh.rims[0].name, "mitral_orifice_rim");
  EXPECT_EQ(mesh.rims[0].tag, 1000 + *surface_from_name("mitral_orifice"));
  for (const auto n : mesh.rims[0].nodes) {
    const auto& p = mesh.nodes_mm[static_cast<std::size_t>(n)];
    EXPECT_NEAR(std::hypot(p.x, p.y), 14, 2.5);
    EXPECT_NEAR(p.z, 0, 2.5);
  }
}

TEST(MeshLabels, FieldOfViewCutsFlat) {
  const auto labels =
      label_cube(20, 2, [](const Vec3& p) { return std::hypot(p.x, p.y) < 15 ? Region::torso : Region::none; });
  auto settings = coarse();
  settings.torso_edge_mm = 5;
  const auto mesh = mesh::mesh_labels(labels, settings);
  const auto report = check(mesh);
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  const auto surfaces = surface_counts(mesh);
  ASSERT_EQ(surfaces.size(), 2U);
  double cut_area = 0;
  std::set<std::int32_t> cut_nodes;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (surface_name(mesh.surface[f]) != "fov_cut") {
      EXPECT_EQ(surface_name(mesh.surface[f]), "skin");
      continue;
    }
    const auto p = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(mesh.faces[f][i])]; };
    cut_area += norm(cross(p(1) - p(0), p(2) - p(0))) / 2;
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(std::abs(p(i).z), 20, 0.01);
  }
  const double exact = 2 * std::numbers::pi * 15 * 15;
  EXPECT_NEAR(cut_area, exact, 0.05 * exact);
  for (const auto& p : mesh.nodes_mm) EXPECT_LE(std::abs(p.z), 20.01) << "nothing sticks out of the cut";
}

TEST(MeshLabels, TinyIslandIsDroppedOrMeshedButNeverBreaksTheMesh) {
  for (const double radius : {1.0, 2.5, 4.0}) {
    const auto labels = label_cube(24, 1.5, [&](const Vec3& p) {
      if (norm(p - Vec3{2, 1, 0}) < radius) return Region::papillary;
      return norm(p) < 13 ? Region::lv_blood : Region::none;
    });
    const auto mesh = mesh::mesh_labels(labels, coarse());
    const auto report = check(mesh);
    EXPECT_TRUE(all_passed(report)) << radius << "\n" << failed_rows(report);
    if (radius > 3) {
      const double exact = 4.0 / 3 * std::numbers::pi * radius * radius * radius;
      EXPECT_NEAR(region_volume_mm3(mesh, Region::papillary), exact, 0.3 * exact);
    }
  }
}

TEST(MeshLabels, RefusesNothingAndNonsense) {
  const auto empty = label_cube(8, 2, [](const Vec3&) { return Region::none; });
  EXPECT_THROW(mesh::mesh_labels(empty, coarse()), UserError);
  auto unknown = label_cube(8, 2, [](const Vec3&) { return Region::torso; });
  unknown.voxels[5] = 42;
  EXPECT_THROW(mesh::mesh_labels(unknown, coarse()), UserError);
  auto settings = coarse();
  settings.heart_edge_mm = 0;
  EXPECT_THROW(mesh::mesh_labels(label_cube(8, 2, [](const Vec3&) { return Region::torso; }), settings), UserError);
}

TEST(LatticeBackend, MeshesTheSmallHeartWithGoodAngles) {
  const auto labels = label_cube(36, 1.5, small_heart);
  auto settings = coarse();
  settings.backend = "lattice";
  mesh::LatticeReport steps;
  const auto mesh = mesh::mesh_labels(labels, settings, &steps);
  const auto report = check(mesh);
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  EXPECT_GE(row_value(report, "mesh", "dihedral_min"), 30);
  EXPECT_LE(row_value(report, "mesh", "dihedral_max"), 143);
  EXPECT_GE(steps.seconds.size(), 3U);
  for (const auto region : {Region::lv_myocardium, Region::rv_myocardium, Region::lv_blood, Region::rv_blood}) {
    const double wanted = region_volume_mm3(labels, region);
    EXPECT_NEAR(region_volume_mm3(mesh, region), wanted, 0.06 * wanted) << region_name(tag(region));
  }
}

TEST(LatticeBackend, IsTheDefault) { EXPECT_EQ(MeshSettings{}.backend, "lattice"); }

TEST(DelaunayBackend, MeshesTheSmallHeartToo) {
  const auto labels = label_cube(36, 1.5, small_heart);
  auto settings = coarse();
  settings.backend = "cgal";
  const auto mesh = mesh::mesh_labels(labels, settings);
  const auto report = check(mesh);
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  for (const auto region : {Region::lv_myocardium, Region::rv_myocardium, Region::lv_blood, Region::rv_blood}) {
    const double wanted = region_volume_mm3(labels, region);
    EXPECT_NEAR(region_volume_mm3(mesh, region), wanted, 0.06 * wanted) << region_name(tag(region));
  }
}

class SmallHeart : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    labels = new LabelVolume(label_cube(36, 1.5, small_heart));
    meshes = new std::map<std::string, TetMesh>(mesh::mesh_heart(*labels, coarse()));
  }
  static void TearDownTestSuite() {
    delete labels;
    delete meshes;
  }
  static inline LabelVolume* labels = nullptr;
  static inline std::map<std::string, TetMesh>* meshes = nullptr;
};

TEST_F(SmallHeart, MeshesAreValidAndHaveTheVolumesOfTheLabels) {
  ASSERT_EQ(meshes->size(), 3U);
  for (const auto& [name, mesh] : *meshes) {
    const auto report = validation::check_mesh(name, mesh, ValidationSettings{});
    EXPECT_TRUE(all_passed(report)) << name << "\n" << failed_rows(report);
  }
  for (const auto region : {Region::lv_myocardium, Region::rv_myocardium, Region::lv_blood, Region::rv_blood}) {
    const double wanted = region_volume_mm3(*labels, region);
    EXPECT_NEAR(region_volume_mm3(meshes->at("torso"), region), wanted, 0.06 * wanted) << region_name(tag(region));
  }
}

TEST_F(SmallHeart, PartsAreIdenticalToTheirPlaceInTheTorso) {
  const auto& torso = meshes->at("torso");
  for (const auto* name : {"myocardium", "chambers"}) {
    const auto& part = meshes->at(name);
    ASSERT_EQ(part.parent_node.size(), part.nodes_mm.size());
    ASSERT_EQ(part.parent_cell.size(), part.cells.size());
    for (std::size_t n = 0; n < part.nodes_mm.size(); ++n)
      ASSERT_EQ(part.nodes_mm[n], torso.nodes_mm[static_cast<std::size_t>(part.parent_node[n])]);
    for (std::size_t c = 0; c < part.cells.size(); ++c) {
      const auto parent = static_cast<std::size_t>(part.parent_cell[c]);
      ASSERT_EQ(part.region[c], torso.region[parent]);
      for (std::size_t i = 0; i < 4; ++i)
        ASSERT_EQ(part.parent_node[static_cast<std::size_t>(part.cells[c][i])], torso.cells[parent][i]);
    }
  }
  EXPECT_EQ(torso.parent_node.size(), 0U);
}

TEST_F(SmallHeart, SurfacesKeepTheNamesOfTheWholeMesh) {
  const auto surfaces = surface_counts(meshes->at("myocardium"));
  EXPECT_EQ(surfaces.size(), 4U);
  for (const auto* name : {"epicardium", "lv_endocardium", "rv_endocardium", "septum_junction"})
    EXPECT_GT(surfaces.count(name) ? surfaces.at(name) : 0, 5) << name;
  const auto whole = surface_counts(meshes->at("torso"));
  EXPECT_EQ(whole.at("lv_endocardium"), surfaces.at("lv_endocardium"));
  EXPECT_GT(whole.at("skin"), 5);
  EXPECT_GT(whole.at("fov_cut"), 5);
}

TEST_F(SmallHeart, FacesPointOutOfTheMeshOrFromTheSmallerTag) {
  for (const auto& [name, mesh] : *meshes) {
    double enclosed = 0, volume = 0;  // divergence theorem over the outer faces
    for (const auto& cell : mesh.cells) volume += cell_volume_mm3(mesh, cell);
    std::map<std::set<std::int32_t>, int> count;
    for (const auto& c : mesh.cells)
      for (std::size_t i = 0; i < 4; ++i) ++count[{c[(i + 1) % 4], c[(i + 2) % 4], c[(i + 3) % 4]}];
    for (const auto& f : mesh.faces) {
      if (count.at({f[0], f[1], f[2]}) != 1) continue;
      const auto p = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(f[i])]; };
      enclosed += dot(p(0), cross(p(1), p(2))) / 6;
    }
    EXPECT_NEAR(enclosed, volume, 1e-6 * volume) << name;
  }
}

TEST_F(SmallHeart, SameInputSameBits) {
  const auto again = mesh::mesh_heart(*labels, coarse());
  for (const auto& [name, mesh] : *meshes) {
    EXPECT_EQ(again.at(name).nodes_mm, mesh.nodes_mm);
    EXPECT_EQ(again.at(name).cells, mesh.cells);
    EXPECT_EQ(again.at(name).region, mesh.region);
    EXPECT_EQ(again.at(name).faces, mesh.faces);
    EXPECT_EQ(again.at(name).surface, mesh.surface);
  }
}

TEST_F(SmallHeart, WithoutTorsoOnlyTheHeartIsMeshed) {
  auto settings = coarse();
  settings.meshes = {"myocardium"};
  const auto alone = mesh::mesh_heart(*labels, settings);
  ASSERT_EQ(alone.size(), 1U);
  const auto& mesh = alone.at("myocardium");
  EXPECT_TRUE(mesh.parent_node.empty());
  EXPECT_EQ(surface_counts(mesh).count("lv_endocardium"), 1U) << "blood still decides the name of the surface";
  const double wanted = region_volume_mm3(*labels, Region::lv_myocardium);
  EXPECT_NEAR(region_volume_mm3(mesh, Region::lv_myocardium), wanted, 0.06 * wanted);
}

TEST(MeshHeart, NamesTheRegionThatIsEmpty) {
  const auto labels = label_cube(12, 2, [](const Vec3& p) {
    return norm(p) < 6 ? Region::lv_blood : norm(p) < 10 ? Region::lv_myocardium : Region::none;
  });
  try {
    mesh::mesh_heart(labels, coarse());
    FAIL() << "a heart without rv_myocardium was accepted";
  } catch (const UserError& error) {
    EXPECT_NE(error.message.find("rv_myocardium"), std::string::npos) << error.message;
  }
}

TEST(MeshHeart, TurnedGridGivesTheSameHeart) {
  // The same heart on a grid whose i axis runs to the right and whose j axis runs to the front.
  const auto labels = label_cube(36, 1.5, small_heart);
  LabelVolume turned = labels;
  turned.grid.direction = {{Vec3{-1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}}};
  turned.grid.origin_mm = lps_from_index(labels.grid, {35, 35, 0});
  for (std::int64_t k = 0; k < 36; ++k)
    for (std::int64_t j = 0; j < 36; ++j)
      for (std::int64_t i = 0; i < 36; ++i) turned(i, j, k) = labels(35 - i, 35 - j, k);
  auto settings = coarse();
  settings.meshes = {"myocardium"};
  const auto a = mesh::mesh_heart(labels, settings).at("myocardium");
  const auto b = mesh::mesh_heart(turned, settings).at("myocardium");
  Vec3 center_a, center_b;
  for (const auto& p : a.nodes_mm) center_a += p / static_cast<double>(a.nodes_mm.size());
  for (const auto& p : b.nodes_mm) center_b += p / static_cast<double>(b.nodes_mm.size());
  EXPECT_LT(norm(center_a - center_b), 0.5);
  EXPECT_NEAR(region_volume_mm3(a, Region::lv_myocardium), region_volume_mm3(b, Region::lv_myocardium),
              0.01 * region_volume_mm3(a, Region::lv_myocardium));
}

}  // namespace
