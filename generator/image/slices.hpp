// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: connected components of one slice.
#pragma once
#include "generator/image/components.hpp"
#include "model/volume.hpp"

namespace heartgen::image {

/// Components (sharing an edge) of the pixels of slice k whose value obeys the rule.
template <class Rule>
Components slice_components(const Volume<float>& image, std::int64_t k, Rule&& rule) {
  Grid grid = image.grid;
  grid.size[2] = 1;
  Mask pixels(grid);
  const auto first = static_cast<std::size_t>(image.grid.offset(0, 0, k));
  for (std::size_t p = 0; p < pixels.voxels.size(); ++p) pixels.voxels[p] = rule(image.voxels[first + p]);
  return connected_components(pixels);
}

}  // namespace heartgen::image
