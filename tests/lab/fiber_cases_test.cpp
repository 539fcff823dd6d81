// SPDX-License-Identifier: GPL-3.0-or-later
// The hearts of `heartgen-lab fiber-accuracy`: how uneven labels differ from exact ones.
#include "benchmarks/lab/fiber_cases.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "benchmarks/lab/fiber_accuracy_command.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heartgen {
namespace {

constexpr Vec3 spacing_mm{2, 2, 2}, coarse_mm{3, 3, 3};

bool is_blood_or_papillary(std::uint8_t label) {
  return is_blood(static_cast<Region>(label)) || label == tag(Region::papillary);
}

bool is_ventricle(std::uint8_t label) {
  return label == tag(Region::lv_myocardium) || label == tag(Region::rv_myocardium) || label == tag(Region::lv_blood) ||
         label == tag(Region::rv_blood) || label == tag(Region::papillary);
}

/// Mean distance between two surfaces: the volume between them over the exact one's area (the gradients' sum of its
/// smoothed mask).
double mean_distance_mm(const LabelVolume& exact, const LabelVolume& moved,
                        const std::function<bool(std::uint8_t)>& inside) {
  Volume<float> smooth(exact.grid);
  double volume_mm3 = 0;
  for (std::size_t v = 0; v < exact.voxels.size(); ++v) {
    smooth.voxels[v] = inside(exact.voxels[v]);
    volume_mm3 += inside(exact.voxels[v]) != inside(moved.voxels[v]) ? exact.grid.voxel_volume_mm3() : 0;
  }
  smooth = image::smoothed(smooth, 1);
  double area_mm2 = 0;
  for (std::int64_t k = 0; k < exact.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < exact.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < exact.grid.size[0]; ++i)
        area_mm2 += norm(image::gradient_at(smooth, i, j, k)) * exact.grid.voxel_volume_mm3();
  return volume_mm3 / area_mm2;
}

TEST(FiberCases, UnevenSurfacesAreMovedByFourTenthsOfAMillimetre) {
  const auto exact = lab::make_fiber_case("2", spacing_mm), uneven = lab::make_fiber_case("uneven2", spacing_mm);
  EXPECT_EQ(uneven.landmarks.valves.size(), exact.landmarks.valves.size());
  const double expected_mm = 0.4 * std::sqrt(2 / std::acos(-1.0));  // mean size of a normal variable
  EXPECT_NEAR(mean_distance_mm(exact.labels, uneven.labels, is_ventricle), expected_mm, 0.07);
  EXPECT_NEAR(mean_distance_mm(exact.labels, uneven.labels, is_blood_or_papillary), expected_mm, 0.07);
}

TEST(FiberCases, TheSameSeedMovesTheSameWay) {
  const auto first = lab::make_fiber_case("uneven", coarse_mm), again = lab::make_fiber_case("uneven1", coarse_mm);
  EXPECT_EQ(first.labels.voxels, again.labels.voxels);
  const auto other = lab::uneven_labels(first.model, first.landmarks, coarse_mm, 2);
  EXPECT_NE(first.labels.voxels, other.voxels);
}

TEST(FiberCases, FibersAreMeasuredAsABuildCarriesThem) {
  const lab::FiberAccuracyCommand usual;
  EXPECT_EQ(usual.depth_grid_mm, FiberSettings{}.depth_grid_mm);
  EXPECT_EQ(usual.spacing_mm, (std::vector{0.5, 0.5, 1.2}));  // the thesis's CT
}

TEST(FiberCases, OtherNamesAreRefused) {
  for (const char* name : {"", "waved", "unevenly", "uneven-1x", "3x", "-1"}) {
    EXPECT_THROW(lab::make_fiber_case(name, coarse_mm), UserError) << name;
    EXPECT_THROW(lab::check_fiber_case(name), UserError) << name;
  }
}

}  // namespace
}  // namespace heartgen
