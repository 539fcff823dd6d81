// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/domain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "generator/mesh/size_field.hpp"
#include "mesh/shapes.hpp"
#include "model/error.hpp"
#include "support/places.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

// Thickness (mm) of `region` along x through the middle of the map.
double thickness_mm(const mesh::MeshDomain& domain, Region region) {
  constexpr double step_mm = 0.01;
  const auto& grid = domain.grid;
  const Vec3 middle{0, 0.5 * static_cast<double>(grid.size[1] - 1), 0.5 * static_cast<double>(grid.size[2] - 1)};
  double thickness = 0;
  for (const double x : heartgen::testing::steps(0, static_cast<double>(grid.size[0] - 1), step_mm / grid.spacing_mm.x))
    thickness += mesh::region_at(domain, {x, middle.y, middle.z}) == tag(region) ? step_mm : 0;
  return thickness;
}

TEST(Domain, SmoothingDoesNotThinAWall) {
  // One voxel of wall between blood and torso keeps its thickness under a Gaussian wider than itself.
  const auto labels = label_cube(21, 1.5, [](const Vec3& p) {
    return p.x < -0.75 ? Region::rv_blood : p.x < 0.75 ? Region::rv_myocardium : Region::torso;
  });
  for (const double smoothing_mm : {0.0, 0.8, 1.5, 2.5})
    EXPECT_NEAR(thickness_mm(mesh::make_domain(labels, smoothing_mm), Region::rv_myocardium), 1.5, 0.05)
        << smoothing_mm;
}

TEST(Domain, WallBetweenTwoAtriaKeepsItsThickness) {
  const auto labels = label_cube(21, 1.5, [](const Vec3& p) {
    return p.x < -0.75 ? Region::ra_blood : p.x < 0.75 ? Region::la_wall : Region::la_blood;
  });
  EXPECT_NEAR(thickness_mm(mesh::make_domain(labels, 1.5), Region::la_wall), 1.5, 0.05);
}

TEST(Domain, PlaneStaysWhereItIsAndIsFlat) {
  const auto labels = label_cube(21, 1, [](const Vec3& p) { return p.x < -0.5 ? Region::lv_blood : Region::torso; });
  const auto domain = mesh::make_domain(labels, 1);
  for (const double y : heartgen::testing::steps(3, 17, 0.37)) {
    EXPECT_EQ(mesh::region_at(domain, {9.49, y, y / 2}), tag(Region::lv_blood));
    EXPECT_EQ(mesh::region_at(domain, {9.51, y, y / 2}), tag(Region::torso));
  }
}

TEST(Domain, SmoothingTheBodyLeavesTheHeartAlone) {
  const auto labels = label_cube(26, 1.5, [](const Vec3& p) {
    if (norm(p) < 8) return Region::lv_blood;
    if (norm(p) < 10) return Region::lv_myocardium;
    return std::abs(p.z - 12) < 1 ? Region::bone : Region::torso;
  });
  const auto plain = mesh::make_domain(labels, 0.8), smoothed = mesh::make_domain(labels, 0.8, 6);
  std::int64_t bone_before = 0, bone_after = 0;
  for (const double x : heartgen::testing::steps(0, 25, 0.37))
    for (const double y : heartgen::testing::steps(0, 25, 0.39))
      for (const double z : heartgen::testing::steps(0, 25, 0.41)) {
        const auto before = mesh::region_at(plain, {x, y, z}), after = mesh::region_at(smoothed, {x, y, z});
        const auto is_heart = [](std::uint8_t t) {
          return t == tag(Region::lv_blood) || t == tag(Region::lv_myocardium);
        };
        if (is_heart(before) || is_heart(after)) {
          ASSERT_EQ(before, after);
        }
        bone_before += before == tag(Region::bone);
        bone_after += after == tag(Region::bone);
      }
  EXPECT_GT(bone_before, 1000);
  EXPECT_EQ(bone_after, 0) << "a sheet of half of the smoothing's width is a detail";
}

TEST(Domain, UniformCubesAgreeWithTheShares) {
  const auto labels = label_cube(24, 1.5, [](const Vec3& p) {
    return norm(p) < 8    ? Region::lv_blood
           : norm(p) < 11 ? Region::lv_myocardium
           : p.z > 5      ? Region::lung
                          : Region::torso;
  });
  for (const double body_smoothing_mm : {0.0, 3.0}) {
    const auto domain = mesh::make_domain(labels, 0.8, body_smoothing_mm);
    auto slow = domain;
    std::fill(slow.cubes.begin(), slow.cubes.end(), mesh::MeshDomain::mixed);
    for (const double x : heartgen::testing::steps(-1, 25, 0.71))
      for (const double y : heartgen::testing::steps(-1, 25, 0.83))
        for (const double z : heartgen::testing::steps(-1, 25, 0.97))
          ASSERT_EQ(mesh::region_at(domain, {x, y, z}), mesh::region_at(slow, {x, y, z}));
  }
}

