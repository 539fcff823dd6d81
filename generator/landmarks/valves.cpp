// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/valves.hpp"

#include "generator/chest/working_image.hpp"
#include "generator/image/sections.hpp"
#include "generator/image/statistics.hpp"
#include "generator/landmarks/divide_at_plane.hpp"
#include "generator/landmarks/orifice.hpp"
#include "generator/landmarks/pulmonary_valve.hpp"
#include "generator/landmarks/usual_valves.hpp"

namespace heartgen::landmarks {
namespace {

Volume<float> blood_of(const LabelVolume& chambers, Region a, Region b) {
  Volume<float> blood(chambers.grid);
  for (std::size_t v = 0; v < blood.voxels.size(); ++v)
    blood.voxels[v] = chambers.voxels[v] == tag(a) || chambers.voxels[v] == tag(b);
  return blood;
}

/// Direction of the vessel's first centimetres away from the valve: the line through the centres of slices across it.
Vec3 root_direction(const LabelVolume& chambers, Region vessel, const ValvePatch& valve) {
  constexpr double near_mm = 12, far_mm = 28, slice_mm = 4, longest_mm = 32, wide_mm = 22;
  constexpr std::size_t min_voxels = 30, min_slices = 3;
  constexpr int rounds = 4, slices = 7;
  std::vector<Vec3> offsets, first;
  chest::for_each_voxel(chambers.grid, [&](const Vec3& p, std::size_t v) {
    if (chambers.voxels[v] != tag(vessel)) return;
    const Vec3 q = p - valve.centre_mm;
    if (norm(q) > near_mm && norm(q) < far_mm) first.push_back(q);
    if (norm(q) < longest_mm + wide_mm) offsets.push_back(q);
  });
  if (first.empty()) return valve.normal;
  Vec3 direction = normalized(image::mean(first));
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::vector<Vec3>> slice(slices);
    for (const Vec3& q : offsets) {
      const double along = dot(q, direction);
      if (along <= slice_mm || along >= longest_mm || norm(q - along * direction) >= wide_mm) continue;
      slice[static_cast<std::size_t>(along / slice_mm) - 1].push_back(q);
    }
    std::vector<Vec3> centres;
    for (const auto& s : slice)
      if (s.size() > min_voxels) centres.push_back(image::mean(s));
    if (centres.size() < min_slices) break;
    const Vec3 line = image::principal_axes(centres).axis[0];
    direction = dot(line, direction) < 0 ? -line : line;
  }
  return direction;
}

/// The contact of aorta and ventricle is small and uneven: half of its direction is the vessel's.
void straighten_aortic(const LabelVolume& chambers, ValvePatch& valve) {
  valve.normal = normalized(valve.normal + root_direction(chambers, Region::aorta, valve));
}

/// Moves a valve to the plane of least area nearby, `rounds` times by up to 6 mm: farther at once, a vein or the apex
/// would be the tightest place.
void tighten(const LabelVolume& chambers, Region ventricle, Region beyond, int rounds, ValvePatch& valve) {
  constexpr double reach_mm = 6;
  const auto blood = blood_of(chambers, ventricle, beyond);
  for (int round = 0; round < rounds; ++round) {
    const auto plane = image::tightest_plane(blood, valve.centre_mm, valve.normal, reach_mm);
    if (!plane) return;
    valve.centre_mm = plane->section.centre_mm;
    valve.normal = plane->normal;
    valve.diameter_mm = plane->section.diameter_mm();
  }
}

/// Divides the pools at the valve's plane and takes the disc from their new contact: a recess beside the orifice that
/// bulges past the plane belongs to the section, but not to the valve.
void settle(LabelVolume& chambers, Region ventricle, Region beyond, ValvePatch& valve) {
  divide_at_plane(chambers, ventricle, beyond, valve.centre_mm, valve.normal);
  const auto patch = find_valve_patch(chambers, ventricle, beyond);
  if (!patch) return;
  const Vec3 normal = valve.normal;
  valve = *patch;
  valve.normal = normal;
}

/// No farther from where the valve usually lies than twice as far as in known hearts.
bool lies_as_usual(const ValvePatch& valve, const ValvePatch& usual) {
  constexpr double farthest_mm = 20, max_turned_deg = 40;
  return norm(valve.centre_mm - usual.centre_mm) <= farthest_mm &&
         image::angle_deg(valve.normal, usual.normal) <= max_turned_deg;
}

/// The tightest plane near the flood's border, or near the usual place if that is clearly tighter. In a crooked or
/// crowded heart a fold of the ventricle may be nearer to the flood's border than the valve is, and as tight.
ValvePatch tightest_tricuspid(const LabelVolume& chambers, const ValvePatch& start,
                              const std::optional<ValvePatch>& usual) {
  using enum Region;
  constexpr int rounds = 3;
  constexpr double clearly_tighter = 0.9;
  ValvePatch from_flood = start;
  tighten(chambers, rv_blood, ra_blood, rounds, from_flood);
  if (!usual) return from_flood;
  ValvePatch from_usual = *usual;
  tighten(chambers, rv_blood, ra_blood, rounds, from_usual);
  const bool flood_is_usual = lies_as_usual(from_flood, *usual);
  if (flood_is_usual != lies_as_usual(from_usual, *usual)) return flood_is_usual ? from_flood : from_usual;
  return from_usual.diameter_mm < clearly_tighter * from_flood.diameter_mm ? from_usual : from_flood;
}

/// The tricuspid valve; `start` is where the flood parted atrium and ventricle, up to 15 mm below the valve.
ValvePatch find_tricuspid(LabelVolume& chambers, const chest::WorkingImage& image, const RightHeartLook& right,
                          const ValvePatch& start, const std::optional<ValvePatch>& usual) {
  using enum Region;
  ValvePatch valve = tightest_tricuspid(chambers, start, usual);
  settle(chambers, rv_blood, ra_blood, valve);
  if (!right.faint) return valve;
  const auto orifice = find_orifice(show_tissue(image.hu, *right.faint), valve);
  valve.hidden = !orifice;
  if (!orifice) return valve;
  divide_at_plane(chambers, rv_blood, ra_blood, orifice->centre_mm, orifice->normal);
  return *orifice;
}

ValvePatch find_pulmonary(LabelVolume& chambers, const chest::WorkingImage& image, const RightHeartLook& right,
                          const ValvePatch& start, const std::optional<Vec3>& typical_mm) {
  using enum Region;
  ValvePatch valve = find_pulmonary_valve(chambers, image, right.faint, start, typical_mm);
  if (right.faint)
    divide_at_plane(chambers, rv_blood, pulmonary_artery, valve.centre_mm, valve.normal);
  else
    settle(chambers, rv_blood, pulmonary_artery, valve);
  return valve;
}

/// The tricuspid valve of a right heart full of streaks, in the groove; where the flood parted it, if there is none.
void find_tricuspid_in_streaks(LabelVolume& chambers, const chest::WorkingImage& image, double muscle_hu,
                               const ValvePatch& usual, std::map<std::string, ValvePatch>& valves) {
  using enum Region;
  auto valve = narrowest_tricuspid(chambers, image.hu, muscle_hu, usual);
  if (!valve) return;
  settle(chambers, rv_blood, ra_blood, *valve);
  valves["tricuspid"] = *valve;
}

}  // namespace

