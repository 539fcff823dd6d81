// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/presets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "generator/labels/usual_names.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace heartgen::labels {
namespace {

using enum Region;
using Structures = std::vector<std::string>;

/// Structures of TotalSegmentator that a heart model uses; a name that begins with the text (all of its parts).
constexpr std::array total_regions = {
    std::pair{"heart_myocardium", lv_myocardium},  // of the left ventricle
    std::pair{"heart_atrium_left", la_blood},
    std::pair{"heart_ventricle_left", lv_blood},
    std::pair{"heart_atrium_right", ra_blood},
    std::pair{"heart_ventricle_right", rv_blood},
    std::pair{"aorta", aorta},
    std::pair{"pulmonary_artery", pulmonary_artery},
    std::pair{"lung_upper_lobe", lung},
    std::pair{"lung_middle_lobe", lung},
    std::pair{"lung_lower_lobe", lung},
    std::pair{"liver", liver},
    std::pair{"trachea", trachea},
    std::pair{"body", torso},
    std::pair{"vertebrae", bone},
    std::pair{"rib_", bone},
    std::pair{"sternum", bone},
    std::pair{"sacrum", bone},
    std::pair{"scapula", bone},
    std::pair{"clavicula", bone},
    std::pair{"humerus", bone},
    std::pair{"femur", bone},
    std::pair{"hip_", bone},
    std::pair{"skull", bone},
};

Region region_of_total(const std::string& name) {
  for (const auto& [start, region] : total_regions)
    if (name.starts_with(start) && name != "liver_vessels" && name != "liver_tumor") return region;
  return none;
}

void add(Structures& list, std::initializer_list<const char*> names) {
  for (const char* name : names) list.emplace_back(name);
}

void add_numbered(Structures& list, const std::string& stem, int from, int to) {
  const int step = from < to ? 1 : -1;
  for (int n = from; n != to + step; n += step) list.push_back(stem + std::to_string(n));
}

void add_sides(Structures& list, std::initializer_list<const char*> stems) {
  for (const char* stem : stems)
    for (const char* side : {"_left", "_right"}) list.push_back(std::string(stem) + side);
}

/// From the lowest lumbar vertebra up.
void add_vertebrae(Structures& list) {
  add_numbered(list, "vertebrae_L", 5, 1);
  add_numbered(list, "vertebrae_T", 12, 1);
  add_numbered(list, "vertebrae_C", 7, 1);
}

void add_ribs(Structures& list) {
  add_numbered(list, "rib_left_", 1, 12);
  add_numbered(list, "rib_right_", 1, 12);
}

constexpr auto limb_bones = {"humerus", "scapula", "clavicula", "femur", "hip"};
constexpr auto muscles = {"gluteus_maximus", "gluteus_medius", "gluteus_minimus", "autochthon", "iliopsoas"};

/// Values 1 to 117 of the task `total`, version 2.
Structures total_v2() {
  Structures s;
  add(s, {"spleen",
          "kidney_right",
          "kidney_left",
          "gallbladder",
          "liver",
          "stomach",
          "pancreas",
          "adrenal_gland_right",
          "adrenal_gland_left",
          "lung_upper_lobe_left",
          "lung_lower_lobe_left",
          "lung_upper_lobe_right",
          "lung_middle_lobe_right",
          "lung_lower_lobe_right",
          "esophagus",
          "trachea",
          "thyroid_gland",
          "small_bowel",
          "duodenum",
          "colon",
          "urinary_bladder",
          "prostate",
          "kidney_cyst_left",
          "kidney_cyst_right",
          "sacrum",
          "vertebrae_S1"});
  add_vertebrae(s);
  add(s, {"heart", "aorta", "pulmonary_vein", "brachiocephalic_trunk", "subclavian_artery_right",
          "subclavian_artery_left", "common_carotid_artery_right", "common_carotid_artery_left",
          "brachiocephalic_vein_left", "brachiocephalic_vein_right", "atrial_appendage_left", "superior_vena_cava",
          "inferior_vena_cava", "portal_vein_and_splenic_vein", "iliac_artery_left", "iliac_artery_right",
          "iliac_vena_left", "iliac_vena_right"});
  add_sides(s, limb_bones);
  add(s, {"spinal_cord"});
  add_sides(s, muscles);
  add(s, {"brain", "skull"});
  add_ribs(s);
  add(s, {"sternum", "costal_cartilages"});
  return s;
}

/// Values 1 to 104 of the task `total`, version 1.
Structures total_v1() {
  Structures s;
  add(s,
      {"spleen", "kidney_right", "kidney_left", "gallbladder", "liver", "stomach", "aorta", "inferior_vena_cava",
       "portal_vein_and_splenic_vein", "pancreas", "adrenal_gland_right", "adrenal_gland_left", "lung_upper_lobe_left",
       "lung_lower_lobe_left", "lung_upper_lobe_right", "lung_middle_lobe_right", "lung_lower_lobe_right"});
  add_vertebrae(s);
  add(s, {"esophagus", "trachea", "heart_myocardium", "heart_atrium_left", "heart_ventricle_left", "heart_atrium_right",
          "heart_ventricle_right", "pulmonary_artery", "brain", "iliac_artery_left", "iliac_artery_right",
          "iliac_vena_left", "iliac_vena_right", "small_bowel", "duodenum", "colon"});
  add_ribs(s);
  add_sides(s, limb_bones);
  add(s, {"sacrum", "face"});
  add_sides(s, muscles);
  add(s, {"urinary_bladder"});
  return s;
}

/// Values 1 to 7 of the task `heartchambers_highres`.
Structures total_heart() {
  return {"heart_myocardium",   "heart_atrium_left",     "heart_ventricle_left",
          "heart_atrium_right", "heart_ventricle_right", "aorta",
          "pulmonary_artery"};
}

/// Names of files that a folder of its results may hold beside those tasks' own.
Structures total_other() {
  return {"body",
          "body_trunc",
          "body_extremities",
          "skin",
          "coronary_arteries",
          "lung_vessels",
          "lung_trachea_bronchia",
          "pleural_effusion",
          "pericardial_effusion",
          "subcutaneous_fat",
          "torso_fat",
          "skeletal_muscle",
          "liver_vessels",
          "liver_tumor",
          "vertebrae_body",
          "intervertebral_discs",
          "carpal",
          "abdominal_cavity",  // these four: task trunk_cavities
          "thoracic_cavity",
          "pericardium",
          "mediastinum"};
}

std::map<std::string, Region> total_names() {
  std::map<std::string, Region> names;
  for (const auto& list : {total_v2(), total_v1(), total_heart(), total_other()})
    for (const auto& name : list) names[plain_name(name)] = region_of_total(name);
  return names;
}

LabelPreset total_preset(std::string_view name, std::string_view what, const Structures& list) {
  LabelPreset preset{name, what, {}, total_names()};
  for (std::size_t i = 0; i < list.size(); ++i)
    preset.values[static_cast<std::int32_t>(i) + 1] = {list[i], region_of_total(list[i])};
  return preset;
}

/// A preset whose names are those of its values.
LabelPreset value_preset(std::string_view name, std::string_view what, std::map<std::int32_t, KnownStructure> values) {
  LabelPreset preset{name, what, std::move(values), {}};
  for (const auto& [value, structure] : preset.values) preset.names[plain_name(structure.name)] = structure.region;
  return preset;
}

LabelPreset own_preset() {
  std::map<std::int32_t, KnownStructure> values;
  for (const auto& row : region_table())
    if (const auto region = static_cast<Region>(row.tag); is_label(region))
      values[row.tag] = {std::string(row.name), region};
  return value_preset("heartgen", "the tags and names of heartgen's own regions", std::move(values));
}

LabelPreset mm_whs_preset() {
  return value_preset("mm_whs", "the MM-WHS challenge: 205, 420, 500, 550, 600, 820, 850",
                      {{205, {"left ventricle myocardium", lv_myocardium}},
                       {420, {"left atrium blood cavity", la_blood}},
                       {421, {"left atrium blood cavity", la_blood}},
                       {500, {"left ventricle blood cavity", lv_blood}},
                       {550, {"right atrium blood cavity", ra_blood}},
                       {600, {"right ventricle blood cavity", rv_blood}},
                       {820, {"ascending aorta", aorta}},
                       {850, {"pulmonary artery", pulmonary_artery}}});
}

LabelPreset imagechd_preset() {
  return value_preset("imagechd", "ImageCHD, and MM-WHS in numbers from 1 to 7",
                      {{1, {"left ventricle", lv_blood}},
                       {2, {"right ventricle", rv_blood}},
                       {3, {"left atrium", la_blood}},
                       {4, {"right atrium", ra_blood}},
                       {5, {"myocardium", lv_myocardium}},
                       {6, {"aorta", aorta}},
                       {7, {"pulmonary artery", pulmonary_artery}}});
}

}  // namespace

