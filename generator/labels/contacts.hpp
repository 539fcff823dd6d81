// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: which regions of a label map touch, and over which area.
#pragma once
#include <array>
#include <cstdint>
#include <numeric>

#include "model/labels.hpp"
#include "model/priors.hpp"
#include "model/volume.hpp"

namespace heartgen::labels {

constexpr double far_more = 2;  ///< as much contact as with the right neighbour, before it is a mistake

/// Areas over which voxels of two regions touch.
struct Contacts {
  static constexpr std::size_t regions = 18;
  std::array<std::array<double, regions>, regions> area_mm2{};
  std::array<bool, 256> is_there{};

  void add(std::uint8_t a, std::uint8_t b, double area) {
    if (a == b || a >= regions || b >= regions) return;
    area_mm2[a][b] += area;
    area_mm2[b][a] += area;
  }
  /// With what lies around the heart.
  double outside(Region region) const {
    using enum Region;
    return of(region, none) + of(region, torso) + of(region, lung) + of(region, liver) + of(region, bone);
  }
  double of(Region a, Region b) const { return area_mm2[tag(a)][tag(b)]; }
  /// With anything.
  double all(Region region) const {
    return std::accumulate(area_mm2[tag(region)].begin(), area_mm2[tag(region)].end(), 0.0);
  }
  /// Whether `region` touches `wrong` as it should touch `right`, which is there.
  bool prefers(Region region, Region wrong, Region right) const {
    return is_there[tag(right)] && of(region, wrong) > priors::smallest_valve_mm2 &&
           of(region, wrong) > far_more * of(region, right);
  }
};

Contacts contacts_in(const LabelVolume& labels);

}  // namespace heartgen::labels
