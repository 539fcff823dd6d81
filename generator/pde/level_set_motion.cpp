// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/level_set_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "generator/pde/row_loops.hpp"
#include "generator/pde/spacing.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

/// Avoids divisions by zero where φ is flat (delta of thesis 3.11).
constexpr float flat = 1e-10F;
/// A voxel keeps at least a quarter of itself, so that the step is a convex combination and cannot oscillate.
constexpr float limit = 4.0F / 3.0F;

/// A row of φ with its eight neighbours, rows[1 + dk][1 + dj], and of h with its four.
struct Rows {
  const float* rows[3][3];
  const float *h, *h_front, *h_back, *h_below, *h_above;
  float* out;
  std::int64_t nx;
};

/// The terms times the time step; x, y, z are 1 / spacing, 0 along an axis with one voxel.
struct Step {
  float x, y, z;
  float curvature, edge_curvature, attraction, balloon;
};

/// Mean square of the one-sided differences along an axis. Central differences vanish on peaks and on ridges one voxel
/// wide, which then would never sink.
HEARTGEN_INLINE float mean_square(float lower, float here, float upper, float inverse_spacing) {
  return 0.5F * (square(inverse_spacing * (here - lower)) + square(inverse_spacing * (upper - here)));
}

/// One over the gradient on a face: `across` is the difference over the face, the others are mean squares of the
/// differences along it at its two voxels.
HEARTGEN_INLINE float face(float across, float s_here, float s_there, float t_here, float t_there) {
  return 1.0F / (std::sqrt(square(across) + 0.5F * (s_here + s_there) + 0.5F * (t_here + t_there)) + flat);
}

/// Squared Godunov slope along an axis for a front that grows; one that shrinks has both differences turned.
HEARTGEN_INLINE float upwind(float lower, float upper) {
  return square(larger(larger(lower, 0.0F), -smaller(upper, 0.0F)));
}

/// The new value at voxel i with left and right neighbours l and r.
HEARTGEN_INLINE float step_at(const Rows& n, std::int64_t l, std::int64_t i, std::int64_t r, const Step& s) {
  const float* const(*u)[3] = n.rows;
  const auto sx = [&](int k, int j) { return mean_square(u[k][j][l], u[k][j][i], u[k][j][r], s.x); };
  const auto sy = [&](int k, std::int64_t at) { return mean_square(u[k][0][at], u[k][1][at], u[k][2][at], s.y); };
  const auto sz = [&](int j, std::int64_t at) { return mean_square(u[0][j][at], u[1][j][at], u[2][j][at], s.z); };
  const float here = u[1][1][i], h = n.h[i];
  const float dl = s.x * (here - u[1][1][l]), dr = s.x * (u[1][1][r] - here), df = s.y * (here - u[1][0][i]);
  const float db = s.y * (u[1][2][i] - here), dd = s.z * (here - u[0][1][i]), du = s.z * (u[2][1][i] - here);
  const float xx = sx(1, 1), yy = sy(1, i), zz = sz(1, i);

  const float xl = face(dl, yy, sy(1, l), zz, sz(1, l)) * s.x, xr = face(dr, yy, sy(1, r), zz, sz(1, r)) * s.x;
  const float yl = face(df, xx, sx(1, 0), zz, sz(0, i)) * s.y, yr = face(db, xx, sx(1, 2), zz, sz(2, i)) * s.y;
  const float zl = face(dd, xx, sx(0, 1), yy, sy(0, i)) * s.z, zr = face(du, xx, sx(2, 1), yy, sy(2, i)) * s.z;
  const float speed = (s.curvature + s.edge_curvature * h) * std::sqrt(xx + yy + zz);
  const float bend = (xr * dr - xl * dl) + (yr * db - yl * df) + (zr * du - zl * dd);
  const float rate = speed * ((xl + xr) * s.x + (yl + yr) * s.y + (zl + zr) * s.z);

  const float hx = s.attraction * 0.5F * s.x * (n.h[r] - n.h[l]);
  const float hy = s.attraction * 0.5F * s.y * (n.h_back[i] - n.h_front[i]);
  const float hz = s.attraction * 0.5F * s.z * (n.h_above[i] - n.h_below[i]);
  const float pull = (larger(hx, 0.0F) * dr + smaller(hx, 0.0F) * dl) +
                     (larger(hy, 0.0F) * db + smaller(hy, 0.0F) * df) +
                     (larger(hz, 0.0F) * du + smaller(hz, 0.0F) * dd);

  const float sign = s.balloon < 0 ? -1.0F : 1.0F;
  const float slope =
      std::sqrt(upwind(sign * dl, sign * dr) + upwind(sign * df, sign * db) + upwind(sign * dd, sign * du));
  return here + speed * bend / larger(1.0F, rate * limit) + pull - s.balloon * h * slope;
}

