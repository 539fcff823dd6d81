// SPDX-License-Identifier: GPL-3.0-or-later
// Agreement of two label maps: overlap and distances between the regions' surfaces.
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "model/labels.hpp"
#include "validation/contour_fit.hpp"
#include "validation/distance_map.hpp"
#include "validation/quantiles.hpp"

namespace heartgen::validation {
namespace {

LabelVolume resampled_nearest(const LabelVolume& labels, const Grid& grid) {
  if (labels.grid == grid) return labels;
  LabelVolume result(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const Vec3 lps = lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const Vec3 index = index_from_lps(labels.grid, lps);
        const std::int64_t a = std::lround(index.x), b = std::lround(index.y), c = std::lround(index.z);
        if (labels.grid.contains(a, b, c)) result(i, j, k) = labels(a, b, c);
      }
  return result;
}

/// Both maps cut to the box around one region, with a margin of one voxel.
struct Crop {
  Grid grid;
  std::vector<std::uint8_t> ours, reference;
};

Crop crop_region(const LabelVolume& ours, const LabelVolume& reference, std::uint8_t region) {
  Index3 low = reference.grid.size, high{-1, -1, -1};
  const Grid& grid = reference.grid;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        if (ours(i, j, k) != region && reference(i, j, k) != region) continue;
        const Index3 at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], at[a]), high[a] = std::max(high[a], at[a]);
      }
  Crop crop;
  crop.grid.spacing_mm = grid.spacing_mm;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] -= 1;
    crop.grid.size[a] = high[a] + 1 - low[a] + 1;
  }
  const auto count = static_cast<std::size_t>(crop.grid.voxel_count());
  crop.ours.assign(count, 0);
  crop.reference.assign(count, 0);
  for (std::int64_t k = low[2] + 1; k <= high[2]; ++k)
    for (std::int64_t j = low[1] + 1; j <= high[1]; ++j)
      for (std::int64_t i = low[0] + 1; i <= high[0]; ++i) {
        const auto at = static_cast<std::size_t>(crop.grid.offset(i - low[0], j - low[1], k - low[2]));
        crop.ours[at] = ours(i, j, k) == region;
        crop.reference[at] = reference(i, j, k) == region;
      }
  return crop;
}

/// Voxels of the mask with a face neighbour outside it; the mask never touches the crop's border.
std::vector<std::uint8_t> border(const Grid& grid, const std::vector<std::uint8_t>& mask) {
  std::vector<std::uint8_t> result(mask.size(), 0);
  const std::int64_t stride[3] = {1, grid.size[0], grid.size[0] * grid.size[1]};
  for (std::size_t v = 0; v < mask.size(); ++v) {
    if (!mask[v]) continue;
    for (const auto s : stride)
      if (!mask[v + static_cast<std::size_t>(s)] || !mask[v - static_cast<std::size_t>(s)]) result[v] = 1;
  }
  return result;
}

void append_distances(const Grid& grid, const std::vector<std::uint8_t>& from, const std::vector<std::uint8_t>& to,
                      std::vector<double>& distances) {
  const auto map = distance_to(grid, to);
  for (std::size_t v = 0; v < from.size(); ++v)
    if (from[v]) distances.push_back(map[v]);
}

void add_region_rows(Report& report, const Crop& crop, const std::string& scope) {
  double both = 0, sum = 0, ours_count = 0;
  for (std::size_t v = 0; v < crop.ours.size(); ++v) {
    both += crop.ours[v] && crop.reference[v];
    sum += crop.ours[v] + crop.reference[v];
    ours_count += crop.ours[v];
  }
  const auto add = [&](const char* metric, double value, const char* unit) {
    report.push_back({"fit", scope, metric, value, unit, {}, {}});
  };
  add("dice", 2 * both / sum, "1");
  if (ours_count == 0 || sum == ours_count) return;  // one side is empty: no distance
  const auto a = border(crop.grid, crop.ours), b = border(crop.grid, crop.reference);
  std::vector<double> distances;
  append_distances(crop.grid, a, b, distances);
  append_distances(crop.grid, b, a, distances);
  double mean = 0;
  for (const double d : distances) mean += d / static_cast<double>(distances.size());
  add("surface_distance_mean", mean, "mm");
  add("surface_distance_p95", quantile(distances, 0.95), "mm");
  add("surface_distance_max", quantile(distances, 1), "mm");
}

