// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/chest/trachea.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "generator/chest/working_image.hpp"
#include "generator/image/slices.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"

namespace heartgen::chest {
namespace {

constexpr float air_limit_hu = -600;                              // partial volume of a tube 15 mm wide stays above
constexpr double smallest_disc_mm2 = 60, largest_disc_mm2 = 900;  // adult tracheas: 100 to 500
constexpr double smallest_roundness = 0.8;                        // 1 for a disc, 0.95 for an ellipse of 2 : 1
constexpr double step_limit_mm = 5, growth_limit = 2;             // between neighbouring slices
constexpr double shortest_chain_mm = 25;

struct Disc {
  Vec3 centre_mm;
  double area_mm2 = 0, roundness = 0;
};
using Chain = std::vector<Disc>;

struct Moments {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0;
  bool at_border = false;
};

std::vector<Moments> moments_of(const image::Components& pieces, const Grid& grid, std::int64_t k) {
  std::vector<Moments> moments(pieces.voxel_count.size());
  const auto [nx, ny, nz] = grid.size;
  std::size_t p = 0;
  for (std::int64_t j = 0; j < ny; ++j)
    for (std::int64_t i = 0; i < nx; ++i, ++p) {
      const auto label = static_cast<std::size_t>(pieces.label.voxels[p]);
      if (label == 0) continue;
      Moments& m = moments[label];
      const Vec3 at = position_mm(grid, i, j, k) - grid.origin_mm;
      m.n += 1;
      m.x += at.x;
      m.y += at.y;
      m.xx += at.x * at.x;
      m.yy += at.y * at.y;
      m.at_border |= i == 0 || j == 0 || i == nx - 1 || j == ny - 1;
    }
  return moments;
}

std::vector<Disc> discs_of_slice(const Volume<float>& hu, std::int64_t k) {
  const auto pieces = image::slice_components(hu, k, [](float v) { return v < air_limit_hu; });
  const double pixel_mm2 = hu.grid.spacing_mm.x * hu.grid.spacing_mm.y;
  std::vector<Disc> discs;
  for (const Moments& m : moments_of(pieces, hu.grid, k)) {
    const double area = m.n * pixel_mm2;
    if (m.at_border || area <= smallest_disc_mm2 || area >= largest_disc_mm2) continue;
    const double x = m.x / m.n, y = m.y / m.n;
    const double spread = m.xx / m.n - x * x + m.yy / m.n - y * y;
    const double roundness = area / (2 * std::numbers::pi * spread);
    if (roundness < smallest_roundness) continue;
    const Vec3 height = position_mm(hu.grid, 0, 0, k);
    discs.push_back({{hu.grid.origin_mm.x + x, hu.grid.origin_mm.y + y, height.z}, area, roundness});
  }
  return discs;
}

/// The nearest disc that continues the chain; -1 for none.
int continuation(const Disc& last, const std::vector<Disc>& discs) {
  int best = -1;
  double nearest = step_limit_mm;
  for (std::size_t n = 0; n < discs.size(); ++n) {
    const Vec3 step = discs[n].centre_mm - last.centre_mm;
    const double growth = discs[n].area_mm2 / last.area_mm2;
    const double distance = math::hypot(step.x, step.y);
    if (distance >= nearest || growth > growth_limit || growth < 1 / growth_limit) continue;
    nearest = distance;
    best = static_cast<int>(n);
  }
  return best;
}

/// Chains of discs from the top down.
std::vector<Chain> chains_of(const std::vector<std::vector<Disc>>& discs) {
  std::vector<Chain> finished, growing;
  for (std::size_t k = discs.size(); k-- > 0;) {
    std::vector<bool> used(discs[k].size(), false);
    std::vector<Chain> next;
    for (Chain& chain : growing) {
      const int n = continuation(chain.back(), discs[k]);
      if (n < 0) {
        finished.push_back(std::move(chain));
        continue;
      }
      chain.push_back(discs[k][static_cast<std::size_t>(n)]);
      used[static_cast<std::size_t>(n)] = true;
      next.push_back(std::move(chain));
    }
    for (std::size_t n = 0; n < discs[k].size(); ++n)
      if (!used[n]) next.push_back({discs[k][n]});
    growing = std::move(next);
  }
  finished.insert(finished.end(), growing.begin(), growing.end());
  return finished;
}

/// Long, round, high, in the middle and in front of the spine: the trachea; else an oesophagus, bronchus or bulla.
double score(const Chain& chain, const Spine& spine, const Grid& grid) {
  double roundness = 0, area = 0, side = 0, front = 0, height = 0;
  for (const Disc& disc : chain) {
    const Vec3 vertebra = spine.at(disc.centre_mm.z);
    roundness += disc.roundness;
    area += disc.area_mm2;
    side += std::abs(disc.centre_mm.x - vertebra.x);
    front += vertebra.y - disc.centre_mm.y;
    height += (disc.centre_mm.z - grid.origin_mm.z) / (static_cast<double>(grid.size[2]) * grid.spacing_mm.z);
  }
  const double n = static_cast<double>(chain.size());
  constexpr double off_centre_mm = 15, nearest_to_spine_mm = 15, small_mm2 = 90;
  double result = grid.spacing_mm.z * roundness + 30 * height / n - 2 * std::max(0.0, side / n - off_centre_mm);
  if (front / n < nearest_to_spine_mm) result -= 100;
  if (area / n < small_mm2) result -= 60;
  return result;
}

}  // namespace

std::optional<Vec3> find_trachea(const Volume<float>& hu, const Spine& spine) {
  std::vector<std::vector<Disc>> discs(static_cast<std::size_t>(hu.grid.size[2]));
  parallel::parallel_for(0, hu.grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k) discs[static_cast<std::size_t>(k)] = discs_of_slice(hu, k);
  });
  const Chain* best = nullptr;
  double best_score = 0;
  const auto chains = chains_of(discs);
  for (const Chain& chain : chains) {
    if (static_cast<double>(chain.size()) * hu.grid.spacing_mm.z < shortest_chain_mm) continue;
    const double s = score(chain, spine, hu.grid);
    if (s <= best_score) continue;
    best = &chain;
    best_score = s;
  }
  if (!best) return std::nullopt;
  return (*best)[best->size() / 2].centre_mm;
}

}  // namespace heartgen::chest
