// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/redistance.hpp"

#include <cmath>
#include <tuple>
#include <utility>

#include "generator/pde/primal_dual.hpp"
#include "generator/pde/row_loops.hpp"
#include "generator/pde/stencil.hpp"
#include "model/error.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

/// Differences of a voxel to its six neighbours, divided by the spacing, away from the voxel's lower side.
struct Differences {
  float left, right, front, back, below, above;
};

HEARTGEN_INLINE Differences differences(const StencilRow& row, std::int64_t l, std::int64_t i, std::int64_t r,
                                        const AxisWeights& w) {
  const float u = row.u[i];
  return {w.x * (u - row.u[l]),       w.x * (row.u[r] - u),       w.y * (u - row.below_j[i]),
          w.y * (row.above_j[i] - u), w.z * (u - row.below_k[i]), w.z * (row.above_k[i] - u)};
}

/// Squared upwind slope along an axis for a front that moves outwards (8.7).
HEARTGEN_INLINE float upwind(float lower, float upper) {
  return square(larger(larger(lower, 0.0f), -smaller(upper, 0.0f)));
}

/// Inside, the front moves inwards: the same with both signs turned (8.6).
HEARTGEN_INLINE float evolve(const StencilRow& row, std::int64_t l, std::int64_t i, std::int64_t r, float sign,
                             const AxisWeights& w, float time_step) {
  const Differences d = differences(row, l, i, r, w);
  const float slope = std::sqrt(upwind(sign * d.left, sign * d.right) + upwind(sign * d.front, sign * d.back) +
                                upwind(sign * d.below, sign * d.above));
  return row.u[i] + time_step * sign * (1.0f - slope);
}

HEARTGEN_INLINE void evolve_row_body(const StencilRow& r, const float* sign, const AxisWeights& weights,
                                     float time_step) {
  const StencilRow row = r;
  const AxisWeights w = weights;
  for_row(row.nx, [&](std::int64_t left, std::int64_t i, std::int64_t right)
                      HEARTGEN_INLINE_LAMBDA { row.out[i] = evolve(row, left, i, right, sign[i], w, time_step); });
}

void evolve_row(const StencilRow& r, const float* sign, const AxisWeights& weights, float time_step) {
  vectorised<evolve_row_body>(r, sign, weights, time_step);
}

bool inside(float value) { return value < 0; }

/// Distance and sign of one voxel at the start; the sign is 0 where the voxel lies beside the zero level and stays.
std::pair<float, float> begin(const StencilRow& row, std::int64_t i, const AxisWeights& w) {
  const auto l = std::max<std::int64_t>(i - 1, 0), r = std::min(i + 1, row.nx - 1);
  const float u = row.u[i], sign = inside(u) ? -1.0f : 1.0f;
  bool beside = false;
  for (const float other : {row.u[l], row.u[r], row.below_j[i], row.above_j[i], row.below_k[i], row.above_k[i]})
    beside = beside || inside(other) != inside(u);
  if (!beside) return {u, sign};
  const Differences d = differences(row, l, i, r, w);
  float slope =
      std::sqrt(square((d.left + d.right) / 2) + square((d.front + d.back) / 2) + square((d.below + d.above) / 2));
  for (const float one_sided : {d.left, d.right, d.front, d.back, d.below, d.above})
    slope = larger(slope, std::abs(one_sided));
  return {u / slope, 0.0f};  // a neighbour of the other sign makes the slope positive
}

}  // namespace

void redistance(Slab<float>& level_set, const RedistanceSettings& settings, const Comm& comm) {
  if (settings.iterations < 0) throw UserError("iterations must not be negative", "redistance", "");
  const double h = smallest_spacing(level_set.grid);
  const AxisWeights w = axis_weights(level_set.grid, 1 / h);
  const auto time_step = static_cast<float>(h / 2);
  const auto nx = level_set.grid.size[0];
  auto next = parallel::make_slab_like<float>(level_set, level_set.ghosts), sign = next;
  parallel::exchange_halo(level_set, comm);
  parallel::for_rows(level_set, [&](std::int64_t j, std::int64_t k) {
    const StencilRow row = stencil_row(level_set, next, j, k);
    for (std::int64_t i = 0; i < nx; ++i) std::tie(row.out[i], sign.row(j, k)[i]) = begin(row, i, w);
  });
  std::swap(level_set.values, next.values);
  for (int step = 0; step < settings.iterations; ++step) {
    parallel::exchange_halo(level_set, comm);
    parallel::for_rows(level_set, [&](std::int64_t j, std::int64_t k) {
      evolve_row(stencil_row(level_set, next, j, k), sign.row(j, k), w, time_step);
    });
    std::swap(level_set.values, next.values);
  }
  parallel::exchange_halo(level_set, comm);
}

}  // namespace heartgen::pde
