// SPDX-License-Identifier: GPL-3.0-or-later
// Signs between voxels against the values there.
#include "generator/mesh/level_set_at.hpp"

#include <gtest/gtest.h>

#include <random>

namespace heartgen {
namespace {

LevelSet volume_of(const Index3& size) {
  Grid grid;
  grid.size = size;
  grid.spacing_mm = {0.5, 0.7, 1.2};
  return LevelSet(grid);
}

LevelSet random_level_set(const Index3& size, std::mt19937_64& random) {
  auto volume = volume_of(size);
  std::normal_distribution<float> value(0, 1);
  float before = 0;
  for (auto& voxel : volume.voxels) voxel = before = 0.9F * before + 0.3F * value(random);  // runs of one sign
  return volume;
}

// Also beyond the borders, and in volumes of one voxel along an axis.
TEST(LevelSetAt, SignsAreThoseOfTheValues) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share(-0.2, 1.2);
  for (const Index3& size : {Index3{9, 7, 5}, Index3{1, 8, 3}, Index3{33, 1, 4}, Index3{6, 5, 1}, Index3{1, 1, 1}}) {
    const auto volume = random_level_set(size, random);
    const auto signs = mesh::signs_of(volume);
    int negative = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 extent{0.5 * static_cast<double>(size[0]), 0.7 * static_cast<double>(size[1]),
                        1.2 * static_cast<double>(size[2])};
      const Vec3 p{share(random) * extent.x, share(random) * extent.y, share(random) * extent.z};
      const bool is_negative = mesh::value_at(volume, p) < 0;
      negative += is_negative;
      ASSERT_EQ(mesh::is_negative_at(volume, signs, p), is_negative) << p.x << ' ' << p.y << ' ' << p.z;
    }
    const bool is_either = negative > 100 && negative < 3900;
    EXPECT_TRUE(is_either || volume.voxels.size() == 1) << negative;
  }
}

TEST(LevelSetAt, ValuesAreThoseOfAPlane) {
  auto volume = volume_of({6, 5, 4});
  const auto plane = [](const Vec3& p) { return 0.3 * p.x - 1.1 * p.y + 0.7 * p.z + 0.2; };
  for (std::int64_t k = 0; k < 4; ++k)
    for (std::int64_t j = 0; j < 5; ++j)
      for (std::int64_t i = 0; i < 6; ++i)
        volume(i, j, k) = static_cast<float>(
            plane({0.5 * static_cast<double>(i), 0.7 * static_cast<double>(j), 1.2 * static_cast<double>(k)}));
  const Vec3 p{1.13, 0.9, 2.2};
  const auto found = mesh::sample(volume, p);
  EXPECT_NEAR(mesh::value_at(volume, p), plane(p), 1e-6);
  EXPECT_NEAR(found.value, plane(p), 1e-6);
  EXPECT_NEAR(found.gradient.x, 0.3, 1e-5);
  EXPECT_NEAR(found.gradient.y, -1.1, 1e-5);
  EXPECT_NEAR(found.gradient.z, 0.7, 1e-5);
}

}  // namespace
}  // namespace heartgen
