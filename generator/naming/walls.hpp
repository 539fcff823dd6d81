// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Walls that show between two pools of blood though they are too thin, or their blood too different, for a threshold.
#pragma once
#include "generator/naming/levels.hpp"
#include "generator/naming/scene.hpp"

namespace heartgen::naming {

struct Walls {
  Mask valley;              ///< darker than the blood on both sides: a septum
  Mask ridge;               ///< where the grey value changes fastest, between blood and brighter blood
  std::vector<float> flat;  ///< grey values of the room where they hardly change
  double noise_hu = 0;      ///< standard deviation
};

Walls find_walls(const Scene& scene, const Levels& levels);

/// Grey closing by a ball: dark valleys narrower than it are filled, the rest stays.
Volume<float> grey_closing(const Volume<float>& image, double radius_mm);

}  // namespace heartgen::naming
