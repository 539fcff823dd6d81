// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: which basins are the left ventricle, the left atrium and the aorta.
#pragma once
#include <optional>

#include "generator/landmarks/pools.hpp"

namespace heartgen::landmarks {

struct LeftHeart {
  std::vector<std::int32_t> ventricle;  ///< the main basin first
  std::int32_t atrium = 0, aorta = 0;
  std::vector<std::int32_t> descending_aorta;
  double certainty = 0;  ///< 1 minus the score of the second best ventricle relative to it, at least 0
};

/// The ventricle is the basin in a shell of muscle, left of the spine; atrium and aorta are its two widest
/// neighbours. Large papillary muscles can part its apex from its base: they are put together. `choice` 0 is the basin
/// that looks most like a left ventricle, 1 the next. Nothing where there is no such basin, or where it has fewer than
/// two neighbours. Throws UserError where no basin has a muscular shell.
std::optional<LeftHeart> find_left_heart(const image::Basins& basins, const Pools& pools, const chest::Spine& spine,
                                         std::size_t choice = 0);

}  // namespace heartgen::landmarks
