// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/wall_layers.hpp"

#include <gtest/gtest.h>

#include "support/diced_cubes.hpp"
#include "support/two_region_mesh.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

/// Diced cubes: lv_blood below, a wall of `layers` cubes from z = 1 on, `beyond` above it; only the faces between them
/// are listed. An edge of a diced cube goes one cube up at most.
TetMesh slab(int layers, Region wall, Region beyond) {
  constexpr int n = 6;
  TetMesh mesh;
  mesh.nodes_mm = cube_corners(n);
  dice_cubes(n, [&](const Cell& cell, int, int, int k) {
    mesh.cells.push_back(cell);
    mesh.region.push_back(tag(k < 1 ? Region::lv_blood : k <= layers ? wall : beyond));
  });
  label_faces(mesh);
  std::vector<Face> faces;
  std::vector<std::int32_t> surfaces;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto z = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(mesh.faces[f][i])].z; };
    if (z(0) != z(1) || z(0) != z(2)) continue;  // a side of the cube
    faces.push_back(mesh.faces[f]);
    surfaces.push_back(mesh.surface[f]);
  }
  mesh.faces = std::move(faces);
  mesh.surface = std::move(surfaces);
  return mesh;
}

TEST(WallLayersOfMesh, AreCountedThroughASlab) {
  for (const int layers : {1, 2, 3, 4})
    for (const Region beyond : {Region::torso, Region::rv_blood}) {
      const auto found = validation::wall_layers(slab(layers, Region::lv_myocardium, beyond));
      const auto& wall = found.at(tag(Region::lv_myocardium));
      EXPECT_EQ(wall.median, layers);
      EXPECT_EQ(wall.below_two, layers < 2 ? 1 : 0);
      EXPECT_EQ(wall.p5, layers);
      EXPECT_NEAR(wall.area_mm2, 36, 1e-9);
    }
}

TEST(WallLayersOfMesh, BloodOfTheSameSideIsNoOtherSide) {
  // Left ventricle against left atrium: where a wall ends at a valve.
  EXPECT_TRUE(validation::wall_layers(slab(2, Region::lv_myocardium, Region::la_blood)).empty());
  EXPECT_EQ(validation::wall_layers(slab(2, Region::lv_myocardium, Region::ra_blood)).size(), 1U);
}

TEST(WallLayersOfMesh, PapillaryMusclesAreNoWall) {
  EXPECT_TRUE(validation::wall_layers(slab(2, Region::papillary, Region::torso)).empty());
}

}  // namespace
