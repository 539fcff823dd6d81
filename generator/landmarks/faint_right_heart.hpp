// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the right heart where its blood is hardly brighter, or darker, than muscle.
#pragma once
#include <optional>

#include "generator/anatomy/faint_blood.hpp"
#include "generator/landmarks/contrast.hpp"
#include "generator/landmarks/long_axis.hpp"

namespace heartgen::landmarks {

/// A faint right heart's grey values and surroundings, on the chambers' grid.
struct FaintRightHeart {
  anatomy::FaintContrast contrast;
  anatomy::WallDistances walls;
  Mask near;  ///< within 6 mm of its cavities
};

/// `chambers` holds the left heart; on return all blood of the right heart is rv_blood (what it held there before is
/// replaced). The right heart is the soft tissue across the septum that hangs together through wide ways, once walls of
/// usual thickness are taken off. `region`: where heart blood may be. Nothing, and `chambers` unchanged, where there is
/// no such space.
std::optional<FaintRightHeart> add_faint_right_heart(LabelVolume& chambers, const chest::WorkingImage& image,
                                                     const Mask& region, const LongAxis& axis, const Contrast& contrast,
                                                     double muscle_hu);

}  // namespace heartgen::landmarks
