#include "generator/atlas/even_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "generator/atlas/distance_map.hpp"

namespace heart::atlas {
namespace {

constexpr double finest_steps = 1.1;  // standard deviation, in steps of the labels: less leaves the steps themselves
constexpr double coarsest_mm = 6;     // of the scales: beyond, the wall's own curvature would go
constexpr double scale_ratio = std::numbers::sqrt2;
// Details of a rough surface grow from scale to scale at most as the scale does (self-affine, Hurst exponent 1), and
// ever less; what grows faster is shape.
constexpr double most_growth = scale_ratio;
constexpr double significant = 3;            // squared details below so many times the noise's are chance
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
  const auto half = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), half, sizes.end());
  return double{*half} / normal_median;
}

/// Which share of the details around is more than noise; 0 far from the surface.
Volume<float> gains(const Volume<float>& detail_mm, const std::vector<std::size_t>& on_surface, double noise,
                    double window_voxels) {
  constexpr float least_weight = 1e-6F;
  Volume<float> squares(detail_mm.grid), weight(detail_mm.grid);
  for (const auto v : on_surface) {
    squares.voxels[v] = detail_mm.voxels[v] * detail_mm.voxels[v];
    weight.voxels[v] = 1;
  }
  squares = smoothed(squares, window_voxels);
  weight = smoothed(weight, window_voxels);
  const auto chance = static_cast<float>(significant * noise * noise);
  for (std::size_t v = 0; v < weight.voxels.size(); ++v) {
    const float square = weight.voxels[v] > least_weight ? squares.voxels[v] / weight.voxels[v] : 0;
    squares.voxels[v] = square > chance ? 1 - chance / square : 0;
  }
  return squares;
}

}  // namespace

LevelSet even_surface(const Mask& inside, const Mask& own, double step_voxels) {
  const double spacing_mm = inside.grid.spacing_mm.x;
  double sigma_voxels = std::min(finest_steps * step_voxels, coarsest_mm / spacing_mm);
  LevelSet once = smoothed(signed_distance(inside, 0), sigma_voxels), twice = smoothed(once, sigma_voxels);
  LevelSet detail = unbiased(std::move(once), twice), result = detail;
  OnSurface on;
  double last_noise = std::numeric_limits<double>::infinity(), growth = most_growth;
  while (sigma_voxels * scale_ratio * spacing_mm <= coarsest_mm) {
    // Twice with one width is once with the next one.
    sigma_voxels *= scale_ratio;
    once = std::move(twice);
    twice = smoothed(once, sigma_voxels);
    LevelSet coarser = unbiased(std::move(once), twice);
    if (on.all.empty()) on = on_surface(coarser, own, step_voxels * spacing_mm);
    for (std::size_t v = 0; v < detail.voxels.size(); ++v) detail.voxels[v] -= coarser.voxels[v];
    const double noise = std::min(noise_mm(detail, on.own), growth * last_noise);
    if (std::isfinite(last_noise) && last_noise > 0) growth = std::min(growth, noise / last_noise);
    last_noise = noise;
    const auto gain = gains(detail, on.all, noise, sigma_voxels);
    for (std::size_t v = 0; v < result.voxels.size(); ++v) result.voxels[v] -= (1 - gain.voxels[v]) * detail.voxels[v];
    detail = std::move(coarser);
  }
  return result;
}

}  // namespace heart::atlas