TEST(Domain, MapContinuesBeyondItsBorder) {
  const auto labels = label_cube(12, 1, [](const Vec3& p) { return p.x < 0 ? Region::torso : Region::none; });
  const auto domain = mesh::make_domain(labels, 1);
  EXPECT_EQ(mesh::region_at(domain, {1, 5, -9}), tag(Region::torso));
  EXPECT_EQ(mesh::region_at(domain, {10, 5, 30}), 0);
}

TEST(Domain, SingleSliceIsNoProblem) {
  auto labels = label_cube(12, 1, [](const Vec3& p) { return norm(p) < 40 ? Region::torso : Region::none; });
  labels.grid.size = {12, 12, 1};
  labels.voxels.resize(144);
  EXPECT_EQ(mesh::region_at(mesh::make_domain(labels, 1), {5, 5, 0}), tag(Region::torso));
}

// Volume (in voxels) of a region by samples at a quarter of a voxel.
double volume_voxels(const mesh::MeshDomain& domain, Region region) {
  constexpr double step = 0.25;
  double volume = 0;
  for (const double z : heartgen::testing::steps(step / 2, static_cast<double>(domain.grid.size[2] - 1), step))
    for (const double y : heartgen::testing::steps(step / 2, static_cast<double>(domain.grid.size[1] - 1), step))
      for (const double x : heartgen::testing::steps(step / 2, static_cast<double>(domain.grid.size[0] - 1), step))
        volume += mesh::region_at(domain, {x, y, z}) == tag(region) ? step * step * step : 0;
  return volume;
}

double count_of(const LabelVolume& labels, Region region) {
  return static_cast<double>(std::count(labels.voxels.begin(), labels.voxels.end(), tag(region)));
}

TEST(Domain, RoundPoolsKeepTheirVolume) {
  for (const double radius : {3.3, 5.2, 7.7}) {
    const auto labels = label_cube(22, 1, [&](const Vec3& p) {
      const double r = norm(p - Vec3{0.2, -0.3, 0.1});
      return r < radius ? Region::lv_blood : r < radius + 1.5 ? Region::lv_myocardium : Region::torso;
    });
    const auto domain = mesh::make_domain(labels, 0.8);
    for (const Region region : {Region::lv_blood, Region::lv_myocardium})
      EXPECT_NEAR(volume_voxels(domain, region) / count_of(labels, region), 1, 0.015) << radius;
  }
}

TEST(Domain, StrandsInBloodKeepTheirVolume) {
  const auto labels = label_cube(22, 1, [](const Vec3& p) {
    return std::hypot(p.x - 0.3 * p.z, p.y) < 1.9 ? Region::papillary : Region::lv_blood;
  });
  const auto domain = mesh::make_domain(labels, 0.8);
  EXPECT_NEAR(volume_voxels(domain, Region::papillary) / count_of(labels, Region::papillary), 1, 0.06);
}

TEST(Domain, SurfaceOfABallIsNearerThanItsVoxels) {
  constexpr double radius = 8.3;
  const Vec3 center{0.2, -0.3, 0.1};
  const auto labels = label_cube(
      24, 1, [&](const Vec3& p) { return norm(p - center) < radius ? Region::lv_blood : Region::lv_myocardium; });
  const auto domain = mesh::make_domain(labels, 0.8);
  const double middle = 0.5 * static_cast<double>(labels.grid.size[0] - 1);
  double sum = 0, most = 0;
  int count = 0;
  for (const double polar : heartgen::testing::steps(0.05, 3.1, 0.1))
    for (const double turn : heartgen::testing::steps(0, 6.28, 0.13 / std::sin(polar))) {
      const Vec3 way{std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)};
      double r = 5;
      while (mesh::region_at(domain, Vec3{middle, middle, middle} + center + r * way) == tag(Region::lv_blood))
        r += 0.005;
      ++count;
      sum += std::abs(r - radius);
      most = std::max(most, std::abs(r - radius));
    }
  EXPECT_LT(sum / count, 0.1) << "voxels; the voxels' own surface is 0.25 away";
  EXPECT_LT(most, 0.5);
}

TEST(Domain, ThinStrandsAreNotBroken) {
  const auto labels = label_cube(20, 1, [](const Vec3& p) {
    return std::abs(p.x) < 1 && std::abs(p.y) < 1 ? Region::papillary : Region::lv_blood;
  });
  const auto domain = mesh::make_domain(labels, 0.8);
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) ASSERT_EQ(domain.voxels[v], labels.voxels[v]);
}

TEST(Domain, SharpKernelHasNoSecondMoment) {
  const auto kernels = mesh::sharp_kernels({1.3, 1.3, 2});
  for (const auto& weights : kernels) {
    const double radius = 0.5 * static_cast<double>(weights.size() - 1);
    double sum = 0, moment = 0, width = 0;
    for (std::size_t n = 0; n < weights.size(); ++n) {
      const auto w = static_cast<double>(weights[n]), i = static_cast<double>(n) - radius;
      sum += w;
      moment += w * i * i;
      width += std::abs(w) * i * i;
    }
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_LT(std::abs(moment), 0.1 * width);
  }
}

