// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: which part of the ventricles' wall is the left one's.
#pragma once
#include "generator/anatomy/wall_cells.hpp"

namespace heartgen::anatomy {

/// The part of the wall of both `ventricles` (their cut, blood included) that is the left ventricle's, with the septum.
/// Where the right free wall meets it the left wall goes on as thick as it is beside: its thickness is measured at its
/// free outer surface and at the septum's right side, and interpolated over the junction between them.
Mask left_part(const HeartBand& heart, const Mask& ventricles);

}  // namespace heartgen::anatomy
