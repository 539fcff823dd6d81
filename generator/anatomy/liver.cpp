// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/liver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "generator/anatomy/seeds.hpp"
#include "generator/image/box_around.hpp"
#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/morphology.hpp"
#include "model/crop.hpp"
#include "model/error.hpp"
#include "model/priors.hpp"
#include "model/quantile.hpp"
#include "model/tissue.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double smoothing_mm = 2;
constexpr double seed_ball_mm = 8;
constexpr double smallest_opening_mm = 3, largest_opening_mm = 12;

Volume<float> smoothed(const CtVolume& ct) {
  Volume<float> image(ct.grid);
  std::copy(ct.voxels.begin(), ct.voxels.end(), image.voxels.begin());
  return image::gaussian(image, smoothing_mm);
}

/// Empty where no opening parts the liver from its neighbours.
Mask grow(const Volume<float>& image, const Mask& free, const Index3& seed, double grey) {
  const double spread = tissue::liver_spread_hu;
  Mask alike(free.grid);
  for (std::size_t v = 0; v < alike.voxels.size(); ++v)
    alike.voxels[v] = free.voxels[v] && std::abs(static_cast<double>(image.voxels[v]) - grey) < spread;
  const auto limit = static_cast<std::int64_t>(priors::liver_max_ml * 1000 / free.grid.voxel_volume_mm3());
  constexpr double step_mm = 3;
  constexpr int steps = 1 + static_cast<int>((largest_opening_mm - smallest_opening_mm) / step_mm);
  for (int step = 0; step < steps; ++step) {
    const double radius = smallest_opening_mm + step * step_mm;
    const Mask core = image::component_of(image::erode(alike, radius), seed, limit);
    if (image::count(core) == 0) continue;
    const Mask liver = image::intersect(image::dilate(core, radius), alike);
    if (image::count(liver) <= limit)
      return image::intersect(image::fill_holes(image::close(liver, priors::liver_vessel_radius_mm)), free);
  }
  return Mask(free.grid);
}

/// Index along the first axis that parts the lungs' voxels in halves.
std::int64_t middle_of(const Mask& lung) {
  const auto [nx, ny, nz] = lung.grid.size;
  std::vector<std::int64_t> voxels(static_cast<std::size_t>(nx), 0);
  for (std::size_t v = 0; v < lung.voxels.size(); ++v) voxels[v % static_cast<std::size_t>(nx)] += lung.voxels[v] != 0;
  std::int64_t below = 0, i = 0;
  for (const std::int64_t all = image::count(lung); i < nx && 2 * below < all; ++i)
    below += voxels[static_cast<std::size_t>(i)];
  return i;
}

/// Soft tissue straight below the right lung.
Mask soft_under_lung(const Mask& lung, const Mask& soft, std::int64_t middle) {
  const auto& grid = lung.grid;
  const auto reach = static_cast<std::int64_t>(priors::liver_under_lung_mm / grid.spacing_mm.z);
  Mask under(grid);
  for (std::int64_t j = 0; j < grid.size[1]; ++j)
    for (std::int64_t i = 0; i < middle; ++i) {
      std::int64_t k = 0;
      while (k < grid.size[2] && !lung(i, j, k)) ++k;
      if (k == grid.size[2]) continue;
      const std::int64_t lowest = std::max<std::int64_t>(k - reach, 0);
      while (k-- > lowest) under(i, j, k) = soft(i, j, k);
    }
  return under;
}

/// The voxel of `among` that is deepest inside `soft`; nothing where none is deep enough.
std::optional<Index3> deepest(const Mask& soft, const Mask& among) {
  Mask outside(soft.grid);
  for (std::size_t v = 0; v < outside.voxels.size(); ++v) outside.voxels[v] = !soft.voxels[v];
  const auto depth = image::distance_to(outside, 1e3F);
  auto most = static_cast<float>(priors::liver_depth_min_mm);
  std::optional<Index3> place;
  const auto& size = soft.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i)
        if (among(i, j, k) && depth(i, j, k) > most) {
          most = depth(i, j, k);
          place = Index3{i, j, k};
        }
  return place;
}

/// What is free below the middle of the lungs' height: no liver reaches higher. Empty without a lung.
Box lower_part(const Mask& lung, const Mask& free) {
  const auto is_set = [](std::uint8_t v) { return v != 0; };
  const Box lungs = bounding_box(lung, 0, is_set);
  if (lungs.empty()) return {};
  Box box = bounding_box(free, 0, is_set);
  box.end[2] = std::min(box.end[2], (lungs.begin[2] + lungs.end[2]) / 2);
  return box;
}

/// Whether a region has a liver's size, side and evenness.
bool is_plausible(const Mask& liver, const Volume<float>& image, std::int64_t middle) {
  std::vector<float> greys;
  std::int64_t right = 0;
  for (std::size_t v = 0; v < liver.voxels.size(); ++v) {
    if (!liver.voxels[v]) continue;
    greys.push_back(image.voxels[v]);
    right += static_cast<std::int64_t>(v) % liver.grid.size[0] < middle;
  }
  if (static_cast<double>(greys.size()) * liver.grid.voxel_volume_mm3() < priors::liver_min_ml * 1000) return false;
  const auto quartile = [&](std::size_t n) { return static_cast<double>(ranked(greys, n * greys.size() / 4)); };
  return static_cast<double>(right) > priors::liver_right_share_min * static_cast<double>(greys.size()) &&
         quartile(3) - quartile(1) < tissue::liver_quartiles_max_hu;
}

}  // namespace

Mask segment_liver(const CtVolume& ct, const Mask& free, const Vec3& seed_mm) {
  const Index3 seed = seed_voxel(ct.grid, "liver", seed_mm);
  const double grey = median_around(ct, seed_mm, seed_ball_mm);
  Mask liver = grow(smoothed(ct), free, seed, grey);
  if (image::count(liver) > 0) return liver;
  throw UserError(fmt::format("no liver-sized region of {:.0f} HU is found at the seed", grey),
                  fmt::format("landmarks: seed liver at ({:.1f}, {:.1f}, {:.1f}) mm", seed_mm.x, seed_mm.y, seed_mm.z),
                  "move the seed into the middle of the liver, or leave it out");
}

Mask find_liver(const CtVolume& ct_all, const Mask& lung_all, const Mask& free_all) {
  const Box box = lower_part(lung_all, free_all);
  if (box.empty()) return Mask(ct_all.grid);
  const CtVolume ct = crop(ct_all, box);
  const Mask lung = crop(lung_all, box), free = crop(free_all, box);
  const Volume<float> image = smoothed(ct);
  Mask soft(ct.grid);
  for (std::size_t v = 0; v < soft.voxels.size(); ++v)
    soft.voxels[v] = free.voxels[v] && image.voxels[v] > tissue::liver_min_hu && image.voxels[v] < tissue::liver_max_hu;
  const std::int64_t middle = middle_of(lung_all) - box.begin[0];
  const auto seed = deepest(soft, soft_under_lung(lung, soft, middle));
  if (!seed) return Mask(ct_all.grid);
  const Vec3 place = lps_from_index(
      ct.grid, {static_cast<double>((*seed)[0]), static_cast<double>((*seed)[1]), static_cast<double>((*seed)[2])});
  const Mask liver = grow(image, free, *seed, median_around(ct, place, seed_ball_mm));
  return is_plausible(liver, image, middle) ? image::pasted(ct_all.grid, liver, box) : Mask(ct_all.grid);
}

}  // namespace heartgen::anatomy
