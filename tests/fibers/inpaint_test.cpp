// SPDX-License-Identifier: GPL-3.0-or-later
// Total variation inpainting of axes on a mesh.
#include "generator/fibers/inpaint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "generator/fibers/even_junction.hpp"
#include "generator/fibers/inpaint_grid.hpp"
#include "generator/parallel/threads.hpp"
#include "support/model_heart.hpp"

namespace heartgen::fibers {
namespace {

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
    gap.axes.push_back(axis_tensor(testing::fiber_of(heart, p)));
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
    const Vec3 axis = leading_axis(gap.axes[n]);
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

/// A chain of elements 1 mm apart: the first along x, the last 80 degrees off it, `between` of them blended.
struct Chain {
  NeighborGraph graph;
  std::vector<AxisTensor> axes;
  std::vector<std::uint8_t> blended;
};

Chain chain_of(std::size_t between) {
  constexpr double end = 80 * 3.14159265358979323846 / 180;
  Chain chain;
  chain.graph.start = {0};
  const std::size_t count = between + 2;
  for (std::size_t e = 0; e < count; ++e) {
    if (e > 0) chain.graph.neighbor.push_back(static_cast<std::int32_t>(e - 1));
    if (e + 1 < count) chain.graph.neighbor.push_back(static_cast<std::int32_t>(e + 1));
    chain.graph.start.push_back(static_cast<std::int64_t>(chain.graph.neighbor.size()));
    const double share = static_cast<double>(e) / static_cast<double>(count - 1);
    chain.axes.push_back((1 - share) * axis_tensor({1, 0, 0}) + share * axis_tensor({std::cos(end), std::sin(end), 0}));
    chain.blended.push_back(e > 0 && e + 1 < count);
  }
  chain.graph.distance_mm.assign(chain.graph.neighbor.size(), 1);
  return chain;
}

double largest_turn_deg(const Chain& chain) {
  double largest = 0;
  for (std::size_t e = 1; e < chain.axes.size(); ++e)
    largest = std::max(largest, testing::axis_angle_deg(leading_axis(chain.axes[e - 1]), leading_axis(chain.axes[e])));
  return largest;
}

TEST(RelaxAxes, ABlendOfCrossedAxesTurnsEvenlyAndItsEndsHold) {
  Chain chain = chain_of(7);
  ASSERT_GT(largest_turn_deg(chain), 25);  // the mean of dyads flips in the middle
  const auto first = chain.axes.front(), last = chain.axes.back();
  relax_axes(chain.graph, chain.blended, 2000, chain.axes);
  EXPECT_NEAR(largest_turn_deg(chain), 10, 1e-3);  // 80 degrees over 8 edges
  EXPECT_EQ(chain.axes.front().c, first.c);
  EXPECT_EQ(chain.axes.back().c, last.c);
}

/// Largest turn in degrees per mm of a chain of edges of this length, in whose middle axes jump by 80 degrees, once
/// they turn evenly.
double turn_where_walls_meet(double edge_mm) {
  Chain chain = chain_of(38);
  for (float& mm : chain.graph.distance_mm) mm = static_cast<float>(edge_mm);
  std::vector<double> from_junction_mm;
  for (std::size_t e = 0; e < chain.axes.size(); ++e) {
    chain.axes[e] = e < 20 ? chain.axes.front() : chain.axes.back();
    from_junction_mm.push_back(edge_mm * std::abs(static_cast<double>(e) - 19.5));
  }
  turn_evenly(chain.graph, from_junction_mm, chain.axes);
  return largest_turn_deg(chain) / edge_mm;
}

TEST(TurnEvenly, WhereWallsMeetAxesTurnOverFiveMillimetresWhateverTheEdges) {
  for (const double edge_mm : {0.4, 0.8, 1.2, 1.8}) EXPECT_LT(turn_where_walls_meet(edge_mm), 80 / 4.5) << edge_mm;
}

TEST(TurnEvenly, WhereOneWallIsAloneNothingChanges) {
  Chain chain = chain_of(7);
  const auto before = chain.axes;
  turn_evenly(chain.graph, std::vector<double>(before.size(), std::numeric_limits<double>::infinity()), chain.axes);
  for (std::size_t e = 0; e < before.size(); ++e) EXPECT_EQ(chain.axes[e].c, before[e].c) << e;
}

TEST(RelaxAxes, SameBitsForAnyNumberOfThreadsAndZerosStay) {
  const int before = parallel::thread_count();
  Chain one = chain_of(40);
  one.axes[20] = {};
  Chain many = one;
  parallel::set_thread_count(1);
  relax_axes(one.graph, one.blended, 30, one.axes);
  parallel::set_thread_count(5);
  relax_axes(many.graph, many.blended, 30, many.axes);
  parallel::set_thread_count(before);
  for (std::size_t e = 0; e < one.axes.size(); ++e) ASSERT_EQ(one.axes[e].c, many.axes[e].c);
  EXPECT_EQ(one.axes[20].c, AxisTensor{}.c);
}

/// A tilted field in a ball, unknown in a shell through it; the ball touches the image's border.
struct VoxelGap {
  Volume<Vec3> fiber;
  Mask wall;
};

VoxelGap ball_with_gap() {
  Grid grid;
  grid.size = {15, 13, 11};
  grid.spacing_mm = {0.75, 1, 1.5};
  VoxelGap gap{Volume<Vec3>(grid), Mask(grid)};
  for (std::int64_t k = 0; k < 11; ++k)
    for (std::int64_t j = 0; j < 13; ++j)
      for (std::int64_t i = 0; i < 15; ++i) {
        const Vec3 p = lps_from_index(grid, {double(i), double(j), double(k)}) - Vec3{5, 6, 6};
        gap.wall(i, j, k) = norm(p) < 6.5;
        const bool known = norm(p) < 2 || norm(p) > 5;
        if (gap.wall(i, j, k) && known) gap.fiber(i, j, k) = normalized({1, 0.3 * p.x, 0.2 * p.z});
      }
  return gap;
}

/// The faces between the wall's voxels.
NeighborGraph face_graph(const Mask& wall) {
  NeighborGraph graph;
  graph.start = {0};
  const Grid& g = wall.grid;
  constexpr Index3 steps[] = {{0, 0, -1}, {0, -1, 0}, {-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        for (const auto& [a, b, c] : steps)
          if (wall(i, j, k) && g.contains(i + a, j + b, k + c) && wall(i + a, j + b, k + c)) {
            graph.neighbor.push_back(static_cast<std::int32_t>(g.offset(i + a, j + b, k + c)));
            graph.distance_mm.push_back(static_cast<float>(a ? g.spacing_mm.x : b ? g.spacing_mm.y : g.spacing_mm.z));
          }
        graph.start.push_back(static_cast<std::int64_t>(graph.neighbor.size()));
      }
  return graph;
}

TEST(InpaintGrid, EqualsTheGraphOfItsFacesBitForBit) {
  const VoxelGap gap = ball_with_gap();
  std::vector<AxisTensor> axes;
  std::vector<std::uint8_t> missing;
  for (std::size_t v = 0; v < gap.wall.voxels.size(); ++v) {
    const bool known = norm(gap.fiber.voxels[v]) > 0.5;
    axes.push_back(known ? axis_tensor(normalized(gap.fiber.voxels[v])) : AxisTensor{});
    missing.push_back(gap.wall.voxels[v] && !known);
  }
  const auto holes = std::count(missing.begin(), missing.end(), 1);
  ASSERT_GT(holes, 100);
  EXPECT_EQ(inpaint_axes(face_graph(gap.wall), 40, axes, missing), holes);
  const auto filled = inpaint_axes(gap.fiber, gap.wall, 40, parallel::self());
  for (std::size_t v = 0; v < axes.size(); ++v) {
    const Vec3 before = gap.fiber.voxels[v];
    ASSERT_EQ(filled.voxels[v], norm(before) > 0.5 ? before : leading_axis(axes[v])) << v;
  }
}

TEST(InpaintGrid, WhatNothingReachesStaysWithoutAnAxis) {
  VoxelGap gap = ball_with_gap();
  gap.wall(0, 0, 0) = 1;  // alone
  EXPECT_EQ(inpaint_axes(gap.fiber, gap.wall, 5, parallel::self())(0, 0, 0), Vec3{});
}

}  // namespace
}  // namespace heartgen::fibers
