// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/label_scores.hpp"

#include <algorithm>
#include <limits>

#include "model/crop.hpp"
#include "model/report.hpp"
#include "validation/contour_fit.hpp"

namespace heartgen::lab {
namespace {

double metric_of(const Report& report, Region region, const std::string& metric) {
  for (const auto& row : report)
    if (row.scope == region_name(tag(region)) && row.metric == metric) return row.value;
  return std::numeric_limits<double>::quiet_NaN();
}

/// ml.
double volume_of(const LabelVolume& labels, Region region) {
  return static_cast<double>(std::count(labels.voxels.begin(), labels.voxels.end(), tag(region))) *
         labels.grid.voxel_volume_mm3() / 1000;
}

}  // namespace

std::vector<Score> scores_of(const LabelVolume& ours, const LabelVolume& truth, std::span<const Region> regions) {
  const auto only = [&](const LabelVolume& map) {
    LabelVolume part = map;
    for (auto& label : part.voxels)
      if (std::none_of(regions.begin(), regions.end(), [&](Region r) { return label == tag(r); })) label = 0;
    return part;
  };
  const LabelVolume mine = only(ours), reference = only(truth);
  LabelVolume either = mine;
  for (std::size_t v = 0; v < either.voxels.size(); ++v) either.voxels[v] |= reference.voxels[v];
  const auto box = bounding_box(either, 1, [](std::uint8_t label) { return label != 0; });
  if (box.empty()) return {};
  const Report report = validation::compare_labels(crop(mine, box), crop(reference, box));
  std::vector<Score> scores;
  for (const Region region : regions)
    scores.push_back({region_name(tag(region)), metric_of(report, region, "dice"),
                      metric_of(report, region, "surface_distance_mean"),
                      metric_of(report, region, "surface_distance_max"), volume_of(mine, region)});
  return scores;
}

LabelVolume labelled(const Mask& mask, Region region) {
  LabelVolume labels(mask.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v]) labels.voxels[v] = tag(region);
  return labels;
}

}  // namespace heartgen::lab