// Walls a voxel thick, strands that smoothing would break, and noise; the heart reaches two sides of the map.
LabelVolume rugged_labels() {
  std::uint32_t state = 7;
  return label_cube(24, 1.5, [&](const Vec3& p) {
    state = 1664525 * state + 1013904223;
    const double r = norm(p - Vec3{8, 8, 0}) + 1.5 * static_cast<double>(state >> 16U) / 65536;
    if (std::abs(p.x + 10) < 1 && std::abs(p.y) < 1) return Region::pulmonary_artery;
    if (r < 8) return Region::lv_blood;
    if (r < 10) return Region::lv_myocardium;
    return r < 12 ? Region::rv_blood : p.z < 0 ? Region::torso : Region::bone;
  });
}

TEST(Domain, WhatChangedInPartsIsAsIfAllHadBeenDecidedAgain) {
  const auto labels = rugged_labels();
  const auto domain = mesh::make_domain(labels, 2);
  auto again = domain;
  auto whole = mesh::no_spans(labels.grid.size);
  whole.add({{0, 0, 0}, {labels.grid.size[0] - 1, labels.grid.size[1] - 1, labels.grid.size[2] - 1}});
  std::ranges::fill(again.voxels, std::uint8_t{99});
  std::ranges::fill(again.cubes, std::uint8_t{99});
  mesh::update_regions(again, labels, whole);
  EXPECT_EQ(again.voxels, domain.voxels);
  EXPECT_EQ(again.cubes, domain.cubes);
}

TEST(Domain, EighthsOfACubeAreTheRegionsThere) {
  const auto labels = rugged_labels();
  const auto domain = mesh::make_domain(labels, 2);
  int mixed = 0;
  for (std::int64_t k = 0; k + 1 < labels.grid.size[2]; ++k)
    for (std::int64_t j = 0; j + 1 < labels.grid.size[1]; ++j)
      for (std::int64_t i = 0; i + 1 < labels.grid.size[0]; ++i) {
        const auto regions = mesh::regions_of_eighths(domain, {i, j, k});
        mixed += domain.cubes[static_cast<std::size_t>(labels.grid.offset(i, j, k))] == mesh::MeshDomain::mixed;
        for (std::size_t part = 0; part < 8; ++part) {
          const auto at = [&](std::int64_t first, std::size_t axis) {
            return static_cast<double>(first) + ((part >> axis & 1U) != 0 ? 0.75 : 0.25);
          };
          ASSERT_EQ(regions[part], mesh::region_at(domain, {at(i, 0), at(j, 1), at(k, 2)}));
        }
      }
  EXPECT_GT(mixed, 1000);
}

TEST(Spans, HoldWhatIsOnTheMap) {
  auto spans = mesh::no_spans({5, 4, 3});
  spans.add({{-2, 1, 2}, {1, 9, 9}});
  spans.add({{3, 1, 2}, {3, 1, 2}});
  EXPECT_EQ(spans.row(1, 2).first, 0);
  EXPECT_EQ(spans.row(1, 2).last, 3);
  EXPECT_EQ(spans.row(3, 2).last, 1);
  for (const auto& [j, k] : {std::pair{0, 2}, {1, 1}, {4, 2}, {-1, 0}, {1, 3}}) EXPECT_EQ(spans.row(j, k).last, -1);
}

TEST(SizeField, IsFineInWallsAndGrowsAsTold) {
  const auto labels = label_cube(60, 2, [](const Vec3& p) {
    return norm(p) < 10 ? Region::lv_blood : norm(p) < 14 ? Region::lv_myocardium : Region::torso;
  });
  MeshSettings settings;
  settings.heart_edge_mm = 2;
  settings.blood_edge_mm = 3;
  settings.torso_edge_mm = 12;
  settings.growth = 0.3;
  const auto sizes = mesh::size_field(mesh::make_domain(labels, 0.8), settings);
  EXPECT_NEAR(mesh::edge_at(sizes, {12, 0, 0}), 2, 0.05);
  EXPECT_NEAR(mesh::edge_at(sizes, {0, 0, 0}), 3, 0.05);
  for (const double distance : {5.0, 10.0, 20.0, 30.0})
    EXPECT_NEAR(mesh::edge_at(sizes, {14 + distance, 0, 0}), 2 + 0.3 * distance, 0.7) << distance;
  EXPECT_NEAR(mesh::edge_at(sizes, {58, 58, 58}), 12, 0.01);
  const auto& s = sizes.grid.spacing_mm;
  for (std::int64_t k = 0; k < sizes.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < sizes.grid.size[1]; ++j)
      for (std::int64_t i = 1; i < sizes.grid.size[0]; ++i)
        ASSERT_LE(std::abs(sizes(i, j, k) - sizes(i - 1, j, k)), 0.3 * s.x + 1e-4);
}

}  // namespace
