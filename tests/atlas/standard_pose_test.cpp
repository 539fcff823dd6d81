// SPDX-License-Identifier: GPL-3.0-or-later
// The frame and the unit of an atlas's file do not reach what is carried from it.
#include "generator/atlas/standard_pose.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/phantom/phantom.hpp"
#include "generator/atlas/atlas_image.hpp"
#include "generator/ventricles/ventricles.hpp"
#include "support/model_heart.hpp"

namespace heartgen::atlas {
namespace {

FiberAtlas standin_after(const Mat3& matrix, const Vec3& offset) {
  const auto mesh = phantom::make_standin_atlas();
  std::vector<Vec3> points, fibers;
  for (const Vec3& x : mesh.nodes_mm) points.push_back(matrix * x + offset);
  for (const Vec3& f : mesh.node_fibers.fiber) fibers.push_back(matrix * f);
  return make_fiber_atlas("stand-in", points, mesh.cells, fibers);
}

Mat3 scaled(double factor, Mat3 m) {
  for (auto& row : m.rows) row *= factor;
  return m;
}

double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t n = 0; n < a.size(); ++n) most = std::max(most, norm(a[n] - b[n]));
  return most;
}

TEST(StandardPose, TurnsSizesUnitsAndOrdersOfTheAxesLeaveNoTrace) {
  const auto plain = in_standard_pose(standin_after({}, {}));
  const Mat3 turn = testing::rotation_about(normalized({1, -2, 0.5}), 40);
  const Mat3 order{{Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 0, 0}}};
  for (const Mat3& matrix : {turn, order, scaled(0.8, {}), scaled(1e-3, {}), scaled(0.8e-3, order * turn)}) {
    const auto other = in_standard_pose(standin_after(matrix, matrix * Vec3{150, -40, 20}));
    EXPECT_LT(farthest(other.points_mm, plain.points_mm), 1e-6);
    EXPECT_LT(farthest(other.fiber, plain.fiber), 1e-6);
  }
}

TEST(StandardPose, AMirroredAtlasStaysMirrored) {
  const auto plain = in_standard_pose(standin_after({}, {}));
  const auto mirrored = in_standard_pose(standin_after({{Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}}, {}));
  EXPECT_GT(farthest(mirrored.points_mm, plain.points_mm), 5);
}

TEST(StandardPose, ImagesOfTheSameHeartInOtherFramesAreTheSame) {
  const auto plain = atlas::image_of_atlas(standin_after({}, {}), 2.5);
  const auto turned = atlas::image_of_atlas(
      standin_after(scaled(0.8e-3, testing::rotation_about(normalized({1, -2, 0.5}), 40)), {0.1, 0, 0.05}), 2.5);
  ASSERT_EQ(turned.ventricles.parts.grid.size, plain.ventricles.parts.grid.size);
  std::size_t other = 0;
  for (std::size_t v = 0; v < plain.ventricles.parts.voxels.size(); ++v)
    other += plain.ventricles.parts.voxels[v] != turned.ventricles.parts.voxels[v];
  EXPECT_LT(static_cast<double>(other), 1e-4 * static_cast<double>(plain.ventricles.parts.voxels.size()));
}

}  // namespace
}  // namespace heartgen::atlas
