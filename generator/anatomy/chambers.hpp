// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Chambers and great vessels out of the contrast-filled blood (thesis 6.2: components of seeds, separated at the
/// planes of the valves).
#pragma once
#include "generator/pde/hierarchy.hpp"
#include "model/landmarks.hpp"
#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// lv_blood, rv_blood, la_blood, ra_blood, aorta, pulmonary_artery and papillary on the CT's grid, 0 elsewhere.
/// Needs seeds for the four chambers; aorta and pulmonary artery where seeds are given. Valve planes, where given,
/// are where the regions end; else they end at the narrowest section between the seeds. Of the tree only the grey
/// values are used (what muscle and blood look like); the blood itself is cut by the local contrast, see
/// blood_pool.hpp. Throws UserError for a missing seed, a seed outside the image or not in blood. Root only.
LabelVolume split_chambers(const CtVolume& ct, const pde::SegmentationTree& tree, const Landmarks& landmarks,
                           const ChamberSettings& settings);

}  // namespace heartgen::anatomy
