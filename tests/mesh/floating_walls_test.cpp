// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of the walls beside the heart go to what lies around them.
#include "generator/mesh/floating_walls.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "generator/mesh/mesh_heart.hpp"
#include "mesh/shapes.hpp"
#include "model/labels.hpp"
#include "support/diced_cubes.hpp"

namespace heartgen::mesh {
namespace {

constexpr int n = 10;

struct Blocks {
  std::vector<Vec3> nodes = testing::cube_corners(n);
  std::vector<Cell> cells;
  std::vector<std::int32_t> label;

  template <class RegionOf>
  explicit Blocks(RegionOf region_of) {
    testing::dice_cubes(n, [&](const Cell& cell, int i, int j, int k) {
      cells.push_back(cell);
      label.push_back(tag(region_of(i, j, k)));
    });
  }
  std::int64_t cells_of(Region region) const { return std::count(label.begin(), label.end(), tag(region)); }
};

LabelSet walls() {
  LabelSet set{};
  for (const auto& row : region_table())
    set[static_cast<std::size_t>(row.tag)] = is_myocardium(static_cast<Region>(row.tag));
  return set;
}

/// Blood in the half x < 5, torso in the other; a slab of muscle below.
Region ground(int i, int k) {
  if (k < 3) return Region::lv_myocardium;
  return i < 5 ? Region::lv_blood : Region::torso;
}

TEST(FloatingWalls, TakeTheLabelAroundThem) {
  Blocks blocks([](int i, int j, int k) {
    const bool in_blood = i == 2 && j == 2 && k == 6;
    const bool in_torso = i == 7 && (j == 5 || j == 6) && k == 6;
    return in_blood || in_torso ? (in_blood ? Region::rv_myocardium : Region::la_wall) : ground(i, k);
  });
  EXPECT_EQ(absorb_floating_walls(blocks.nodes, blocks.cells, blocks.label, walls()), 18);
  EXPECT_EQ(blocks.cells_of(Region::rv_myocardium), 0);
  EXPECT_EQ(blocks.cells_of(Region::la_wall), 0);
  EXPECT_EQ(blocks.cells_of(Region::lv_blood), 6 * 5 * 10 * 7);
  EXPECT_EQ(blocks.cells_of(Region::torso), 6 * 5 * 10 * 7);
}

TEST(FloatingWalls, StayWhereTheyShareANodeOrAreAPartOfTheHeart) {
  Blocks blocks([](int i, int j, int k) {
    const bool at_a_corner = i == 2 && j == 2 && k == 3;
    const bool is_large = i > 6 && j < 4 && k == 8;  // 12 of 313 cubes
    return at_a_corner || is_large ? Region::la_wall : ground(i, k);
  });
  const auto before = blocks.label;
  EXPECT_EQ(absorb_floating_walls(blocks.nodes, blocks.cells, blocks.label, walls()), 0);
  EXPECT_EQ(blocks.label, before);
}

/// A ventricle with a crumb of muscle in its blood and one outside, each more than the mesher drops by itself.
TEST(FloatingWalls, AreNotInTheMeshOfALabelMap) {
  const auto labels = testing::label_cube(40, 1, [](const Vec3& p) {
    if (norm(p) < 2.6 || norm(p - Vec3{17, 17, 17}) < 2.6) return Region::lv_myocardium;
    return norm(p) < 11 ? Region::lv_blood : norm(p) < 16 ? Region::lv_myocardium : Region::torso;
  });
  MeshSettings settings;
  settings.heart_edge_mm = settings.blood_edge_mm = 1.2;
  settings.torso_edge_mm = 3;
  settings.smoothing_mm = 0.3;
  const auto mesh = mesh_labels(labels, settings);
  auto regions = mesh.region;
  ASSERT_EQ(absorb_floating_walls(mesh.nodes_mm, mesh.cells, regions, walls()), 0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(Region::lv_myocardium))
      for (const auto node : mesh.cells[c]) {
        const double r = norm(mesh.nodes_mm[static_cast<std::size_t>(node)]);
        EXPECT_TRUE(r > 9 && r < 18) << r;
      }
}

}  // namespace
}  // namespace heartgen::mesh
