// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/ventricles/regularized_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "generator/image/isotropic_distance.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"
#include "model/quantile.hpp"

namespace heartgen::ventricles {
namespace {

constexpr double finest_steps = 1.1;    // standard deviation, in steps of the labels: less leaves the steps themselves
constexpr double max_smoothing_mm = 6;  // of the scales: beyond, the wall's own curvature would go
constexpr double scale_ratio = std::numbers::sqrt2;
// Details of a rough surface grow from scale to scale at most as the scale does (self-affine, Hurst exponent 1), and
// ever less; what grows faster is shape.
constexpr double max_growth = scale_ratio;
constexpr double significant = 3;            // squared details below so many times the noise's are chance
constexpr double certain = 1.5;              // the same for terraces, whose size is known
constexpr double normal_median = 0.6744898;  // of the size of a standard normal variable

/// A Gaussian moves a surface of mean curvature H by sigma^2 H; this does not, to second order.
LevelSet unbiased(LevelSet once, const LevelSet& twice) {
  for (std::size_t v = 0; v < once.voxels.size(); ++v) once.voxels[v] = 2 * once.voxels[v] - twice.voxels[v];
  return once;
}

/// Numbers of voxels on a surface, and of those among them that are `own`; all where none is.
struct OnSurface {
  std::vector<std::size_t> all, own;
};

OnSurface on_surface(const LevelSet& surface, const Mask& own, double within_mm) {
  OnSurface on;
  for (std::size_t v = 0; v < surface.voxels.size(); ++v) {
    if (std::abs(surface.voxels[v]) >= within_mm) continue;
    on.all.push_back(v);
    if (own.voxels[v]) on.own.push_back(v);
  }
  if (on.own.empty()) on.own = on.all;
  return on;
}

/// Standard deviation of the details on most of the surface, mm.
double noise_mm(const Volume<float>& detail_mm, const std::vector<std::size_t>& voxels) {
  if (voxels.empty()) return 0;
  std::vector<float> sizes;
  sizes.reserve(voxels.size());
  for (const auto v : voxels) sizes.push_back(std::abs(detail_mm.voxels[v]));
  return double{upper_median(sizes)} / normal_median;
}

/// What `unbiased` smoothing leaves of a sine wave; its frequency as waves per standard deviation.
double left_of_wave(double waves) {
  const double once = math::exp(-2 * std::numbers::pi * std::numbers::pi * waves * waves);
  return 2 * once - once * once;
}

/// Mean square of the details of terraces one unit high, a sawtooth, between one scale and the next one, by how many
/// terraces there are in the finer scale's standard deviation: the squares of the sawtooth's Fourier coefficients.
double terrace_square(double terraces) {
  constexpr int waves = 6;
  constexpr double smoothed_away = 0.7;  // waves in a standard deviation: a ten-thousandth is left
  double sum = 0;
  for (int n = 1; n <= waves && n * terraces < smoothed_away; ++n) {
    const double detail = left_of_wave(n * terraces) - left_of_wave(n * scale_ratio * terraces);
    sum += detail * detail / (2 * std::numbers::pi * std::numbers::pi * n * n);
  }
  return sum;
}

/// Mean squares, mm2, of the details that the labels' steps make on a surface, per voxel of `on`, by its slope against
/// the labels' slices.
std::vector<float> terrace_squares(const LevelSet& surface, const std::vector<std::size_t>& on,
                                   const LabelSteps& steps_mm, double sigma_mm) {
  const Grid& g = surface.grid;
  std::vector<float> result(on.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(on.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const auto v = static_cast<std::int64_t>(on[n]);
      const Vec3 normal = normalized(
          image::gradient_at(surface, v % g.size[0], v / g.size[0] % g.size[1], v / (g.size[0] * g.size[1])));
      double sum = 0;
      for (const Vec3& step : steps_mm) {
        const double step_mm = norm(step);
        if (step_mm <= 0) continue;
        const double height_mm = std::abs(dot(normal, step));
        const double sine = std::sqrt(std::max(0.0, 1 - height_mm * height_mm / (step_mm * step_mm)));
        sum += height_mm * height_mm * terrace_square(sigma_mm * sine / step_mm);
      }
      result[n] = static_cast<float>(sum);
    }
  });
  return result;
}

/// Cubes of voxels: statistics over a window need no grid finer than a part of it.
struct Blocks {
  Grid grid;
  std::int64_t voxels = 1;  ///< along an edge
};

/// As large as the window's standard deviation, whole voxels.
Blocks blocks_of(const Grid& grid, double window_voxels) {
  Blocks blocks{grid, std::max<std::int64_t>(1, static_cast<std::int64_t>(window_voxels))};
  for (auto& n : blocks.grid.size) n = (n + blocks.voxels - 1) / blocks.voxels;
  return blocks;
}

/// Which share of the details around is more than noise and terraces, per block; 0 far from the surface.
Volume<float> gains(const Volume<float>& detail_mm, const std::vector<std::size_t>& on_surface,
                    const std::vector<float>& terrace_mm2, double noise, const Blocks& blocks, double window_voxels) {
  constexpr float min_weight = 1e-6F;
  const Grid& g = detail_mm.grid;
  Volume<float> squares(blocks.grid), terraces(blocks.grid), weight(blocks.grid);
  for (std::size_t s = 0; s < on_surface.size(); ++s) {
    const auto v = on_surface[s];
    const auto n = static_cast<std::int64_t>(v), b = blocks.voxels;
    const auto block = static_cast<std::size_t>(
        blocks.grid.offset(n % g.size[0] / b, n / g.size[0] % g.size[1] / b, n / (g.size[0] * g.size[1]) / b));
    squares.voxels[block] += detail_mm.voxels[v] * detail_mm.voxels[v];
    terraces.voxels[block] += terrace_mm2[s];
    weight.voxels[block] += 1;
  }
  const double window_blocks = window_voxels / static_cast<double>(blocks.voxels);
  squares = image::smoothed(squares, window_blocks);
  terraces = image::smoothed(terraces, window_blocks);
  weight = image::smoothed(weight, window_blocks);
  const auto noise_chance = static_cast<float>(significant * noise * noise);
  for (std::size_t v = 0; v < weight.voxels.size(); ++v) {
    if (weight.voxels[v] <= min_weight) {
      squares.voxels[v] = 0;
      continue;
    }
    const float square = squares.voxels[v] / weight.voxels[v];
    const float chance = std::max(noise_chance, static_cast<float>(certain) * terraces.voxels[v] / weight.voxels[v]);
    squares.voxels[v] = square > chance ? 1 - chance / square : 0;
  }
  return squares;
}

/// Where a line of voxels lies between the centres of blocks along one axis.
struct BetweenBlocks {
  std::vector<std::int64_t> low, high;
  std::vector<float> share;  ///< of `high`
};

BetweenBlocks between_blocks(std::int64_t voxels, const Blocks& blocks, std::size_t axis) {
  BetweenBlocks between;
  const std::int64_t last = blocks.grid.size[axis] - 1;
  for (std::int64_t i = 0; i < voxels; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(blocks.voxels) - 0.5;
    const auto low = static_cast<std::int64_t>(std::floor(at));
    between.low.push_back(std::clamp<std::int64_t>(low, 0, last));
    between.high.push_back(std::clamp<std::int64_t>(low + 1, 0, last));
    between.share.push_back(static_cast<float>(at - static_cast<double>(low)));
  }
  return between;
}

float mixed(float low, float high, float share) { return low + share * (high - low); }

/// Takes the details away that are noise.
void take_away(const Volume<float>& detail, const Volume<float>& gain, const Blocks& blocks, LevelSet& from) {
  const Grid& g = from.grid;
  const auto x = between_blocks(g.size[0], blocks, 0), y = between_blocks(g.size[1], blocks, 1),
             z = between_blocks(g.size[2], blocks, 2);
  parallel::parallel_for(0, g.size[2], [&](std::int64_t begin, std::int64_t end) {
    std::vector<float> row(static_cast<std::size_t>(blocks.grid.size[0]));
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < g.size[1]; ++j) {
        const auto kn = static_cast<std::size_t>(k), jn = static_cast<std::size_t>(j);
        for (std::int64_t i = 0; i < blocks.grid.size[0]; ++i) {
          const float low = mixed(gain(i, y.low[jn], z.low[kn]), gain(i, y.high[jn], z.low[kn]), y.share[jn]);
          const float high = mixed(gain(i, y.low[jn], z.high[kn]), gain(i, y.high[jn], z.high[kn]), y.share[jn]);
          row[static_cast<std::size_t>(i)] = mixed(low, high, z.share[kn]);
        }
        for (std::int64_t i = 0; i < g.size[0]; ++i) {
          const auto n = static_cast<std::size_t>(i);
          const float low = row[static_cast<std::size_t>(x.low[n])], high = row[static_cast<std::size_t>(x.high[n])];
          from(i, j, k) -= (1 - mixed(low, high, x.share[n])) * detail(i, j, k);
        }
      }
  });
}

}  // namespace

