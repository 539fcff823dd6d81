// SPDX-License-Identifier: GPL-3.0-or-later
// The switch that keeps or closes trabeculae.
#include <gtest/gtest.h>

#include <cmath>

#include "anatomy/toy_heart.hpp"
#include "generator/anatomy/chambers.hpp"

namespace heartgen::anatomy {
namespace {

/// Meridional ridges of muscle, 3 mm high, on the inside of the left ventricle.
ToyHeart ridged_heart() {
  ToyHeart heart = toy_heart();
  std::size_t v = 0;
  for (std::int64_t k = 0; k < heart.ct.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < heart.ct.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < heart.ct.grid.size[0]; ++i, ++v) {
        const Vec3 d =
            lps_from_index(heart.ct.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}) -
            toy::lv;
        const bool ridge = std::cos(10 * std::atan2(d.y, d.x)) > 0.2 && d.z < 0 && norm(d) > 13 && norm(d) < 16;
        if (ridge && heart.truth.voxels[v] == tag(Region::lv_blood)) heart.ct.voxels[v] = 110;
      }
  return heart;
}

/// Faces between the left ventricle's blood and anything else.
std::int64_t surface_faces(const LabelVolume& labels) {
  std::int64_t faces = 0;
  const auto& size = labels.grid.size;
  const auto in = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return labels(i, j, k) == tag(Region::lv_blood);
  };
  for (std::int64_t k = 0; k + 1 < size[2]; ++k)
    for (std::int64_t j = 0; j + 1 < size[1]; ++j)
      for (std::int64_t i = 0; i + 1 < size[0]; ++i)
        faces += (in(i, j, k) != in(i + 1, j, k)) + (in(i, j, k) != in(i, j + 1, k)) + (in(i, j, k) != in(i, j, k + 1));
  return faces;
}

TEST(Trabeculae, AreKeptUnlessTheRecipeClosesThem) {
  const ToyHeart heart = ridged_heart();
  const ToyHeart smooth = toy_heart();
  ChamberSettings closed;
  closed.close_trabeculae_mm = 5;
  const auto kept_labels = anatomy::split_chambers(heart.ct, heart.tree, heart.landmarks, {});
  const auto closed_labels = anatomy::split_chambers(heart.ct, heart.tree, heart.landmarks, closed);
  const auto kept = surface_faces(kept_labels), after = surface_faces(closed_labels);
  const auto ideal = surface_faces(anatomy::split_chambers(smooth.ct, smooth.tree, smooth.landmarks, {}));
  EXPECT_GT(static_cast<double>(kept), 1.12 * static_cast<double>(ideal));
  EXPECT_LT(static_cast<double>(after), 1.06 * static_cast<double>(ideal));
  EXPECT_GT(dice(closed_labels, heart.truth, Region::lv_blood),
            dice(kept_labels, heart.truth, Region::lv_blood) + 0.02);
}

}  // namespace
}  // namespace heartgen::anatomy
