// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The hierarchical segmentation (thesis 5.3, 5.4, 6): a tree of two-phase splits. Each step divides one side of an
/// earlier step by a Chan-Vese contour.
#pragma once
#include <string>
#include <vector>

#include "generator/parallel/comm.hpp"
#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heartgen::pde {

struct SegmentationSide {
  std::string name;
  Mask below;          ///< voxels of the domain on the darker side
  Mask above;          ///< voxels of the domain on the brighter side
  double c_below = 0;  ///< median (L1) or mean (L2) grey value of each side
  double c_above = 0;
  int iterations = 0;  ///< sweeps of the solver
};

using SegmentationTree = std::vector<SegmentationSide>;

/// Throws UserError for a repeated name, a domain that names no earlier step, an unknown norm and weights out of range.
void check_steps(const std::vector<SegmentationStep>& steps);

/// Throws UserError, naming `where`, when `name` is no side of a step, such as "blood.above".
void check_side(const std::vector<SegmentationStep>& steps, const std::string& name, const std::string& where);

/// Runs the steps in order. @collective: the image is read on the root only, the tree is complete on the root and has
/// names and grey values, but empty masks, elsewhere.
/// Throws UserError (on every rank) as check_steps, and for an empty domain.
SegmentationTree segment(const Volume<float>& image_on_root, const std::vector<SegmentationStep>& steps,
                         const parallel::Comm& comm);

/// The mask that a domain such as "blood.above" names. Throws UserError for an unknown name.
const Mask& side(const SegmentationTree& tree, const std::string& name);

/// The grey value (median or mean) of that side.
double grey_value(const SegmentationTree& tree, const std::string& name);

}  // namespace heartgen::pde
