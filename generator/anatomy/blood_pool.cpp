// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/blood_pool.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "generator/anatomy/faint_right_heart.hpp"
#include "generator/anatomy/hounsfield.hpp"
#include "generator/anatomy/seeds.hpp"
#include "generator/image/box_around.hpp"
#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/modal_intensity.hpp"
#include "generator/image/morphology.hpp"
#include "model/error.hpp"
#include "model/quantile.hpp"
#include "model/tissue.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double smoothing_mm = 0.6;        // against noise; moves a flat edge by nothing
constexpr double core_smoothing_mm = 1.5;   // for the grey values of blood, which vary slowly
constexpr double seed_ball_mm = 4;          // grey values are medians of this ball around a seed
constexpr double min_contrast_hu = 25;      // blood less bright than this above muscle cannot be told from it
constexpr double clear_contrast = 4;        // times the noise: weaker contrasts are cut in the smoother image
constexpr double core_depth_mm = 3;         // blood this deep has its own grey value, free of partial volumes
constexpr double core_fraction = 0.3;       // of the weakest contrast: what counts as blood for the cores
constexpr double threshold_fraction = 0.5;  // the edge lies half-way between muscle and blood
constexpr double grey_step_hu = 4;          // grey values travel with distances as one byte
constexpr double leaflet_ml = 0.3;          // dark islands in blood up to this are leaflets, chordae or noise

Mask above(const Volume<float>& image, double threshold) {
  Mask result(image.grid);
  for (std::size_t v = 0; v < image.voxels.size(); ++v)
    result.voxels[v] = static_cast<double>(image.voxels[v]) > threshold;
  return result;
}

/// Typical grey value of the soft tissue 2 to 6 mm outside the left ventricle's blood near its seed, on the side away
/// from the right heart, whose blood may be as dark as to be taken for muscle; on all sides where too little is left.
double muscle_shell_hu(const Volume<float>& image, const Landmarks& landmarks, double soft_hu, double lv_hu) {
  constexpr double reach_mm = 45;
  constexpr std::size_t min_voxels = 100;
  const auto& seeds = landmarks.seeds_mm;
  const Vec3& lv = seeds.at("lv_blood");
  const Vec3 to_right = 0.5 * (seeds.at("rv_blood") + seeds.at("ra_blood")) - lv;
  const Volume<float> part = crop(image, image::box_around(image.grid, lv, reach_mm));
  const double threshold = (soft_hu + lv_hu) / 2;
  const auto distance = image::distance_to(above(part, threshold));
  std::vector<float> away, all;
  const auto add = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const float grey = part(i, j, k), distance_mm = distance(i, j, k);
    if (!(distance_mm > 2 && distance_mm < 6 && grey > 0 && static_cast<double>(grey) < threshold)) return;
    const Vec3 index{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
    all.push_back(grey);
    if (dot(lps_from_index(part.grid, index) - lv, to_right) < 0) away.push_back(grey);
  };
  const auto& size = part.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) add(i, j, k);
  auto& values = away.size() < min_voxels ? all : away;
  if (values.size() < min_voxels) return soft_hu;
  return std::min(image::modal_intensity(values, tissue::muscle_window_hu), threshold);
}

/// Grey value of the nearest deep blood (the mean of the deep blood around, so without partial volumes) as a byte of
/// `grey_step_hu`; 0 where there is none.
LabelVolume local_blood_byte(const Volume<float>& image, const Mask& core, double cap_hu) {
  Volume<float> weight(image.grid);
  Volume<float> grey(image.grid);
  for (std::size_t v = 0; v < core.voxels.size(); ++v)
    if (core.voxels[v]) weight.voxels[v] = 1, grey.voxels[v] = image.voxels[v];
  weight = image::gaussian(weight, core_smoothing_mm);
  grey = image::gaussian(grey, core_smoothing_mm);
  LabelVolume byte(image.grid);
  for (std::size_t v = 0; v < core.voxels.size(); ++v) {
    if (!core.voxels[v]) continue;
    const double mean = static_cast<double>(grey.voxels[v] / weight.voxels[v]);
    byte.voxels[v] = static_cast<std::uint8_t>(std::clamp(std::min(mean, cap_hu) / grey_step_hu + 0.5, 1.0, 255.0));
  }
  return image::nearest_label(byte, 1e9);
}

Mask fill_islands(const Mask& blood, double limit_ml) {
  Mask dark(blood.grid);
  for (std::size_t v = 0; v < dark.voxels.size(); ++v) dark.voxels[v] = blood.voxels[v] == 0;
  const auto limit = static_cast<std::int64_t>(limit_ml * 1000 / blood.grid.voxel_volume_mm3());
  const Mask kept = image::drop_small_components(dark, limit);
  Mask result(blood.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v) result.voxels[v] = kept.voxels[v] == 0;
  return result;
}

