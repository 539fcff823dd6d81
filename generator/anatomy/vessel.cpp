// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/vessel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "generator/anatomy/hounsfield.hpp"
#include "generator/anatomy/seeds.hpp"
#include "generator/image/box_around.hpp"
#include "generator/image/components.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/morphology.hpp"
#include "generator/pde/total_variation.hpp"
#include "model/error.hpp"
#include "model/tissue.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double lumen_ball_mm = 1.5;    // inside the lumen
constexpr double around_ball_mm = 15;    // whose median is taken for the surroundings
constexpr double edge_search_mm = 1.5;   // the edge is looked for this far on both sides of the threshold's surface
constexpr double edge_smoothing_mm = 4;  // grey values of the edge are averaged with this standard deviation

std::string place(const Vec3& seed) {
  return fmt::format("carotid seed at ({:.1f}, {:.1f}, {:.1f}) mm", seed.x, seed.y, seed.z);
}

Volume<float> smoothed(const Volume<float>& image, double lambda) {
  const auto comm = parallel::self();
  auto slab = parallel::scatter(image, comm);
  pde::total_variation_l2(slab, {.lambda = lambda, .iterations = 60}, comm);
  return parallel::gather(slab, comm);
}

/// Downhill direction of an image at a voxel, mm⁻¹, along the grid's axes.
Vec3 downhill(const Volume<float>& image, const Index3& voxel) {
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    Index3 low = voxel, high = voxel;
    low[a] = std::max<std::int64_t>(voxel[a] - 1, 0);
    high[a] = std::min(voxel[a] + 1, image.grid.size[a] - 1);
    const double step = static_cast<double>(std::max<std::int64_t>(high[a] - low[a], 1)) * image.grid.spacing_mm[axis];
    slope[axis] = (image(low[0], low[1], low[2]) - image(high[0], high[1], high[2])) / step;
  }
  return slope;
}

/// The grey value where the image falls most steeply along a direction through a voxel.
double grey_at_edge(const Volume<float>& image, const Index3& voxel, const Vec3& direction) {
  const Vec3& spacing = image.grid.spacing_mm;
  const double step = std::min({spacing.x, spacing.y, spacing.z}) / 2;
  const auto reach = static_cast<int>(std::lround(edge_search_mm / step));
  const auto value = [&](int n) {
    const double way = n * step;
    return sample_linear(image, {static_cast<double>(voxel[0]) + way * direction.x / spacing.x,
                                 static_cast<double>(voxel[1]) + way * direction.y / spacing.y,
                                 static_cast<double>(voxel[2]) + way * direction.z / spacing.z});
  };
  double steepest = -1e30, grey = value(0);
  for (int n = -reach; n <= reach; ++n) {
    const double inside = value(n - 1), outside = value(n + 1);
    if (inside - outside <= steepest) continue;
    steepest = inside - outside;
    grey = (inside + outside) / 2;
  }
  return grey;
}

struct SurfaceVoxel {
  Index3 voxel;
  double grey_at_edge = 0;
};

/// The voxels of a mask that touch its outside, with the grey value of the edge near them.
std::vector<SurfaceVoxel> surface_of(const Mask& mask, const Volume<float>& image, const Volume<float>& smooth) {
  std::vector<SurfaceVoxel> surface;
  const auto& grid = mask.grid;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const auto outside = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
          return grid.contains(x, y, z) && !mask(x, y, z);
        };
        if (!mask(i, j, k)) continue;
        if (!outside(i - 1, j, k) && !outside(i + 1, j, k) && !outside(i, j - 1, k) && !outside(i, j + 1, k) &&
            !outside(i, j, k - 1) && !outside(i, j, k + 1))
          continue;
        const Vec3 direction = normalized(downhill(smooth, {i, j, k}));
        if (norm(direction) > 0) surface.push_back({{i, j, k}, grey_at_edge(image, {i, j, k}, direction)});
      }
  return surface;
}

/// The grey value of the edge everywhere near the surface: a weighted mean over a few millimetres of it.
Volume<float> edge_level(const Grid& grid, const std::vector<SurfaceVoxel>& surface, double far_value) {
  Volume<float> sum(grid), weight(grid);
  for (const auto& [voxel, grey] : surface) {
    sum(voxel[0], voxel[1], voxel[2]) = static_cast<float>(grey);
    weight(voxel[0], voxel[1], voxel[2]) = 1;
  }
  sum = image::gaussian(sum, edge_smoothing_mm);
  weight = image::gaussian(weight, edge_smoothing_mm);
  for (std::size_t v = 0; v < sum.voxels.size(); ++v)
    sum.voxels[v] = weight.voxels[v] > 1e-6F ? sum.voxels[v] / weight.voxels[v] : static_cast<float>(far_value);
  return sum;
}

