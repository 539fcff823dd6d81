// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/curvature.hpp"

#include <algorithm>
#include <cmath>

#include "generator/pde/primal_dual.hpp"
#include "generator/pde/row_loops.hpp"
#include "model/error.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

/// Avoids divisions by zero where the image is flat (delta of thesis 3.11).
constexpr float flat = 1e-10f;

/// A voxel keeps at least a quarter of itself, so that the step is a convex combination and cannot oscillate.
constexpr float limit = 4.0f / 3.0f;

/// A row and its eight neighbours: rows[1 + dk][1 + dj].
struct Neighbourhood {
  const float* rows[3][3];
  const float* g;  ///< image that the fidelity pulls to
  float* out;
  std::int64_t nx;
};

struct Coefficients {
  float x, y, z;              ///< 1 / spacing, 0 along an axis with one voxel
  float time_step, fidelity;  ///< mm², lambda
};

/// One over the gradient on a face: `across` is the difference over the face, the others are central differences
/// along it at its two voxels.
HEARTGEN_INLINE float face(float across, float s_here, float s_there, float t_here, float t_there) {
  return 1.0f /
         (std::sqrt(square(across) + square((s_here + s_there) * 0.5f) + square((t_here + t_there) * 0.5f)) + flat);
}

/// Of the slopes at both sides of a voxel: differs from the square of the central slope by h² u_xx² / 4 only, but is
/// not zero on peaks and ridges one voxel wide, which would never sink.
HEARTGEN_INLINE float mean_square(float lower, float upper) { return 0.5f * (square(lower) + square(upper)); }

/// The step at voxel i with left and right neighbours l and r.
HEARTGEN_INLINE float step_at(const Neighbourhood& n, std::int64_t l, std::int64_t i, std::int64_t r,
                              const Coefficients& c) {
  const float* const(*u)[3] = n.rows;
  const auto dx = [&](int k, int j) { return 0.5f * c.x * (u[k][j][r] - u[k][j][l]); };
  const auto dy = [&](int k, std::int64_t at) { return 0.5f * c.y * (u[k][2][at] - u[k][0][at]); };
  const auto dz = [&](int j, std::int64_t at) { return 0.5f * c.z * (u[2][j][at] - u[0][j][at]); };
  const float here = u[1][1][i], left = u[1][1][l], right = u[1][1][r];
  const float front = u[1][0][i], back = u[1][2][i], below = u[0][1][i], above = u[2][1][i];
  const float ux = dx(1, 1), uy = dy(1, i), uz = dz(1, i);
  const float xl = face(c.x * (here - left), uy, dy(1, l), uz, dz(1, l)) * c.x * c.x;
  const float xr = face(c.x * (right - here), uy, dy(1, r), uz, dz(1, r)) * c.x * c.x;
  const float yl = face(c.y * (here - front), ux, dx(1, 0), uz, dz(0, i)) * c.y * c.y;
  const float yr = face(c.y * (back - here), ux, dx(1, 2), uz, dz(2, i)) * c.y * c.y;
  const float zl = face(c.z * (here - below), ux, dx(0, 1), uy, dy(0, i)) * c.z * c.z;
  const float zr = face(c.z * (above - here), ux, dx(2, 1), uy, dy(2, i)) * c.z * c.z;
  const float speed = c.time_step * std::sqrt(mean_square(c.x * (here - left), c.x * (right - here)) +
                                              mean_square(c.y * (here - front), c.y * (back - here)) +
                                              mean_square(c.z * (here - below), c.z * (above - here)));
  const float neighbours = (xl * left + xr * right) + (yl * front + yr * back) + (zl * below + zr * above);
  const float weights = (xl + xr) + (yl + yr) + (zl + zr);
  const float target = neighbours + c.fidelity * n.g[i], rate = weights + c.fidelity;
  return here + speed * (target - rate * here) / larger(1.0f, speed * rate * limit);
}

HEARTGEN_INLINE void step_row_body(const Neighbourhood& row, const Coefficients& coefficients) {
  const Neighbourhood n = row;
  const Coefficients c = coefficients;
  for_row(n.nx, [&](std::int64_t left, std::int64_t i, std::int64_t right)
                    HEARTGEN_INLINE_LAMBDA { n.out[i] = step_at(n, left, i, right, c); });
}

void step_row(const Neighbourhood& row, const Coefficients& coefficients) {
  vectorised<step_row_body>(row, coefficients);
}

Neighbourhood neighbourhood(const Slab<float>& u, const Slab<float>& g, Slab<float>& out, std::int64_t j,
                            std::int64_t k) {
  const auto rows = u.grid.size[1];
  Neighbourhood n{{}, g.row(j, k), out.row(j, k), u.grid.size[0]};
  for (int dk = 0; dk < 3; ++dk)
    for (int dj = 0; dj < 3; ++dj)
      n.rows[dk][dj] = u.row(std::clamp<std::int64_t>(j + dj - 1, 0, rows - 1), k + dk - 1);
  return n;
}

Coefficients coefficients(const Grid& grid, double time_step, double lambda) {
  const AxisWeights w = axis_weights(grid);
  const double h = smallest_spacing(grid);
  const auto over = [&](float weight) { return static_cast<float>(weight / h); };
  return {over(w.x), over(w.y), over(w.z), static_cast<float>(time_step * h * h), static_cast<float>(lambda)};
}

}  // namespace

void curvature_motion_with_fidelity(Slab<float>& image, const CurvatureSettings& settings, double lambda,
                                    const Comm& comm) {
  if (settings.iterations < 0) throw UserError("iterations must not be negative", "curvature", "");
  if (!(settings.time_step > 0)) throw UserError("time_step must be positive", "curvature", "0.1 is the usual value");
  const Coefficients c = coefficients(image.grid, settings.time_step, lambda);
  const Slab<float> g = image;
  auto next = image;
  for (int step = 0; step < settings.iterations; ++step) {
    parallel::exchange_halo(image, comm);
    parallel::for_rows(image,
                       [&](std::int64_t j, std::int64_t k) { step_row(neighbourhood(image, g, next, j, k), c); });
    std::swap(image.values, next.values);
  }
  parallel::exchange_halo(image, comm);
}

void curvature_motion(Slab<float>& image, const CurvatureSettings& settings, const Comm& comm) {
  curvature_motion_with_fidelity(image, settings, 0, comm);
}

}  // namespace heartgen::pde
