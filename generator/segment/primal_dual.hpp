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

}  // namespace heart::segment
