// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/edge_function.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "generator/pde/diffusion.hpp"
#include "generator/pde/spacing.hpp"
#include "model/error.hpp"
#include "model/quantile.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

/// Heat runs in units of the smallest squared spacing: sigma² / 2 of time, in equal steps below the stable one.
Slab<float> smoothed(const Slab<float>& image, double sigma_mm, const Comm& comm) {
  constexpr double longest_step = 0.15;
  Slab<float> result = image;
  const double h = smallest_spacing(image.grid), time = sigma_mm * sigma_mm / (2 * h * h);
  if (time > 0) {
    const int steps = static_cast<int>(std::ceil(time / longest_step));
    heat(result, {steps, time / steps}, comm);
  }
  return result;
}

}  // namespace

Slab<float> edge_function(const Slab<float>& image, const EdgeSettings& settings, const Comm& comm) {
  if (!(settings.smoothing_mm >= 0))
    throw UserError("the smoothing must not be negative", "edge function", "0 leaves the image as it is");
  if (!(settings.edge_per_mm > 0))
    throw UserError("the edge must be positive", "edge function", "give the slope of an edge, grey values per mm");
  const Slab<float> smooth = smoothed(image, settings.smoothing_mm, comm);
  Slab<float> result = parallel::make_slab_like<float>(image, 1);
  const auto [nx, ny, nz] = image.grid.size;
  const auto slope = [&](std::size_t axis) {
    return static_cast<float>(0.5 * inverse_spacing(image.grid, axis) / settings.edge_per_mm);
  };
  const float sx = slope(0), sy = slope(1), sz = slope(2);
  parallel::for_rows(image, [&, nx = nx, ny = ny](std::int64_t j, std::int64_t k) {
    const float *here = smooth.row(j, k), *below = smooth.row(j, k - 1), *above = smooth.row(j, k + 1);
    const float *front = smooth.row(std::max<std::int64_t>(j - 1, 0), k),
                *back = smooth.row(std::min(j + 1, ny - 1), k);
    float* out = result.row(j, k);
    for (std::int64_t i = 0; i < nx; ++i) {
      const float x = sx * (here[std::min(i + 1, nx - 1)] - here[std::max<std::int64_t>(i - 1, 0)]);
      const float y = sy * (back[i] - front[i]), z = sz * (above[i] - below[i]);
      out[i] = 1.0F / (1.0F + (x * x + y * y + z * z));
    }
  });
  parallel::exchange_halo(result, comm);
  return result;
}

double default_edge_per_mm(const Volume<float>& image, double smoothing_mm) {
  if (image.voxels.empty()) throw UserError("the image is empty", "edge function", "check the input file");
  std::vector<float> values = image.voxels;
  const double range = double{quantile(values, 0.99)} - double{quantile(values, 0.01)},
               sigma = std::max(smoothing_mm, 0.5 * smallest_spacing(image.grid));
  const double slope = range / (sigma * std::sqrt(2 * std::numbers::pi));
  return slope > 0 ? slope / 10 : 1;
}

}  // namespace heartgen::pde
