// SPDX-License-Identifier: GPL-3.0-or-later
#include "datasets/phantom/phantom.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "datasets/phantom/companions.hpp"
#include "datasets/phantom/image.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"

namespace heartgen::phantom {
namespace {

void check(const PhantomSettings& settings) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (settings.size[axis] < 8 || settings.size[axis] > 4096)
      throw UserError("a phantom of " + std::to_string(settings.size[axis]) + " voxels along an axis", "phantom --size",
                      "give 8 to 4096 voxels");
    const double spacing = settings.spacing_mm[static_cast<int>(axis)];
    if (!(spacing >= 0.2 && spacing <= 10))
      throw UserError("a voxel spacing of " + std::to_string(spacing) + " mm", "phantom --spacing",
                      "give 0.2 to 10 mm");
  }
  if (!(settings.noise_hu >= 0 && settings.noise_hu <= 500))
    throw UserError("noise out of range", "phantom --noise", "give 0 to 500 HU");
  if (!(settings.point_spread_mm >= 0 && settings.point_spread_mm <= 5))
    throw UserError("point spread out of range", "phantom", "give 0 to 5 mm");
}

/// Tissues that are not uniform in a CT: spongy bone most of all. Blood and heart muscle stay exact.
std::array<float, tissue_count> textures() {
  std::array<float, tissue_count> amplitude{};
  amplitude[static_cast<std::size_t>(Tissue::lung)] = 22;
  amplitude[static_cast<std::size_t>(Tissue::marrow)] = 110;
  amplitude[static_cast<std::size_t>(Tissue::vertebra)] = 110;
  amplitude[static_cast<std::size_t>(Tissue::cortical_bone)] = 150;
  amplitude[static_cast<std::size_t>(Tissue::muscle)] = 14;
  amplitude[static_cast<std::size_t>(Tissue::fat)] = 9;
  amplitude[static_cast<std::size_t>(Tissue::liver)] = 6;
  return amplitude;
}

FiberGrid sample_fibers(const HeartModel& model, const LabelVolume& labels) {
  const Grid& grid = labels.grid;
  FiberGrid fibers{Volume<float>(grid), Volume<float>(grid), Volume<float>(grid)};
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          const auto region = static_cast<Region>(labels(i, j, k));
          if (region != Region::lv_myocardium && region != Region::rv_myocardium && region != Region::papillary)
            continue;
          const Vec3 index{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          const Vec3 fiber = fiber_at(model, lps_from_index(grid, index));
          fibers.x(i, j, k) = static_cast<float>(fiber.x);
          fibers.y(i, j, k) = static_cast<float>(fiber.y);
          fibers.z(i, j, k) = static_cast<float>(fiber.z);
        }
  });
  return fibers;
}

}  // namespace

Grid phantom_grid(const HeartModel& model, const Index3& size, const Vec3& spacing_mm) {
  const auto& anatomy = *model.anatomy;
  const Vec3& stretch = anatomy.body.stretch;
  const double margin = 8;  // mm of air kept around the body
  const Vec3 low{-176 * stretch.x - margin, -94 * stretch.y - margin, -200 * stretch.z};
  const Vec3 high{176 * stretch.x + margin, 153 * stretch.y + margin, 230 * stretch.z};
  Grid grid;
  grid.size = size;
  grid.spacing_mm = spacing_mm;
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = static_cast<double>(size[static_cast<std::size_t>(axis)] - 1) * spacing_mm[axis];
    double start = anatomy.heart.middle[axis] - extent / 2;
    if (extent >= high[axis] - low[axis])
      start = 0.5 * (low[axis] + high[axis] - extent);
    else
      start = std::clamp(start, low[axis], high[axis] - extent);
    grid.origin_mm[axis] = std::round(start * 100) / 100;
  }
  return grid;
}

Phantom make_phantom(const PhantomSettings& settings) {
  check(settings);
  Phantom phantom;
  phantom.model = make_heart_model(settings.variant, settings.overrides, settings.grey);
  phantom.landmarks = landmarks_of(phantom.model);
  const auto& anatomy = *phantom.model.anatomy;
  const Grid grid = phantom_grid(phantom.model, settings.size, settings.spacing_mm);
  auto samples = sample_volume(anatomy, grid);
  auto grey = grey_volume(anatomy, samples, anatomy.hu);
  add_texture(grey, samples.tissues, textures(), 0x7E + static_cast<std::uint64_t>(settings.variant));
  blur(grey, settings.point_spread_mm);
  add_noise(grey, settings.noise_hu, 0xC7 + static_cast<std::uint64_t>(settings.variant));
  phantom.ct = rounded(grey, -1024, 3071);
  phantom.labels = std::move(samples.regions);
  if (settings.fibers) phantom.fibers = sample_fibers(phantom.model, phantom.labels);
  if (settings.companions) {
    add_torso_mr(phantom, settings.variant);
    add_carotid(phantom, settings.variant, settings.noise_hu);
  }
  return phantom;
}

}  // namespace heartgen::phantom
