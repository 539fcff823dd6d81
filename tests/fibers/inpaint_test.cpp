// Total variation inpainting of axes on a mesh.
#include "generator/fibers/inpaint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generator/parallel/threads.hpp"
#include "support/model_heart.hpp"

namespace heart::fibers {
namespace {

using atlas::AxisTensor;

struct Gap {
  TetMesh mesh;
  std::vector<AxisTensor> axes;
  std::vector<std::uint8_t> missing;
};

/// The left ventricle's wall with its known fibres, which are missing in two balls.
Gap wall_with_gaps() {
  const testing::ModelHeart heart;
  Gap gap;
  gap.mesh = testing::voxel_mesh(testing::labels_of(heart, 2.5));
  gap.missing.resize(gap.mesh.nodes_mm.size());
  for (std::size_t n = 0; n < gap.missing.size(); ++n) {
    const Vec3& p = gap.mesh.nodes_mm[n];
    gap.axes.push_back(atlas::axis_tensor(testing::fiber_of(heart, p)));
    gap.missing[n] = norm(p - Vec3{23, 0, 0}) < 8 || norm(p - Vec3{0, 23, -10}) < 5;
    if (gap.missing[n]) gap.axes[n] = {};
  }
  return gap;
}

std::int64_t fill(Gap& gap, int iterations) {
  const std::vector<std::uint8_t> all(gap.mesh.cells.size(), 1);
  return inpaint_axes(edge_graph(gap.mesh, all), iterations, gap.axes, gap.missing);
}

TEST(InpaintMesh, GapsInAWallAreFilledWithUnitAxesNearTheKnownField) {
  const Gap before = wall_with_gaps();
  Gap gap = before;
  const auto holes = std::count(before.missing.begin(), before.missing.end(), 1);
  ASSERT_GT(holes, 50);
  EXPECT_EQ(fill(gap, 200), holes);
  double sum = 0;
  for (std::size_t n = 0; n < gap.axes.size(); ++n) {
    if (!before.missing[n]) {
      ASSERT_EQ(gap.axes[n].c, before.axes[n].c);
      continue;
    }
    ASSERT_NEAR(trace(gap.axes[n]), 1, 1e-9);
    const Vec3 axis = atlas::leading_axis(gap.axes[n]);
    sum += testing::axis_angle_deg(axis, testing::fiber_of({}, gap.mesh.nodes_mm[n]));
  }
  // The larger gap goes through the whole wall, in which fibres turn by 120 degrees.
  EXPECT_LT(sum / static_cast<double>(holes), 25);
}

TEST(InpaintMesh, SameBitsForAnyNumberOfThreads) {
  const int before = parallel::thread_count();
  Gap one = wall_with_gaps(), many = one;
  parallel::set_thread_count(1);
  fill(one, 50);
  parallel::set_thread_count(5);
  fill(many, 50);
  parallel::set_thread_count(before);
  for (std::size_t n = 0; n < one.axes.size(); ++n) ASSERT_EQ(one.axes[n].c, many.axes[n].c);
}

}  // namespace
}  // namespace heart::fibers
