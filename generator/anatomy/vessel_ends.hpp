// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Where the heart's vessels end in the model: arteries cut flat and perpendicular to their axis, veins cut to stumps.
#pragma once
#include "model/landmarks.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// The part of an artery within `length_mm` of its valve, measured along the inside. Each branch that goes on ends in
/// a plane perpendicular to its axis there. `start` marks where the artery begins (voxels at its valve).
Mask cut_artery(const Mask& artery, const Mask& start, double length_mm);

/// A chamber without the veins that enter it: its wide part (the opening by `core_share` of its inscribed radius,
/// the piece that holds the deepest point) and what lies within `stump_mm` of it along the inside.
Mask cut_veins(const Mask& chamber, double core_share, double stump_mm);

/// A right atrium without the venae cavae, which leave it above and below: each ends in a plane perpendicular to its
/// axis, `stump_radii` of its radii away from where its section, followed inwards, has grown twice as large. A vein
/// that cannot be followed so ends level, 10 mm above or 4 mm below the wide part (as in cut_veins). Up and down are
/// the patient's. The veins should be there for 10 mm more.
Mask cut_venae_cavae(const Mask& atrium, double core_share, double stump_radii);

/// The largest piece of a region without branches thinner than `radius_mm` (coronaries at the aortic root, small
/// veins): its opening, and what lies within a voxel's reach of it.
Mask drop_thin_branches(const Mask& region, double radius_mm);

}  // namespace heartgen::anatomy
