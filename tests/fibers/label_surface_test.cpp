// Surfaces of labels below the voxel, against half spaces and the groove between two of them.
#include "generator/atlas/label_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "generator/atlas/compact_wall.hpp"
#include "generator/atlas/distance_map.hpp"
#include "generator/atlas/resample.hpp"

namespace heart {
namespace {

constexpr Vec3 middle_mm{24.3, 23.8, 24.1};

struct Smoothed {
  Mask inside;
  LevelSet surface;
};

Smoothed smoothed_surface(const std::function<bool(const Vec3& from_middle)>& inside) {
  constexpr double smoothing_voxels = 2.2;
  Grid grid;
  grid.size = {49, 49, 49};
  Smoothed result{Mask(grid), {}};
  for (std::size_t v = 0; v < result.inside.voxels.size(); ++v)
    result.inside.voxels[v] = inside(atlas::voxel_center(grid, static_cast<std::int64_t>(v)) - middle_mm);
  result.surface = atlas::signed_distance(result.inside, smoothing_voxels);
  return result;
}

/// Greatest and mean distance of the surface from where it should be, at places that step along a line.
struct Off {
  double most = 0, mean = 0;
};

Off off_along(const LevelSet& surface, const Vec3& line) {
  Off off;
  for (int n = -10; n <= 10; ++n) {
    const double d = std::abs(atlas::distance_along_gradient(surface, middle_mm + 0.8 * n * line));
    off.most = std::max(off.most, d);
    off.mean += d / 21;
  }
  return off;
}

TEST(LabelSurface, AGrooveKeepsItsBottom) {
  const Vec3 a = normalized({1, 0.4, 0.3}), line = normalized(cross(a, {0.2, 1, -0.5})), b = cross(line, a);
  auto groove = smoothed_surface([&](const Vec3& d) { return dot(d, a) < 0 || dot(d, b) < 0; });
  const auto before = off_along(groove.surface, line);
  atlas::respect_labels(groove.inside, 1.2, 6, groove.surface);
  const auto after = off_along(groove.surface, line);
  EXPECT_GT(before.mean, 0.5);
  EXPECT_LT(after.mean, 0.75 * before.mean);
}

TEST(LabelSurface, APlaneStaysWhereItIs) {
  for (const Vec3& normal : {normalized({1, 0.4, 0.3}), normalized({1, 1, 0}), normalized({0.1, 0.05, -1})}) {
    auto plane = smoothed_surface([&](const Vec3& d) { return dot(d, normal) < 0; });
    const Vec3 line = normalized(cross(normal, {0.3, -0.2, 1}));
    const auto before = off_along(plane.surface, line);
    atlas::respect_labels(plane.inside, 1.2, 6, plane.surface);
    const auto after = off_along(plane.surface, line);
    EXPECT_LT(after.mean, before.mean + 0.02);
    EXPECT_LT(after.most, before.most + 0.02);
  }
}

TEST(LabelSurface, ASingleVoxelOnTheWrongSideHardlyCounts) {
  auto plane = smoothed_surface([](const Vec3& d) { return d.z < 0; });
  plane.inside(24, 24, 26) = 1;
  const Vec3 below{24, 24, middle_mm.z};
  const double before = atlas::distance_along_gradient(plane.surface, below);
  atlas::respect_labels(plane.inside, 1.2, 6, plane.surface);
  EXPECT_NEAR(atlas::distance_along_gradient(plane.surface, below), before, 0.5);
}

}  // namespace
}  // namespace heart
