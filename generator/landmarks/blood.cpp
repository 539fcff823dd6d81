// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/blood.hpp"

#include <algorithm>
#include <array>

#include "generator/image/components.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/statistics.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::landmarks {
namespace {

constexpr int reach_voxels = 4;           // 6 mm: from the middle of a thin wall to blood on both of its sides
constexpr double local_sigma_mm = 1.5;    // noise does not decide the local contrast
constexpr double over_blood = 1.05;       // streaks brighter than the left heart's blood do not raise the threshold
constexpr double min_above_soft_hu = 45;  // noise of muscle stays below
constexpr double weak_contrast_hu = 60;   // bright threshold this near to soft tissue: contrast is weak
constexpr double strong_contrast_floor_hu = 120;

/// Maximum over each row window of half width 0 to reach_voxels.
std::vector<Volume<float>> row_maxima(const Volume<float>& image) {
  std::vector<Volume<float>> maxima{image};
  const std::int64_t nx = image.grid.size[0], ny = image.grid.size[1], nz = image.grid.size[2];
  for (int half = 1; half <= reach_voxels; ++half) {
    maxima.push_back(image);
    parallel::parallel_for(0, ny * nz, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t row = begin; row < end; ++row) {
        const float* in = image.voxels.data() + row * nx;
        float* out = maxima.back().voxels.data() + row * nx;
        for (std::int64_t i = 0; i < nx; ++i) {
          const auto from = std::max<std::int64_t>(i - half, 0), to = std::min(i + half, nx - 1);
          out[i] = *std::max_element(in + from, in + to + 1);
        }
      }
    });
  }
  return maxima;
}

/// Grey dilation by a ball of reach_voxels: the maximum over the rows that make up the ball.
Volume<float> brightest_within_reach(const Volume<float>& image) {
  const auto rows = row_maxima(image);
  Volume<float> result = image;
  const std::int64_t nx = image.grid.size[0], ny = image.grid.size[1], nz = image.grid.size[2];
  parallel::parallel_for(0, nz, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < ny; ++j)
        for (std::int64_t dk = -reach_voxels; dk <= reach_voxels; ++dk)
          for (std::int64_t dj = -reach_voxels; dj <= reach_voxels; ++dj) {
            const std::int64_t left = reach_voxels * reach_voxels - dk * dk - dj * dj;
            if (left < 0 || k + dk < 0 || k + dk >= nz || j + dj < 0 || j + dj >= ny) continue;
            const auto half = static_cast<std::size_t>(std::sqrt(static_cast<double>(left)));
            const float* in = rows[half].voxels.data() + image.grid.offset(0, j + dj, k + dk);
            float* out = result.voxels.data() + image.grid.offset(0, j, k);
            for (std::int64_t i = 0; i < nx; ++i) out[i] = std::max(out[i], in[i]);
          }
  });
  return result;
}

}  // namespace

Mask local_blood(const chest::WorkingImage& image, const Contrast& contrast, double fraction) {
  const auto local = brightest_within_reach(image::gaussian(image.hu, local_sigma_mm));
  const double soft = contrast.soft_hu;
  const double floor =
      contrast.bright_hu < soft + weak_contrast_hu ? 0.5 * (soft + contrast.bright_hu) : strong_contrast_floor_hu;
  const double ceiling = soft + fraction * (contrast.blood_hu - soft);
  return chest::mask_where(image.smooth.grid, [&](const Vec3&, std::size_t v) {
    const double brightest = std::min(static_cast<double>(local.voxels[v]), over_blood * contrast.blood_hu);
    const double threshold = std::min(std::max(soft + fraction * (brightest - soft), floor), ceiling);
    return static_cast<double>(image.smooth.voxels[v]) > std::max(threshold, soft + min_above_soft_hu);
  });
}

Mask without_spine(const Mask& chest, const chest::Spine& spine) {
  constexpr double vertebra_radius_mm = 20, in_front_mm = 10;
  return chest::mask_where(chest.grid, [&](const Vec3& p, std::size_t v) {
    if (!chest.voxels[v]) return false;
    const Vec3 vertebra = spine.at(p.z);
    return p.y <= vertebra.y - in_front_mm && math::hypot(p.x - vertebra.x, p.y - vertebra.y) >= vertebra_radius_mm;
  });
}

Vec3 heart_centre(const Mask& blood, const Mask& region) {
  constexpr double deep_mm = 5, search_sigma_mm = 25, ball_mm = 65;
  constexpr int shifts = 5;
  const auto depth = chest::depth_of(blood);
  Volume<float> core(blood.grid);
  std::vector<Vec3> points;
  chest::for_each_voxel(blood.grid, [&](const Vec3& p, std::size_t v) {
    if (depth.voxels[v] <= deep_mm || !region.voxels[v]) return;
    core.voxels[v] = 1;
    points.push_back(p);
  });
  if (points.empty())
    throw UserError("no pool of bright blood is between the lungs", "landmarks",
                    "use a scan that shows the heart with contrast, or give the seeds by hand");
  const auto density = image::gaussian(core, search_sigma_mm);
  const auto peak = std::max_element(density.voxels.begin(), density.voxels.end()) - density.voxels.begin();
  const auto row = peak / blood.grid.size[0];
  Vec3 centre =
      chest::position_mm(blood.grid, peak % blood.grid.size[0], row % blood.grid.size[1], row / blood.grid.size[1]);
  for (int shift = 0; shift < shifts; ++shift) {
    std::vector<Vec3> near;
    std::copy_if(points.begin(), points.end(), std::back_inserter(near),
                 [&](const Vec3& p) { return norm(p - centre) < ball_mm; });
    if (!near.empty()) centre = image::mean(near);
  }
  return centre;
}

Mask heart_blood(const Mask& blood, const Mask& region, const Vec3& centre) {
  constexpr double largest_island_mm3 = 300;
  Mask result = chest::mask_where(blood.grid, [&](const Vec3& p, std::size_t v) {
    return blood.voxels[v] && region.voxels[v] && norm(p - centre) < heart_reach_mm;
  });
  const auto islands = image::connected_components(chest::inverse(result));
  const auto limit = static_cast<std::int64_t>(largest_island_mm3 / blood.grid.voxel_volume_mm3());
  for (std::size_t v = 0; v < result.voxels.size(); ++v) {
    const auto label = static_cast<std::size_t>(islands.label.voxels[v]);
    if (label != 0 && islands.voxel_count[label] < limit) result.voxels[v] = 1;
  }
  return result;
}

}  // namespace heartgen::landmarks