/// The contour of least surface around what is brighter than the edge, within reach of the threshold's surface: the
/// zero level of the total variation smoothing of the signed evidence (Chambolle 2004).
Mask moved_to_the_edge(const Mask& start, const Volume<float>& image, const Volume<float>& level, double contrast,
                       double curvature_mm) {
  const Mask inner = image::erode(start, edge_search_mm), outer = image::dilate(start, edge_search_mm);
  Volume<float> evidence(start.grid);
  for (std::size_t v = 0; v < evidence.voxels.size(); ++v) {
    const double difference = static_cast<double>(image.voxels[v] - level.voxels[v]) / contrast;
    evidence.voxels[v] = static_cast<float>(inner.voxels[v]    ? 1
                                            : !outer.voxels[v] ? -1
                                                               : std::clamp(difference, -1.0, 1.0));
  }
  if (curvature_mm > 0) evidence = smoothed(evidence, 1 / (2 * curvature_mm));
  Mask lumen(start.grid);
  for (std::size_t v = 0; v < lumen.voxels.size(); ++v) lumen.voxels[v] = evidence.voxels[v] > 0;
  return lumen;
}

}  // namespace

VesselThreshold threshold_vessel(const CtVolume& angiogram, const Vec3& seed_mm, double smoothing_hu,
                                 double maximum_volume_ml) {
  const Index3 seed = seed_voxel(angiogram.grid, "carotid", seed_mm);
  VesselThreshold result;
  result.lumen_hu = median_around(angiogram, seed_mm, lumen_ball_mm);
  result.around_hu = median_around(angiogram, seed_mm, around_ball_mm);
  if (result.lumen_hu < result.around_hu + tissue::carotid_contrast_min_hu)
    throw UserError(fmt::format("the seed is not in a vessel: {:.0f} HU there, {:.0f} HU around it", result.lumen_hu,
                                result.around_hu),
                    place(seed_mm), "move the seed into the lumen, or use an angiogram with contrast agent");
  // A flat zone moves towards its surroundings by area / (2 lambda volume): a ball of 3 mm radius by smoothing_hu.
  result.smooth = as_float(angiogram);
  if (smoothing_hu > 0) result.smooth = smoothed(result.smooth, 1 / (2 * smoothing_hu));
  Mask bright(angiogram.grid);
  for (std::size_t v = 0; v < bright.voxels.size(); ++v)
    bright.voxels[v] = static_cast<double>(result.smooth.voxels[v]) > (result.lumen_hu + result.around_hu) / 2;
  bright(seed[0], seed[1], seed[2]) = 1;
  const auto limit = static_cast<std::int64_t>(maximum_volume_ml * 1000 / angiogram.grid.voxel_volume_mm3());
  result.lumen = image::component_of(bright, seed, limit);
  if (image::count(result.lumen) == 0)
    throw UserError(
        fmt::format("the vessel at the seed has more than {:.0f} ml: it runs into something else", maximum_volume_ml),
        place(seed_mm), "crop the angiogram to the vessel, or raise maximum_volume_ml");
  return result;
}

Mask smoothed_lumen(const Mask& rough, const Vec3& seed_mm, double curvature_mm) {
  Mask lumen = rough;
  if (curvature_mm > 0) {
    Volume<float> evidence(rough.grid);
    for (std::size_t v = 0; v < evidence.voxels.size(); ++v) evidence.voxels[v] = rough.voxels[v] ? 1.0F : -1.0F;
    evidence = smoothed(evidence, 1 / (2 * curvature_mm));
    for (std::size_t v = 0; v < lumen.voxels.size(); ++v) lumen.voxels[v] = evidence.voxels[v] > 0;
  }
  const Index3 seed = seed_voxel(rough.grid, "carotid", seed_mm);
  lumen(seed[0], seed[1], seed[2]) = 1;
  return image::fill_holes(image::component_of(lumen, seed));
}

Mask segment_vessel(const CtVolume& angiogram, const Vec3& seed_mm, const VesselSettings& settings) {
  const auto [start, smooth, lumen, around] =
      threshold_vessel(angiogram, seed_mm, settings.smoothing_hu, settings.maximum_volume_ml);
  const Volume<float> image = as_float(angiogram);
  const auto level = edge_level(angiogram.grid, surface_of(start, image, smooth), (lumen + around) / 2);
  const Mask vessel = moved_to_the_edge(start, image, level, (lumen - around) / 2, settings.curvature_mm);
  return smoothed_lumen(vessel, seed_mm, 0);
}

}  // namespace heartgen::anatomy
