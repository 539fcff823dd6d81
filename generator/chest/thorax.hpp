// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What surrounds the heart - lungs, the space between them, the spine.
#pragma once
#include <vector>

#include "model/volume.hpp"

namespace heartgen::chest {

/// The centre line of the vertebral bodies, one point per slice of a grid along the LPS axes.
struct Spine {
  double z0_mm = 0, step_mm = 1;
  std::vector<double> x_mm, y_mm;
  bool is_sure = true;  ///< false: the image may end before it

  /// At a height; the ends are continued.
  Vec3 at(double z_mm) const;
};

struct Thorax {
  Mask lung;   ///< air of the two lungs
  Mask chest;  ///< between and around the lungs: their convex hull per slice, grown
  Spine spine;
  bool back_is_cut = false;  ///< lungs end at the image's back: the spine may lie beyond it
};

/// `image` is smoothed and coarse (3 mm): nothing here needs detail. Throws UserError where there are no lungs.
Thorax find_thorax(const Volume<float>& image);

}  // namespace heartgen::chest
