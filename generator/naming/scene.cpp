// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/scene.hpp"

#include <cmath>

#include "generator/chest/spine.hpp"
#include "generator/chest/working_image.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/morphology.hpp"
#include "generator/naming/levels.hpp"
#include "generator/naming/priors.hpp"
#include "model/error.hpp"

namespace heartgen::naming {
namespace {

constexpr double smooth_sigma_mm = 1.2, smoother_sigma_mm = 2;
constexpr std::int64_t margin_voxels = 3;

bool in_spine_zone(const Vec3& p, const Vec3& spine) {
  const double beside = std::abs(p.x - spine.x), behind = p.y - spine.y;
  return behind >= spine_behind_mm || (behind > -spine_before_mm && beside < spine_half_width_mm) ||
         beside * beside + behind * behind < spine_radius_mm * spine_radius_mm;
}

Mask room_before(const Mask& between_lungs, const chest::Spine& spine) {
  return chest::mask_where(between_lungs.grid, [&](const Vec3& p, std::size_t v) {
    return between_lungs.voxels[v] != 0 && !in_spine_zone(p, spine.at(p.z));
  });
}

/// A field of view that ends in the lungs may not hold the spine, and what was taken for it may be an atrium.
chest::Spine true_spine(const chest::Thorax& thorax, const Volume<float>& smooth) {
  constexpr double surely_unlike = 0.25;
  if (!thorax.back_is_cut) return thorax.spine;
  const chest::Spine behind = chest::spine_behind(smooth.grid);
  const auto levels = find_levels(smooth, room_before(thorax.chest, behind));
  if (!levels.has_contrast()) return thorax.spine;
  const double unlike = chest::share_unlike_spine(thorax.spine, smooth, thorax.lung, levels.blood_hu);
  return unlike > surely_unlike ? behind : thorax.spine;
}

}  // namespace

Scene make_scene(const CtVolume& ct) {
  const auto image = chest::make_working_image(ct, spacing_mm);
  const auto thorax = chest::find_thorax(image.smooth);
  Scene scene;
  scene.spine = true_spine(thorax, image.smooth);
  const Mask room = room_before(thorax.chest, scene.spine);
  const Box box = bounding_box(room, margin_voxels, [](std::uint8_t set) { return set != 0; });
  if (box.empty())
    throw UserError("no room is between the lungs: the heart cannot be found there", "landmarks",
                    "use a scan of the whole chest, or give the seeds and valve planes by hand");
  scene.hu = crop(image.hu, box);
  scene.room = crop(room, box);
  scene.smooth = image::gaussian(scene.hu, smooth_sigma_mm);
  scene.smoother = image::gaussian(scene.hu, smoother_sigma_mm);
  scene.room_depth_mm = chest::depth_of(scene.room);
  for (std::size_t a = 0; a < 3; ++a) {
    scene.view.begin[a] = -box.begin[a];
    scene.view.end[a] = image.hu.grid.size[a] - box.begin[a];
  }
  return scene;
}

}  // namespace heartgen::naming
