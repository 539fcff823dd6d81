// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Masks by a rule. Deterministic; a rule has no side effects.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::image {

/// 1 at the voxels, told by their place in the volume, for which `rule(std::size_t)` holds.
template <class Rule>
Mask mask_where(const Grid& grid, Rule&& rule) {
  Mask mask(grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) mask.voxels[v] = rule(v) ? 1 : 0;
  return mask;
}

/// 1 where `rule(std::uint8_t)` holds of the voxel's value; each value is asked once.
template <class Rule>
Mask mask_where(const Volume<std::uint8_t>& volume, Rule&& rule) {
  std::array<std::uint8_t, 256> table{};
  for (std::size_t value = 0; value < table.size(); ++value)
    table[value] = rule(static_cast<std::uint8_t>(value)) ? 1 : 0;
  Mask mask(volume.grid);
  std::transform(volume.voxels.begin(), volume.voxels.end(), mask.voxels.begin(),
                 [&](std::uint8_t value) { return table[value]; });
  return mask;
}

/// 1 in a region.
inline Mask mask_of(const LabelVolume& labels, Region region) {
  return mask_where(labels, [&](std::uint8_t label) { return label == tag(region); });
}

}  // namespace heartgen::image