HEARTGEN_INLINE void step_row(const Rows& rows, const Step& step) {
  const Rows n = rows;
  const Step s = step;
  const auto last = n.nx - 1;
  n.out[0] = step_at(n, 0, 0, std::min<std::int64_t>(1, last), s);
  HEARTGEN_INDEPENDENT
  for (std::int64_t i = 1; i < last; ++i) n.out[i] = step_at(n, i - 1, i, i + 1, s);
  if (last > 0) n.out[last] = step_at(n, last - 1, last, last, s);
}

Rows rows_at(const Slab<float>& phi, const Slab<float>& h, Slab<float>& out, std::int64_t j, std::int64_t k) {
  const auto last = phi.grid.size[1] - 1;
  const auto front = std::max<std::int64_t>(j - 1, 0), back = std::min(j + 1, last);
  Rows n{{},
         h.row(j, k),
         h.row(front, k),
         h.row(back, k),
         h.row(j, k - 1),
         h.row(j, k + 1),
         out.row(j, k),
         phi.grid.size[0]};
  for (int dk = 0; dk < 3; ++dk) {
    n.rows[dk][0] = phi.row(front, k + dk - 1);
    n.rows[dk][1] = phi.row(j, k + dk - 1);
    n.rows[dk][2] = phi.row(back, k + dk - 1);
  }
  return n;
}

Step scaled(const Grid& grid, const MotionTerms& terms, double dt) {
  const auto inverse = [&](std::size_t axis) { return static_cast<float>(inverse_spacing(grid, axis)); };
  const auto times_dt = [&](double v) { return static_cast<float>(dt * v); };
  return {inverse(0),
          inverse(1),
          inverse(2),
          times_dt(terms.curvature_mm),
          times_dt(terms.edge_curvature_mm),
          times_dt(terms.attraction_mm),
          times_dt(terms.balloon)};
}

/// Rows on the border of the image along y or z keep their values.
bool on_border(const Grid& grid, std::int64_t j, std::int64_t k) {
  const auto& size = grid.size;
  return (size[1] > 1 && (j == 0 || j == size[1] - 1)) || (size[2] > 1 && (k == 0 || k == size[2] - 1));
}

void move_row(const Slab<float>& phi, const Slab<float>& h, Slab<float>& next, const Step& step, Border border,
              std::int64_t j, std::int64_t k) {
  const auto nx = phi.grid.size[0];
  const float* old = phi.row(j, k);
  float* row = next.row(j, k);
  if (border == Border::held && on_border(phi.grid, j, k)) {
    std::copy_n(old, nx, row);
    return;
  }
  parallel::vectorised<step_row>(rows_at(phi, h, next, j, k), step);
  if (border == Border::held && nx > 1) {
    row[0] = old[0];
    row[nx - 1] = old[nx - 1];
  }
}

/// Largest |h_x| / dx + |h_y| / dy + |h_z| / dz: the rate at which the advection empties a voxel.
double steepest(const Slab<float>& h, const Comm& comm) {
  const Step s = scaled(h.grid, {}, 0);
  const auto [nx, ny, nz] = h.grid.size;
  double result = 0;
  for (auto k = h.first; k < h.end(); ++k)
    for (std::int64_t j = 0; j < ny; ++j) {
      const float *here = h.row(j, k), *below = h.row(j, k - 1), *above = h.row(j, k + 1);
      const float *front = h.row(std::max<std::int64_t>(j - 1, 0), k), *back = h.row(std::min(j + 1, ny - 1), k);
      for (std::int64_t i = 0; i < nx; ++i) {
        const float x = here[std::min(i + 1, nx - 1)] - here[std::max<std::int64_t>(i - 1, 0)];
        const float rate = 0.5F * (s.x * s.x * std::abs(x) + s.y * s.y * std::abs(back[i] - front[i]) +
                                   s.z * s.z * std::abs(above[i] - below[i]));
        result = std::max(result, static_cast<double>(rate));
      }
    }
  return parallel::max(comm, result);
}

}  // namespace

double stable_step(const Slab<float>& h, const MotionTerms& terms, const Comm& comm) {
  const Step s = scaled(h.grid, {}, 0);
  const double fastest = std::max({s.x, s.y, s.z});  // one over the smallest spacing
  const double across = std::sqrt(double{s.x} * s.x + double{s.y} * s.y + double{s.z} * s.z);
  const double rate = 4 * (terms.curvature_mm + terms.edge_curvature_mm) * fastest * fastest +
                      terms.attraction_mm * steepest(h, comm) + std::abs(terms.balloon) * across;
  return rate > 0 ? 0.5 / rate : 0;
}

void move_level_sets(Slab<float>& phi, const Slab<float>& h, const MotionTerms& terms, double time_step, int steps,
                     Border border, const Comm& comm) {
  const Step step = scaled(phi.grid, terms, time_step);
  auto next = phi;
  parallel::exchange_halo(phi, comm);
  for (int n = 0; n < steps; ++n) {
    parallel::for_rows(phi, [&](std::int64_t j, std::int64_t k) { move_row(phi, h, next, step, border, j, k); });
    std::swap(phi.values, next.values);
    parallel::exchange_halo(phi, comm);
  }
}

}  // namespace heartgen::pde