LevelSet regularized_surface(const Mask& inside, const Mask& own, double step_voxels) {
  return regularized_surface(image::signed_distance(inside, 0), own, step_voxels);
}

LevelSet regularized_surface(const LevelSet& surface, const Mask& own, double step_voxels, const LabelSteps& steps_mm) {
  const double spacing_mm = surface.grid.spacing_mm.x;
  double sigma_voxels = std::min(finest_steps * step_voxels, max_smoothing_mm / spacing_mm);
  LevelSet once = image::smoothed(surface, sigma_voxels), twice = image::smoothed(once, sigma_voxels);
  LevelSet detail = unbiased(std::move(once), twice), result = detail;
  OnSurface on;
  double last_noise = std::numeric_limits<double>::infinity(), growth = max_growth;
  while (sigma_voxels * scale_ratio * spacing_mm <= max_smoothing_mm) {
    // Twice with one width is once with the next one.
    sigma_voxels *= scale_ratio;
    once = std::move(twice);
    twice = image::smoothed(once, sigma_voxels);
    LevelSet coarser = unbiased(std::move(once), twice);
    if (on.all.empty()) on = on_surface(coarser, own, step_voxels * spacing_mm);
    for (std::size_t v = 0; v < detail.voxels.size(); ++v) detail.voxels[v] -= coarser.voxels[v];
    const double noise = std::min(noise_mm(detail, on.own), growth * last_noise);
    if (std::isfinite(last_noise) && last_noise > 0) growth = std::min(growth, noise / last_noise);
    last_noise = noise;
    const Blocks blocks = blocks_of(result.grid, sigma_voxels);
    const auto terraces = terrace_squares(coarser, on.all, steps_mm, sigma_voxels / scale_ratio * spacing_mm);
    take_away(detail, gains(detail, on.all, terraces, noise, blocks, sigma_voxels), blocks, result);
    detail = std::move(coarser);
  }
  return result;
}

}  // namespace heartgen::ventricles
