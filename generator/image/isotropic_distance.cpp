// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/isotropic_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "generator/parallel/simd.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"

namespace heartgen::image {
namespace {

constexpr float far_away = 1e9F;

constexpr std::int64_t lanes = 16;  // lines that go through together, so that memory is read along x whatever the axis

/// Up to `lanes` lines along one axis that start side by side: value n of lane l at values[n * lanes + l].
struct Bundle {
  std::int64_t start = 0, stride = 0, length = 0, between = 0, count = 0;  ///< `between`: from lane to lane
};

std::int64_t bundle_count(const Grid& grid, int axis) {
  const auto along_x = (grid.size[0] + lanes - 1) / lanes;
  if (axis == 0) return (grid.size[1] * grid.size[2] + lanes - 1) / lanes;
  return along_x * grid.size[axis == 1 ? 2 : 1];
}

Bundle bundle_of(const Grid& grid, int axis, std::int64_t n) {
  const auto nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  if (axis == 0) return {n * lanes * nx, 1, nx, nx, std::min(lanes, ny * nz - n * lanes)};
  const auto along_x = (nx + lanes - 1) / lanes;
  const auto i = n % along_x * lanes, row = n / along_x;
  const auto count = std::min(lanes, nx - i);
  if (axis == 1) return {row * nx * ny + i, nx, ny, 1, count};
  return {row * nx + i, nx * ny, nz, 1, count};
}

/// Lines of the volume into the values of a bundle. Lanes beyond the grid keep what they had.
void load(const Volume<float>& volume, const Bundle& b, std::vector<float>& values) {
  const float* const from = volume.voxels.data() + b.start;
  float* const to = values.data();
  if (b.between == 1 && b.count == lanes) {
    for (std::int64_t p = 0; p < b.length; ++p) std::copy_n(from + p * b.stride, lanes, to + p * lanes);
    return;
  }
  for (std::int64_t lane = 0; lane < b.count; ++lane)
    for (std::int64_t p = 0; p < b.length; ++p) to[p * lanes + lane] = from[p * b.stride + lane * b.between];
}

void store(const std::vector<float>& values, const Bundle& b, Volume<float>& volume) {
  const float* const from = values.data();
  float* const to = volume.voxels.data() + b.start;
  if (b.between == 1 && b.count == lanes) {
    for (std::int64_t p = 0; p < b.length; ++p) std::copy_n(from + p * lanes, lanes, to + p * b.stride);
    return;
  }
  for (std::int64_t lane = 0; lane < b.count; ++lane)
    for (std::int64_t p = 0; p < b.length; ++p) to[p * b.stride + lane * b.between] = from[p * lanes + lane];
}

/// Replaces all lines along an axis by what per_bundle(in, out, length) makes of them; both hold length * lanes values,
/// those of lanes beyond the grid are of any line.
template <class PerBundle>
void for_each_bundle(Volume<float>& volume, int axis, PerBundle&& per_bundle) {
  parallel::parallel_for(0, bundle_count(volume.grid, axis), [&](std::int64_t begin, std::int64_t end) {
    std::vector<float> in(static_cast<std::size_t>(volume.grid.size[static_cast<std::size_t>(axis)] * lanes)),
        out(in.size());
    for (std::int64_t n = begin; n < end; ++n) {
      const Bundle b = bundle_of(volume.grid, axis, n);
      load(volume, b, in);
      per_bundle(in, out, b.length);
      store(out, b, volume);
    }
  });
}

/// Room for the lower envelope of a line's parabolas.
struct Envelope {
  std::vector<int> vertex;
  std::vector<double> bound;
};

/// Squared distances along one lane: the lower envelope of the parabolas f(q) + (p - q)^2.
void squared_distance_lane(const float* f, float* d, std::int64_t length, Envelope& envelope) {
  const int n = static_cast<int>(length);
  envelope.vertex.resize(static_cast<std::size_t>(n));
  envelope.bound.resize(static_cast<std::size_t>(n) + 1);
  int* const vertex = envelope.vertex.data();
  double* const bound = envelope.bound.data();
  int last = -1;
  const auto value = [&](int q) { return static_cast<double>(f[q * lanes]); };
  for (int q = 0; q < n; ++q) {
    if (f[q * lanes] >= far_away) continue;
    double cut = -std::numeric_limits<double>::infinity();
    while (last >= 0) {
      const int v = vertex[last];
      cut = ((value(q) + static_cast<double>(q) * q) - (value(v) + static_cast<double>(v) * v)) / (2.0 * (q - v));
      if (cut > bound[last]) break;
      --last;
      cut = -std::numeric_limits<double>::infinity();
    }
    vertex[++last] = q;
    bound[last] = cut;
  }
  for (int p = 0, at = 0; p < n; ++p) {
    if (last < 0) {
      d[p * lanes] = far_away;
      continue;
    }
    while (at < last && bound[at + 1] < p) ++at;
    const int v = vertex[at];
    d[p * lanes] = static_cast<float>(value(v) + static_cast<double>(p - v) * (p - v));
  }
}

/// The same for all lanes at once where all values are small, as inside a body: the least of f(q) + (p - q)^2, sought
/// from p outwards as far as a lane can still gain. `in` and `out` as in for_each_bundle.
HEARTGEN_INLINE void near_squared_distance_bundle(const float* in, float* out, std::int64_t length) {
  for (std::int64_t p = 0; p < length; ++p) {
    float least[lanes];
    for (std::int64_t lane = 0; lane < lanes; ++lane) least[lane] = in[p * lanes + lane];
    for (std::int64_t r = 1; r < length; ++r) {
      const auto squared = static_cast<float>(r * r);
      float largest = 0;
      for (std::int64_t lane = 0; lane < lanes; ++lane) largest = std::max(largest, least[lane]);
      if (largest <= squared) break;
      // Beyond the end of a line its last value, seen from too far, which changes nothing.
      const float* const before = in + std::max<std::int64_t>(p - r, 0) * lanes;
      const float* const after = in + std::min(p + r, length - 1) * lanes;
      for (std::int64_t lane = 0; lane < lanes; ++lane)
        least[lane] = std::min(least[lane], std::min(before[lane], after[lane]) + squared);
    }
    for (std::int64_t lane = 0; lane < lanes; ++lane) out[p * lanes + lane] = least[lane];
  }
}

/// Whole numbers, so both ways give the same bits.
void squared_distance_bundle(const std::vector<float>& in, std::vector<float>& out, std::int64_t length) {
  constexpr float near = 32 * 32;  // as far as looking around is quicker than an envelope
  thread_local Envelope envelope;
  if (*std::max_element(in.begin(), in.end()) <= near)
    return parallel::vectorised<near_squared_distance_bundle>(in.data(), out.data(), length);
  for (std::int64_t lane = 0; lane < lanes; ++lane)
    squared_distance_lane(in.data() + lane, out.data() + lane, length, envelope);
}

/// Where every value is 0 or far away, as along the first axis, two passes do.
void binary_distance_bundle(const std::vector<float>& in, std::vector<float>& out, std::int64_t length) {
  constexpr float none = 1e4F;  // voxels: squared below far_away, beyond every grid
  std::array<float, static_cast<std::size_t>(lanes)> steps;
  const auto pass = [&](std::int64_t p, auto&& keep) {
    const auto row = static_cast<std::size_t>(p * lanes);
    for (std::size_t lane = 0; lane < steps.size(); ++lane) {
      steps[lane] = in[row + lane] == 0 ? 0 : std::min(steps[lane] + 1, none);
      out[row + lane] = keep(out[row + lane], steps[lane]);
    }
  };
  steps.fill(none);
  for (std::int64_t p = 0; p < length; ++p) pass(p, [](float, float step) { return step; });
  steps.fill(none);
  for (std::int64_t p = length - 1; p >= 0; --p) pass(p, [](float old, float step) { return std::min(old, step); });
  for (float& d : out) d = d >= none ? far_away : d * d;
}

std::vector<float> gaussian_weights(double sigma) {
  const int radius = std::max(1, static_cast<int>(std::ceil(4 * sigma)));
  std::vector<double> weights(static_cast<std::size_t>(radius) + 1);
  double sum = 0;
  for (int i = 0; i <= radius; ++i) {
    weights[static_cast<std::size_t>(i)] = math::exp(-0.5 * i * i / (sigma * sigma));
    sum += (i ? 2 : 1) * weights[static_cast<std::size_t>(i)];
  }
  std::vector<float> shares(weights.size());
  std::transform(weights.begin(), weights.end(), shares.begin(), [&](double w) { return static_cast<float>(w / sum); });
  return shares;
}

/// Weighted sums around the values of each lane, whose borders are continued; `in` and `out` as in for_each_bundle.
HEARTGEN_INLINE void smooth_bundle(const float* weights, std::int64_t radius, const float* in, float* out,
                                   std::int64_t length) {
  for (std::int64_t p = 0; p < length; ++p) {
    float sum[lanes];
    for (std::int64_t lane = 0; lane < lanes; ++lane) sum[lane] = weights[0] * in[p * lanes + lane];
    for (std::int64_t r = 1; r <= radius; ++r) {
      const float* const before = in + std::max<std::int64_t>(p - r, 0) * lanes;
      const float* const after = in + std::min(p + r, length - 1) * lanes;
      for (std::int64_t lane = 0; lane < lanes; ++lane) sum[lane] += weights[r] * (before[lane] + after[lane]);
    }
    for (std::int64_t lane = 0; lane < lanes; ++lane) out[p * lanes + lane] = sum[lane];
  }
}

}  // namespace

Volume<float> distance_to(const Mask& mask) {
  Volume<float> result(mask.grid, far_away);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v]) result.voxels[v] = 0;
  for_each_bundle(result, 0, binary_distance_bundle);
  for (const int axis : {1, 2}) for_each_bundle(result, axis, squared_distance_bundle);
  const auto spacing = static_cast<float>(mask.grid.spacing_mm.x);
  for (float& d : result.voxels) d = d >= far_away ? far_away : spacing * std::sqrt(d);
  return result;
}

