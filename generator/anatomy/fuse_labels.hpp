// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// One label map out of the stages' results.
#pragma once
#include "generator/anatomy/body.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// What lies around the heart as a label map. Precedence, highest first: trachea | bone | lung | liver | torso (the
/// rest of the body). All on one grid; an empty `trachea` is left out. Root only.
LabelVolume label_surroundings(const BodyResult& body, const Mask& trachea);

/// Precedence, highest first: chambers (blood, vessels, papillary) | walls | surroundings. All on one grid; an empty
/// `walls` (no voxels) is left out. Pieces of a heart region (not of papillary muscle, which is many pieces) with less
/// than 1 % of its volume are islands and take the nearest other label. Root only.
LabelVolume fuse_labels(const LabelVolume& chambers, const LabelVolume& walls, const LabelVolume& surroundings);

}  // namespace heartgen::anatomy
