// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Seeds, valve planes and the long axis of the heart in a contrast-enhanced CT. LPS mm. Not collective; everything
/// throws UserError.
#pragma once
#include "generator/landmarks/landmarks.hpp"
#include "model/error.hpp"
#include "model/recipe.hpp"

namespace heartgen {

using landmarks::FoundLandmarks;

/// As `heartgen landmarks`: padding is closed first. A confidence below 0.5 can hardly be a heart.
FoundLandmarks find_landmarks(CtVolume ct);

}  // namespace heartgen
