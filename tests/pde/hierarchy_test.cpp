// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/hierarchy.hpp"

#include <gtest/gtest.h>

#include "model/error.hpp"

namespace heartgen::pde {
namespace {

/// Nested boxes of air, fat, muscle and blood.
Volume<float> nested() {
  Grid grid;
  grid.size = {24, 24, 24};
  Volume<float> image(grid, -1000);
  for (std::int64_t k = 0; k < 24; ++k)
    for (std::int64_t j = 0; j < 24; ++j)
      for (std::int64_t i = 0; i < 24; ++i) {
        const auto depth = std::min({i, j, k, 23 - i, 23 - j, 23 - k});
        image(i, j, k) = depth < 2 ? -1000.0F : depth < 4 ? -90.0F : depth < 7 ? 100.0F : 380.0F;
      }
  return image;
}

std::vector<SegmentationStep> steps() {
  return {{.name = "body", .mu = 0},
          {.name = "soft", .domain = "body.above", .mu = 0},
          {.name = "blood", .domain = "soft.above", .mu = 0}};
}

std::string error_of(const std::vector<SegmentationStep>& bad, const Volume<float>& image) {
  try {
    pde::segment(image, bad, parallel::self());
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Hierarchy, EachStepDividesItsDomain) {
  const auto image = nested();
  const auto tree = pde::segment(image, steps(), parallel::self());
  ASSERT_EQ(tree.size(), 3U);
  for (std::size_t v = 0; v < image.voxels.size(); ++v) {
    EXPECT_EQ(tree[0].below.voxels[v] + tree[0].above.voxels[v], 1);
    EXPECT_EQ(tree[1].below.voxels[v] + tree[1].above.voxels[v], tree[0].above.voxels[v]);
    EXPECT_EQ(pde::side(tree, "blood.above").voxels[v], image.voxels[v] > 200 ? 1 : 0);
  }
  EXPECT_DOUBLE_EQ(pde::grey_value(tree, "body.below"), -1000);
  EXPECT_DOUBLE_EQ(pde::grey_value(tree, "blood.above"), 380);
}

TEST(Hierarchy, WrongDomainsAreNamed) {
  auto bad = steps();
  bad[1].domain = "blood.above";  // a later step
  EXPECT_NE(error_of(bad, nested()).find("blood.above"), std::string::npos);
  bad[1].domain = "body.left";
  EXPECT_NE(error_of(bad, nested()).find("body.left"), std::string::npos);
  bad = steps();
  bad[2].name = "body";
  EXPECT_NE(error_of(bad, nested()).find("twice"), std::string::npos);
  bad = steps();
  bad[0].norm = "L3";
  EXPECT_NE(error_of(bad, nested()).find("L3"), std::string::npos);
}

TEST(Hierarchy, AnEmptyDomainIsAUserError) {
  Volume<float> flat(nested().grid, 5);
  auto only = steps();
  only[1].domain = "body.above";
  EXPECT_NE(error_of(only, flat).find("body.above"), std::string::npos);
  EXPECT_THROW(pde::side({}, "blood.above"), UserError);
}

}  // namespace
}  // namespace heartgen::pde
