// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: one iteration of the primal-dual method of Chambolle and Pock (2011) on a slab.
///
/// The dual field of a row needs the primal rows (j, k), (j + 1, k), (j, k + 1); the primal row then needs the dual
/// rows (j, k), (j - 1, k), (j, k - 1). Walking the rows in memory order, both are done in one pass in place. Where a
/// thread (or a rank) begins, the dual rows of the slice below are done beforehand. Several iterations are done in one
/// pass.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "generator/parallel/slab.hpp"
#include "generator/pde/row_kernels.hpp"
#include "generator/pde/row_runs.hpp"
#include "generator/pde/spacing.hpp"
#include "generator/pde/wavefront.hpp"

namespace heartgen::pde {

struct PrimalDualFields {
  parallel::Slab<float> u;
  parallel::Slab<float> bar;         ///< extrapolated u, one ghost slice
  parallel::Slab<float> px, py, pz;  ///< dual field, one ghost slice, zero at the start
};

/// Fields that start at u. @collective
inline PrimalDualFields make_primal_dual(parallel::Slab<float> u, const parallel::Comm& comm) {
  PrimalDualFields f;
  f.bar = parallel::make_slab_like<float>(u, 1);
  std::ranges::copy(u.owned(), f.bar.owned().begin());
  parallel::exchange_halo(f.bar, comm);
  f.px = parallel::make_slab_like<float>(u, 1);
  f.py = parallel::make_slab_like<float>(u, 1);
  f.pz = parallel::make_slab_like<float>(u, 1);
  f.u = std::move(u);
  return f;
}

/// Smallest spacing / spacing along each axis, times `factor`; 0 along an axis with one voxel.
inline AxisWeights axis_weights(const Grid& grid, double factor = 1) {
  const double h = smallest_spacing(grid);
  const auto weight = [&](int axis) {
    return grid.size[static_cast<std::size_t>(axis)] > 1 ? static_cast<float>(factor * h / grid.spacing_mm[axis]) : 0;
  };
  return {weight(0), weight(1), weight(2)};
}

/// The largest singular value of the weighted gradient is at most this.
inline double gradient_bound(const AxisWeights& w) {
  return std::max(2 * std::sqrt(double{w.x} * w.x + double{w.y} * w.y + double{w.z} * w.z), 1e-6);
}

/// A row of `field` and its neighbours ahead, without a dual field. The ghost slice above must be filled.
inline DualRow gradient_row_of(const parallel::Slab<float>& field, std::int64_t j, std::int64_t k, const Run& run) {
  const auto& size = field.grid.size;
  const float* here = field.row(j, k);
  return {here,
          j + 1 < size[1] ? field.row(j + 1, k) : here,
          k + 1 < size[2] ? field.row(j, k + 1) : here,
          nullptr,
          nullptr,
          nullptr,
          run.begin,
          run.end,
          size[0]};
}

inline DualRow dual_row_of(PrimalDualFields& f, std::int64_t j, std::int64_t k, const Run& run) {
  auto row = gradient_row_of(f.bar, j, k, run);
  row.px = f.px.row(j, k);
  row.py = f.py.row(j, k);
  row.pz = f.pz.row(j, k);
  return row;
}

inline PrimalRow primal_row_of(PrimalDualFields& f, std::int64_t j, std::int64_t k, const Run& run) {
  const auto nx = f.bar.grid.size[0];
  const float* py = f.py.row(j, k);
  return {f.u.row(j, k), f.bar.row(j, k),    f.px.row(j, k), py,     f.pz.row(j, k),
          py - nx,       f.pz.row(j, k - 1), run.begin,      run.end};
}

/// One iteration: dual(j, k) and primal(j, k) do a row each. @collective
template <class Dual, class Primal>
void primal_dual_sweep(PrimalDualFields& f, const parallel::Comm& comm, Dual&& dual, Primal&& primal) {
  const auto ny = f.bar.grid.size[1];
  const auto begin = f.bar.first * ny, end = f.bar.end() * ny;
  const auto dual_rows = [&](std::int64_t from, std::int64_t to) {
    for (auto row = from; row < to; ++row) dual(row % ny, row / ny);
  };
  if (f.bar.count && f.bar.first > 0) parallel::parallel_for(begin - ny, begin, dual_rows);
  parallel::parallel_for(begin, end,
                         [&](std::int64_t from, std::int64_t to) { dual_rows(std::max(from, to - ny), to); });
  parallel::parallel_for(begin, end, [&](std::int64_t from, std::int64_t to) {
    for (auto row = from; row < to; ++row) {
      if (row < to - ny) dual(row % ny, row / ny);
      primal(row % ny, row / ny);
    }
  });
  parallel::exchange_halo(f.bar, comm);
}

/// What a pass moves of a voxel: u, its extrapolation, three dual fields, and data of the problem.
constexpr std::int64_t bytes_of_primal_dual = 28;

/// All that a piece can do of the iterations of a pass without its neighbours. Iteration n: dual rows of the slices
/// whose upper neighbours are done, primal rows of those whose dual rows below are. Those of the last slice were done
/// for iteration 0: the slice above it may be another thread's, which goes on meanwhile.
template <class Dual, class Primal>
void primal_dual_inside(const Piece& piece, std::int64_t ny, std::int64_t block, int depth, Dual&& dual,
                        Primal&& primal) {
  for_wavefront(piece, ny, block, depth, [&](std::int64_t n, std::int64_t from, std::int64_t to, std::int64_t k) {
    const bool with_dual =
        k >= piece.lower(std::max<std::int64_t>(n - 1, 0)) && k < piece.upper(std::max<std::int64_t>(n, 1));
    const bool with_primal = k >= piece.lower(n) && k < piece.upper(n);
    for (auto j = from; j < to; ++j) {
      if (with_dual) dual(j, k);
      if (with_primal) primal(j, k);
    }
  });
}

/// A pass of `depth` iterations, with the bits of as many sweeps. Pieces have 2 depth slices or more. @collective
template <class Dual, class Primal>
void primal_dual_pass(PrimalDualFields& f, int depth, const parallel::Comm& comm, Dual&& dual, Primal&& primal) {
  const auto ny = f.bar.grid.size[1];
  const auto block = rows_of_block(f.bar.grid.size[0], depth, bytes_of_primal_dual);
  const auto pieces = pieces_of(f.bar);
  const auto slices = [&](auto&& row, std::int64_t from, std::int64_t to) {
    for (auto k = from; k < to; ++k)
      for (std::int64_t j = 0; j < ny; ++j) row(j, k);
  };
  for (int n = 0; n < depth; ++n) {
    if (f.bar.first > 0)
      parallel::parallel_for(0, ny, [&](std::int64_t from, std::int64_t to) {
        for (auto j = from; j < to; ++j) dual(j, f.bar.first - 1);
      });
    for_pieces(pieces, [&](const Piece& piece) {
      if (n > 0) slices(dual, piece.first, piece.lower(n - 1));
      slices(dual, piece.upper(std::max(n, 1)), piece.end);
    });
    for_pieces(pieces, [&](const Piece& piece) {
      if (n == 0) return primal_dual_inside(piece, ny, block, depth, dual, primal);
      slices(primal, piece.first, piece.lower(n));
      slices(primal, piece.upper(n), piece.end);
    });
    parallel::exchange_halo(f.bar, comm);
  }
}

/// Iterations with the bits of as many sweeps, one after the other. @collective
template <class Dual, class Primal>
void primal_dual_sweeps(PrimalDualFields& f, int count, const parallel::Comm& comm, Dual&& dual, Primal&& primal) {
  // Ranks may go by passes of different depths: they exchange the same slices once an iteration.
  while (count > 0) {
    const int depth = pass_depth(f.bar, count);
    if (depth > 1)
      primal_dual_pass(f, depth, comm, dual, primal);
    else
      primal_dual_sweep(f, comm, dual, primal);
    count -= depth;
  }
}

}  // namespace heartgen::pde
