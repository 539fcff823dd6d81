// The phantom's companion images: an MR-like torso of another patient and a carotid angiogram.
#pragma once
#include "datasets/phantom/phantom.hpp"

namespace heart::datasets {

/// Fills torso_model, torso_mr, torso_mr_labels and torso_mr_landmarks: whole torso, 3 x 3 x 4 mm.
void add_torso_mr(Phantom& phantom, int variant);

/// Fills carotid, carotid_labels and carotid_seed_mm: the bifurcation on a grid of 0.5 mm.
void add_carotid(Phantom& phantom, int variant, double noise_hu);

}  // namespace heart::datasets