Volume<float> smoothed(const Volume<float>& volume, double sigma_voxels) {
  return smoothed(volume, Vec3{sigma_voxels, sigma_voxels, sigma_voxels});
}

Volume<float> smoothed(const Volume<float>& volume, const Vec3& sigma_voxels) {
  Volume<float> result = volume;
  for (int axis = 0; axis < 3; ++axis) {
    if (sigma_voxels[axis] <= 0) continue;
    const auto weights = gaussian_weights(sigma_voxels[axis]);
    for_each_bundle(result, axis, [&](const std::vector<float>& in, std::vector<float>& out, std::int64_t length) {
      parallel::vectorised<smooth_bundle>(weights.data(), static_cast<std::int64_t>(weights.size()) - 1, in.data(),
                                          out.data(), length);
    });
  }
  return result;
}

LevelSet signed_distance(const Mask& mask, double sigma_voxels) {
  Mask complement(mask.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) complement.voxels[v] = mask.voxels[v] ? 0 : 1;
  LevelSet outside = distance_to(mask);
  const auto inside = distance_to(complement);
  const auto half = static_cast<float>(mask.grid.spacing_mm.x / 2);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    outside.voxels[v] = mask.voxels[v] ? half - inside.voxels[v] : outside.voxels[v] - half;
  return sigma_voxels <= 0 ? outside : smoothed_level_set(outside, sigma_voxels);
}