std::map<std::string, ValvePatch> find_valves(LabelVolume& chambers, const chest::WorkingImage& image,
                                              const LongAxis& axis, const RightHeartLook& right) {
  using enum Region;
  std::map<std::string, ValvePatch> valves;
  const auto add = [&](const std::string& name, Region ventricle, Region beyond) {
    if (const auto patch = find_valve_patch(chambers, ventricle, beyond)) valves[name] = *patch;
  };
  add("mitral", lv_blood, la_blood);
  add("aortic", lv_blood, aorta);
  add("tricuspid", rv_blood, ra_blood);
  add("pulmonary", rv_blood, pulmonary_artery);
  if (valves.contains("aortic")) straighten_aortic(chambers, valves.at("aortic"));
  if (valves.contains("mitral")) tighten(chambers, lv_blood, la_blood, 1, valves.at("mitral"));
  std::optional<ValvePatch> usual;
  std::optional<Vec3> usual_pulmonary;
  if (valves.contains("mitral") && valves.contains("aortic")) {
    usual = usual_tricuspid(valves.at("mitral"), valves.at("aortic"), axis);
    usual_pulmonary = usual_pulmonary_mm(valves.at("mitral"), valves.at("aortic"), axis);
  }
  if (right.streaks) {
    if (usual) find_tricuspid_in_streaks(chambers, image, right.muscle_hu, *usual, valves);
  } else if (valves.contains("tricuspid")) {
    valves.at("tricuspid") = find_tricuspid(chambers, image, right, valves.at("tricuspid"), usual);
  }
  if (valves.contains("pulmonary"))
    valves.at("pulmonary") = find_pulmonary(chambers, image, right, valves.at("pulmonary"), usual_pulmonary);
  return valves;
}

}  // namespace heartgen::landmarks
