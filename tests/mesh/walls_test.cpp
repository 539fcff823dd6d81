// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/walls.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "mesh/shapes.hpp"
#include "model/error.hpp"
#include "validation/label_fidelity.hpp"
#include "validation/mesh_checks.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

constexpr double middle_mm = 15, half_wall_mm = 0.75, voxel_mm = 1.2;
constexpr double thinnest_mm = 1;

// A wall that is 1.5 mm thin, with blood in it, of voxels of 1.2 mm.
LabelVolume thin_ball() {
  return label_cube(40, voxel_mm, [](const Vec3& p) {
    const double radius = norm(p - Vec3{0.2, 0.1, -0.3});
    return radius < middle_mm - half_wall_mm   ? Region::lv_blood
           : radius < middle_mm + half_wall_mm ? Region::lv_myocardium
                                               : Region::none;
  });
}

LevelSet thin_wall() {
  return mesh::wall_level_set(mesh::make_domain(thin_ball(), 0.8), 0.5,
                              {.wall_mm = thinnest_mm, .gap_mm = thinnest_mm});
}

TEST(WallLevelSet, ThinWallKeepsBothItsSurfaces) {
  const auto solid = thin_wall();
  const Vec3 center = index_from_lps(solid.grid, {0.2, 0.1, -0.3});
  double volume = 0;
  for (const float value : solid.voxels) volume += value < 0 ? solid.grid.voxel_volume_mm3() : 0;
  const double area = 4 * std::numbers::pi * middle_mm * middle_mm;
  EXPECT_NEAR(volume, 2 * half_wall_mm * area, 0.08 * 2 * half_wall_mm * area);
  int holes = 0;
  for (int i = 0; i < 400; ++i) {  // along a spiral over the sphere
    const double z = -1 + (i + 0.5) / 200, turn = 2.4 * i, r = std::sqrt(1 - z * z);
    const Vec3 way{r * std::cos(turn), r * std::sin(turn), z};
    const auto& s = solid.grid.spacing_mm;
    const auto at = [&](double radius) {
      return sample_linear(solid, center + Vec3{radius * way.x / s.x, radius * way.y / s.y, radius * way.z / s.z});
    };
    holes += at(middle_mm) >= 0;
    EXPECT_GT(at(middle_mm - 2), 0);
    EXPECT_GT(at(middle_mm + 2), 0);
  }
  EXPECT_EQ(holes, 0);
}

// A block with a slot, as between a papillary muscle and its wall, and a fin as thick as the slot is wide.
TEST(WallLevelSet, ClosesNarrowGapsAndKeepsWallsAsThin) {
  constexpr double half_mm = 1.6;
  const auto labels = label_cube(44, 1, [](const Vec3& p) {
    const bool is_block = std::abs(p.x) < 12 && std::abs(p.y) < 12 && p.z < 4 && p.z > -12;
    const bool is_slot = std::abs(p.x) < half_mm && p.z > -6;
    const bool is_fin = std::abs(p.x - 8) < half_mm && std::abs(p.y) < 12 && p.z > 0 && p.z < 12;
    return (is_block && !is_slot) || is_fin ? Region::lv_myocardium : Region::none;
  });
  const auto domain = mesh::make_domain(labels, 0.8);
  const Vec3 in_slot{0, 0, -2}, in_fin{8, 0, 8};
  for (const double gap_mm : {1.0, 6.0}) {
    const auto solid = mesh::wall_level_set(domain, 0.5, {.wall_mm = 1, .gap_mm = gap_mm});
    const auto at = [&](const Vec3& p) { return sample_linear(solid, index_from_lps(solid.grid, p)); };
    EXPECT_EQ(at(in_slot) < 0, gap_mm > 2 * half_mm) << gap_mm;
    EXPECT_LT(at(in_fin), 0) << gap_mm;
  }
}

// What rolling balls leave is no part of a heart: a strand beside it, a bubble in it. But what is alone is the heart.
TEST(WallLevelSet, IslandsAndBubblesGoButNotTheOnlyPart) {
  const Vec3 strand{0, 0, 14}, bubble{0, 0, -4}, block{8, 8, -4};
  const auto solid_of = [&](bool has_block) {
    const auto labels = label_cube(44, 1, [&](const Vec3& p) {
      const bool is_block = has_block && std::abs(p.x) < 12 && std::abs(p.y) < 12 && p.z < 4 && p.z > -12;
      const bool is_wall = (is_block && norm(p - bubble) > 2.5) || norm(p - strand) < 2.5;
      return is_wall ? Region::lv_myocardium : Region::none;
    });
    return mesh::wall_level_set(mesh::make_domain(labels, 0.8), 0.5, {.wall_mm = 1, .gap_mm = 1});
  };
  const auto at = [](const LevelSet& solid, const Vec3& p) {
    return sample_linear(solid, index_from_lps(solid.grid, p));
  };
  const auto solid = solid_of(true);
  EXPECT_GT(at(solid, strand), 0);
  EXPECT_LT(at(solid, bubble), 0);
  EXPECT_LT(at(solid, block), 0);
  EXPECT_LT(at(solid_of(false), strand), 0);
}

