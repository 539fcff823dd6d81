// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/sobolev.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "generator/pde/primal_dual.hpp"
#include "generator/pde/stencil.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

/// Chebyshev coefficients for a spectrum within [1, largest].
struct Chebyshev {
  double center, radius, rho;
  int iterations;

  Chebyshev(double largest, double tolerance) : center((largest + 1) / 2), radius((largest - 1) / 2) {
    rho = radius / center;
    const double root = std::sqrt(largest);
    iterations =
        std::max(1, static_cast<int>(std::ceil(math::log(2 / tolerance) / math::log((root + 1) / (root - 1)))));
  }

  /// Factors of the last direction and of the residual in the next direction.
  std::pair<float, float> next() {
    const double last = rho;
    rho = 1 / (2 * center / radius - last);
    return {static_cast<float>(rho * last), static_cast<float>(2 * rho / radius)};
  }
};

/// u += d, r -= (I - length² Δ) d, then d = keep d + gain r.
void step(Slab<float>& u, Slab<float>& r, Slab<float>& d, Slab<float>& next, const AxisWeights& laplacian, float keep,
          float gain) {
  const auto nx = u.grid.size[0];
  parallel::for_rows(u, [&](std::int64_t j, std::int64_t k) {
    float *uu = u.row(j, k), *rr = r.row(j, k), *out = next.row(j, k);
    const float* dd = d.row(j, k);
    heat_row(stencil_row(d, next, j, k), laplacian);  // d + length² Δ d
    for (std::int64_t i = 0; i < nx; ++i) {
      uu[i] += dd[i];
      rr[i] -= 2 * dd[i] - out[i];
      out[i] = keep * dd[i] + gain * rr[i];
    }
  });
  std::swap(d.values, next.values);
}

constexpr double max_extents = 4;  // greater lengths change nothing but the number of steps, without end

double largest_extent(const Grid& grid) {
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    largest = std::max(largest, static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) * grid.spacing_mm[axis]);
  return largest;
}

}  // namespace

void sobolev(Slab<float>& image, const SobolevSettings& settings, const Comm& comm) {
  if (!(settings.smoothing_mm >= 0)) throw UserError("length_mm must not be negative", "sobolev", "");
  if (!(settings.tolerance > 0 && settings.tolerance < 1))
    throw UserError("tolerance must lie in (0, 1)", "sobolev", "1e-4 is the usual value");
  const double max_mm = max_extents * largest_extent(image.grid);
  if (settings.smoothing_mm > max_mm)
    throw UserError(
        fmt::format("length_mm is {:g}, the image's longest side {:g} mm", settings.smoothing_mm, max_mm / max_extents),
        "sobolev", fmt::format("give at most {:g}: there the image has become its mean", max_mm));
  const double length = settings.smoothing_mm / smallest_spacing(image.grid);
  const AxisWeights laplacian = squared(axis_weights(image.grid), length * length);
  const double largest = 1 + 4 * (double{laplacian.x} + laplacian.y + laplacian.z);
  if (!(largest > 1)) return;
  Chebyshev chebyshev(largest, settings.tolerance);
  auto next = parallel::make_slab_like<float>(image, 1), residual = next, direction = next;
  parallel::exchange_halo(image, comm);
  const auto nx = image.grid.size[0];
  parallel::for_rows(image, [&](std::int64_t j, std::int64_t k) {  // start at u = g: the residual is length² Δ g
    const float* g = image.row(j, k);
    float *r = residual.row(j, k), *d = direction.row(j, k);
    heat_row(stencil_row(image, residual, j, k), laplacian);
    for (std::int64_t i = 0; i < nx; ++i) {
      r[i] -= g[i];
      d[i] = r[i] / static_cast<float>(chebyshev.center);
    }
  });
  for (int n = 0; n < chebyshev.iterations; ++n) {
    parallel::exchange_halo(direction, comm);
    const auto [keep, gain] = chebyshev.next();
    step(image, residual, direction, next, laplacian, keep, gain);
  }
  parallel::exchange_halo(image, comm);
}

}  // namespace heartgen::pde
