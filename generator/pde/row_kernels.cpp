// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/row_kernels.hpp"

#include <cmath>
#include <vector>

#include "generator/pde/row_loops.hpp"

namespace heartgen::pde {
namespace {

HEARTGEN_INLINE float clamp01(float v) { return smaller(larger(v, 0.0f), 1.0f); }
HEARTGEN_INLINE float link(std::uint8_t a, std::uint8_t b) { return static_cast<float>(static_cast<int>(a & b)); }

/// Adds the ascent (ax, ay, az) to p at voxel i and projects onto the ball of this radius.
HEARTGEN_INLINE void ascend(const DualRow& row, std::int64_t i, float ax, float ay, float az, float radius) {
  const float x = row.px[i] + ax, y = row.py[i] + ay, z = row.pz[i] + az;
  const float scale = radius / larger(larger(radius, 1e-30f), std::sqrt(x * x + y * y + z * z));
  row.px[i] = x * scale;
  row.py[i] = y * scale;
  row.pz[i] = z * scale;
}

/// The last voxel of a row has no neighbour along x: loops over the others stop before it.
HEARTGEN_INLINE std::int64_t end_of_links(const DualRow& row) { return row.end < row.nx ? row.end : row.nx - 1; }

HEARTGEN_INLINE float divergence(const PrimalRow& row, std::int64_t i, const AxisWeights& w) {
  return w.x * (row.px[i] - row.px[i - 1]) + w.y * (row.py[i] - row.py_j[i]) + w.z * (row.pz[i] - row.pz_k[i]);
}

HEARTGEN_INLINE void store(const PrimalRow& row, std::int64_t i, float value) {
  row.bar[i] = 2 * value - row.u[i];
  row.u[i] = value;
}

HEARTGEN_INLINE float gradient_norm(const DualRow& row, std::int64_t i, float dx, const AxisWeights& w) {
  const float x = w.x * dx, y = w.y * (row.bar_j[i] - row.bar[i]), z = w.z * (row.bar_k[i] - row.bar[i]);
  return std::sqrt(x * x + y * y + z * z);
}

/// Beyond this many edges, squared, the conductivity falls no more: products of three stay in the range of a float.
constexpr float max_squared = 1e8f;

/// The sum of the fluxes step d / (1 + d² / edge²) over three faces, with one division for the three.
HEARTGEN_INLINE float fluxes(float x, float y, float z, const AxisWeights& step, float inverse_edge2) {
  const float a = 1.0f + smaller(x * x * inverse_edge2, max_squared);
  const float b = 1.0f + smaller(y * y * inverse_edge2, max_squared);
  const float c = 1.0f + smaller(z * z * inverse_edge2, max_squared);
  const float bc = b * c;
  const float inverse = 1.0f / (a * bc);
  return (step.x * x * inverse) * bc + ((step.y * y * inverse) * (a * c) + (step.z * z * inverse) * (a * b));
}

}  // namespace

namespace {
HEARTGEN_INLINE void dual_row_body(const DualRow& r, const AxisWeights& step) {
  const DualRow row = r;
  const AxisWeights s = step;
  const auto end = end_of_links(row);
  HEARTGEN_INDEPENDENT
  for (auto i = row.begin; i < end; ++i)
    ascend(row, i, s.x * (row.bar[i + 1] - row.bar[i]), s.y * (row.bar_j[i] - row.bar[i]),
           s.z * (row.bar_k[i] - row.bar[i]), 1.0f);
  for (auto i = end; i < row.end; ++i)
    ascend(row, i, 0.0f, s.y * (row.bar_j[i] - row.bar[i]), s.z * (row.bar_k[i] - row.bar[i]), 1.0f);
}
}  // namespace

void dual_row(const DualRow& r, const AxisWeights& step) { vectorised<dual_row_body>(r, step); }

namespace {
HEARTGEN_INLINE void dual_row_masked_body(const DualRow& r, const AxisWeights& step, const std::uint8_t* mask,
                                          const std::uint8_t* mask_j, const std::uint8_t* mask_k) {
  const DualRow row = r;
  const AxisWeights s = step;
  const auto end = end_of_links(row);
  HEARTGEN_INDEPENDENT
  for (auto i = row.begin; i < end; ++i)
    ascend(row, i, s.x * (row.bar[i + 1] - row.bar[i]) * link(mask[i], mask[i + 1]),
           s.y * (row.bar_j[i] - row.bar[i]) * link(mask[i], mask_j[i]),
           s.z * (row.bar_k[i] - row.bar[i]) * link(mask[i], mask_k[i]), 1.0f);
  for (auto i = end; i < row.end; ++i)
    ascend(row, i, 0.0f, s.y * (row.bar_j[i] - row.bar[i]) * link(mask[i], mask_j[i]),
           s.z * (row.bar_k[i] - row.bar[i]) * link(mask[i], mask_k[i]), 1.0f);
}
}  // namespace

void dual_row_masked(const DualRow& r, const AxisWeights& step, const std::uint8_t* mask, const std::uint8_t* mask_j,
                     const std::uint8_t* mask_k) {
  vectorised<dual_row_masked_body>(r, step, mask, mask_j, mask_k);
}

namespace {
HEARTGEN_INLINE void dual_row_weighted_body(const DualRow& r, const AxisWeights& step, const float* h) {
  const DualRow row = r;
  const AxisWeights s = step;
  const auto end = end_of_links(row);
  HEARTGEN_INDEPENDENT
  for (auto i = row.begin; i < end; ++i)
    ascend(row, i, h[i] * (s.x * (row.bar[i + 1] - row.bar[i])), h[i] * (s.y * (row.bar_j[i] - row.bar[i])),
           h[i] * (s.z * (row.bar_k[i] - row.bar[i])), h[i]);
  for (auto i = end; i < row.end; ++i)
    ascend(row, i, 0.0f, h[i] * (s.y * (row.bar_j[i] - row.bar[i])), h[i] * (s.z * (row.bar_k[i] - row.bar[i])), h[i]);
}
}  // namespace

void dual_row_weighted(const DualRow& r, const AxisWeights& step, const float* h) {
  vectorised<dual_row_weighted_body>(r, step, h);
}

namespace {
HEARTGEN_INLINE void primal_row_force_body(const PrimalRow& r, const AxisWeights& step, const float* g,
                                           const LinearForce& force) {
  const PrimalRow row = r;
  const AxisWeights s = step;
  const LinearForce f = force;
  HEARTGEN_INDEPENDENT
  for (auto i = row.begin; i < row.end; ++i) {
    const float pull = larger(-f.limit, smaller(f.limit, f.gain * (f.middle - g[i])));
    store(row, i, clamp01(row.u[i] + divergence(row, i, s) - pull));
  }
}
}  // namespace

void primal_row_force(const PrimalRow& r, const AxisWeights& step, const float* g, const LinearForce& force) {
  vectorised<primal_row_force_body>(r, step, g, force);
}

namespace {
HEARTGEN_INLINE void primal_row_steps_body(const PrimalRow& r, const AxisWeights& weights, const float* tau) {
  const PrimalRow row = r;
  const AxisWeights w = weights;
  HEARTGEN_INDEPENDENT
  for (auto i = row.begin; i < row.end; ++i) store(row, i, clamp01(row.u[i] + tau[i] * divergence(row, i, w)));
}
}  // namespace

void primal_row_steps(const PrimalRow& r, const AxisWeights& weights, const float* tau) {
  vectorised<primal_row_steps_body>(r, weights, tau);
}

namespace {
HEARTGEN_INLINE void primal_row_l2_body(const PrimalRow& r, const AxisWeights& step, const float* g, float pull) {
  const PrimalRow row = r;
  const AxisWeights s = step;
  const float scale = 1.0f / (1.0f + pull);
  HEARTGEN_INDEPENDENT
  for (auto i = row.begin; i < row.end; ++i) store(row, i, (row.u[i] + divergence(row, i, s) + pull * g[i]) * scale);
}
}  // namespace

void primal_row_l2(const PrimalRow& r, const AxisWeights& step, const float* g, float pull) {
  vectorised<primal_row_l2_body>(r, step, g, pull);
}

namespace {
HEARTGEN_INLINE void primal_row_l1_body(const PrimalRow& r, const AxisWeights& step, const float* g, float pull) {
  const PrimalRow row = r;
  const AxisWeights s = step;
  HEARTGEN_INDEPENDENT
  for (auto i = row.begin; i < row.end; ++i) {
    const float away = row.u[i] + divergence(row, i, s) - g[i];
    store(row, i, g[i] + (larger(away - pull, 0.0f) - larger(-away - pull, 0.0f)));
  }
}
}  // namespace

void primal_row_l1(const PrimalRow& r, const AxisWeights& step, const float* g, float pull) {
  vectorised<primal_row_l1_body>(r, step, g, pull);
}

namespace {
HEARTGEN_INLINE void gradient_norms_body(const DualRow& r, const AxisWeights& weights, float* out) {
  const DualRow row = r;
  const AxisWeights w = weights;
  const auto end = end_of_links(row);
  HEARTGEN_INDEPENDENT
  for (auto i = row.begin; i < end; ++i) out[i] = gradient_norm(row, i, row.bar[i + 1] - row.bar[i], w);
  for (auto i = end; i < row.end; ++i) out[i] = gradient_norm(row, i, 0.0f, w);
}
}  // namespace

void gradient_norms(const DualRow& r, const AxisWeights& weights, float* out) {
  vectorised<gradient_norms_body>(r, weights, out);
}

double gradient_row_sum(const DualRow& row, const AxisWeights& weights, const float* h) {
  thread_local std::vector<float> norms;
  norms.resize(static_cast<std::size_t>(row.nx));
  gradient_norms(row, weights, norms.data());
  double sum = 0;
  for (auto i = row.begin; i < row.end; ++i) {
    const double norm = norms[static_cast<std::size_t>(i)];
    sum += h ? static_cast<double>(h[i]) * norm : norm;
  }
  return sum;
}

namespace {
HEARTGEN_INLINE void divergence_row_body(const PrimalRow& r, const AxisWeights& weights, float* out) {
  const PrimalRow row = r;
  const AxisWeights w = weights;
  HEARTGEN_INDEPENDENT
  for (auto i = row.begin; i < row.end; ++i) out[i] = divergence(row, i, w);
}
}  // namespace

void divergence_row(const PrimalRow& r, const AxisWeights& weights, float* out) {
  vectorised<divergence_row_body>(r, weights, out);
}

namespace {

HEARTGEN_INLINE float heat_at(const StencilRow& row, std::int64_t left, std::int64_t i, std::int64_t right,
                              const AxisWeights& s) {
  const float u = row.u[i];
  return u + s.x * ((row.u[left] - u) + (row.u[right] - u)) + s.y * ((row.below_j[i] - u) + (row.above_j[i] - u)) +
         s.z * ((row.below_k[i] - u) + (row.above_k[i] - u));
}

HEARTGEN_INLINE float perona_malik_at(const StencilRow& row, std::int64_t left, std::int64_t i, std::int64_t right,
                                      const AxisWeights& s, float e) {
  const float u = row.u[i];
  return u + (fluxes(row.u[left] - u, row.below_j[i] - u, row.below_k[i] - u, s, e) +
              fluxes(row.u[right] - u, row.above_j[i] - u, row.above_k[i] - u, s, e));
}

HEARTGEN_INLINE void heat_row_body(const StencilRow& r, const AxisWeights& step) {
  const StencilRow row = r;
  const AxisWeights s = step;
  for_row(row.nx, [&](std::int64_t left, std::int64_t i, std::int64_t right)
                      HEARTGEN_INLINE_LAMBDA { row.out[i] = heat_at(row, left, i, right, s); });
}

HEARTGEN_INLINE void perona_malik_row_body(const StencilRow& r, const AxisWeights& step, float inverse_edge2) {
  const StencilRow row = r;
  const AxisWeights s = step;
  const float e = inverse_edge2;
  for_row(row.nx, [&](std::int64_t left, std::int64_t i, std::int64_t right)
                      HEARTGEN_INLINE_LAMBDA { row.out[i] = perona_malik_at(row, left, i, right, s, e); });
}

}  // namespace

void heat_row(const StencilRow& r, const AxisWeights& step) { vectorised<heat_row_body>(r, step); }

void perona_malik_row(const StencilRow& r, const AxisWeights& step, float inverse_edge2) {
  vectorised<perona_malik_row_body>(r, step, inverse_edge2);
}

}  // namespace heartgen::pde
