#include "generator/segment/liver.hpp"

#include <fmt/format.h>

#include <cmath>

#include "generator/segment/components.hpp"
#include "generator/segment/gaussian.hpp"
#include "generator/segment/morphology.hpp"
#include "generator/segment/seeds.hpp"
#include "model/error.hpp"

namespace heart::segment {
namespace {

constexpr double smoothing_mm = 2;
constexpr double seed_ball_mm = 8;
constexpr double tolerance_hu = 30;  // around the seed's grey value
constexpr double maximum_ml = 2800;  // more is a leak into other soft tissue
constexpr double smallest_opening_mm = 3, largest_opening_mm = 12;
constexpr double vessel_mm = 3;  // vessels inside the liver are brighter; they belong to it

}  // namespace

Mask segment_liver(const CtVolume& ct, const Mask& free, const Vec3& seed_mm) {
  Volume<float> image(ct.grid);
  std::copy(ct.voxels.begin(), ct.voxels.end(), image.voxels.begin());
  image = gaussian(image, smoothing_mm);
  const Index3 seed = seed_voxel(ct.grid, "liver", seed_mm);
  const double grey = median_around(ct, seed_mm, seed_ball_mm);
  Mask alike(ct.grid);
  for (std::size_t v = 0; v < alike.voxels.size(); ++v)
    alike.voxels[v] = free.voxels[v] && std::abs(static_cast<double>(image.voxels[v]) - grey) < tolerance_hu;
  const auto limit = static_cast<std::int64_t>(maximum_ml * 1000 / ct.grid.voxel_volume_mm3());
  for (double radius = smallest_opening_mm; radius <= largest_opening_mm; radius += 3) {
    const Mask core = component_of(erode(alike, radius), seed, limit);
    if (count(core) == 0) continue;
    const Mask liver = intersect(dilate(core, radius), alike);
    if (count(liver) <= limit) return intersect(fill_holes(close(liver, vessel_mm)), free);
  }
  throw UserError(fmt::format("no liver-sized region of {:.0f} HU is found at the seed", grey),
                  fmt::format("landmarks: seed liver at ({:.1f}, {:.1f}, {:.1f}) mm", seed_mm.x, seed_mm.y, seed_mm.z),
                  "move the seed into the middle of the liver, or leave it out");
}

}  // namespace heart::segment
