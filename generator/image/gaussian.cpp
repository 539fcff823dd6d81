// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/gaussian.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "generator/parallel/threads.hpp"
#include "model/contract.hpp"
#include "model/mathematics.hpp"

namespace heartgen::image {
namespace {

/// Right half of the normalised kernel, the centre first.
std::vector<float> half_kernel(double sigma_voxels) {
  const auto radius = static_cast<int>(std::ceil(3 * sigma_voxels));
  std::vector<double> weight;
  double sum = 0;
  for (int n = 0; n <= radius; ++n) {
    weight.push_back(math::exp(-0.5 * n * n / (sigma_voxels * sigma_voxels)));
    sum += n == 0 ? weight.back() : 2 * weight.back();
  }
  std::vector<float> kernel;
  kernel.reserve(weight.size());
  for (const double w : weight) kernel.push_back(static_cast<float>(w / sum));
  return kernel;
}

void smooth_row(const float* in, float* out, std::int64_t n, const std::vector<float>& kernel) {
  for (std::int64_t i = 0; i < n; ++i) {
    float sum = kernel[0] * in[i];
    for (std::size_t m = 1; m < kernel.size(); ++m) {
      const auto offset = static_cast<std::int64_t>(m);
      sum += kernel[m] * (in[std::max<std::int64_t>(i - offset, 0)] + in[std::min(i + offset, n - 1)]);
    }
    out[i] = sum;
  }
}

/// Row j, k of the result along axis 1 or 2: a weighted sum of whole rows, so memory is read in order.
void sum_rows(const Volume<float>& in, Volume<float>& out, std::int64_t j, std::int64_t k, int axis,
              const std::vector<float>& kernel) {
  const auto& size = in.grid.size;
  const auto row = [&](std::int64_t offset) {
    const auto jj = axis == 1 ? std::clamp<std::int64_t>(j + offset, 0, size[1] - 1) : j;
    const auto kk = axis == 2 ? std::clamp<std::int64_t>(k + offset, 0, size[2] - 1) : k;
    return in.voxels.data() + in.grid.offset(0, jj, kk);
  };
  float* result = out.voxels.data() + out.grid.offset(0, j, k);
  const float* centre = row(0);
  for (std::int64_t i = 0; i < size[0]; ++i) result[i] = kernel[0] * centre[i];
  for (std::size_t m = 1; m < kernel.size(); ++m) {
    const float* before = row(-static_cast<std::int64_t>(m));
    const float* after = row(static_cast<std::int64_t>(m));
    for (std::int64_t i = 0; i < size[0]; ++i) result[i] += kernel[m] * (before[i] + after[i]);
  }
}

}  // namespace

Volume<float> gaussian(const Volume<float>& image, double sigma_mm) {
  HEARTGEN_EXPECTS(sigma_mm >= 0);
  Volume<float> now = image;
  Volume<float> next(image.grid);
  const std::int64_t nx = image.grid.size[0], ny = image.grid.size[1], nz = image.grid.size[2];
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = sigma_mm / image.grid.spacing_mm[axis];
    if (sigma < 1.0 / 3) continue;
    const auto kernel = half_kernel(sigma);
    parallel::parallel_for(0, ny * nz, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t r = begin; r < end; ++r) {
        if (axis == 0)
          smooth_row(now.voxels.data() + r * nx, next.voxels.data() + r * nx, nx, kernel);
        else
          sum_rows(now, next, r % ny, r / ny, axis, kernel);
      }
    });
    std::swap(now, next);
  }
  return now;
}

}  // namespace heartgen::image