/// Per voxel of `vessel`, the way (mm) along it from the ventricle it leaves, over 26 neighbours; infinite elsewhere.
/// A vessel begins within two voxels of its ventricle.
std::vector<double> way_from_ventricle(const LabelVolume& labels, std::uint8_t vessel, std::uint8_t ventricle) {
  const Grid& grid = labels.grid;
  const auto& spacing = grid.spacing_mm;
  std::vector<double> way_mm(labels.voxels.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::int64_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  const auto visit = [&](std::int64_t i, std::int64_t j, std::int64_t k, int reach, const auto& call) {
    for (std::int64_t c = std::max<std::int64_t>(k - reach, 0); c <= std::min(k + reach, grid.size[2] - 1); ++c)
      for (std::int64_t b = std::max<std::int64_t>(j - reach, 0); b <= std::min(j + reach, grid.size[1] - 1); ++b)
        for (std::int64_t a = std::max<std::int64_t>(i - reach, 0); a <= std::min(i + reach, grid.size[0] - 1); ++a)
          call(a, b, c);
  };
  const auto lower = [&](std::int64_t at, double value) {
    if (value >= way_mm[static_cast<std::size_t>(at)]) return;
    way_mm[static_cast<std::size_t>(at)] = value;
    front.emplace(value, at);
  };
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        if (labels(i, j, k) != vessel) continue;
        visit(i, j, k, 2, [&](std::int64_t a, std::int64_t b, std::int64_t c) {
          if (labels(a, b, c) == ventricle) lower(grid.offset(i, j, k), 0);
        });
      }
  while (!front.empty()) {
    const auto [value, at] = front.top();
    front.pop();
    if (value > way_mm[static_cast<std::size_t>(at)]) continue;
    const std::int64_t i = at % grid.size[0], j = at / grid.size[0] % grid.size[1],
                       k = at / grid.size[0] / grid.size[1];
    visit(i, j, k, 1, [&](std::int64_t a, std::int64_t b, std::int64_t c) {
      if (labels(a, b, c) != vessel) return;
      const double x = spacing[0] * static_cast<double>(a - i), y = spacing[1] * static_cast<double>(b - j),
                   z = spacing[2] * static_cast<double>(c - k);
      lower(grid.offset(a, b, c), value + std::sqrt(x * x + y * y + z * z));
    });
  }
  return way_mm;
}

/// The great vessels of `reference` as far along them as ours go: a model holds stumps of them. Our end is where 95 %
/// of our vessel's voxels lie below: it is cut level, at an angle to the vessel. What both hold counts, wherever it
/// lies.
LabelVolume cut_to_stumps(LabelVolume reference, const LabelVolume& ours) {
  for (const auto& [vessel, ventricle] :
       {std::pair{tag(Region::aorta), tag(Region::lv_blood)}, {tag(Region::pulmonary_artery), tag(Region::rv_blood)}}) {
    std::vector<double> reached;
    for (const double way_mm : way_from_ventricle(ours, vessel, ventricle))
      if (std::isfinite(way_mm)) reached.push_back(way_mm);
    if (reached.empty()) continue;
    const double end_mm = quantile(reached, 0.95);
    const auto way_mm = way_from_ventricle(reference, vessel, ventricle);
    for (std::size_t v = 0; v < way_mm.size(); ++v)
      if (reference.voxels[v] == vessel && ours.voxels[v] != vessel && way_mm[v] > end_mm) reference.voxels[v] = 0;
  }
  return reference;
}

std::vector<std::uint8_t> values_in(const LabelVolume& labels) {
  std::vector<std::uint8_t> present(256, 0);
  for (const auto label : labels.voxels) present[label] = 1;
  return present;
}

}  // namespace

Report compare_labels(const LabelVolume& ours, const LabelVolume& reference) {
  const LabelVolume mine = resampled_nearest(ours, reference.grid);
  const LabelVolume theirs = cut_to_stumps(reference, mine);
  const auto in_mine = values_in(mine), in_theirs = values_in(theirs);
  Report report;
  for (std::size_t value = 1; value < in_mine.size(); ++value) {
    const auto region = static_cast<Region>(value);
    const bool is_heart = is_myocardium(region) || is_blood(region);
    if (in_mine[value] || (in_theirs[value] && is_heart))
      add_region_rows(report, crop_region(mine, theirs, static_cast<std::uint8_t>(value)),
                      region_name(static_cast<std::int32_t>(value)));
  }
  return report;
}

}  // namespace heartgen::validation
