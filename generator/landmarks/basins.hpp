// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the blood divided into basins at its constrictions, and the graph of their neighbourhood.
/// A watershed of the depth (distance to the wall): voxels are added from the deepest to the shallowest; where two
/// basins meet they are joined if the way between them is nearly as wide as the narrower one, else the line between
/// them stays. The lines fall on the valves.
#pragma once
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::landmarks {

struct Contact {
  double width_mm = 0;  ///< the greatest depth on the common border: half the width of the way from one to the other
  double area_mm2 = 0;  ///< common voxel faces
};

struct Basins {
  Volume<std::int32_t> label;  ///< 0 outside and in pools without depth; 1..N by falling volume
  Volume<float> depth_mm;      ///< distance to the wall
  std::int32_t count = 0;
  std::map<std::pair<std::int32_t, std::int32_t>, Contact> contacts;  ///< smaller label first

  double width(std::int32_t a, std::int32_t b) const;  ///< width_mm of a contact, 0 for none
};

Basins divide_at_constrictions(const Mask& blood);

}  // namespace heartgen::landmarks
