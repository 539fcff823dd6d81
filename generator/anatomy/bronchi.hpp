// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: airways that are too thin for a contour of high curvature weight (thesis 6.2.1 leaves them
/// out), followed from the wide ones on.
#pragma once
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// `airways` with the bronchi that leave them: what hangs together with them in voxels darker than a level between the
/// grey values of lumen and lung, the highest level that does not leak. A leak is anything that is wide where
/// `airways` found nothing, or that has a large share of their volume. `air`: airways and lung in one. Root only.
Mask with_bronchi(const CtVolume& ct, const Mask& airways, const Mask& air, double lumen_hu, double lung_hu);

}  // namespace heartgen::anatomy
