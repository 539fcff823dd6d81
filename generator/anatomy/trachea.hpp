// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The lumen of the trachea (thesis 6.2.1): air around a seed, with a size limit against leaks into the lungs.
#pragma once
#include "generator/pde/hierarchy.hpp"
#include "model/landmarks.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// Air of the trachea and the main bronchi. Starts from the seed "trachea", else from the longest chain of round air
/// discs through the slices; empty where there is none (a CT that does not reach the neck) or where it cannot be
/// parted from the lungs. Root only. Throws UserError for a seed outside the image or not in air.
Mask segment_trachea(const CtVolume& ct, const pde::SegmentationTree& tree, const Landmarks& landmarks);

}  // namespace heartgen::anatomy
