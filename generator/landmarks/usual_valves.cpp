// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/usual_valves.hpp"

#include <algorithm>

#include "generator/anatomy/faint_blood.hpp"
#include "generator/chest/working_image.hpp"
#include "generator/image/sections.hpp"
#include "model/labels.hpp"

namespace heartgen::landmarks {
namespace {

// In the frame of the left heart's base, mm and parts: means over hearts in two CTs and the phantom, which lie within
// 10 mm and 20 degrees of them.
constexpr double mitral_weight = 0.65;      // of the base's middle, as for the long axis
constexpr Vec3 tricuspid_mm{-8, 27, 33};    // towards base, aortic valve and right
constexpr Vec3 pulmonary_mm{-12, 40, -20};  // so in two CTs and the phantom, within 16 mm
constexpr double normal_to_base = 0.9, normal_to_aortic = 0.1, normal_to_right = 0.35;
constexpr double typical_diameter_mm = 34;  // adults: 28 to 40

struct BaseFrame {
  Vec3 middle_mm, to_base, to_aortic, to_right;

  Vec3 at(const Vec3& mm) const { return middle_mm + mm.x * to_base + mm.y * to_aortic + mm.z * to_right; }
};

BaseFrame base_frame(const ValvePatch& mitral, const ValvePatch& aortic, const LongAxis& axis) {
  BaseFrame frame;
  frame.middle_mm = mitral_weight * mitral.centre_mm + (1 - mitral_weight) * aortic.centre_mm;
  frame.to_base = -axis.direction;
  const Vec3 across = aortic.centre_mm - mitral.centre_mm;
  frame.to_aortic = normalized(across - dot(across, frame.to_base) * frame.to_base);
  frame.to_right = cross(frame.to_aortic, frame.to_base);
  return frame;
}

}  // namespace

ValvePatch usual_tricuspid(const ValvePatch& mitral, const ValvePatch& aortic, const LongAxis& axis) {
  const BaseFrame frame = base_frame(mitral, aortic, axis);
  ValvePatch usual;
  usual.centre_mm = frame.at(tricuspid_mm);
  usual.normal = normalized(normal_to_base * frame.to_base + normal_to_aortic * frame.to_aortic +
                            normal_to_right * frame.to_right);
  usual.diameter_mm = typical_diameter_mm;
  usual.share = 1;
  return usual;
}

Vec3 usual_pulmonary_mm(const ValvePatch& mitral, const ValvePatch& aortic, const LongAxis& axis) {
  return base_frame(mitral, aortic, axis).at(pulmonary_mm);
}

std::optional<ValvePatch> narrowest_tricuspid(const LabelVolume& chambers, const Volume<float>& hu, double muscle_hu,
                                              const ValvePatch& usual) {
  constexpr double reach_mm = 12;
  const auto is = [&](std::size_t v, Region region) { return chambers.voxels[v] == tag(region); };
  const Mask lv = chest::mask_where(hu.grid, [&](const Vec3&, std::size_t v) { return is(v, Region::lv_blood); });
  const Mask other = chest::mask_where(
      hu.grid, [&](const Vec3&, std::size_t v) { return is(v, Region::la_blood) || is(v, Region::aorta); });
  const auto walls = anatomy::measure_walls(hu, lv, other, muscle_hu);
  Volume<float> cavity = anatomy::prior_cavity(walls, Mask(hu.grid, 1));
  for (float& inside : cavity.voxels)  // 1 inside, 0 outside, half-way at the wall
    inside = std::clamp(inside / static_cast<float>(chest::working_spacing_mm) + 0.5F, 0.0F, 1.0F);
  const auto plane = image::tightest_plane(cavity, usual.centre_mm, usual.normal, reach_mm);
  if (!plane) return std::nullopt;
  ValvePatch valve = usual;
  valve.centre_mm = plane->section.centre_mm;
  valve.normal = plane->normal;
  return valve;
}

}  // namespace heartgen::landmarks
