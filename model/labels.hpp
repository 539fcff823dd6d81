// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The only table of region, surface, rim and cap names and their integer tags.
/// Tags are part of the bundle format: only append. Regions 1-50, the user's own 51-99, surfaces from 101: some readers
/// share one table.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace heartgen {

enum class Region : std::uint8_t {
  none = 0,
  lv_myocardium = 1,
  rv_myocardium = 2,
  papillary = 3,
  la_wall = 4,
  ra_wall = 5,
  lv_blood = 6,
  rv_blood = 7,
  la_blood = 8,
  ra_blood = 9,
  aorta = 10,
  pulmonary_artery = 11,
  lung = 12,
  bone = 13,
  liver = 14,
  trachea = 15,
  carotid = 16,
  torso = 17,
  la_annulus = 18,  ///< of meshes alone: the layer of an atrium's wall that does not conduct into the ventricles
  ra_annulus = 19,
};

constexpr std::uint8_t tag(Region region) { return static_cast<std::uint8_t>(region); }

struct NamedTag {
  std::string_view name;
  std::int32_t tag;
};

/// All regions in tag order (without `none`).
const std::vector<NamedTag>& region_table();
/// All surfaces with a fixed tag. Numbered ends (trachea_end_N, carotid_end_N ...) follow `end_surface_tag`.
const std::vector<NamedTag>& surface_table();

std::string region_name(std::int32_t tag);  ///< "region_42" for an unknown tag
std::optional<Region> region_from_name(std::string_view name);
std::string surface_name(std::int32_t tag);  ///< also trachea_end_N ..., and of caps: mitral_orifice_cap
std::optional<std::int32_t> surface_from_name(std::string_view name);

/// Tag of the N-th (1-based) cut end of the trachea (200 + N), the carotid (300 + N), the aorta (400 + N), the
/// pulmonary artery (500 + N) or a pulmonary vein (600 + N, of la_blood).
std::int32_t end_surface_tag(Region vessel, int number);

/// The surface where two regions meet (order does not matter; Region::none is the outside of the mesh).
/// Total: every pair has exactly one surface, so every boundary face gets exactly one label. Pairs without an
/// anatomical name of their own get the name of the coarser boundary they belong to (e.g. epicardium).
std::int32_t surface_between(Region a, Region b);

/// Tag of the cap over an opening whose surface in the blood has this tag: 2000 more.
constexpr std::int32_t cap_tag(std::int32_t surface) { return 2000 + surface; }
constexpr bool is_cap(std::int32_t tag) { return tag > cap_tag(0); }

/// Tags of the user's own regions.
constexpr std::int32_t first_user_region = 51, last_user_region = 99;

/// Whether a label map can hold the region; the annuli are made of meshes.
constexpr bool is_label(Region region) { return region <= Region::torso; }

bool is_myocardium(Region region);  ///< ventricles, papillary muscles, atrial walls with their annuli
bool is_annulus(Region region);
bool is_blood(Region region);  ///< chambers, aorta, pulmonary artery

}  // namespace heartgen
