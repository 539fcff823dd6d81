// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Helix angles at places of known wall depth: what a fibre field looks like through a wall.
#pragma once
#include <vector>

namespace heartgen {

struct DepthSamples {
  std::vector<float> depth;      ///< 0 endocardium to 1 epicardium
  std::vector<float> helix_deg;  ///< per entry of `depth`, -90 to 90
};

}  // namespace heartgen
