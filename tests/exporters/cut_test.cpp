// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/cut.hpp"

#include <gtest/gtest.h>

#include <map>

#include "exporters/adjacency.hpp"
#include "model/error.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/two_region_mesh.hpp"

namespace heartgen::exporters {
namespace {

using testing::error_of;
using testing::two_region_mesh;

std::map<std::string, int> faces_by_name(const TetMesh& mesh) {
  std::map<std::string, int> count;
  for (const auto tag : mesh.surface) ++count[surface_name(tag)];
  return count;
}

/// Sum of the area vectors: zero for a closed surface that looks outwards.
Vec3 openness(const TetMesh& mesh) {
  Vec3 sum;
  for (const auto& face : mesh.faces) {
    const auto at = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(face[i])]; };
    sum += cross(at(1) - at(0), at(2) - at(0));
  }
  return sum;
}

TEST(Cut, NamesStandForRegions) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(regions_named(Names{"ventricles"}), (std::set<std::int32_t>{1, 2, 3}));
  EXPECT_EQ(regions_named(Names{"atria", "lung"}), (std::set<std::int32_t>{4, 5, 12, 18, 19}));
  EXPECT_EQ(regions_named(Names{"walls"}).size(), 7U);
  EXPECT_NE(error_of([] { regions_named(Names{"ventricle"}); }).find("ventricles, atria"), std::string::npos);
}

TEST(Cut, VentriclesEndInABase) {
  const TetMesh heart = two_region_mesh(2, Region::la_wall);
  const std::vector<std::string> names = {"ventricles"};
  const TetMesh part = only_regions(heart, regions_named(names));
  EXPECT_EQ(part.cells.size(), heart.cells.size() / 2);
  EXPECT_EQ(faces_by_name(part), (std::map<std::string, int>{{"base", 8}, {"epicardium", 40}}));
  EXPECT_LT(norm(openness(part)), 1e-12);
  for (const auto& sides : cells_of_faces(part)) EXPECT_TRUE(sides[0] >= 0 && sides[1] < 0);
  for (std::size_t c = 0; c < part.cells.size(); ++c) {
    const auto parent = static_cast<std::size_t>(part.parent_cell[c]);
    EXPECT_EQ(part.cell_fibers.sheet[c], heart.cell_fibers.sheet[parent]);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(part.parent_node[static_cast<std::size_t>(part.cells[c][i])], heart.cells[parent][i]);
  }
  for (std::size_t n = 0; n < part.nodes_mm.size(); ++n)
    EXPECT_EQ(part.node_fibers.fiber[n], heart.node_fibers.fiber[static_cast<std::size_t>(part.parent_node[n])]);
}

TEST(Cut, TheOtherSideLooksOutwardsToo) {
  const TetMesh part = only_regions(two_region_mesh(2, Region::la_wall), {tag(Region::la_wall)});
  EXPECT_EQ(faces_by_name(part).at("base"), 8);
  EXPECT_LT(norm(openness(part)), 1e-12);
}

TEST(Cut, AnInterfaceThatBecomesABoundaryKeepsItsName) {
  const TetMesh part = only_regions(two_region_mesh(2, Region::lv_blood), {tag(Region::lv_myocardium)});
  EXPECT_EQ(faces_by_name(part), (std::map<std::string, int>{{"lv_endocardium", 8}, {"epicardium", 40}}));
}

TEST(Cut, OuterFacesAlone) {
  const TetMesh heart = two_region_mesh(2, Region::la_wall), outer = without_interfaces(heart);
  EXPECT_EQ(heart.faces.size() - outer.faces.size(), 8U);
  EXPECT_EQ(faces_by_name(outer).count("atrioventricular_junction"), 0U);
  EXPECT_LT(norm(openness(outer)), 1e-12);
}

}  // namespace
}  // namespace heartgen::exporters
