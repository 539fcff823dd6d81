// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Labels without wedges and slivers.
#pragma once
#include <cstdint>
#include <span>

#include "model/volume.hpp"

namespace heartgen::mesh {

/// Opens each of some labels by a ball, the others and the outside (0) being in its way: a voxel that no ball of its
/// own label reaches goes to the label whose ball comes nearest, if one comes within a width of the ball. What is thin
/// but has no other label beside it stays, and so does the outside. The same result for any number of threads.
void open_labels(LabelVolume& labels, std::span<const std::uint8_t> tags, double radius_mm);

}  // namespace heartgen::mesh
