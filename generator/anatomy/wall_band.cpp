// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/wall_band.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "generator/image/components.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/morphology.hpp"
#include "generator/parallel/threads.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double min_weight = 0.5;             // of an edge inside the tissue, where nothing says it is the heart's
constexpr float free_end = 0.2F;               // weight between the wall and what is surely outside
constexpr std::int64_t island_fraction = 100;  // smaller pieces are no heart; the atria may be two pieces
constexpr double opening_mm = 1;               // half the width of what is no wall, voxels permitting
constexpr double area_bin_mm = 1;              // thickness of the shells whose volumes measure the level sets' areas

std::size_t area_bin(float distance_mm) {
  return static_cast<std::size_t>(static_cast<double>(distance_mm) / area_bin_mm);
}

/// Reference area divided by the area of the level set at each distance (bins of area_bin_mm), smoothed once, in the
/// thick part of the wall.
std::vector<double> area_factors(const BandInput& band, const Mask& state) {
  std::vector<double> volume(2, 0);
  for (std::size_t v = 0; v < state.voxels.size(); ++v) {
    if (state.voxels[v] == pde::cut_inner || !band.thick.voxels[v] || !band.reach.voxels[v]) continue;
    const std::size_t bin = area_bin(band.distance_mm.voxels[v]);
    if (bin >= volume.size()) volume.resize(bin + 1, 0);
    volume[bin] += 1;
  }
  std::vector<double> area(volume.size());
  for (std::size_t n = 0; n < volume.size(); ++n)
    area[n] = (volume[n > 0 ? n - 1 : 0] + 2 * volume[n] + volume[std::min(n + 1, volume.size() - 1)]) / 4;
  const double largest = *std::max_element(area.begin(), area.end());
  for (double& a : area) a = largest > 0 ? largest / std::max(a, 0.1 * largest) : 1;
  return area;
}

/// Whether one of the voxels that share a face or an edge is set. Those at corners would make thin walls too thick, and
/// the mesher parts what meets in a point only.
bool touches(const Mask& mask, const Index3& at) {
  const auto& size = mask.grid.size;
  for (std::int64_t k = std::max<std::int64_t>(at[2] - 1, 0); k <= std::min(at[2] + 1, size[2] - 1); ++k)
    for (std::int64_t j = std::max<std::int64_t>(at[1] - 1, 0); j <= std::min(at[1] + 1, size[1] - 1); ++j)
      for (std::int64_t i = std::max<std::int64_t>(at[0] - 1, 0); i <= std::min(at[0] + 1, size[0] - 1); ++i)
        if (mask(i, j, k) && std::abs(i - at[0]) + std::abs(j - at[1]) + std::abs(k - at[2]) < 3) return true;
  return false;
}

/// Free voxels that no chain of free voxels joins to the inside are outside: no cut has to part them from it.
void drop_unreached(Mask& state) {
  Mask open(state.grid);
  for (std::size_t v = 0; v < state.voxels.size(); ++v) open.voxels[v] = state.voxels[v] != pde::cut_outer;
  const image::Components pieces = image::connected_components(open);
  std::vector<std::uint8_t> reached(pieces.voxel_count.size(), 0);
  for (std::size_t v = 0; v < state.voxels.size(); ++v)
    if (state.voxels[v] == pde::cut_inner) reached[static_cast<std::size_t>(pieces.label.voxels[v])] = 1;
  for (std::size_t v = 0; v < state.voxels.size(); ++v)
    if (state.voxels[v] == pde::cut_free && !reached[static_cast<std::size_t>(pieces.label.voxels[v])])
      state.voxels[v] = pde::cut_outer;
}

/// Whether the wall may end between this voxel and one of the next along i, j and k, whose differences the solver
/// weighs with this voxel's weight: one of the two is not outside, the other is forbidden, fat or air.
bool ends_here(const BandInput& band, const Mask& state, const Index3& at) {
  const auto outside = [&](const Index3& p) {
    return state(p[0], p[1], p[2]) == pde::cut_outer &&
           (band.forbidden(p[0], p[1], p[2]) != 0 || band.beyond(p[0], p[1], p[2]) != 0);
  };
  const auto within = [&](const Index3& p) { return state(p[0], p[1], p[2]) != pde::cut_outer; };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Index3 next = at;
    if (++next[axis] == state.grid.size[axis]) continue;
    if ((outside(at) && within(next)) || (within(at) && outside(next))) return true;
  }
  return false;
}

}  // namespace

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

void add_min_wall(BandInput& band, const Mask& cavity, double min_mm) {
  const auto& size = cavity.grid.size;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        if (band.forbidden.voxels[v]) continue;
        if (static_cast<double>(band.distance_mm.voxels[v]) <= min_mm || touches(cavity, {i, j, k}))
          band.inner.voxels[v] = 1;
      }
}

Mask band_state(const BandInput& band) {
  Mask state(band.inner.grid, pde::cut_free);
  for (std::size_t v = 0; v < state.voxels.size(); ++v) {
    if (band.inner.voxels[v])
      state.voxels[v] = pde::cut_inner;
    else if (band.forbidden.voxels[v] || band.beyond.voxels[v] || !band.reach.voxels[v])
      state.voxels[v] = pde::cut_outer;
  }
  drop_unreached(state);
  return state;
}

Volume<float> band_weight(const Volume<float>& tissue, const BandInput& band, const Mask& state,
                          double edge_hu_per_mm) {
  const auto area = area_factors(band, state);
  const Index3& size = state.grid.size;
  Volume<float> weight(state.grid, 1.0F);
  parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j)
        for (std::int64_t i = 0; i < size[0]; ++i) {
          if (ends_here(band, state, {i, j, k})) {
            weight(i, j, k) = free_end;
            continue;
          }
          if (state(i, j, k) != pde::cut_free) continue;
          const Vec3 fall = gradient(tissue, {i, j, k});
          const double outward = -dot(fall, normalized(gradient(band.distance_mm, {i, j, k})));
          const double edge = std::max(outward, 0.0) / edge_hu_per_mm;
          const double scale = band.thick(i, j, k) ? area[area_bin(band.distance_mm(i, j, k))] : 1;
          weight(i, j, k) = static_cast<float>(scale * std::max(1 / (1 + edge * edge), min_weight));
        }
  });
  return weight;
}

Mask inside_of_cut(const Volume<float>& u, const BandInput& band) {
  const Vec3& spacing = u.grid.spacing_mm;
  Mask inside(u.grid);
  for (std::size_t v = 0; v < inside.voxels.size(); ++v) inside.voxels[v] = u.voxels[v] > 0.5F;
  const double thin = std::max(opening_mm, std::min({spacing.x, spacing.y, spacing.z}));
  inside = image::fill_holes(image::unite(image::open(inside, thin), band.inner));
  return image::drop_small_components(inside, std::max<std::int64_t>(image::count(inside) / island_fraction, 1));
}

}  // namespace heartgen::anatomy
