// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/pools.hpp"

#include <algorithm>
#include <cmath>

#include "generator/image/distance.hpp"
#include "generator/image/modal_intensity.hpp"
#include "generator/image/morphology.hpp"
#include "generator/image/statistics.hpp"
#include "generator/parallel/threads.hpp"
#include "model/tissue.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double smallest_pool_ml = 1.5;
constexpr double shell_from_mm = 4, shell_to_mm = 7.5;  // beyond partial volume, within the left ventricle's wall
constexpr double grey_from_mm = 3, grey_to_mm = 6.5;    // so much nearer that thin walls are seen
constexpr float fat_hu = -10;
constexpr double brightest_muscle_hu = 180;
constexpr double thick_mm = 10;  // no wall of a heart is thicker than 20 mm: liver and other muscles are
constexpr float deep_mm = 3;     // inside, where the wall does not blur the grey value
constexpr std::int64_t margin_voxels = 8;

/// Soft tissue in sheets: what a ventricular wall looks like.
Mask thin_muscle(const Volume<float>& smooth, double bright_hu) {
  const double limit = std::min(bright_hu, brightest_muscle_hu);
  const Mask muscle = chest::mask_where(smooth.grid, [&](const Vec3&, std::size_t v) {
    return smooth.voxels[v] > fat_hu && static_cast<double>(smooth.voxels[v]) <= limit;
  });
  return image::subtract(muscle, image::open(muscle, thick_mm));
}

struct Extent {
  std::int64_t voxels = 0;
  Box box{{INT64_MAX, INT64_MAX, INT64_MAX}, {0, 0, 0}};
  Vec3 sum;
};

std::vector<Extent> extents_of(const image::Basins& basins) {
  std::vector<Extent> extents(static_cast<std::size_t>(basins.count) + 1);
  const Grid& grid = basins.label.grid;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        if (basins.label.voxels[v] == 0) continue;
        Extent& e = extents[static_cast<std::size_t>(basins.label.voxels[v])];
        const Index3 at{i, j, k};
        ++e.voxels;
        e.sum += chest::position_mm(grid, i, j, k);
        for (std::size_t a = 0; a < 3; ++a) {
          e.box.begin[a] = std::min(e.box.begin[a], at[a]);
          e.box.end[a] = std::max(e.box.end[a], at[a] + 1);
        }
      }
  return extents;
}

Box grown(Box box, const Grid& grid) {
  for (std::size_t a = 0; a < 3; ++a) {
    box.begin[a] = std::max<std::int64_t>(box.begin[a] - margin_voxels, 0);
    box.end[a] = std::min(box.end[a] + margin_voxels, grid.size[a]);
  }
  return box;
}

void measure_shell(const Volume<float>& smooth, const Mask& muscle, const Volume<std::int32_t>& labels,
                   std::int32_t label, Pool& pool) {
  const auto distance = image::distance_to(
      chest::mask_where(labels.grid, [&](const Vec3&, std::size_t v) { return labels.voxels[v] == label; }));
  double shell = 0, in_muscle = 0, dark = 0;
  std::vector<float> grey;
  for (std::size_t v = 0; v < distance.voxels.size(); ++v) {
    const double mm = static_cast<double>(distance.voxels[v]);
    if (muscle.voxels[v] && mm > grey_from_mm && mm < grey_to_mm) grey.push_back(smooth.voxels[v]);
    if (mm <= shell_from_mm || mm >= shell_to_mm) continue;
    shell += 1;
    in_muscle += muscle.voxels[v];
    dark += smooth.voxels[v] < fat_hu;
  }
  if (shell == 0) return;
  pool.muscle_share = in_muscle / shell;
  pool.fat_or_air_share = dark / shell;
  pool.shell_hu = image::modal_intensity(grey, tissue::muscle_window_hu);
}

void measure_grey(const Volume<float>& hu, const Volume<float>& smooth, const Volume<float>& depth,
                  const Volume<std::int32_t>& labels, std::int32_t label, Pool& pool) {
  std::vector<float> all;
  double n = 0, sum = 0, squares = 0;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    if (labels.voxels[v] != label) continue;
    all.push_back(hu.voxels[v]);
    pool.depth_mm = std::max(pool.depth_mm, static_cast<double>(depth.voxels[v]));
    if (depth.voxels[v] <= deep_mm) continue;
    const double value = static_cast<double>(smooth.voxels[v]);
    n += 1;
    sum += value;
    squares += value * value;
  }
  pool.hu = image::median(all);
  if (n > 0) pool.hu_deviation = std::sqrt(std::max(squares / n - sum / n * (sum / n), 0.0));
}

}  // namespace

Pools measure_pools(const chest::WorkingImage& image, const image::Basins& basins, const Contrast& contrast,
                    const chest::Spine& spine, const Vec3& heart_centre) {
  const Grid& grid = basins.label.grid;
  const Mask muscle = thin_muscle(image.smooth, contrast.bright_hu);
  const auto extents = extents_of(basins);
  Pools pools;
  for (std::int32_t label = 1; label <= basins.count; ++label) {
    const Extent& extent = extents[static_cast<std::size_t>(label)];
    Pool pool;
    pool.volume_ml = static_cast<double>(extent.voxels) * grid.voxel_volume_mm3() / 1000;
    if (pool.volume_ml < smallest_pool_ml) continue;
    pool.centre_mm = extent.sum / static_cast<double>(extent.voxels);
    pool.bottom_mm = chest::position_mm(grid, 0, 0, extent.box.begin[2]).z;
    pool.top_mm = chest::position_mm(grid, 0, 0, extent.box.end[2] - 1).z;
    const auto box = grown(extent.box, grid);
    const auto labels = crop(basins.label, box);
    const auto smooth = crop(image.smooth, box);
    measure_shell(smooth, crop(muscle, box), labels, label, pool);
    measure_grey(crop(image.hu, box), smooth, crop(basins.depth_mm, box), labels, label, pool);
    const Vec3 vertebra = spine.at(pool.centre_mm.z);
    pool.from_heart_mm = norm(pool.centre_mm - heart_centre);
    pool.left_mm = pool.centre_mm.x - vertebra.x;
    pool.front_mm = vertebra.y - pool.centre_mm.y;
    pools.emplace(label, pool);
  }
  return pools;
}

double relative_width(const image::Basins& basins, const Pools& pools, std::int32_t a, std::int32_t b) {
  return basins.width(a, b) / std::min(pools.at(a).depth_mm, pools.at(b).depth_mm);
}

}  // namespace heartgen::landmarks
