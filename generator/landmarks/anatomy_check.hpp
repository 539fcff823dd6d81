// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: does what was found look like the heart of an adult?
#pragma once
#include <optional>

#include "generator/anatomy/faint_blood.hpp"
#include "generator/landmarks/landmarks.hpp"
#include "generator/landmarks/left_wall.hpp"
#include "generator/landmarks/long_axis.hpp"
#include "generator/landmarks/valves.hpp"

namespace heartgen::landmarks {

struct Findings {
  const LabelVolume& chambers;
  const std::map<std::string, ValvePatch>& valves;
  const LongAxis& axis;
  const std::map<std::string, double>& volumes_ml;
  LeftWall left_wall{};
  double ventricle_certainty = 0;
  std::optional<double> left_of_spine_mm{};       ///< middle of the heart's blood; none where the spine is not sure
  std::optional<anatomy::FaintContrast> faint{};  ///< of the right heart, where it was found by that
  bool slanted = false;  ///< the header turns the image: that is told elsewhere, in place of other suspicions
};

/// Fills warnings and confidence.
void check_anatomy(const Findings& findings, FoundLandmarks& found);

}  // namespace heartgen::landmarks
