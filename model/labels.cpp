// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/labels.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace heartgen {
namespace {

// Surface tags: 101-199 fixed surfaces, from 201 on numbered ends, a hundred a vessel; regions have 1-99.
enum Surface : std::int32_t {
  epicardium = 101,
  lv_endocardium = 102,
  rv_endocardium = 103,
  la_endocardium = 104,
  ra_endocardium = 105,
  mitral_orifice = 106,
  aortic_orifice = 107,
  tricuspid_orifice = 108,
  pulmonary_orifice = 109,
  aorta_wall = 110,
  pulmonary_artery_wall = 111,
  skin = 112,
  fov_cut = 113,
  trachea_wall = 114,
  carotid_wall = 115,
  lung_surface = 116,
  bone_surface = 117,
  liver_surface = 118,
  papillary_surface = 119,
  septum_junction = 120,            // LV muscle against RV muscle
  atrioventricular_junction = 121,  // ventricular muscle against atrial wall
  interatrial_junction = 122,       // left against right atrial wall
  papillary_base = 123,             // papillary muscle against the compact wall
  blood_contact = 124,              // two blood pools that touch away from a valve
  base = 125,                       // what a mesh of the ventricles ends in where the atria were cut off
  aorta_end = 126,                  // flat; of an aorta that ends once
  pulmonary_artery_end = 127,
  superior_vena_cava_end = 128,
  inferior_vena_cava_end = 129,
  coronary_sinus_end = 130,
  annulus_border = 131,  // an annulus against the wall of its atrium
};

/// Ends that are numbered: their tags are base + N.
struct NumberedEnds {
  std::string_view prefix;
  std::int32_t base;
  Region vessel;
};
constexpr std::array numbered_ends{NumberedEnds{"trachea_end_", 200, Region::trachea},
                                   NumberedEnds{"carotid_end_", 300, Region::carotid},
                                   NumberedEnds{"aorta_end_", 400, Region::aorta},
                                   NumberedEnds{"pulmonary_artery_end_", 500, Region::pulmonary_artery},
                                   NumberedEnds{"pulmonary_vein_end_", 600, Region::la_blood}};
constexpr std::string_view cap_ending = "_cap";

bool is_ventricular_muscle(Region r) { return r == Region::lv_myocardium || r == Region::rv_myocardium; }
bool is_atrial_wall(Region r) { return r == Region::la_wall || r == Region::ra_wall; }
/// Where the annuli are no different from the walls that they are part of.
Region wall_of(Region r) {
  if (r == Region::la_annulus) return Region::la_wall;
  return r == Region::ra_annulus ? Region::ra_wall : r;
}
bool is_chamber(Region r) {
  return r == Region::lv_blood || r == Region::rv_blood || r == Region::la_blood || r == Region::ra_blood;
}

std::int32_t endocardium_of(Region chamber) {
  switch (chamber) {
    case Region::lv_blood:
      return lv_endocardium;
    case Region::rv_blood:
      return rv_endocardium;
    case Region::la_blood:
      return la_endocardium;
    default:
      return ra_endocardium;
  }
}

std::int32_t between_muscles(Region a, Region b) {
  if (a == Region::papillary || b == Region::papillary) return papillary_base;
  if (is_ventricular_muscle(a) && is_ventricular_muscle(b)) return septum_junction;
  if (is_atrial_wall(a) && is_atrial_wall(b)) return interatrial_junction;
  return atrioventricular_junction;
}

std::int32_t between_bloods(Region a, Region b) {
  const auto pair = std::minmax(a, b);
  using enum Region;
  if (pair == std::minmax(lv_blood, la_blood)) return mitral_orifice;
  if (pair == std::minmax(lv_blood, aorta)) return aortic_orifice;
  if (pair == std::minmax(rv_blood, ra_blood)) return tricuspid_orifice;
  if (pair == std::minmax(rv_blood, pulmonary_artery)) return pulmonary_orifice;
  return blood_contact;
}

std::int32_t muscle_against(Region muscle, Region other) {
  if (is_myocardium(other)) return between_muscles(muscle, other);
  if (is_chamber(other)) return muscle == Region::papillary ? papillary_surface : endocardium_of(other);
  if (other == Region::aorta) return aorta_wall;
  if (other == Region::pulmonary_artery) return pulmonary_artery_wall;
  return epicardium;
}

std::int32_t blood_against(Region blood, Region other) {
  if (is_blood(other)) return between_bloods(blood, other);
  if (is_chamber(blood)) return endocardium_of(blood);
  return blood == Region::aorta ? aorta_wall : pulmonary_artery_wall;
}

}  // namespace

const std::vector<NamedTag>& region_table() {
  static const std::vector<NamedTag> table = {
      {"lv_myocardium", 1},     {"rv_myocardium", 2}, {"papillary", 3},   {"la_wall", 4},    {"ra_wall", 5},
      {"lv_blood", 6},          {"rv_blood", 7},      {"la_blood", 8},    {"ra_blood", 9},   {"aorta", 10},
      {"pulmonary_artery", 11}, {"lung", 12},         {"bone", 13},       {"liver", 14},     {"trachea", 15},
      {"carotid", 16},          {"torso", 17},        {"la_annulus", 18}, {"ra_annulus", 19}};
  return table;
}

