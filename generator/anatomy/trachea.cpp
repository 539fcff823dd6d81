// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/trachea.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "generator/anatomy/bronchi.hpp"
#include "generator/anatomy/hounsfield.hpp"
#include "generator/anatomy/seeds.hpp"
#include "generator/image/box_around.hpp"
#include "generator/image/components.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/morphology.hpp"
#include "generator/pde/chan_vese.hpp"
#include "model/crop.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"
#include "model/priors.hpp"
#include "model/quantile.hpp"
#include "model/tissue.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double lumen_ball_mm = 3;  // ball inside the lumen whose median is its grey value
constexpr double curvature_mm = 1;   // tubes in the lung with radii below twice this are left to it
constexpr double smoothing_mm = 1;   // of the image that outlines where the contour is looked for
constexpr double margin_mm = 4;      // around that outline

struct Disc {
  double x = 0, y = 0;  // centroid, mm along the grid's axes
  double area_mm2 = 0;
  std::int64_t slice = 0;
};

/// Round pieces of air in one slice that do not touch its border, with the area of a trachea.
std::vector<Disc> discs_in_slice(const CtVolume& ct, std::int64_t k) {
  const auto [nx, ny, nz] = ct.grid.size;
  Grid plane = ct.grid;
  plane.size[2] = 1;
  Mask air(plane);
  for (std::int64_t v = 0; v < nx * ny; ++v)
    air.voxels[static_cast<std::size_t>(v)] =
        ct.voxels[static_cast<std::size_t>(k * nx * ny + v)] < tissue::airway_max_hu;
  const image::Components pieces = image::connected_components(air);
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
    if (m.border || area < priors::trachea_section_min_mm2 || area > priors::trachea_section_max_mm2) continue;
    const double x = m.x / m.n, y = m.y / m.n;
    const double spread = m.r2 / m.n - x * x - y * y;  // area / 2 pi for a disc, more for other shapes
    if (area < priors::trachea_roundness_min * 2 * std::numbers::pi * spread) continue;
    discs.push_back({x, y, area, k});
  }
  return discs;
}

/// The first slice above the left ventricle: round air below it is gas in stomach or bowel.
std::int64_t slice_above_heart(const CtVolume& ct, const Landmarks& landmarks) {
  const auto heart = landmarks.seeds_mm.find("lv_blood");
  if (heart == landmarks.seeds_mm.end()) return 0;
  return std::max<std::int64_t>(0, std::lround(index_from_lps(ct.grid, heart->second).z) + 1);
}

/// The longest chain of discs through neighbouring slices, its middle as a voxel. Chains start from the top.
std::optional<Index3> find_trachea(const CtVolume& ct, std::int64_t lowest_slice) {
  std::vector<std::vector<Disc>> chains;
  for (std::int64_t k = ct.grid.size[2] - 1; k >= lowest_slice; --k)
    for (const Disc& disc : discs_in_slice(ct, k)) {
      const auto follows = [&](const std::vector<Disc>& chain) {
        const Disc& last = chain.back();
        const double ratio = disc.area_mm2 / last.area_mm2;
        return last.slice == k + 1 && math::hypot(disc.x - last.x, disc.y - last.y) < priors::trachea_drift_max_mm &&
               ratio > 1 / priors::trachea_section_change_max && ratio < priors::trachea_section_change_max;
      };
      const auto chain = std::find_if(chains.begin(), chains.end(), follows);
      if (chain != chains.end())
        chain->push_back(disc);
      else
        chains.push_back({disc});
    }
  const auto longest =
      std::max_element(chains.begin(), chains.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (longest == chains.end() ||
      static_cast<double>(longest->size()) * ct.grid.spacing_mm.z < priors::trachea_length_min_mm)
    return std::nullopt;
  const Disc& middle = (*longest)[longest->size() / 2];
  return Index3{std::lround(middle.x / ct.grid.spacing_mm.x), std::lround(middle.y / ct.grid.spacing_mm.y),
                middle.slice};
}

std::optional<Index3> start_voxel(const CtVolume& ct, const Landmarks& landmarks) {
  const auto seed = landmarks.seeds_mm.find("trachea");
  if (seed == landmarks.seeds_mm.end()) return find_trachea(ct, slice_above_heart(ct, landmarks));
  const Mask air = image::mask_where(ct.grid, [&](std::size_t v) { return ct.voxels[v] < tissue::airway_max_hu; });
  return seed_in_mask(ct, air, "trachea", seed->second, 3, "air");
}

double median_of(const CtVolume& ct, const Mask& mask) {
  std::vector<std::int16_t> values;
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v]) values.push_back(ct.voxels[v]);
  return upper_median(values);
}

/// The grey value of the lung that `air` leaks into; nothing where there is none. More air than airways can hold is
/// mostly lung. Else lung is what is brighter than the lumen without being half wall.
std::optional<double> lung_grey(const CtVolume& ct, const Mask& air, const Volume<float>& smooth, double lumen_grey,
                                std::int64_t limit) {
  if (image::count(air) > limit) return median_of(ct, air);
  const Vec3& spacing = ct.grid.spacing_mm;
  const Mask deep = image::erode(air, 1.5 * std::max({spacing.x, spacing.y, spacing.z}));
  const Mask brighter = image::mask_where(ct.grid, [&](std::size_t v) {
    return deep.voxels[v] && static_cast<double>(smooth.voxels[v]) > lumen_grey + tissue::airway_contrast_min_hu;
  });
  if (static_cast<double>(image::count(brighter)) * ct.grid.voxel_volume_mm3() <
      priors::lung_beside_airways_min_ml * 1000)
    return std::nullopt;
  return median_of(ct, brighter);
}

