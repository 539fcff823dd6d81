// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Numbers about patients: how grey tissues are in a CT, Hounsfield units. docs/numbers.md is their table.
#pragma once
#include "model/number.hpp"

namespace heartgen {
namespace tissue {

inline constexpr Number fat_hu = number(
    "fat_hu", -100, "HU", -115, -65, "Fat, where an image shows too little of it to be measured", Basis::paper,
    "monti2021: epicardial fat in contrast CT has -81.5 HU (quartiles -84.9 and -78.0); subcutaneous fat is darker");
inline constexpr Number fat_max_hu = number("fat_max_hu", -30, "HU", -50, -10, "Brightest fat", Basis::paper,
                                            "misaka2020: fat around vessels is counted from -190 to -30 HU");
inline constexpr Number fat_min_hu =
    number("fat_min_hu", -160, "HU", -190, -140, "Darkest fat; what is darker is mixed with air", Basis::paper,
           "misaka2020: counted from -190 HU; 30 HU less here, no record why");
inline constexpr Number padding_fat_hu =
    number("padding_fat_hu", -80, "HU", -115, -65, "Fat that closes a body whose lungs the image cuts",
           Basis::unrecorded, "Not recorded; could be fat_hu: changes the bits of padded scans");
inline constexpr Number muscle_window_hu =
    number("muscle_window_hu", 50, "HU", 30, 100,
           "Window of grey values that holds muscle under noise, and no mixture with fat", Basis::data,
           "Set on phantoms with walls of 5 to 16 mm");
inline constexpr Number muscle_beside_bone_hu =
    number("muscle_beside_bone_hu", 60, "HU", 30, 100, "Muscle that touches bone");
inline constexpr Number soft_tissue_edge_hu =
    number("soft_tissue_edge_hu", 60, "HU", 30, 100,
           "Contrast at which smoothing falls to a half: between muscle and fat or blood (denoise.edge_hu)");
inline constexpr Number epicardial_edge_hu_per_mm =
    number("epicardial_edge_hu_per_mm", 12, "HU/mm", 6, 40,
           "Slope of the image at which the epicardium is drawn to it by half (epicardium.edge_hu_per_mm)");
inline constexpr Number bare_soft_tissue_max_hu =
    number("bare_soft_tissue_max_hu", 200, "HU", 150, 300,
           "Brightest value of an image of soft tissue alone, which may well be in Hounsfield units");
inline constexpr Number blood_enhanced_hu =
    number("blood_enhanced_hu", 100, "HU", 60, 200,
           "Blood is enhanced if it is so much brighter than the left wall's darkest quarter");
inline constexpr Number valve_contrast_min_hu = number(
    "valve_contrast_min_hu", 60, "HU", 40, 120, "Least contrast of blood and muscle by which a gap in a valve is seen");
inline constexpr Number other_vessel_contrast_share =
    number("other_vessel_contrast_share", 0.35, "1", 0.2, 0.5,
           "Of the contrast of blood and muscle: brighter unlabelled tissue beside the heart is blood");
inline constexpr Number other_vessel_contrast_min_hu =
    number("other_vessel_contrast_min_hu", 20, "HU", 10, 50,
           "Of blood and muscle, at least: brighter unlabelled tissue beside the heart is blood");
inline constexpr Number great_vessel_share =
    number("great_vessel_share", 0.75, "1", 0.6, 0.9,
           "Of the left ventricle's grey value: what is brighter and joined to the heart is a great vessel, no bone");
inline constexpr Number filled_vessel_max_share = number(
    "filled_vessel_max_share", 1.15, "1", 1, 1.4, "Of the blood's grey value: no vessel full of contrast is brighter");
inline constexpr Number filled_vessel_correlation =
    number("filled_vessel_correlation", 0.6, "1", 0.3, 0.9,
           "Of depth and grey value in a piece: tubes of blood have more, bones less");
inline constexpr Number carotid_contrast_min_hu =
    number("carotid_contrast_min_hu", 50, "HU", 30, 150, "Least contrast of a carotid's lumen and its surroundings");
inline constexpr Number carotid_edge_hu_per_mm =
    number("carotid_edge_hu_per_mm", 60, "HU/mm", 30, 150,
           "Slope of the image at which a snake is drawn to the lumen's edge by half");
inline constexpr Number even_organ_slope_max_hu_per_mm =
    number("even_organ_slope_max_hu_per_mm", 16, "HU/mm", 8, 40,
           "Spleen, kidneys and blood full of contrast vary less; spongy bone varies more");
inline constexpr Number organ_rim_spread_hu =
    number("organ_rim_spread_hu", 80, "HU", 40, 160,
           "An even organ's rim is no brighter than its inside by more; what is, is bone beside it");
inline constexpr Number liver_min_hu = number("liver_min_hu", 20, "HU", 0, 50, "Darkest liver, smoothed");
inline constexpr Number liver_max_hu =
    number("liver_max_hu", 220, "HU", 120, 250, "Brightest liver, smoothed, with contrast", Basis::unrecorded,
           "Not recorded; naruo2007: contrast adds 56.2 +- 13.7 HU to a healthy liver in the portal phase");
inline constexpr Number liver_spread_hu =
    number("liver_spread_hu", 30, "HU", 15, 50, "A liver's grey values lie so far from its seed's");
inline constexpr Number liver_quartiles_max_hu =
    number("liver_quartiles_max_hu", 25, "HU", 12, 40, "Between the quartiles of a liver's grey values");
inline constexpr Number spongy_bone_min_hu =
    number("spongy_bone_min_hu", 160, "HU", 90, 230, "Darkest spongy bone that is looked for, smoothed", Basis::paper,
           "jang2019: the first lumbar vertebra's has 226 +- 44 HU below 30 years and "
           "89 +- 38 from 90 on; old bone is found by its shell");
inline constexpr Number cortical_bone_min_hu =
    number("cortical_bone_min_hu", 300, "HU", 250, 500, "Every bone has a shell brighter than this, smoothed");
inline constexpr Number bone_per_cortex =
    number("bone_per_cortex", 10, "1", 5, 20, "A bone has at most so many voxels for one of its shell");
inline constexpr Number bone_max_hu =
    number("bone_max_hu", 1800, "HU", 1500, 2500, "Brighter is metal, or undiluted contrast in a vein");
inline constexpr Number bone_edge_share = number(
    "bone_edge_share", 0.45, "1", 0.3, 0.6,
    "A bone ends at this share of its shell's height above muscle; a half, and a little less for the marrow's sake");
inline constexpr Number spinal_canal_max_hu = number(
    "spinal_canal_max_hu", 100, "HU", 60, 140, "Cord and fluid in the spinal canal are darker, most marrow is brighter",
    Basis::paper, "jang2019: marrow has 226 +- 44 HU in the young, 89 +- 38 in the oldest, whose canal may be missed");
inline constexpr Number lung_max_hu =
    number("lung_max_hu", -500, "HU", -650, -350, "Half-way between lung and soft tissue", Basis::reasoning,
           "(-910 + 0) / 2 or so: lung has -910 to -850 HU");
inline constexpr Number lung_min_hu =
    number("lung_min_hu", -960, "HU", -1000, -910, "Emptiest lung; air of the room, stomach and bowel is mostly darker",
           Basis::paper, "wang2013: emphysema is best told by -925 to -965 HU");
inline constexpr Number padding_lung_min_hu =
    number("padding_lung_min_hu", -980, "HU", -1000, -950, "Darkest lung beside what an image does not hold",
           Basis::unrecorded, "Not recorded; could be lung_min_hu: changes which padding is seen");
inline constexpr Number padding_lung_max_hu =
    number("padding_lung_max_hu", -600, "HU", -700, -400, "Brightest lung beside what an image does not hold",
           Basis::unrecorded, "Not recorded; could be lung_max_hu: changes which padding is seen");
inline constexpr Number heart_label_air_max_hu =
    number("heart_label_air_max_hu", -200, "HU", -400, -100,
           "Given labels of a heart that lie in what is darker lie in air or lung", Basis::unrecorded,
           "Not recorded; could be air_in_gap_max_hu");
inline constexpr Number air_in_gap_max_hu =
    number("air_in_gap_max_hu", -300, "HU", -500, -150, "Darker voxels count when the mean of an air space is taken");
inline constexpr Number room_air_max_hu =
    number("room_air_max_hu", -930, "HU", -1000, -900, "Mean of an air space that is the room; lungs are brighter",
           Basis::unrecorded, "Not recorded; lung has -910 to -850 HU in breath-hold");
inline constexpr Number padding_max_hu =
    number("padding_max_hu", -500, "HU", -2000, -200, "Brightest value that scanners write where nothing was measured");
inline constexpr Number scale_floor_hu =
    number("scale_floor_hu", -1024, "HU", -1024, -1000,
           "Darkest value of a scanner's scale of 12 bits; what is darker is padding", Basis::reasoning,
           "Twelve bits from -1024");
inline constexpr Number airway_max_hu =
    number("airway_max_hu", -700, "HU", -850, -500, "A trachea's section is darker");
inline constexpr Number airway_wall_hu =
    number("airway_wall_hu", -500, "HU", -650, -350, "The airways' wall, where no split of the image gives it",
           Basis::reasoning, "Half-way between air (-1000) and tissue (0 HU)");
inline constexpr Number airway_contrast_min_hu =
    number("airway_contrast_min_hu", 50, "HU", 25, 100, "Lung is brighter than the airways' lumen by so much");

}  // namespace tissue
}  // namespace heartgen