const std::vector<NamedTag>& surface_table() {
  static const std::vector<NamedTag> table = {{"epicardium", epicardium},
                                              {"lv_endocardium", lv_endocardium},
                                              {"rv_endocardium", rv_endocardium},
                                              {"la_endocardium", la_endocardium},
                                              {"ra_endocardium", ra_endocardium},
                                              {"mitral_orifice", mitral_orifice},
                                              {"aortic_orifice", aortic_orifice},
                                              {"tricuspid_orifice", tricuspid_orifice},
                                              {"pulmonary_orifice", pulmonary_orifice},
                                              {"aorta_wall", aorta_wall},
                                              {"pulmonary_artery_wall", pulmonary_artery_wall},
                                              {"skin", skin},
                                              {"fov_cut", fov_cut},
                                              {"trachea_wall", trachea_wall},
                                              {"carotid_wall", carotid_wall},
                                              {"lung_surface", lung_surface},
                                              {"bone_surface", bone_surface},
                                              {"liver_surface", liver_surface},
                                              {"papillary_surface", papillary_surface},
                                              {"septum_junction", septum_junction},
                                              {"atrioventricular_junction", atrioventricular_junction},
                                              {"interatrial_junction", interatrial_junction},
                                              {"papillary_base", papillary_base},
                                              {"blood_contact", blood_contact},
                                              {"base", base},
                                              {"aorta_end", aorta_end},
                                              {"pulmonary_artery_end", pulmonary_artery_end},
                                              {"superior_vena_cava_end", superior_vena_cava_end},
                                              {"inferior_vena_cava_end", inferior_vena_cava_end},
                                              {"coronary_sinus_end", coronary_sinus_end},
                                              {"annulus_border", annulus_border}};
  return table;
}

std::string region_name(std::int32_t tag) {
  for (const auto& row : region_table())
    if (row.tag == tag) return std::string(row.name);
  return "region_" + std::to_string(tag);
}

std::optional<Region> region_from_name(std::string_view name) {
  for (const auto& row : region_table())
    if (row.name == name) return static_cast<Region>(row.tag);
  return std::nullopt;
}

std::string surface_name(std::int32_t tag) {
  if (is_cap(tag)) return surface_name(tag - cap_tag(0)) + std::string(cap_ending);
  for (const auto& ends : numbered_ends)
    if (tag > ends.base && tag < ends.base + 100) return std::string(ends.prefix) + std::to_string(tag - ends.base);
  for (const auto& row : surface_table())
    if (row.tag == tag) return std::string(row.name);
  return "surface_" + std::to_string(tag);
}

std::optional<std::int32_t> surface_from_name(std::string_view name) {
  for (const auto& row : surface_table())
    if (row.name == name) return row.tag;
  if (name.ends_with(cap_ending)) {
    const auto opening = surface_from_name(name.substr(0, name.size() - cap_ending.size()));
    return opening ? std::optional(cap_tag(*opening)) : std::nullopt;
  }
  for (const auto& [prefix, base, vessel] : numbered_ends) {
    if (!name.starts_with(prefix)) continue;
    int number = 0;
    const auto digits = name.substr(prefix.size());
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error == std::errc{} && end == digits.data() + digits.size() && number > 0 && number < 100)
      return base + number;
  }
  return std::nullopt;
}

std::int32_t end_surface_tag(Region vessel, int number) {
  for (const auto& ends : numbered_ends)
    if (ends.vessel == vessel) return ends.base + number;
  return 0;
}

bool is_annulus(Region r) { return r == Region::la_annulus || r == Region::ra_annulus; }

bool is_myocardium(Region r) {
  return is_ventricular_muscle(r) || is_atrial_wall(r) || r == Region::papillary || is_annulus(r);
}

bool is_blood(Region r) { return is_chamber(r) || r == Region::aorta || r == Region::pulmonary_artery; }

std::int32_t surface_between(Region a, Region b) {
  using enum Region;
  if (is_annulus(a) != is_annulus(b) && wall_of(a) == wall_of(b)) return annulus_border;
  a = wall_of(a);
  b = wall_of(b);
  if (is_myocardium(a)) return muscle_against(a, b);
  if (is_myocardium(b)) return muscle_against(b, a);
  if (is_blood(a)) return blood_against(a, b);
  if (is_blood(b)) return blood_against(b, a);
  for (const auto& [region, surface] : std::array<std::pair<Region, std::int32_t>, 5>{{{Region::trachea, trachea_wall},
                                                                                       {Region::carotid, carotid_wall},
                                                                                       {lung, lung_surface},
                                                                                       {bone, bone_surface},
                                                                                       {liver, liver_surface}}})
    if (a == region || b == region) return surface;
  return skin;
}

}  // namespace heartgen
