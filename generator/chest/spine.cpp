// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/chest/spine.hpp"

#include <algorithm>
#include <cmath>

#include "generator/chest/working_image.hpp"
#include "generator/image/gaussian.hpp"
#include "model/mathematics.hpp"
#include "model/quantile.hpp"

namespace heartgen::chest {
namespace {

constexpr float bone_hu = 150, brightest_hu = 200;  // beyond, it is rather the aorta that is filled with contrast
constexpr double vertebra_sigma_mm = 10;            // about a third of a vertebral body
constexpr double enough_lung_mm2 = 3000;            // per slice, to say where the back of the chest is
constexpr double lung_before_back = 0.985;          // share of the lung in front of "the back of the lungs"
constexpr double spine_before_back_mm = 6;          // the vertebral centre in front of it
constexpr double depth_tolerance_mm = 14, side_tolerance_mm = 35;
constexpr double median_window_mm = 30, smoothing_mm = 8;

/// Row of the back of the lungs per slice; NaN where there is too little lung.
std::vector<double> back_of_lungs(const Mask& lung) {
  const auto [nx, ny, nz] = lung.grid.size;
  const double pixel_mm2 = lung.grid.spacing_mm.x * lung.grid.spacing_mm.y;
  std::vector<double> back(static_cast<std::size_t>(nz), std::nan(""));
  for (std::int64_t k = 0; k < nz; ++k) {
    std::vector<std::int64_t> rows(static_cast<std::size_t>(ny), 0);
    std::int64_t all = 0, seen = 0;
    for (std::int64_t j = 0; j < ny; ++j)
      for (std::int64_t i = 0; i < nx; ++i) rows[static_cast<std::size_t>(j)] += lung(i, j, k);
    for (const auto n : rows) all += n;
    if (static_cast<double>(all) * pixel_mm2 < enough_lung_mm2) continue;
    std::int64_t row = 0;
    while (static_cast<double>(seen) < lung_before_back * static_cast<double>(all))
      seen += rows[static_cast<std::size_t>(row++)];
    back[static_cast<std::size_t>(k)] = static_cast<double>(row - 1);
  }
  return back;
}

/// Replaces NaN by linear interpolation between known neighbours; the ends are continued. All NaN: `otherwise`.
void fill_gaps(std::vector<double>& values, double otherwise) {
  std::ptrdiff_t known = -1;
  const auto n = static_cast<std::ptrdiff_t>(values.size());
  const auto value = [&](std::ptrdiff_t at) -> double& { return values[static_cast<std::size_t>(at)]; };
  for (std::ptrdiff_t at = 0; at < n; ++at) {
    if (std::isnan(value(at))) continue;
    for (std::ptrdiff_t gap = known + 1; gap < at; ++gap) {
      const double t = known < 0 ? 1 : static_cast<double>(gap - known) / static_cast<double>(at - known);
      value(gap) = known < 0 ? value(at) : (1 - t) * value(known) + t * value(at);
    }
    known = at;
  }
  for (std::ptrdiff_t gap = known + 1; gap < n; ++gap) value(gap) = known < 0 ? otherwise : value(known);
}

std::vector<double> median_filtered(const std::vector<double>& values, std::ptrdiff_t half) {
  std::vector<double> result;
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  for (std::ptrdiff_t at = 0; at <= last; ++at) {
    std::vector<double> window;
    for (std::ptrdiff_t n = at - half; n <= at + half; ++n)
      window.push_back(values[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(n, 0, last))]);
    result.push_back(upper_median(window));
  }
  return result;
}

std::vector<double> gaussian_filtered(const std::vector<double>& values, double sigma) {
  std::vector<double> result;
  const auto half = static_cast<std::ptrdiff_t>(std::ceil(3 * sigma));
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  for (std::ptrdiff_t at = 0; at <= last; ++at) {
    double sum = 0, weights = 0;
    for (std::ptrdiff_t n = -half; n <= half; ++n) {
      const double weight = math::exp(-0.5 * static_cast<double>(n * n) / (sigma * sigma));
      sum += weight * values[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at + n, 0, last))];
      weights += weight;
    }
    result.push_back(sum / weights);
  }
  return result;
}

double middle_of_lungs_mm(const Mask& lung) {
  std::vector<double> x;
  for_each_voxel(lung.grid, [&](const Vec3& p, std::size_t v) {
    if (lung.voxels[v]) x.push_back(p.x);
  });
  std::sort(x.begin(), x.end());
  const std::size_t rim = x.size() / 50;  // 2 per cent: a few stray voxels do not count
  return 0.5 * (x[rim] + x[x.size() - 1 - rim]);
}

/// Smoothed bone, weighted by how near the expected place it is.
Volume<float> vertebra_score(const Volume<float>& image, const Mask& lung) {
  auto back = back_of_lungs(lung);
  fill_gaps(back, static_cast<double>(image.grid.size[1]) - 1);
  const double step = image.grid.spacing_mm.z;
  back = gaussian_filtered(median_filtered(back, std::llround(0.5 * median_window_mm / step)), smoothing_mm / step);
  const double middle = middle_of_lungs_mm(lung);
  Volume<float> bone(image.grid);
  for (std::size_t v = 0; v < bone.voxels.size(); ++v)
    bone.voxels[v] = image.voxels[v] > bone_hu ? std::min(image.voxels[v], brightest_hu) : 0;
  bone = image::gaussian(bone, vertebra_sigma_mm);
  std::size_t v = 0;
  for (std::int64_t k = 0; k < image.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < image.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < image.grid.size[0]; ++i, ++v) {
        const Vec3 p = position_mm(image.grid, i, j, k);
        const double expected_y =
            image.grid.origin_mm.y + back[static_cast<std::size_t>(k)] * image.grid.spacing_mm.y - spine_before_back_mm;
        const double y = (p.y - expected_y) / depth_tolerance_mm, x = (p.x - middle) / side_tolerance_mm;
        bone.voxels[v] *= static_cast<float>(math::exp(-0.5 * (x * x + y * y)));
      }
  return bone;
}

