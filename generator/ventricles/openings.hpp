// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Where the ventricles open: their valves, and what lies beyond them.
/// Not collective; the same bits for any number of threads.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "generator/ventricles/ventricles.hpp"
#include "model/labels.hpp"

namespace heartgen::ventricles {

/// The disc of a valve.
struct Opening {
  Vec3 center_mm, normal;  ///< the normal is unit, out of the ventricle
  double radius_mm = 0;
};

/// Where blood of `ventricle` touches blood of `beyond`; empty where fewer than 20 voxels do.
std::optional<Opening> contact_disc(const LabelVolume& labels, Region ventricle, Region beyond);

/// "mitral", "aortic", "tricuspid" and "pulmonary": from the landmarks, else where the labels meet; those known.
std::map<std::string, Opening> openings_of(const LabelVolume& labels, const Landmarks& landmarks);

/// Only what lies beyond a valve is no epicardium: muscle that faces it ends there as at a cut (Part::other). Where
/// atria and vessels lie upon a ventricle, its wall has its outer surface like anywhere else (Part::outside).
void close_base(Volume<std::uint8_t>& parts, const std::map<std::string, Opening>& openings);

/// On `grid`: lv_cavity or rv_cavity where blood just beyond an outflow valve goes on through the orifice, no wider
/// than it, else outside. Without it the cavity's surface would bend over its valve.
Volume<std::uint8_t> blood_beyond(const LabelVolume& labels, const Grid& grid,
                                  const std::map<std::string, Opening>& openings);

/// The same for ventricles cut at a plane and labelled without vessels: an orifice is where their blood meets what is
/// no part of the heart below the plane. What lies beyond one becomes Part::other.
Volume<std::uint8_t> open_orifices(Volume<std::uint8_t>& parts, const Plane& cut);

}  // namespace heartgen::ventricles