// Two shells side by side, the left one with an atrium on its blood.
Region small_heart(const Vec3& p) {
  const double left = norm(p - Vec3{9, 0, 0}), right = norm(p - Vec3{-10, 0, 0}), atrium = norm(p - Vec3{9, 0, 17});
  if (left < 10) return p.z < 7 ? Region::lv_blood : Region::la_blood;
  if (atrium < 9) return Region::la_blood;
  if (left < 15 && p.z < 9) return Region::lv_myocardium;
  if (right < 10) return Region::rv_blood;
  if (right < 13) return Region::rv_myocardium;
  return atrium < 11.5 ? Region::la_wall : Region::none;
}

class SmallWalls : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    labels = new LabelVolume(label_cube(70, 1, small_heart));
    settings.heart_edge_mm = 1.2;
    walls = new mesh::WallLevelSets(mesh::wall_level_sets(*labels, settings));
    whole = new TetMesh(mesh::mesh_walls(*walls, settings));
  }
  static void TearDownTestSuite() {
    delete labels;
    delete walls;
    delete whole;
  }
  static inline MeshSettings settings;
  static inline LabelVolume* labels = nullptr;
  static inline mesh::WallLevelSets* walls = nullptr;
  static inline TetMesh* whole = nullptr;
};

constexpr std::array regions{Region::lv_myocardium, Region::rv_myocardium, Region::la_wall};

TEST_F(SmallWalls, AreOneSolidWithGoodAngles) {
  const auto report = validation::check_mesh("mesh", *whole, ValidationSettings{});
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  EXPECT_GE(row_value(report, "mesh", "dihedral_min"), 30);
  EXPECT_LE(row_value(report, "mesh", "dihedral_max"), 143.05);
}

TEST_F(SmallWalls, HaveTheVolumesOfTheLabels) {
  for (const auto region : regions) {
    const double wanted = region_volume_mm3(*labels, region);
    EXPECT_NEAR(region_volume_mm3(*whole, region), wanted, 0.04 * wanted) << region_name(tag(region));
  }
}

TEST_F(SmallWalls, FollowTheirLevelSets) {
  const auto of_walls = mesh::labels_of(*walls);
  const auto faces = validation::mesh_faces(*whole);
  const auto against_labels = validation::check_against_labels("mesh", *whole, faces, of_walls, {});
  EXPECT_TRUE(all_passed(against_labels)) << failed_rows(against_labels);
  const auto rows = validation::check_against_level_sets("mesh", *whole, faces, of_walls.grid,
                                                         [&](const Vec3& p) { return mesh::wall_at(*walls, p); }, {});
  EXPECT_LE(row_value(rows, "mesh", "to_level_set_p99_in_edges"), 0.1);
  EXPECT_LE(row_value(rows, "mesh", "to_level_set_max_in_edges"), 0.3);
}

TEST_F(SmallWalls, NameTheirFacesAfterWhatLiesBeyond) {
  const auto surfaces = surface_counts(*whole);
  for (const auto* name : {"epicardium", "lv_endocardium", "rv_endocardium", "la_endocardium", "septum_junction",
                           "atrioventricular_junction"})
    EXPECT_GT(surfaces.count(name) ? surfaces.at(name) : 0, 20) << name;
  EXPECT_EQ(surfaces.size(), 6U);
  for (std::size_t f = 0; f < whole->faces.size(); ++f) {
    if (surface_name(whole->surface[f]) != "rv_endocardium") continue;
    for (const auto n : whole->faces[f])
      EXPECT_LT(norm(whole->nodes_mm[static_cast<std::size_t>(n)] - Vec3{-10, 0, 0}), 11.5);
  }
}

TEST_F(SmallWalls, HaveTheRimOfTheMitralOrifice) {
  ASSERT_EQ(whole->rims.size(), 1U);
  const auto& rim = whole->rims.front();
  EXPECT_EQ(rim.name, "mitral_orifice_rim");
  EXPECT_GT(rim.nodes.size(), 15U);
  const double radius_mm = std::sqrt(10.0 * 10 - 7 * 7);
  for (const auto n : rim.nodes) {
    const Vec3 p = whole->nodes_mm[static_cast<std::size_t>(n)] - Vec3{9, 0, 7};
    EXPECT_NEAR(p.z, 0, 1.5);
    EXPECT_NEAR(std::hypot(p.x, p.y), radius_mm, 1.5);
  }
}

TEST_F(SmallWalls, SameInputSameBits) {
  const auto again = mesh::mesh_walls(mesh::wall_level_sets(*labels, settings), settings);
  EXPECT_EQ(again.nodes_mm, whole->nodes_mm);
  EXPECT_EQ(again.cells, whole->cells);
  EXPECT_EQ(again.region, whole->region);
  EXPECT_EQ(again.surface, whole->surface);
}

TEST(Walls, RefusesAMapWithoutWalls) {
  const auto labels = label_cube(10, 1, [](const Vec3&) { return Region::lv_blood; });
  EXPECT_THROW(mesh::wall_level_sets(labels, MeshSettings{}), UserError);
}

}  // namespace
