// SPDX-License-Identifier: GPL-3.0-or-later
// An atlas that ends otherwise than the patient where the ventricles' walls meet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "datasets/phantom/phantom.hpp"
#include "generator/atlas/atlas.hpp"
#include "generator/atlas/atlas_image.hpp"
#include "generator/fibers/registered_pair.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/resample.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"
#include "support/model_heart.hpp"

namespace heartgen {
namespace {

constexpr double spacing_mm = 1.6;

LabelVolume labels_of(const phantom::HeartModel& model, const Landmarks& marks) {
  constexpr double half_mm = 90;
  Grid grid;
  grid.size.fill(static_cast<std::int64_t>(2 * half_mm / spacing_mm));
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  grid.origin_mm =
      0.5 * (marks.seeds_mm.at("lv_blood") + marks.seeds_mm.at("rv_blood")) - Vec3{half_mm, half_mm, half_mm};
  LabelVolume labels(grid);
  parallel::parallel_for(0, grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t v = begin; v < end; ++v)
      labels.voxels[static_cast<std::size_t>(v)] = tag(phantom::region_at(model, image::voxel_center(grid, v)));
  });
  return labels;
}

/// The right wall's voxels so far from the left one, in mm.
std::vector<Vec3> right_wall_between(const LabelVolume& labels, double from_mm, double to_mm) {
  const auto to_left =
      image::distance_to(image::mask_where(labels, [](auto v) { return v == tag(Region::lv_myocardium); }));
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    if (labels.voxels[v] == tag(Region::rv_myocardium) && to_left.voxels[v] >= from_mm && to_left.voxels[v] < to_mm)
      points.push_back(image::voxel_center(labels.grid, static_cast<std::int64_t>(v)));
  return points;
}

TEST(Junction, WallsMeetBetweenVoxelsWhereTheLabelsHaveIt) {
  constexpr double meet_mm = 10.3, middle_mm = 12, half_mm = 6;
  Grid grid;
  grid.size = {24, 24, 24};
  ventricles::Ventricles walls;
  walls.parts = Volume<std::uint8_t>(grid);
  auto& shares = walls.shares;
  shares.lv_cavity = shares.rv_cavity = shares.left = shares.both = Volume<float>(grid);
  for (std::size_t v = 0; v < walls.parts.voxels.size(); ++v) {
    const Vec3 p = image::voxel_center(grid, static_cast<std::int64_t>(v));
    if (std::abs(p.y - middle_mm) > half_mm || std::abs(p.z - middle_mm) > half_mm) continue;
    walls.parts.voxels[v] = tag(p.x < meet_mm ? ventricles::Part::lv_wall : ventricles::Part::rv_wall);
    shares.left.voxels[v] = static_cast<float>(std::clamp(0.5 + 0.5 * (meet_mm - p.x), 0.0, 1.0));
    shares.both.voxels[v] = 1;
  }
  const auto left_mm = fibers::left_of_junction(walls);
  for (int i = 6; i <= 14; ++i) EXPECT_NEAR(left_mm(i, 12, 12), meet_mm - i, 0.05) << i;
}

/// Two walls side by side, all of both known, that meet at `meet_mm` along x.
fibers::RegisteredPair walls_that_meet(double meet_mm) {
  Grid grid;
  grid.size = {20, 4, 4};
  const Volume<float> half(grid, 0.5F);
  const ventricles::WallCoordinates known{Mask(grid, 1), half, Volume<float>(grid, 3.0F), Volume<Vec3>(grid, {0, 0, 1}),
                                          Volume<float>(grid)};
  fibers::RegisteredPair hearts;
  hearts.patient_walls = {known, known};
  hearts.patient.frame.long_axis = {0, 1, 0};
  hearts.left_of_junction_mm = Volume<float>(grid);
  for (std::size_t v = 0; v < half.voxels.size(); ++v)
    hearts.left_of_junction_mm.voxels[v] =
        static_cast<float>(meet_mm - image::voxel_center(grid, static_cast<std::int64_t>(v)).x);
  return hearts;
}

TEST(Junction, AWallKeepsItsOwnAxesUpToAFifthOfAMillimetreOfTheOther) {
  constexpr double meet_mm = 10.3, near_mm = 0.2;
  const std::vector<Vec3> points{{meet_mm - near_mm, 2, 2}, {meet_mm, 2, 2}, {meet_mm + near_mm, 2, 2}};
  const auto walls = fibers::point_walls(walls_that_meet(meet_mm), points, {1, 1, 1});
  EXPECT_EQ(walls.left_share[0], 1);
  EXPECT_NEAR(walls.left_share[1], 0.5, 1e-3);
  EXPECT_EQ(walls.left_share[2], 0);
  for (const double mm : walls.from_junction_mm) EXPECT_LT(mm, 1.5);
}

TEST(Junction, AnAtlasThatBendsIntoTheJunctionTurnsNoFibersOfAPatientWhoseWallDoesNot) {
  const auto model = phantom::make_heart_model(3);
  const auto marks = phantom::landmarks_of(model);
  const auto labels = labels_of(model, marks);
  const auto mesh = phantom::make_standin_atlas();
  FiberSettings settings;
  settings.depth_grid_mm = settings.grid_mm = spacing_mm;
  const auto hearts = fibers::register_pair(
      labels, marks,
      atlas::image_of_atlas(atlas::make_fiber_atlas("stand-in", mesh.nodes_mm, mesh.cells, mesh.node_fibers.fiber),
                            spacing_mm),
      "stand-in", settings);
  const auto points = right_wall_between(labels, 4, 12);
  auto walls = fibers::point_walls(hearts, points, std::vector<std::uint8_t>(points.size(), 1));
  // What coarse labels do to the patient's depth is another matter.
  for (std::size_t n = 0; n < points.size(); ++n)
    if (const double depth = phantom::depth_at(model, points[n]); !std::isnan(depth)) walls.rv[n].depth = depth;
  const auto carried =
      fibers::carried_axes(hearts, walls, points, fibers::atlas_positions(hearts, points), "local_angles").axes;
  double sum_deg = 0, count = 0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Vec3 known = phantom::fiber_at(model, points[n]);
    if (norm(known) < 0.5 || trace(carried[n]) <= 0) continue;
    sum_deg += testing::axis_angle_deg(known, leading_axis(carried[n]));
    ++count;
  }
  EXPECT_GT(count, 1000);
  // 6.2 where places beyond the samples are not looked up at their border, 8.6 where samples end nearer to the
  // junction.
  EXPECT_LT(sum_deg / count, 6);
}

}  // namespace
}  // namespace heartgen
