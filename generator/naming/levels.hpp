// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Grey values of the heart's blood and muscle, and the thresholds between them.
#pragma once
#include <vector>

#include "model/volume.hpp"

namespace heartgen::naming {

struct Levels {
  double deep_ml = 0;    ///< of blood with contrast, deep in the room
  double blood_hu = 0;   ///< the left heart's
  double muscle_hu = 0;  ///< around the brightest blood
  double contrast_hu() const { return blood_hu - muscle_hu; }
  bool has_contrast() const;
};

/// `smooth` and `room` on one grid.
Levels find_levels(const Volume<float>& smooth, const Mask& room);

/// Thresholds by falling brightness, each at the emptiest place of the histogram of `flat` grey values in its window,
/// so that none runs through a chamber's own grey value. `noise_hu`: standard deviation.
std::vector<double> thresholds(const std::vector<float>& flat, const Levels& levels, double noise_hu);

}  // namespace heartgen::naming
