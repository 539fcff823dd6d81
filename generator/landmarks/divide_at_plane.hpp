// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: moves the border between two pools to a plane.
#pragma once
#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::landmarks {

/// The main piece of the two pools' blood on the side that `normal` points to becomes `beyond`, the main piece on the
/// other side `ventricle`; pieces cut off by the plane (a recess that bulges past it) keep their label.
void divide_at_plane(LabelVolume& chambers, Region ventricle, Region beyond, const Vec3& point, const Vec3& normal);

}  // namespace heartgen::landmarks