/// Offset of the best of the up to nine pixels around (i, j) in one slice of sums.
std::int64_t best_around(const std::vector<float>& sums, const Index3& size, std::int64_t i, std::int64_t j) {
  std::int64_t best = j * size[0] + i;
  for (std::int64_t jj = std::max<std::int64_t>(j - 1, 0); jj <= std::min(j + 1, size[1] - 1); ++jj)
    for (std::int64_t ii = std::max<std::int64_t>(i - 1, 0); ii <= std::min(i + 1, size[0] - 1); ++ii)
      if (sums[static_cast<std::size_t>(jj * size[0] + ii)] > sums[static_cast<std::size_t>(best)])
        best = jj * size[0] + ii;
  return best;
}

/// Pixel per slice of the path with the greatest sum of scores that moves by at most one pixel per slice.
std::vector<std::int64_t> best_path(const Volume<float>& score) {
  const auto& size = score.grid.size;
  const std::int64_t area = size[0] * size[1];
  std::vector<std::vector<float>> sums(static_cast<std::size_t>(size[2]));
  for (std::int64_t k = 0; k < size[2]; ++k) {
    auto& here = sums[static_cast<std::size_t>(k)];
    here.assign(score.voxels.begin() + k * area, score.voxels.begin() + (k + 1) * area);
    if (k == 0) continue;
    const auto& below = sums[static_cast<std::size_t>(k - 1)];
    for (std::int64_t p = 0; p < area; ++p)
      here[static_cast<std::size_t>(p)] +=
          below[static_cast<std::size_t>(best_around(below, size, p % size[0], p / size[0]))];
  }
  std::vector<std::int64_t> path(static_cast<std::size_t>(size[2]));
  path.back() = std::max_element(sums.back().begin(), sums.back().end()) - sums.back().begin();
  for (std::size_t k = path.size() - 1; k > 0; --k)
    path[k - 1] = best_around(sums[k - 1], size, path[k] % size[0], path[k] / size[0]);
  return path;
}

}  // namespace

Spine find_spine(const Volume<float>& image, const Mask& lung) {
  const Grid& grid = image.grid;
  Spine spine{grid.origin_mm.z, grid.spacing_mm.z, {}, {}, true};
  for (const auto pixel : best_path(vertebra_score(image, lung))) {
    const Vec3 p = position_mm(grid, pixel % grid.size[0], pixel / grid.size[0], 0);
    spine.x_mm.push_back(p.x);
    spine.y_mm.push_back(p.y);
  }
  const double sigma = smoothing_mm / grid.spacing_mm.z;
  spine.x_mm = gaussian_filtered(spine.x_mm, sigma);
  spine.y_mm = gaussian_filtered(spine.y_mm, sigma);
  return spine;
}

double share_unlike_spine(const Spine& spine, const Volume<float>& image, const Mask& lung, double blood_hu) {
  constexpr double radius_mm = 10;  // within a vertebral body
  constexpr double darkest_hu = 60, blood_share = 0.75;
  const auto [nx, ny, nz] = image.grid.size;
  std::int64_t slices = 0, unlike = 0;
  for (std::int64_t k = 0; k < nz; ++k) {
    const auto first = lung.voxels.begin() + k * nx * ny;
    if (std::find(first, first + nx * ny, 1) == first + nx * ny) continue;
    double sum = 0, pixels = 0;
    for (std::int64_t j = 0; j < ny; ++j)
      for (std::int64_t i = 0; i < nx; ++i) {
        const Vec3 p = position_mm(image.grid, i, j, k), vertebra = spine.at(p.z);
        if (math::hypot(p.x - vertebra.x, p.y - vertebra.y) >= radius_mm) continue;
        sum += static_cast<double>(image(i, j, k));
        pixels += 1;
      }
    ++slices;
    unlike += sum < darkest_hu * pixels || sum > blood_share * blood_hu * pixels;
  }
  return slices > 0 ? static_cast<double>(unlike) / static_cast<double>(slices) : 1;
}

Spine spine_behind(const Grid& grid) {
  constexpr double right_of_heart_mm = 10, behind_mm = 15;
  const auto [nx, ny, nz] = grid.size;
  const Vec3 middle = position_mm(grid, nx / 2, ny - 1, 0);
  return {grid.origin_mm.z, grid.spacing_mm.z, {middle.x - right_of_heart_mm}, {middle.y + behind_mm}, false};
}

Vec3 Spine::at(double z_mm) const {
  const double last = static_cast<double>(x_mm.size()) - 1;
  const auto n = static_cast<std::size_t>(std::llround(std::clamp((z_mm - z0_mm) / step_mm, 0.0, last)));
  return {x_mm[n], y_mm[n], z_mm};
}

}  // namespace heartgen::chest
