// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder and generator/contours: loops over the voxels of a row, for generator/parallel/simd.hpp.
#pragma once
#include <cstdint>

#include "generator/parallel/simd.hpp"

namespace heartgen::pde {

using parallel::vectorised;

/// Voxels that a block of a row has: the longest vector.
inline constexpr std::int64_t block = 16;

/// Calls at(i) for i in [0, n), in whole blocks for the vectoriser; the last block begins earlier where n is no
/// multiple of the block, so at(i) may be called twice and must not read what it writes.
template <class At>
HEARTGEN_INLINE void for_blocks(std::int64_t n, At&& at) {
  if (n < block) {
    for (std::int64_t i = 0; i < n; ++i) at(i);
    return;
  }
  for (std::int64_t begin = 0; begin < n; begin += block) {
    const auto first = begin < n - block ? begin : n - block;
    HEARTGEN_INDEPENDENT
    for (std::int64_t i = 0; i < block; ++i) at(first + i);
  }
}

/// Calls at(left, i, right) for the voxels of a row, the ends being their own neighbours.
template <class At>
HEARTGEN_INLINE void for_row(std::int64_t nx, At&& at) {
  const auto last = nx - 1;
  at(std::int64_t{0}, std::int64_t{0}, last > 0 ? std::int64_t{1} : std::int64_t{0});
  for_blocks(nx - 2, [&](std::int64_t i) HEARTGEN_INLINE_LAMBDA { at(i, i + 1, i + 2); });
  if (last > 0) at(last - 1, last, last);
}

HEARTGEN_INLINE float larger(float a, float b) { return a > b ? a : b; }
HEARTGEN_INLINE float smaller(float a, float b) { return a < b ? a : b; }
HEARTGEN_INLINE float square(float v) { return v * v; }

}  // namespace heartgen::pde
