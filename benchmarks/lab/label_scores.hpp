// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How far some regions of a label map are from those of a phantom.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::lab {

struct Score {
  std::string name;
  double dice = 0;
  double mean_mm = 0, max_mm = 0;  ///< surface distances
  double volume_ml = 0;            ///< ours
};

/// One row per region, over the box that holds them in either map; none where neither has any of them.
std::vector<Score> scores_of(const LabelVolume& ours, const LabelVolume& truth, std::span<const Region> regions);

LabelVolume labelled(const Mask& mask, Region region);

}  // namespace heartgen::lab