/// Standard deviation of the noise in the blood, from the median deviation from the smoother image.
double noise_hu(const Volume<float>& image, const Volume<float>& smooth, const Mask& blood) {
  std::vector<float> deviation;
  for (std::size_t v = 0; v < blood.voxels.size(); ++v)
    if (blood.voxels[v]) deviation.push_back(std::abs(image.voxels[v] - smooth.voxels[v]));
  return deviation.empty() ? 0 : 1.48 * static_cast<double>(upper_median(deviation));
}

struct SeedGreys {
  double left = 0;     ///< the dimmer of the left ventricle and atrium
  double right = 0;    ///< the dimmer of the right ones
  bool faint = false;  ///< the right ones are hardly brighter than muscle, or darker
};

/// Grey value at a seed that must be in bright blood. It may lie on a papillary muscle: only what is clearly brighter
/// than muscle around it counts.
double bright_grey(const CtVolume& ct, const Landmarks& landmarks, const char* name, double muscle_hu) {
  const double least = muscle_hu + min_contrast_hu;
  const Vec3& seed = landmarks.seeds_mm.at(name);
  const double grey = median_around(ct, seed, seed_ball_mm, least);
  if (grey > least) return grey;
  constexpr double no_tissue_hu = -2000;  // of what is not looked at
  const double all = median_around(ct, seed, seed_ball_mm);
  const auto where = fmt::format("landmarks: seed {} at ({:.1f}, {:.1f}, {:.1f}) mm", name, seed.x, seed.y, seed.z);
  if (all < no_tissue_hu)
    throw UserError("the seed lies outside of what is searched for blood", where,
                    "move it into the chamber's blood; chambers.heart_radius_mm may be too small");
  throw UserError(
      fmt::format("the seed is not in contrast-filled blood: {:.0f} HU there, muscle has {:.0f} HU", all, muscle_hu),
      where, "move the seed into the chamber's blood, or use a CT with contrast agent");
}

SeedGreys seed_greys(const CtVolume& ct, const Landmarks& landmarks, double muscle_hu) {
  const auto bright = [&](const char* name) { return bright_grey(ct, landmarks, name, muscle_hu); };
  const auto plain = [&](const char* name) {
    return median_around(ct, landmarks.seeds_mm.at(name), seed_ball_mm) - muscle_hu;
  };
  SeedGreys grey;
  grey.left = std::min(bright("lv_blood"), bright("la_blood"));
  const double faint = std::min(faint_contrast_hu, faint_contrast_share * (grey.left - muscle_hu));
  grey.faint = std::max(plain("rv_blood"), plain("ra_blood")) < faint;
  grey.right = grey.faint ? grey.left : std::min(bright("rv_blood"), bright("ra_blood"));
  return grey;
}

}  // namespace

BloodPool find_blood(const CtVolume& ct, const Landmarks& landmarks, double soft_hu) {
  const Volume<float> image = image::gaussian(as_float(ct), smoothing_mm);
  const double lv_hu = median_around(ct, landmarks.seeds_mm.at("lv_blood"), seed_ball_mm, soft_hu);
  const double muscle = muscle_shell_hu(image, landmarks, std::min(soft_hu, lv_hu), lv_hu);
  const SeedGreys grey = seed_greys(ct, landmarks, muscle);

  BloodPool result{Mask(ct.grid), image::gaussian(image, core_smoothing_mm), muscle, grey.left};
  const Mask bright = above(result.smooth, muscle + core_fraction * (std::min(grey.left, grey.right) - muscle));
  const Mask core = image::erode(bright, core_depth_mm);
  const LabelVolume local = local_blood_byte(image, core, grey.left);
  const double noise = noise_hu(image, result.smooth, core);
  for (std::size_t v = 0; v < image.voxels.size(); ++v) {
    const double blood_hu = local.voxels[v] ? local.voxels[v] * grey_step_hu : grey.left;
    const double contrast = std::max(blood_hu - muscle, min_contrast_hu);
    const float value = contrast > clear_contrast * noise ? image.voxels[v] : result.smooth.voxels[v];
    result.blood.voxels[v] = static_cast<double>(value) > muscle + threshold_fraction * contrast;
  }
  result.muscles = Mask(ct.grid);
  if (grey.faint) {
    RightHeartBlood faint = faint_right_heart(ct, landmarks, muscle, grey.left);
    result.blood = image::unite(result.blood, faint.blood);
    result.muscles = std::move(faint.muscles);
  }
  result.blood = fill_islands(result.blood, leaflet_ml);
  return result;
}

}  // namespace heartgen::anatomy
