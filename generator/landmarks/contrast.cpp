// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/contrast.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "generator/image/statistics.hpp"
#include "model/error.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double unenhanced_hu = 120;       // blood without contrast (45), liver and muscle with it (up to 110)
constexpr double late_phase_hu = 130;       // little contrast, or little of it in a large body: just above heart muscle
constexpr double deep_mm = 4;               // deeper than ribs and small vessels reach
constexpr double min_deep_blood_ml = 40;    // half of a small left ventricle
constexpr double spine_reach_mm = 25;       // in front of the vertebral centre
constexpr double metal_or_streak_hu = 600;  // denser than opacified left-heart blood: undiluted contrast
constexpr double brightest_muscle_hu = 160;

}  // namespace

double bright_threshold(const Volume<float>& coarse) {
  std::vector<float> values = coarse.voxels;
  image::TwoLevels levels = image::two_medians(values, 0.25, 0.75);
  for (const double high : {0.98, 0.90}) {
    if (levels.threshold() > unenhanced_hu) return levels.threshold();
    std::erase_if(values, [&](float v) { return static_cast<double>(v) <= levels.threshold(); });
    if (values.empty()) return late_phase_hu;
    levels = image::two_medians(values, 0.25, high);
  }
  return levels.threshold() > unenhanced_hu ? levels.threshold() : late_phase_hu;
}

Contrast measure_contrast(const chest::WorkingImage& image, const Mask& chest, const chest::Spine& spine,
                          double bright_hu) {
  const Grid& grid = image.smooth.grid;
  const auto& smooth = image.smooth.voxels;
  const auto depth =
      chest::depth_of(chest::mask_where(grid, [&](const Vec3&, std::size_t v) { return smooth[v] > bright_hu; }));
  std::vector<float> deep, soft;
  chest::for_each_voxel(grid, [&](const Vec3& p, std::size_t v) {
    if (!chest.voxels[v]) return;
    const double hu = static_cast<double>(smooth[v]);
    if (hu > 0 && hu < std::min(bright_hu, brightest_muscle_hu)) soft.push_back(smooth[v]);
    const bool spine_or_ribs = p.y > spine.at(p.z).y - spine_reach_mm;
    if (hu > bright_hu && depth.voxels[v] > deep_mm && !spine_or_ribs) deep.push_back(smooth[v]);
  });
  const double deep_ml = static_cast<double>(deep.size()) * grid.voxel_volume_mm3() / 1000;
  if (deep_ml < min_deep_blood_ml && bright_hu > late_phase_hu)
    return measure_contrast(image, chest, spine, late_phase_hu);
  if (deep_ml < min_deep_blood_ml)
    throw UserError(fmt::format("the blood in the heart is not brighter than its muscle: only {:.0f} ml between the "
                                "lungs are above {:.0f} HU",
                                deep_ml, bright_hu),
                    "landmarks",
                    "use a scan with contrast, or give the seeds lv_blood, rv_blood, la_blood, ra_blood and the valve "
                    "planes by hand");
  const image::TwoLevels levels = image::two_medians(deep, 0.2, 0.8);
  return {bright_hu, image::median(soft), levels.high < metal_or_streak_hu ? levels.high : levels.low};
}

}  // namespace heartgen::landmarks
