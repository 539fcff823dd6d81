#include "generator/segment/trachea.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "generator/segment/components.hpp"
#include "generator/segment/morphology.hpp"
#include "generator/segment/seeds.hpp"
#include "generator/segment/vessel_ends.hpp"
#include "model/error.hpp"

namespace heart::segment {
namespace {

constexpr int lumen_hu = -700;            // a trachea's disc is darker than this
constexpr double volume_limit_ml = 120;   // trachea and bronchi have 30 to 80: more is a leak into the lungs
constexpr double branch_radius_mm = 2.5;  // thinner bronchi are left to the lung
constexpr double wall_reach_mm = 2;       // from the leak-free core to the lumen's wall
constexpr double least_chain_mm = 20;     // a trachea runs at least this far through the slices

struct Disc {
  double x = 0, y = 0;  // centroid, mm along the grid's axes
  double area_mm2 = 0;
  std::int64_t slice = 0;
};

template <class Rule>
Mask mask_where(const Grid& grid, Rule rule) {
  Mask mask(grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) mask.voxels[v] = rule(v);
  return mask;
}

/// Round pieces of air in one slice that do not touch its border, with the area of a trachea.
std::vector<Disc> discs_in_slice(const CtVolume& ct, std::int64_t k) {
  const auto [nx, ny, nz] = ct.grid.size;
  Grid plane = ct.grid;
  plane.size[2] = 1;
  Mask air(plane);
  for (std::int64_t v = 0; v < nx * ny; ++v)
    air.voxels[static_cast<std::size_t>(v)] = ct.voxels[static_cast<std::size_t>(k * nx * ny + v)] < lumen_hu;
  const Components pieces = connected_components(air);
  struct Moments {
    double n = 0, x = 0, y = 0, r2 = 0;
    bool border = false;
  };
  std::vector<Moments> moments(pieces.voxel_count.size());
  for (std::int64_t j = 0; j < ny; ++j)
    for (std::int64_t i = 0; i < nx; ++i) {
      Moments& m = moments[static_cast<std::size_t>(pieces.label(i, j, 0))];
      const double x = static_cast<double>(i) * plane.spacing_mm.x;
      const double y = static_cast<double>(j) * plane.spacing_mm.y;
      m.n += 1, m.x += x, m.y += y, m.r2 += x * x + y * y;
      m.border |= i == 0 || j == 0 || i == nx - 1 || j == ny - 1;
    }
  std::vector<Disc> discs;
  for (std::size_t label = 1; label < moments.size(); ++label) {
    const Moments& m = moments[label];
    const double area = m.n * plane.spacing_mm.x * plane.spacing_mm.y;
    if (m.border || area < 60 || area > 900) continue;
    const double x = m.x / m.n, y = m.y / m.n;
    const double spread = m.r2 / m.n - x * x - y * y;  // area / 2 pi for a disc, more for other shapes
    if (area < 0.75 * 2 * std::numbers::pi * spread) continue;
    discs.push_back({x, y, area, k});
  }
  return discs;
}

/// The longest chain of discs through neighbouring slices, its middle as a voxel. Chains start from the top.
std::optional<Index3> find_trachea(const CtVolume& ct) {
  constexpr double drift_mm = 5;
  std::vector<std::vector<Disc>> chains;
  for (std::int64_t k = ct.grid.size[2] - 1; k >= 0; --k)
    for (const Disc& disc : discs_in_slice(ct, k)) {
      const auto follows = [&](const std::vector<Disc>& chain) {
        const Disc& last = chain.back();
        const double ratio = disc.area_mm2 / last.area_mm2;
        return last.slice == k + 1 && std::hypot(disc.x - last.x, disc.y - last.y) < drift_mm && ratio > 0.5 &&
               ratio < 2;
      };
      const auto chain = std::find_if(chains.begin(), chains.end(), follows);
      if (chain != chains.end())
        chain->push_back(disc);
      else
        chains.push_back({disc});
    }
  const auto longest =
      std::max_element(chains.begin(), chains.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (longest == chains.end() || static_cast<double>(longest->size()) * ct.grid.spacing_mm.z < least_chain_mm)
    return std::nullopt;
  const Disc& middle = (*longest)[longest->size() / 2];
  return Index3{std::lround(middle.x / ct.grid.spacing_mm.x), std::lround(middle.y / ct.grid.spacing_mm.y),
                middle.slice};
}

std::optional<Index3> start_voxel(const CtVolume& ct, const Landmarks& landmarks) {
  const auto seed = landmarks.seeds_mm.find("trachea");
  if (seed == landmarks.seeds_mm.end()) return find_trachea(ct);
  const Mask air = mask_where(ct.grid, [&](std::size_t v) { return ct.voxels[v] < lumen_hu; });
  return seed_in_mask(ct, air, "trachea", seed->second, 3, "air");
}

}  // namespace

Mask segment_trachea(const CtVolume& ct, const SegmentationTree& tree, const Landmarks& landmarks) {
  const auto seed = start_voxel(ct, landmarks);
  if (!seed) return Mask(ct.grid);
  // The first split of the tree parts air and tissue: the wall lies half-way between their grey values.
  const int wall_hu = tree.empty() ? -500 : static_cast<int>((tree.front().c_below + tree.front().c_above) / 2);
  const auto limit = static_cast<std::int64_t>(volume_limit_ml * 1000 / ct.grid.voxel_volume_mm3());
  // The brightest threshold without a leak: the walls of small bronchi vanish in the partial volume above it.
  for (int threshold = wall_hu; threshold >= -1000; threshold -= 25) {
    const Mask air = mask_where(ct.grid, [&](std::size_t v) { return ct.voxels[v] < threshold; });
    Mask lumen = component_of(air, *seed, limit);
    if (count(lumen) == 0) continue;
    lumen = drop_thin_branches(lumen, branch_radius_mm);
    const Mask reach = dilate(lumen, threshold < wall_hu ? wall_reach_mm : 0);
    return mask_where(ct.grid, [&](std::size_t v) {
      return lumen.voxels[v] || (reach.voxels[v] && ct.voxels[v] < wall_hu && ct.voxels[v] > -1100);
    });
  }
  return Mask(ct.grid);
}

}  // namespace heart::segment
