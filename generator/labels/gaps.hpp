// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Gaps of a voxel or two between the blood of chambers whose masks were made one by one: valves that would be muscle.
#pragma once
#include <string>
#include <vector>

#include "model/certificate.hpp"
#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::labels {

/// Two regions of blood with an open valve between them.
struct ValvePair {
  Region from, to;
  const char* orifice;  ///< the surface where they meet
  double open_mm2;      ///< contact of an open valve, at least
};
std::vector<ValvePair> valve_pairs();

/// Gives what lies between the blood of neighbouring chambers that hardly touch, one of them given, to the nearer one:
/// where the CT tells blood from muscle, what is as bright as blood; else what is as narrow as the narrowest place and
/// a voxel more. No voxel that is given as anything but torso changes. All on one grid; `ct` may be null.
LabelVolume with_closed_gaps(LabelVolume chambers, const LabelVolume& given, const CtVolume* ct);

/// A warning labels.no_outlet for each ventricle or atrium of a heart with both that has no way to its neighbour, and
/// labels.narrow_valve where they hardly touch.
std::vector<Warning> closed_valves(const LabelVolume& heart);

}  // namespace heartgen::labels
