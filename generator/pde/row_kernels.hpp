// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the inner loops of the PDE solvers, one image row at a time, written for the vectoriser.
///
/// Layout all of them rely on: rows of one slab follow each other in memory, and the dual fields px, py, pz are zero
/// where the neighbour they point to does not exist (last voxel of a row, last row of a slice, last slice). So px[-1],
/// the row below and the slice below need no special case; fields therefore have a ghost slice on both sides.
///
/// Every function does the same operations in the same order for each voxel, whatever the vector length: no fused
/// multiply-add, no reassociation. Row intervals are [begin, end) in voxels; `nx` is the row's length.
#pragma once
#include <cstdint>

namespace heartgen::pde {

/// Factors of the differences along x, y, z: smallest spacing / spacing, times the step where it says so.
struct AxisWeights {
  float x = 1, y = 1, z = 1;
};

struct DualRow {
  const float* bar;    ///< extrapolated primal field of this row
  const float* bar_j;  ///< of the row j + 1, or `bar` again where there is none
  const float* bar_k;  ///< of the slice k + 1, or `bar` again where there is none
  float *px, *py, *pz;
  std::int64_t begin, end, nx;
};

/// p += step ∇bar, then projected onto |p| <= 1. `step` holds sigma times the axis weights.
void dual_row(const DualRow& row, const AxisWeights& step);

/// The same on links between two voxels of a domain only (masks of this row, row j + 1 and slice k + 1).
void dual_row_masked(const DualRow& row, const AxisWeights& step, const std::uint8_t* mask, const std::uint8_t* mask_j,
                     const std::uint8_t* mask_k);

/// p += h step ∇bar, then projected onto |p| <= h.
void dual_row_weighted(const DualRow& row, const AxisWeights& step, const float* h);

struct PrimalRow {
  float* u;
  float* bar;  ///< becomes 2 u_new - u_old
  const float *px, *py, *pz;
  const float *py_j, *pz_k;  ///< of the row j - 1 and of the slice k - 1
  std::int64_t begin, end;
};

/// u = clamp(u + step div p - force (g), 0, 1) with force(g) = gain (middle - g), clamped to ± limit.
struct LinearForce {
  float gain, middle, limit;
};
void primal_row_force(const PrimalRow& row, const AxisWeights& step, const float* g, const LinearForce& force);

/// u = clamp(u + tau div p, 0, 1) with a step per voxel (0 keeps the voxel).
void primal_row_steps(const PrimalRow& row, const AxisWeights& weights, const float* tau);

/// u = the minimiser of (v - u)² / 2 + pull (v - g)² / 2 after u += step div p.
void primal_row_l2(const PrimalRow& row, const AxisWeights& step, const float* g, float pull);

/// u = the minimiser of (v - u)² / 2 + pull |v - g| after u += step div p.
void primal_row_l1(const PrimalRow& row, const AxisWeights& step, const float* g, float pull);

/// sum of weights·|∇u| (times h unless null) over a row, added in voxel order. `row.px` .. `pz` are not used.
double gradient_row_sum(const DualRow& row, const AxisWeights& weights, const float* h);

/// out[i] = div p, with axis weights.
void divergence_row(const PrimalRow& row, const AxisWeights& weights, float* out);

struct StencilRow {
  const float *u, *below_j, *above_j, *below_k, *above_k;  ///< the row and its neighbours, itself where there is none
  float* out;
  std::int64_t nx;
};

/// out = u + step-weighted Laplacian; neighbours beyond the row's ends count as equal.
void heat_row(const StencilRow& row, const AxisWeights& step);

/// out = u + sum over the faces of step c(d) d with c(d) = 1 / (1 + d² inverse_edge2), at least 1e-8.
void perona_malik_row(const StencilRow& row, const AxisWeights& step, float inverse_edge2);

}  // namespace heartgen::pde
