// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the naming knows of an adult's heart: the names, where they usually lie, how large they are, what touches what.
/// The only file of this room with numbers about patients. Millimetres, LPS; costs are negative logarithms of
/// probabilities (4 = once in 50).
///
/// Source of the offsets, volumes, extents and costs: set on general knowledge of adult anatomy, one synthetic CT of a
/// real heart's anatomy and three real CTs, none of them a paper's figures; not changed since. Set on two public CTs:
/// no_right_contrast, missing_outside, no_part, and the joining of small basins. No limit is calibrated yet:
/// `heartgen-lab naming` prints what comes of them on phantoms that nobody looked at.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "model/vec.hpp"

namespace heartgen::naming {

enum class Name : std::uint8_t { other, lv, la, rv, ra, aorta, pulmonary_artery, svc, ivc, descending_aorta };
constexpr int name_count = 10;

struct Usual {
  std::string_view word;
  std::string_view key;         ///< as tables print it
  Vec3 offset_mm;               ///< of the centre, from the left ventricle's
  double ml = 1, ln_sigma = 1;  ///< volume, and the standard deviation of its logarithm
  Vec3 deviation_mm{1, 1, 1};   ///< of its points about the centre, along x, y, z
  double missing = 0;           ///< cost where it is not found
  double grey_spread = 1;       ///< usual standard deviation of the grey value in it, share of the contrast
};

constexpr std::array<Usual, name_count> usual = {{
    {"other blood", "other", {}, 1, 1, {1, 1, 1}, 0, 1},
    {"the left ventricle", "LV", {0, 0, 0}, 120, .5, {16, 16, 15}, 14, .12},
    {"the left atrium", "LA", {-36, 40, 32}, 80, .5, {19, 13, 15}, 12, .12},
    {"the right ventricle", "RV", {-40, -26, -2}, 140, .5, {20, 17, 21}, 12, .25},
    {"the right atrium", "RA", {-68, 10, 14}, 100, .5, {14, 16, 18}, 12, .6},
    {"the aorta", "Ao", {-38, 18, 66}, 80, .5, {9, 18, 20}, 12, .12},
    {"the pulmonary artery", "PA", {-26, 12, 72}, 55, .6, {24, 17, 12}, 9, .25},
    {"the superior vena cava", "SVC", {-68, 20, 80}, 14, .6, {6, 6, 16}, 4, .6},
    {"the inferior vena cava", "IVC", {-62, 36, -34}, 18, .8, {8, 8, 10}, 2.5, .6},
    {"the descending aorta", "DAo", {-24, 74, 24}, 70, .8, {8, 12, 45}, 5, .12},
}};

constexpr const Usual& usual_of(Name name) { return usual[static_cast<std::size_t>(name)]; }

/// What blood flows through from one to the other, and what no such opening costs.
struct Opening {
  Name from, to;
  double none;
};
constexpr std::array<Opening, 7> openings = {{
    {Name::lv, Name::la, 4},
    {Name::lv, Name::aorta, 4},
    {Name::rv, Name::ra, 4},
    {Name::rv, Name::pulmonary_artery, 3},
    {Name::ra, Name::svc, 2},
    {Name::ra, Name::ivc, 2},
    {Name::aorta, Name::descending_aorta, 1},
}};
constexpr double opening_cm2 = 0.6;        ///< an open contact of this area settles most of the cost
constexpr double widest_opening_cm2 = 14;  ///< larger contacts are no valve
constexpr double too_wide_per_cm2 = 0.15;

/// Never open into each other; all other pairs hardly (a thin wall may be lost in the image).
struct Strangers {
  Name a, b;
};
constexpr std::array<Strangers, 10> strangers = {{
    {Name::lv, Name::rv},
    {Name::lv, Name::ra},
    {Name::lv, Name::pulmonary_artery},
    {Name::lv, Name::svc},
    {Name::lv, Name::ivc},
    {Name::lv, Name::descending_aorta},
    {Name::la, Name::rv},
    {Name::rv, Name::svc},
    {Name::rv, Name::ivc},
    {Name::ra, Name::pulmonary_artery},
}};
constexpr double strangers_per_cm2 = 1, others_per_cm2 = 0.1;

/// One behind the other in the stream: their grey values differ little. The cavae's and the right atrium's say nothing
/// (unmixed contrast).
struct Stream {
  Name from, to;
  double sigma;    ///< share of the contrast
  double at_most;  ///< cost
};
constexpr std::array<Stream, 5> streams = {{
    {Name::lv, Name::la, .1, 6},
    {Name::lv, Name::aorta, .1, 6},
    {Name::aorta, Name::descending_aorta, .1, 4},
    {Name::rv, Name::pulmonary_artery, .25, 3},
    {Name::ra, Name::rv, .5, 3},
}};

// Place: the centres against the usual ones, after a free shift, a small turn and a scale.
constexpr double place_sigma_mm = 12, turn_sigma_rad = 0.3, size_sigma = 0.15;
constexpr double max_volume_cost = 8;                            ///< per name
constexpr double ln_deviation_sigma = 0.45, max_shape_cost = 4;  ///< per name and axis
constexpr double max_grey_cost = 6;                              ///< per name
constexpr double grey_saturates = 0.6;  ///< brighter than the left heart by this share of the contrast: no brighter

// The left ventricle's shell of muscle, measured this far outside its blood.
constexpr double shell_from_mm = 3.5, shell_to_mm = 7.5;
constexpr double usual_muscle_share = 0.65, muscle_share_sigma = 0.12;
constexpr double darker_muscle_hu = 45, brighter_muscle_share = 0.4;  ///< muscle: from its own mode, of the contrast

// Blood without a name, deep between the lungs.
constexpr double unnamed_per_ml = 0.2, max_unnamed = 8, shallow_level = 0.15, shallow_share = 0.5;
constexpr double deep_from_mm = 18, deep_to_mm = 38, unnamed_peak_mm = 4;
// Ribs and sternum lie at the rim of the room; only the descending aorta lies on the spine.
constexpr double rim_mm = 18, rim_softness_mm = 8, rim_cost = 1.5, rim_ml = 4;
constexpr double before_spine_mm = 50, before_spine_softness_mm = 12;
constexpr double on_spine_mm = 28, on_spine_softness_mm = 8, on_spine_ml = 10;
constexpr double smallest_ml = 1.5;  ///< less blood under a name is none

// Borders between names: dear where there is neither a neck nor a step of grey.
constexpr double cut_per_cm2 = 0.5, neck_ratio = 0.7, grey_step = 0.1;
constexpr double lone_cost = 0.8, lone_ml = 3, lone_cm2 = 0.1;  ///< a piece apart from the rest of its name

/// The right heart's blood, which contrast may not have reached.
constexpr std::array<Name, 5> right_heart = {Name::rv, Name::ra, Name::pulmonary_artery, Name::svc, Name::ivc};
constexpr double no_right_contrast = 30;  ///< cost where none of it is found, in place of the sum of its parts

// Where the image ends: what is expected outside costs this share where it is missing.
constexpr double missing_outside = 0.25;
constexpr double cut_from_cm2 = 2;  ///< more of a name's surface at the image's border: it may be smaller than usual

// Small pieces at the rim of the room are vessels of the lung and marrow: they take no part.
constexpr double no_part_ml = 3, no_part_depth_mm = 14;

// Levels and pieces.
constexpr double enhanced_hu = 110;              ///< unenhanced blood and muscle stay below
constexpr double min_deep_ml = 20, deep_mm = 6;  ///< of blood with contrast between the lungs, or there is none
constexpr double undiluted_hu = 600;             ///< more is contrast before it is mixed
constexpr double soft_tissue_hu = 60, brightest_muscle_hu = 190;
constexpr double wall_from_mm = 3.5, wall_to_mm = 8, core_mm = 7;

// The spine's zone in the room between the lungs: no heart there.
constexpr double spine_before_mm = 8, spine_half_width_mm = 30, spine_radius_mm = 21, spine_behind_mm = 10;

}  // namespace heartgen::naming
