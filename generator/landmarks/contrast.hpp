// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: grey values of soft tissue and of contrast-filled blood.
#pragma once
#include "generator/chest/thorax.hpp"
#include "generator/chest/working_image.hpp"

namespace heartgen::landmarks {

struct Contrast {
  double bright_hu = 0;  ///< what is brighter is blood with contrast or bone
  double soft_hu = 0;    ///< median of muscle and other soft tissue
  double blood_hu = 0;   ///< the left heart's blood
};

/// The first threshold above unenhanced tissue: the image is divided into two grey levels (medians), then its upper
/// part again, until the threshold is one that only contrast or bone exceed. `coarse` is the whole smoothed image.
double bright_threshold(const Volume<float>& coarse);

/// `chest` is where the heart may be, on the image's grid; what lies behind the front of the spine does not count.
/// Where too little is brighter than `bright_hu`, a lower threshold is taken, and given back. Throws UserError for an
/// image without contrast.
Contrast measure_contrast(const chest::WorkingImage& image, const Mask& chest, const chest::Spine& spine,
                          double bright_hu);

}  // namespace heartgen::landmarks
