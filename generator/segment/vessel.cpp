#include "generator/segment/vessel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "generator/segment/box_around.hpp"
#include "generator/segment/components.hpp"
#include "generator/segment/morphology.hpp"
#include "generator/segment/seeds.hpp"
#include "generator/segment/total_variation.hpp"
#include "model/error.hpp"

namespace heart::segment {
namespace {

constexpr double lumen_radius_mm = 1.5;  // ball inside the lumen
constexpr double around_mm = 15;         // ball whose median is taken for the surroundings
constexpr double least_contrast_hu = 50;

std::string place(const Vec3& seed) {
  return fmt::format("carotid seed at ({:.1f}, {:.1f}, {:.1f}) mm", seed.x, seed.y, seed.z);
}

Volume<float> smoothed(const CtVolume& angiogram, double smoothing_hu) {
  const auto comm = parallel::self();
  Volume<float> image(angiogram.grid);
  std::copy(angiogram.voxels.begin(), angiogram.voxels.end(), image.voxels.begin());
  if (smoothing_hu <= 0) return image;
  auto slab = parallel::scatter(image, comm);
  // A flat zone moves towards its surroundings by area / (2 lambda volume): a ball of 3 mm radius by smoothing_hu.
  total_variation_l2(slab, {.lambda = 1 / (2 * smoothing_hu), .iterations = 60}, comm);
  return parallel::gather(slab, comm);
}

}  // namespace

Mask segment_vessel(const CtVolume& angiogram, const Vec3& seed_mm, const VesselSettings& settings) {
  const Index3 seed = seed_voxel(angiogram.grid, "carotid", seed_mm);
  const double lumen = median_around(angiogram, seed_mm, lumen_radius_mm);
  const double around = median_around(angiogram, seed_mm, around_mm);
  if (lumen < around + least_contrast_hu)
    throw UserError(fmt::format("the seed is not in a vessel: {:.0f} HU there, {:.0f} HU around it", lumen, around),
                    place(seed_mm), "move the seed into the lumen, or use an angiogram with contrast agent");
  const Volume<float> image = smoothed(angiogram, settings.smoothing_hu);
  Mask bright(angiogram.grid);
  for (std::size_t v = 0; v < bright.voxels.size(); ++v)
    bright.voxels[v] = static_cast<double>(image.voxels[v]) > (lumen + around) / 2;
  bright(seed[0], seed[1], seed[2]) = 1;
  const auto limit = static_cast<std::int64_t>(settings.maximum_volume_ml * 1000 / angiogram.grid.voxel_volume_mm3());
  Mask vessel = component_of(bright, seed, limit);
  if (count(vessel) == 0)
    throw UserError(fmt::format("the vessel at the seed has more than {:.0f} ml: it runs into something else",
                                settings.maximum_volume_ml),
                    place(seed_mm), "crop the angiogram to the vessel, or raise maximum_volume_ml");
  return fill_holes(vessel);
}

}  // namespace heart::segment