LevelSet smoothed_level_set(const LevelSet& surface, double sigma_voxels) {
  // A Gaussian moves a surface of mean curvature H by sigma^2 H; 2 G - G^2 does not, to second order.
  LevelSet once = smoothed(surface, sigma_voxels);
  const LevelSet twice = smoothed(once, sigma_voxels);
  for (std::size_t v = 0; v < once.voxels.size(); ++v) once.voxels[v] = 2 * once.voxels[v] - twice.voxels[v];
  return once;
}

Vec3 gradient_at(const Volume<float>& volume, std::int64_t i, std::int64_t j, std::int64_t k) {
  Vec3 gradient;
  const std::array<std::int64_t, 3> at{i, j, k};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto low = at, high = at;
    low[axis] = std::max<std::int64_t>(at[axis] - 1, 0);
    high[axis] = std::min(at[axis] + 1, volume.grid.size[axis] - 1);
    const auto steps = static_cast<double>(high[axis] - low[axis]);
    if (steps > 0)
      gradient[static_cast<int>(axis)] = (volume(high[0], high[1], high[2]) - volume(low[0], low[1], low[2])) /
                                         (steps * volume.grid.spacing_mm[static_cast<int>(axis)]);
  }
  return gradient;
}

}  // namespace heartgen::image