std::optional<Region> region_of_name(const LabelPreset& preset, std::string_view name) {
  const std::string plain = plain_name(name);
  if (const auto known = preset.names.find(plain); known != preset.names.end()) return known->second;
  if (preset.knows_words) return region_of_words(plain);
  return {};
}

const LabelPreset* preset_for_names(const std::vector<std::string>& names) {
  const LabelPreset* best = nullptr;
  std::size_t most_known = 0;
  for (const auto& preset : label_presets()) {
    std::size_t known = 0;
    bool makes_region = false;
    for (const auto& name : names) {
      const auto region = region_of_name(preset, name);
      known += region.has_value() ? 1U : 0U;
      makes_region |= region.value_or(none) != none;
    }
    if (makes_region && known > most_known) best = &preset, most_known = known;
  }
  return best;
}

const std::vector<LabelPreset>& label_presets() {
  static const std::vector<LabelPreset> presets = {
      {automatic_preset, "whichever makes a heart of the names and values", {}, {}},
      own_preset(),
      total_preset("totalsegmentator", "TotalSegmentator 2, task total; or a folder of its files", total_v2()),
      total_preset("totalsegmentator_v1", "TotalSegmentator 1, task total", total_v1()),
      total_preset("totalsegmentator_heart", "TotalSegmentator, task heartchambers_highres", total_heart()),
      mm_whs_preset(),
      imagechd_preset(),
      {"names", "what people call structures: LV blood pool, left ventricular wall, RA ...", {}, {}, true},
      {"none", "no meaning but that of [labels.regions]", {}, {}}};
  return presets;
}

const LabelPreset& label_preset(std::string_view name) {
  std::vector<std::string> known;
  for (const auto& preset : label_presets()) {
    if (preset.name == name) return preset;
    known.emplace_back(preset.name);
  }
  throw UserError(
      fmt::format("unknown preset \"{}\"", name), "labels.preset",
      fmt::format("did you mean \"{}\"? known presets: {}", nearest_name(name, known), fmt::join(known, ", ")));
}

std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z')
      plain += static_cast<char>(c - 'A' + 'a');
    else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80)
      plain += c;
    else if (!plain.empty() && plain.back() != '_')
      plain += '_';
  }
  while (!plain.empty() && plain.back() == '_') plain.pop_back();
  return plain;
}

}  // namespace heartgen::labels
