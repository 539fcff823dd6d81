// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/usual_names.hpp"

#include <gtest/gtest.h>

#include "generator/labels/presets.hpp"

namespace heartgen::labels {
namespace {

std::optional<Region> meaning(const char* name) { return region_of_words(plain_name(name)); }

TEST(UsualNames, AreUnderstoodByTheirWords) {
  using enum Region;
  const std::pair<const char*, Region> names[]{{"LV blood pool", lv_blood},
                                               {"LV", lv_blood},
                                               {"Left ventricular cavity", lv_blood},
                                               {"lvbp", lv_blood},
                                               {"Left Ventricular Wall", lv_myocardium},
                                               {"LV myocardium", lv_myocardium},
                                               {"left ventricular muscle", lv_myocardium},
                                               {"left pulmonary artery", pulmonary_artery},
                                               {"Myocardium", lv_myocardium},
                                               {"RV_free_wall", rv_myocardium},
                                               {"Right Ventricle", rv_blood},
                                               {"LA", la_blood},
                                               {"Left atrial wall", la_wall},
                                               {"right atrium (lumen)", ra_blood},
                                               {"Ascending aorta", aorta},
                                               {"Aortic root", aorta},
                                               {"Pulmonary trunk", pulmonary_artery},
                                               {"PA", pulmonary_artery},
                                               {"Papillary muscles", papillary},
                                               {"Right lung", lung},
                                               {"Ribs", bone},
                                               {"Body", torso},
                                               {"Superior vena cava", none},
                                               {"Left atrial appendage", none},
                                               {"Pulmonary veins", none}};
  for (const auto& [name, region] : names) EXPECT_EQ(meaning(name), region) << name;
}

TEST(UsualNames, AnUnknownWordIsNotGuessedAround) {
  for (const char* name : {"LV scar", "left kidney", "Segment_1", "ventricle", "", "aneurysm of the aorta",
                           "Aortic wall", "Right wall", "Muscle", "Pulmonary artery wall", "LV and LA", "atrium"})
    EXPECT_FALSE(meaning(name)) << name;
}

TEST(UsualNames, EveryPresetKnowsItsOwnNamesFirst) {
  EXPECT_EQ(preset_for_names({"heart_atrium_left", "spleen"})->name, "totalsegmentator");
  EXPECT_EQ(preset_for_names({"LV cavity", "LV wall"})->name, "names");
  EXPECT_EQ(preset_for_names({"lv_blood", "lv_myocardium"})->name, "heartgen");
  EXPECT_EQ(preset_for_names({"LV cavity", "LV wall", "spleen"})->name, "names") << "it knows the most";
  EXPECT_EQ(preset_for_names({"gizzard"}), nullptr);
  EXPECT_EQ(preset_for_names({"spleen"}), nullptr) << "no region among them";
  EXPECT_EQ(preset_for_names({}), nullptr);
}

}  // namespace
}  // namespace heartgen::labels
