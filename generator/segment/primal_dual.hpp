// Private to this folder: one iteration of the primal-dual method of Chambolle and Pock (2011) on a slab.
//
// The dual field of a row needs the primal rows (j, k), (j + 1, k), (j, k + 1); the primal row then needs the dual rows
// (j, k), (j - 1, k), (j, k - 1). Walking the rows in memory order, both are done in one pass in place. Where a thread
// (or a rank) begins, the dual rows of the slice below are done beforehand.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "generator/parallel/slab.hpp"
#include "generator/segment/row_kernels.hpp"
#include "generator/segment/row_runs.hpp"

namespace heart::segment {

struct PrimalDualFields {
  parallel::Slab<float> u;           ///< no ghosts
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

inline double smallest_spacing(const Grid& grid) {
  double smallest = 0;
  for (int axis = 0; axis < 3; ++axis)
    if (grid.size[static_cast<std::size_t>(axis)] > 1 && (smallest == 0 || grid.spacing_mm[axis] < smallest))
      smallest = grid.spacing_mm[axis];
  return smallest > 0 ? smallest : 1;
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

inline DualRow dual_row_of(PrimalDualFields& f, std::int64_t j, std::int64_t k, const Run& run) {
  const auto& size = f.bar.grid.size;
  const float* bar = f.bar.row(j, k);
  return {bar,
          j + 1 < size[1] ? f.bar.row(j + 1, k) : bar,
          k + 1 < size[2] ? f.bar.row(j, k + 1) : bar,
          f.px.row(j, k),
          f.py.row(j, k),
          f.pz.row(j, k),
          run.begin,
          run.end,
          size[0]};
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

/// Rows that fit into a processor's own cache with all fields, twice: of a slice and of the one before it.
inline std::int64_t rows_in_cache(std::int64_t nx) {
  constexpr std::int64_t cache_bytes = 1 << 20, bytes_per_voxel = 48;
  return std::max<std::int64_t>(cache_bytes / (2 * bytes_per_voxel * nx), 4);
}

/// Two iterations of the slices [first, end), as far as they need no slice beyond: the first iteration but for the dual
/// rows of the last slice, which are done; the second but for the last slice and the primal rows of the first one. It
/// follows a row and a slice behind the first, and does in a row what that leaves in the cache: the fields come from
/// memory once for both.
template <class Dual, class Primal>
void primal_dual_pair_inside(std::int64_t ny, std::int64_t block, std::int64_t first, std::int64_t end, Dual&& dual,
                             Primal&& primal) {
  for (std::int64_t begin = 0; begin < ny; begin += block) {
    const auto stop = std::min(begin + block, ny);
    const auto second_begin = std::max<std::int64_t>(begin - 1, 0), second_stop = stop < ny ? stop - 1 : ny;
    for (auto k = first; k < end; ++k) {
      for (auto j = begin; j < stop; ++j) {
        if (k + 1 < end) dual(j, k);
        primal(j, k);
      }
      if (k == first) continue;
      for (auto j = second_begin; j < second_stop; ++j) {
        dual(j, k - 1);
        if (k - 1 > first) primal(j, k - 1);
      }
    }
  }
}

/// Two iterations, with the bits of two sweeps. @collective
template <class Dual, class Primal>
void primal_dual_pair(PrimalDualFields& f, const parallel::Comm& comm, Dual&& dual, Primal&& primal) {
  const auto ny = f.bar.grid.size[1], first = f.bar.first, end = f.bar.end();
  const auto for_slice = [&](auto&& row, std::int64_t k) {
    for (std::int64_t j = 0; j < ny; ++j) row(j, k);
  };
  const auto dual_of_last_slices = [&] {
    if (f.bar.count && first > 0)
      parallel::parallel_for(0, ny, [&](std::int64_t from, std::int64_t to) {
        for (auto j = from; j < to; ++j) dual(j, first - 1);
      });
    parallel::parallel_for(first, end, [&](std::int64_t, std::int64_t to) { for_slice(dual, to - 1); });
  };
  dual_of_last_slices();
  parallel::parallel_for(first, end, [&](std::int64_t from, std::int64_t to) {
    primal_dual_pair_inside(ny, rows_in_cache(f.bar.grid.size[0]), from, to, dual, primal);
  });
  parallel::exchange_halo(f.bar, comm);
  dual_of_last_slices();
  parallel::parallel_for(first, end, [&](std::int64_t from, std::int64_t to) {
    for_slice(primal, from);
    if (to - 1 > from) for_slice(primal, to - 1);
  });
  parallel::exchange_halo(f.bar, comm);
}

/// Whether threads have enough slices for pairs of iterations: each does its first and last slice by itself.
inline bool pairs_pay(const PrimalDualFields& f) {
  constexpr std::int64_t least_slices = 8;
  return f.bar.count >= least_slices * parallel::thread_count();
}

/// Iterations with the bits of as many sweeps, one after the other. @collective
template <class Dual, class Primal>
void primal_dual_sweeps(PrimalDualFields& f, int count, const parallel::Comm& comm, Dual&& dual, Primal&& primal) {
  // A rank that does pairs and one that does not exchange the same slices.
  for (; count > 1 && pairs_pay(f); count -= 2) primal_dual_pair(f, comm, dual, primal);
  for (; count > 0; --count) primal_dual_sweep(f, comm, dual, primal);
}

}  // namespace heart::segment
