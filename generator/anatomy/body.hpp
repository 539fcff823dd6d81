// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Everything around the heart: the body inside the skin, lungs, bone and liver.
#pragma once
#include "generator/pde/hierarchy.hpp"
#include "model/landmarks.hpp"
#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

struct BodyResult {
  Mask body;   ///< the largest piece of tissue with everything inside it: air in lungs and airways too, no table
  Mask lung;   ///< lung air and the vessels in it; airways that open into it
  Mask bone;   ///< cortical and spongy bone, filled, without the spinal canal and contrast-filled vessels
  Mask liver;  ///< at the "liver" seed, else where a liver lies; all 0 where none is found
};

/// `chambers` on the CT's grid. Root only. Throws UserError where no tissue is found, and
/// for a wrong liver seed. A seed outside the image is left alone: the scan may end above the liver.
BodyResult segment_body(const CtVolume& ct, const pde::SegmentationTree& tree, const LabelVolume& chambers,
                        const Landmarks& landmarks, const ChamberSettings& settings);

}  // namespace heartgen::anatomy
