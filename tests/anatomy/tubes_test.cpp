// SPDX-License-Identifier: GPL-3.0-or-later
// The lumens that are segmented by a step of their own: the carotid (with a fork, a stenosis, a wall and a vein beside
// it) and the trachea (with a bronchus that opens into the lung).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generator/anatomy/trachea.hpp"
#include "generator/anatomy/vessel.hpp"
#include "generator/image/components.hpp"
#include "generator/image/morphology.hpp"
#include "pde/pde_images.hpp"

namespace heartgen {
namespace {

using namespace testing;
using namespace anatomy;
using namespace image;

double to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
  return norm(p - a - t * (b - a));
}

double dice(const Mask& a, const Mask& b) {
  return 2.0 * static_cast<double>(count(intersect(a, b))) / static_cast<double>(count(a) + count(b));
}

/// Mean of grey(p) over eight points of each voxel, with noise, rounded.
template <class Grey>
CtVolume image_of(const Grid& grid, double noise, Grey&& grey) {
  const Vec3 step = 0.25 * grid.spacing_mm;
  auto image = volume_of(grid, [&](double x, double y, double z) {
    double sum = 0;
    for (int n = 0; n < 8; ++n)
      sum += grey(Vec3{x + (n & 1 ? step.x : -step.x), y + (n & 2 ? step.y : -step.y), z + (n & 4 ? step.z : -step.z)});
    return sum / 8;
  });
  image = noisy(std::move(image), noise);
  CtVolume ct(grid);
  std::transform(image.voxels.begin(), image.voxels.end(), ct.voxels.begin(),
                 [](float v) { return static_cast<std::int16_t>(std::lround(v)); });
  return ct;
}

/// Signed distance to a forked artery; its left branch narrows to `narrow_mm` half-way.
double artery(const Vec3& p, double narrow_mm) {
  const double trunk = to_segment(p, {0, 0, -25}, {0, 0, 0}) - 3;
  const double right = to_segment(p, {0, 0, 0}, {7, 2, 25}) - 2;
  const double squeeze = (2.5 - narrow_mm) * std::exp(-(p.z - 12) * (p.z - 12) / 8);
  const double left = to_segment(p, {0, 0, 0}, {-7, -2, 25}) - (2.5 - squeeze);
  return std::min({trunk, left, right});
}

double vein(const Vec3& p) { return to_segment(p, {5.5, -4, -25}, {5.5, -4, 0}) - 2.5; }

Vec3 middle_of(const Grid& grid) {
  return lps_from_index(grid, {0.5 * static_cast<double>(grid.size[0] - 1), 0.5 * static_cast<double>(grid.size[1] - 1),
                               0.5 * static_cast<double>(grid.size[2] - 1)});
}

/// Contrast fades by `fading` HU from the lower to the upper end.
CtVolume angiogram(const Grid& grid, double narrow_mm, double noise, double fading) {
  return image_of(grid, noise, [&](const Vec3& p) {
    const double distance = artery(p, narrow_mm);
    if (distance < 0) return 380 - fading * (p.z + 25) / 50;
    if (distance < 0.9) return 70.0;
    if (vein(p) < 0) return 150.0;
    return -85.0;
  });
}

Mask truth_of(const Grid& grid, double narrow_mm) {
  return volume_of<std::uint8_t>(grid, [&](double x, double y, double z) {
    return artery({x, y, z}, narrow_mm) < 0 ? 1 : 0;
  });
}

TEST(Vessel, EdgeIsFoundWhateverLiesBesideItAndHoweverContrastFades) {
  for (const Vec3 spacing : {Vec3{0.5, 0.5, 0.5}, Vec3{0.4, 0.4, 0.8}}) {
    const auto grid = grid_of({static_cast<std::int64_t>(28 / spacing.x), static_cast<std::int64_t>(20 / spacing.y),
                               static_cast<std::int64_t>(48 / spacing.z)},
                              spacing);
    const Vec3 seed = middle_of(grid) - Vec3{0, 0, 12};
    const Mask truth = truth_of(grid, 1.2);
    for (const double noise : {5.0, 35.0})
      for (const double fading : {0.0, 90.0}) {
        const Mask found = segment_vessel(angiogram(grid, 1.2, noise, fading), seed);
        EXPECT_GT(dice(found, truth), noise > 20 ? 0.95 : 0.96) << spacing.z << " " << noise << " " << fading;
        EXPECT_NEAR(static_cast<double>(count(found)) / static_cast<double>(count(truth)), 1, 0.05)
            << spacing.z << " " << noise << " " << fading;
      }
  }
}

TEST(Vessel, ForkAndStenosisStayAndTheVeinStaysOut) {
  const auto grid = grid_of({56, 40, 96}, {0.5, 0.5, 0.5});
  const Mask truth = truth_of(grid, 0.9);
  const Mask found = segment_vessel(angiogram(grid, 0.9, 15, 0), middle_of(grid) - Vec3{0, 0, 12});
  EXPECT_EQ(connected_components(found).voxel_count.size(), 2U);  // one piece, both branches to their ends
  const auto area = [&](const Mask& mask, std::int64_t k) {
    const auto slice = 56 * 40;
    return std::count(mask.voxels.begin() + k * slice, mask.voxels.begin() + (k + 1) * slice, std::uint8_t{1});
  };
  for (const std::int64_t k : {40, 60, 71, 72, 80, 94})
    EXPECT_NEAR(static_cast<double>(area(found, k)), static_cast<double>(area(truth, k)),
                0.12 * static_cast<double>(area(truth, k)) + 4)
        << k;
  const auto in_vein = volume_of<std::uint8_t>(grid, [](double x, double y, double z) {
    return vein({x, y, z}) < -0.5 ? 1 : 0;
  });
  EXPECT_EQ(count(intersect(found, in_vein)), 0);
}

/// Distance to the airways: a trachea, a main bronchus, and a bronchus of 2.6 mm that ends open in the lung.
double airway(const Vec3& p) {
  const double bronchus = to_segment(p, {0, 0, -2}, {14, 0, -14}) - 5;
  return std::min(
      {to_segment(p, {0, 0, 0}, {0, 0, 30}) - 8, bronchus, to_segment(p, {14, 0, -14}, {26, 0, -20}) - 2.6});
}

TEST(Trachea, DoesNotLeakThroughABronchusThatOpensIntoTheLung) {
  const auto grid = grid_of({64, 44, 40}, {1.2, 1.2, 1.6});
  const auto in_lung = [](const Vec3& p) { return std::hypot((p.x - 16) / 20, p.y / 22, (p.z + 6) / 22) < 1; };
  const Mask truth = volume_of<std::uint8_t>(grid, [](double x, double y, double z) {
    return airway({x, y, z}) < 0 ? 1 : 0;
  });
  for (const double noise : {10.0, 40.0}) {
    const CtVolume ct = image_of(grid, noise, [&](const Vec3& p) {
      if (airway(p) < 0) return -1000.0;
      if (airway(p) < 1.3 && p.x < 24) return 20.0;  // the last 2 mm have no wall
      return in_lung(p) ? -860.0 : 20.0;
    });
    Landmarks landmarks;
    landmarks.seeds_mm["trachea"] = middle_of(grid) + Vec3{0, 0, 20};
    // The table's limit on volume is far larger than this chest: the contour alone has to hold.
    const Mask found = segment_trachea(ct, {}, landmarks);
    EXPECT_GT(dice(found, truth), 0.92) << noise;
    const auto far = volume_of<std::uint8_t>(grid, [](double x, double y, double z) {
      return airway({x, y, z}) > 3 ? 1 : 0;
    });
    EXPECT_EQ(count(intersect(found, far)), 0) << noise;
  }
}

TEST(Trachea, FollowsAThinBronchusAsFarAsItsWallGoes) {
  const auto grid = grid_of({64, 44, 40}, {1.2, 1.2, 1.6});
  const auto bronchus = [](const Vec3& p) { return to_segment(p, {14, 0, -14}, {26, 0, -20}) - 2; };
  const auto lumen = [&](const Vec3& p) {
    const double wide = to_segment(p, {0, 0, -2}, {14, 0, -14}) - 5;
    return std::min({to_segment(p, {0, 0, 0}, {0, 0, 30}) - 8, wide, bronchus(p)});
  };
  for (const double noise : {10.0, 30.0}) {
    const CtVolume ct = image_of(grid, noise, [&](const Vec3& p) {
      if (lumen(p) < 0) return -1000.0;
      if (lumen(p) < 1.1) return 20.0;
      return std::hypot((p.x - 16) / 20, p.y / 22, (p.z + 6) / 22) < 1 ? -860.0 : 20.0;
    });
    Landmarks landmarks;
    landmarks.seeds_mm["trachea"] = middle_of(grid) + Vec3{0, 0, 20};
    const Mask found = segment_trachea(ct, {}, landmarks);
    const Mask thin = volume_of<std::uint8_t>(grid, [&](double x, double y, double z) {
      return bronchus({x, y, z}) < 0 && to_segment({x, y, z}, {0, 0, -2}, {14, 0, -14}) > 7 ? 1 : 0;
    });
    EXPECT_GT(2 * count(intersect(found, thin)), count(thin)) << noise;  // the rest is more wall than lumen
    const auto far = volume_of<std::uint8_t>(grid, [&](double x, double y, double z) {
      return lumen({x, y, z}) > 2 ? 1 : 0;
    });
    EXPECT_EQ(count(intersect(found, far)), 0) << noise;
  }
}

}  // namespace
}  // namespace heartgen
