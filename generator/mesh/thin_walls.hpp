// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Where the walls of the heart are thin.
#pragma once
#include "generator/mesh/domain.hpp"

namespace heartgen::mesh {

/// 1 where a wall of a chamber has a local thickness below `thickness_mm`: the diameter of the largest ball inside the
/// muscle that holds the place (Hildebrand and Rueegsegger 1997; corners of thick parts are spared). The mask has a
/// sample every `sample_mm` over the box of the muscle, in the axes of the label map; its size is {1, 1, 1} where there
/// is no muscle. The same for any number of threads.
Mask thin_walls(const MeshDomain& domain, double thickness_mm, double sample_mm);

}  // namespace heartgen::mesh
