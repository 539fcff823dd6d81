// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The phantom's companion images: an MR-like torso of another patient and a carotid angiogram.
#pragma once
#include "datasets/phantom/phantom.hpp"

namespace heartgen::phantom {

/// Fills torso_model, torso_mr, torso_mr_labels and torso_mr_landmarks: whole torso, 3 x 3 x 4 mm.
void add_torso_mr(Phantom& phantom, int variant);

/// Fills carotid, carotid_labels and carotid_seed_mm: the bifurcation in a field of 36 x 36 x 84 mm.
void add_carotid(Phantom& phantom, int variant, double noise_hu, const Vec3& spacing_mm = {0.5, 0.5, 0.5});

}  // namespace heartgen::phantom
