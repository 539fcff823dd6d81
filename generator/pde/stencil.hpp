// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: a row of an image with its neighbours.
#pragma once
#include <algorithm>

#include "generator/parallel/slab.hpp"
#include "generator/pde/row_kernels.hpp"

namespace heartgen::pde {

/// Row (j, k) with its neighbouring rows. Beyond the image the border is repeated: no flux goes through it.
inline StencilRow stencil_row(const parallel::Slab<float>& image, parallel::Slab<float>& out, std::int64_t j,
                              std::int64_t k) {
  const auto rows = image.grid.size[1], slices = image.grid.size[2];
  return {image.row(j, k),
          image.row(std::max<std::int64_t>(j - 1, 0), k),
          image.row(std::min(j + 1, rows - 1), k),
          image.row(j, std::max<std::int64_t>(k - 1, 0)),
          image.row(j, std::min(k + 1, slices - 1)),
          out.row(j, k),
          image.grid.size[0]};
}

/// Steps of a second-order operator: factor times the squares of the axis weights.
inline AxisWeights squared(const AxisWeights& w, double factor) {
  const auto f = static_cast<float>(factor);
  return {f * w.x * w.x, f * w.y * w.y, f * w.z * w.z};
}

}  // namespace heartgen::pde