/// Airways and lung in one domain: the contour between their grey values with a high weight of the curvature, so that
/// it does not follow thin bronchi (thesis 6.2.1). `air` holds both. Empty where the seed is not inside.
Mask airways_at(const Volume<float>& image, const Volume<float>& smooth, const Mask& air, const Index3& seed,
                double lumen_grey, double level) {
  const auto dark = image::mask_where(
      air.grid, [&](std::size_t v) { return air.voxels[v] && static_cast<double>(smooth.voxels[v]) < level; });
  Mask outline = image::component_of(dark, seed);
  if (image::count(outline) == 0) return outline;
  const auto margin = static_cast<std::int64_t>(
      std::ceil(margin_mm / std::min({air.grid.spacing_mm.x, air.grid.spacing_mm.y, air.grid.spacing_mm.z})));
  const Box box = bounding_box(outline, margin, [](std::uint8_t v) { return v != 0; });
  const Mask domain = image::intersect(image::dilate(crop(outline, box), margin_mm), crop(air, box));
  const auto self = parallel::self();
  const auto found = pde::chan_vese_at(parallel::scatter(crop(image, box), self), parallel::scatter(domain, self),
                                       lumen_grey, 2 * level - lumen_grey, {.mu = curvature_mm}, self);
  return image::pasted(air.grid, image::subtract(domain, parallel::gather(found.above, self)), box);
}

/// Adds the voxels beside the lumen that are more lumen than wall: darker than half-way between the lumen and the
/// crest of the wall, looked for straight on. Half of every wall lies in voxels that it shares with the lumen. A crest
/// nearer to tissue than to the lumen is tissue: walls thinner than a voxel only look fainter.
Mask grown_to_the_wall(const CtVolume& ct, const Mask& lumen, double lumen_grey, double tissue_grey) {
  const auto& size = ct.grid.size;
  Mask grown = lumen;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) {
        if (!lumen(i, j, k)) continue;
        for (int face = 0; face < 6; ++face) {
          const auto axis = static_cast<std::size_t>(face / 2);
          const std::int64_t sign = face % 2 ? 1 : -1;
          Index3 at{i, j, k};
          at[axis] += sign;
          if (!ct.grid.contains(at[0], at[1], at[2]) || lumen(at[0], at[1], at[2])) continue;
          const Index3 next = at;
          double crest = -32768;
          for (int n = 0;
               n * ct.grid.spacing_mm[face / 2] <= priors::airway_wall_max_mm && ct.grid.contains(at[0], at[1], at[2]);
               ++n, at[axis] += sign)
            crest = std::max(crest, static_cast<double>(ct(at[0], at[1], at[2])));
          if (2 * crest > lumen_grey + tissue_grey) crest = std::max(crest, tissue_grey);
          if (2 * ct(next[0], next[1], next[2]) < lumen_grey + crest) grown(next[0], next[1], next[2]) = 1;
        }
      }
  return grown;
}

}  // namespace

Mask segment_trachea(const CtVolume& ct, const pde::SegmentationTree& tree, const Landmarks& landmarks) {
  const auto seed = start_voxel(ct, landmarks);
  if (!seed) return Mask(ct.grid);
  // The first split of the tree parts air and tissue: the wall lies half-way between their grey values.
  const int wall_hu = tree.empty() ? static_cast<int>(tissue::airway_wall_hu)
                                   : static_cast<int>((tree.front().c_below + tree.front().c_above) / 2);
  const double tissue_grey = tree.empty() ? 0 : tree.front().c_above;
  const auto limit = static_cast<std::int64_t>(priors::airways_max_ml * 1000 / ct.grid.voxel_volume_mm3());
  Mask air =
      image::component_of(image::mask_where(ct.grid, [&](std::size_t v) { return ct.voxels[v] < wall_hu; }), *seed);
  const Vec3 center = lps_from_index(
      ct.grid, {static_cast<double>((*seed)[0]), static_cast<double>((*seed)[1]), static_cast<double>((*seed)[2])});
  const double lumen_grey = median_around(ct, center, lumen_ball_mm);
  const Volume<float> image = as_float(ct), smooth = image::gaussian(image, smoothing_mm);
  const auto lung = lung_grey(ct, air, smooth, lumen_grey, limit);
  if (!lung) return air;
  // As close to the grey value of the lung as it can be without a leak: parts of the lung may be as dark as the lumen.
  for (const double share : {0.8, 0.65, 0.5, 0.35, 0.2}) {
    const double level = lumen_grey + share * (*lung - lumen_grey);
    const Mask lumen = image::component_of(airways_at(image, smooth, air, *seed, lumen_grey, level), *seed, limit);
    if (image::count(lumen) == 0) continue;
    const Mask tree_of_airways = with_bronchi(ct, lumen, air, lumen_grey, *lung);
    return image::fill_holes(grown_to_the_wall(ct, tree_of_airways, lumen_grey, tissue_grey));
  }
  return Mask(ct.grid);
}

}  // namespace heartgen::anatomy
