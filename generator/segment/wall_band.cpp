#include "generator/segment/wall_band.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "generator/parallel/threads.hpp"
#include "generator/segment/components.hpp"
#include "generator/segment/gaussian.hpp"
#include "generator/segment/morphology.hpp"

namespace heart::segment {
namespace {

constexpr double fat_hu = -120;                // below fat all is air: its edge is as strong as needed already
constexpr double smoothing_mm = 0.8;           // of the image before its gradient is taken
constexpr float free_end = 0.05F;              // weight next to forbidden voxels
constexpr std::int64_t island_fraction = 100;  // smaller pieces are no heart; the atria may be two pieces
constexpr double area_bin_mm = 1;              // thickness of the shells whose volumes measure the level sets' areas
constexpr float least_edge_hu = 60;            // less contrast to what lies beyond is no edge of the heart

Vec3 gradient(const Volume<float>& image, const Index3& at) {
  Vec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    Index3 low = at;
    Index3 high = at;
    low[a] = std::max<std::int64_t>(at[a] - 1, 0);
    high[a] = std::min(at[a] + 1, image.grid.size[a] - 1);
    if (low[a] == high[a]) continue;
    result[axis] = static_cast<double>(image(high[0], high[1], high[2]) - image(low[0], low[1], low[2])) /
                   (static_cast<double>(high[a] - low[a]) * image.grid.spacing_mm[axis]);
  }
  return result;
}

/// Reference area divided by the area of the level set at each distance (bins of area_bin_mm), smoothed once.
std::vector<double> area_factors(const BandInput& band, const Mask& state) {
  std::vector<double> volume(static_cast<std::size_t>(band.band_mm / area_bin_mm) + 2, 0);
  for (std::size_t v = 0; v < state.voxels.size(); ++v)
    if (state.voxels[v] == cut_free)
      volume[std::min(static_cast<std::size_t>(static_cast<double>(band.distance_mm.voxels[v]) / area_bin_mm),
                      volume.size() - 1)] += 1;
  std::vector<double> area(volume.size());
  for (std::size_t n = 0; n < volume.size(); ++n)
    area[n] = (volume[n > 0 ? n - 1 : 0] + 2 * volume[n] + volume[std::min(n + 1, volume.size() - 1)]) / 4;
  const double largest = *std::max_element(area.begin(), area.end());
  for (double& a : area) a = largest / std::max(a, 0.1 * largest);
  return area;
}

bool touches(const Mask& mask, const Index3& at) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::int64_t step : {-1, 1}) {
      Index3 to = at;
      to[axis] += step;
      if (mask.grid.contains(to[0], to[1], to[2]) && mask(to[0], to[1], to[2])) return true;
    }
  return false;
}

}  // namespace

void add_least_wall(BandInput& band, const Mask& cavity, double least_mm) {
  const auto& size = cavity.grid.size;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        if (band.forbidden.voxels[v]) continue;
        if (static_cast<double>(band.distance_mm.voxels[v]) <= least_mm || touches(cavity, {i, j, k}))
          band.inner.voxels[v] = 1;
      }
}

Mask band_state(const BandInput& band) {
  Mask state(band.inner.grid, cut_free);
  for (std::size_t v = 0; v < state.voxels.size(); ++v) {
    if (band.inner.voxels[v])
      state.voxels[v] = cut_inner;
    else if (band.forbidden.voxels[v] || band.air.voxels[v] ||
             static_cast<double>(band.distance_mm.voxels[v]) > band.band_mm)
      state.voxels[v] = cut_outer;
  }
  return state;
}

Volume<float> band_weight(const Volume<float>& tissue, const BandInput& band, const Mask& state,
                          double edge_hu_per_mm) {
  const auto area = area_factors(band, state);
  const auto [nx, ny, nz] = state.grid.size;
  Volume<float> weight(state.grid, 1.0F);
  parallel::parallel_for(0, nz, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < ny; ++j)
        for (std::int64_t i = 0; i < nx; ++i) {
          if (state(i, j, k) != cut_free) continue;
          const Vec3 fall = gradient(tissue, {i, j, k});
          const double outward = -dot(fall, normalized(gradient(band.distance_mm, {i, j, k})));
          const double edge = std::max(outward, 0.0) / edge_hu_per_mm;
          const auto bin = static_cast<std::size_t>(static_cast<double>(band.distance_mm(i, j, k)) / area_bin_mm);
          double h = (band.thick_wall ? area[std::min(bin, area.size() - 1)] : 1.0) / (1 + edge * edge);
          if (touches(band.forbidden, {i, j, k})) h = std::min(h, static_cast<double>(free_end));
          weight(i, j, k) = static_cast<float>(h);
        }
  });
  return weight;
}

Mask inside_of_cut(const Volume<float>& u, const BandInput& band) {
  Mask inside(u.grid);
  for (std::size_t v = 0; v < inside.voxels.size(); ++v) inside.voxels[v] = u.voxels[v] > 0.5F;
  Mask grown = inside;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < u.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < u.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < u.grid.size[0]; ++i, ++v) {
        if (inside.voxels[v] || band.forbidden.voxels[v] || band.air.voxels[v]) continue;
        grown.voxels[v] = touches(inside, {i, j, k}) && touches(band.forbidden, {i, j, k});
      }
  grown = fill_holes(grown);
  return drop_small_components(grown, std::max<std::int64_t>(count(grown) / island_fraction, 1));
}

Mask grown_to_half_height(const Mask& inside, const BandInput& band, const Volume<float>& tissue) {
  const Grid& grid = inside.grid;
  const float muscle = *std::max_element(tissue.voxels.begin(), tissue.voxels.end());
  const std::array<Index3, 6> steps{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  const auto belongs = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    for (const auto& [a, b, c] : steps) {
      if (!grid.contains(i - a, j - b, k - c) || !grid.contains(i + a, j + b, k + c)) continue;
      if (!inside(i - a, j - b, k - c) || inside(i + a, j + b, k + c)) continue;
      const float beyond = tissue(i + a, j + b, k + c);
      if (muscle - beyond > least_edge_hu && tissue(i, j, k) > (muscle + beyond) / 2) return true;
    }
    return false;
  };
  Mask grown = inside;
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          const bool free = !inside(i, j, k) && !band.forbidden(i, j, k) && !band.air(i, j, k);
          if (free && band.distance_mm(i, j, k) <= band.band_mm && belongs(i, j, k)) grown(i, j, k) = 1;
        }
  });
  return grown;
}

Volume<float> clipped_tissue(const CtVolume& ct, double muscle_hu) {
  Volume<float> image(ct.grid);
  for (std::size_t v = 0; v < ct.voxels.size(); ++v)
    image.voxels[v] = static_cast<float>(std::clamp(static_cast<double>(ct.voxels[v]), fat_hu, muscle_hu));
  return gaussian(image, smoothing_mm);
}

}  // namespace heart::segment
