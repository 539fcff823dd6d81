// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Surfaces of label maps as smooth as the labels ask for and no smoother.
/// Labels are uneven: they have steps, and lumps where a segmentation followed an image's noise. Hearts have grooves,
/// rims and corners. Smoothing over a ladder of scales splits a surface into details; how large those of each scale are
/// on most of the surface says how uneven the labels are, and details no larger are taken away: undecimated wavelets
/// (Starck and Murtagh, Astronomical Image and Data Analysis, 2006) with the noise from a median (Donoho and Johnstone
/// 1994) and gains from the neighbourhood (Mihcak et al., IEEE Signal Processing Letters 6, 1999). Where a surface runs
/// nearly along the labels' slices, its steps are wide terraces, larger details than noise elsewhere: how large they
/// are follows from the slope alone, so they are known not to be shape. Not collective; the same bits for any number of
/// threads.
#pragma once
#include <array>

#include "model/volume.hpp"

namespace heartgen::ventricles {

/// Distance in mm to the surface of `inside`, negative inside. `own`: 1 where the surface nearby is even but for the
/// labels, clear of grooves and ends; there their unevenness is measured. `step_voxels`: how coarse the labels are that
/// `inside` comes from. On a grid with isotropic spacing.
LevelSet regularized_surface(const Mask& inside, const Mask& own, double step_voxels);

/// From a voxel of a label map to its next along each axis, mm; zero where terraces are not looked for.
using LabelSteps = std::array<Vec3, 3>;

/// The same of a surface whose distance is known, as `step_voxels` coarse labels have it.
LevelSet regularized_surface(const LevelSet& surface, const Mask& own, double step_voxels,
                             const LabelSteps& steps_mm = {});

}  // namespace heartgen::ventricles
