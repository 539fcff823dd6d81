// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The blood divided into basins at its constrictions, and the graph of their neighbourhood.
/// A watershed of the depth (distance to the wall): voxels are added from the deepest to the shallowest; where two
/// basins meet they are joined if the way between them is nearly as wide as the narrower one, else the line between
/// them stays. The lines fall on the valves.
#pragma once
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::image {

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

/// Which basins are joined where they meet. The defaults part the chambers of a heart on a grid of 1.5 mm.
struct BasinSettings {
  float peak_level_mm = 4;        ///< peaks below are no chamber and no great vessel: they join what they meet
  float noise_drop_mm = 0.75;     ///< half a voxel: below is the noise of a distance on a grid
  float join_above_ratio = 0.88;  ///< way / narrower basin. Valves: 0.5 to 0.8; trabeculated chambers: above 0.9
};

Basins divide_at_constrictions(const Mask& blood);

/// The same of any depth, positive inside.
Basins divide_at_constrictions(Volume<float> depth_mm, const BasinSettings& settings);

/// Common faces and widths of the labels (0: none) of `basins.label`, with its depth.
void measure_contacts(Basins& basins);

}  // namespace heartgen::image
