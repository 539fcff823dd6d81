// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: several iterations of a sweep over a slab while its fields come from memory once.
///
/// An iteration of a row needs the one before of the rows and slices next to it. Iteration n follows n slices and n
/// rows behind iteration 0 through blocks of rows, so that it finds what it needs in the cache. Where a piece of a slab
/// (a thread's or a rank's) ends inside the image, each iteration gets one slice less far than the one before; what is
/// left there is done afterwards, iteration by iteration, with what the neighbours have done meanwhile.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

/// Slices [first, end) that one thread does.
struct Piece {
  std::int64_t first = 0, end = 0;
  bool open_below = false, open_above = false;  ///< the image goes on there

  /// The slices that iteration n reaches without what the neighbours did in the iterations 0 .. n - 1.
  std::int64_t lower(std::int64_t n) const { return open_below ? first + n : first; }
  std::int64_t upper(std::int64_t n) const { return open_above ? end - n : end; }
};

/// A piece of the slab's slices for every thread.
template <class T>
std::vector<Piece> pieces_of(const parallel::Slab<T>& slab) {
  const auto count = std::min<std::int64_t>(parallel::thread_count(), slab.count);
  std::vector<Piece> pieces;
  for (std::int64_t p = 0; p < count; ++p) {
    const auto first = slab.first + slab.count * p / count, end = slab.first + slab.count * (p + 1) / count;
    pieces.push_back({first, end, first > 0, end < slab.grid.size[2]});
  }
  return pieces;
}

/// Calls at(piece) for all pieces, in any order or at the same time.
template <class At>
void for_pieces(const std::vector<Piece>& pieces, At&& at) {
  parallel::parallel_for(0, static_cast<std::int64_t>(pieces.size()), [&](std::int64_t from, std::int64_t to) {
    for (auto p = from; p < to; ++p) at(pieces[static_cast<std::size_t>(p)]);
  });
}

/// Iterations of one pass: at most four, because what is left at the ends of a piece grows with their square; one where
/// the slab is too thin for more.
template <class T>
int pass_depth(const parallel::Slab<T>& slab, int iterations) {
  constexpr std::int64_t most = 4, slices_of_each = 8;
  const auto allowed = std::clamp<std::int64_t>(slab.count / (slices_of_each * parallel::thread_count()), 1, most);
  return static_cast<int>(std::min<std::int64_t>(allowed, iterations));
}

/// Rows of a block: the slices that are between the first iteration and the last fit into a processor's own cache.
inline std::int64_t rows_of_block(std::int64_t nx, int depth, std::int64_t bytes_per_voxel) {
  constexpr std::int64_t cache_bytes = 1 << 20;
  return std::max<std::int64_t>(cache_bytes / ((depth + 1) * bytes_per_voxel * nx), 4);
}

/// Calls rows(n, from, to, k) for all rows [from, to) of all slices k of a piece, for the iterations n < depth in an
/// order in which (n, j, k) comes after (n - 1, j + 1, k + 1), (n, j - 1, k) and (n, j, k - 1).
template <class Rows>
void for_wavefront(const Piece& piece, std::int64_t row_count, std::int64_t block, int depth, Rows&& rows) {
  for (std::int64_t begin = 0; begin < row_count; begin += block) {
    const auto stop = begin + block;
    for (auto front = piece.first; front < piece.end + depth - 1; ++front)
      for (std::int64_t n = 0; n < depth; ++n) {
        const auto k = front - n;
        if (k < piece.first || k >= piece.end) continue;
        rows(n, std::max<std::int64_t>(begin - n, 0), stop < row_count ? stop - n : row_count, k);
      }
  }
}

}  // namespace heartgen::pde
