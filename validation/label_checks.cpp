// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/label_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "model/crop.hpp"
#include "model/mathematics.hpp"
#include "validation/criteria.hpp"
#include "validation/distance_map.hpp"
#include "validation/quantiles.hpp"

namespace heartgen::validation {
namespace {

constexpr double mm3_per_ml = 1000;

/// A stretch of one label along a row; `root`: a run of the same component that comes no later.
struct Run {
  std::int64_t begin, end;
  std::uint8_t label;
  std::size_t root;
};

std::size_t first_of(std::vector<Run>& runs, std::size_t run) {
  while (runs[run].root != run) run = runs[run].root = runs[runs[run].root].root;
  return run;
}

/// Joins two runs of neighbouring rows where they have one label and touch, if only at corners.
void join(std::vector<Run>& runs, std::size_t a, std::size_t b) {
  const bool touch = runs[a].begin <= runs[b].end && runs[b].begin <= runs[a].end;
  if (!touch || runs[a].label != runs[b].label) return;
  const auto one = first_of(runs, a), two = first_of(runs, b);
  runs[std::max(one, two)].root = std::min(one, two);
}

void join_rows(std::vector<Run>& runs, std::array<std::size_t, 2> row, std::array<std::size_t, 2> other) {
  auto [a, a_end] = row;
  auto [b, b_end] = other;
  while (a < a_end && b < b_end) {
    join(runs, a, b);
    if (runs[a].end == runs[b].end && a + 1 < a_end) join(runs, a + 1, b);
    ++(runs[a].end < runs[b].end ? a : b);
  }
}

/// Sizes (voxels) of the 26-connected components, per region tag.
std::vector<std::vector<std::size_t>> component_sizes(const LabelVolume& labels) {
  const auto& size = labels.grid.size;
  std::vector<Run> runs;
  std::vector<std::size_t> first_run{0};  // of each row, and past the last one
  for (std::int64_t row = 0; row < size[1] * size[2]; ++row) {
    const auto* label = labels.voxels.data() + row * size[0];
    for (std::int64_t i = 0, end = 0; i < size[0]; i = end) {
      while (end < size[0] && label[end] == label[i]) ++end;
      if (label[i] != 0) runs.push_back({i, end, label[i], runs.size()});
    }
    first_run.push_back(runs.size());
  }
  const auto runs_of = [&](std::int64_t j, std::int64_t k) {
    const auto row = static_cast<std::size_t>(k * size[1] + j);
    return std::array{first_run[row], first_run[row + 1]};
  };
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j) {
      if (j > 0) join_rows(runs, runs_of(j, k), runs_of(j - 1, k));
      for (auto beside = std::max<std::int64_t>(j - 1, 0); k > 0 && beside <= std::min(j + 1, size[1] - 1); ++beside)
        join_rows(runs, runs_of(j, k), runs_of(beside, k - 1));
    }
  std::vector<std::size_t> voxels(runs.size(), 0);
  for (std::size_t r = 0; r < runs.size(); ++r)
    voxels[first_of(runs, r)] += static_cast<std::size_t>(runs[r].end - runs[r].begin);
  std::vector<std::vector<std::size_t>> sizes(256);
  for (std::size_t r = 0; r < runs.size(); ++r)
    if (voxels[r] > 0) sizes[runs[r].label].push_back(voxels[r]);
  return sizes;
}

std::vector<double> wall_thickness(const LabelVolume& labels, Region wall, Region cavity) {
  const Box box =
      bounding_box(labels, 1, [&](std::uint8_t label) { return label == tag(wall) || label == tag(cavity); });
  if (box.empty()) return {};
  Grid grid;
  grid.spacing_mm = labels.grid.spacing_mm;
  for (std::size_t a = 0; a < 3; ++a) grid.size[a] = box.end[a] - box.begin[a];
  const auto count = static_cast<std::size_t>(grid.voxel_count());
  std::vector<std::uint8_t> is_wall(count, 0), inside(count, 0), outside(count, 0);
  std::size_t v = 0;
  for (std::int64_t k = box.begin[2]; k < box.end[2]; ++k)
    for (std::int64_t j = box.begin[1]; j < box.end[1]; ++j)
      for (std::int64_t i = box.begin[0]; i < box.end[0]; ++i, ++v) {
        const std::uint8_t label = labels(i, j, k);
        is_wall[v] = label == tag(wall);
        inside[v] = label == tag(cavity) || label == tag(Region::papillary);
        outside[v] = !is_wall[v] && !inside[v];
      }
  const auto to_cavity = distance_to(grid, inside), to_outside = distance_to(grid, outside);
  const double voxel_mm = math::cbrt(grid.voxel_volume_mm3());
  // Centres of voxels lie inside their surfaces: by one voxel on both sides together where the wall runs along the
  // grid, by about 0.6 where it runs obliquely.
  const double inset_mm = 0.75 * voxel_mm;
  std::vector<double> thickness;
  constexpr double none = 1e17;  // one of the two sides does not exist
  for (v = 0; v < count; ++v)
    if (is_wall[v] && to_cavity[v] < none && to_outside[v] < none && std::abs(to_cavity[v] - to_outside[v]) <= voxel_mm)
      thickness.push_back(to_cavity[v] + to_outside[v] - inset_mm);
  return thickness;
}

void add_thickness(Report& report, const LabelVolume& labels, Region wall, Region cavity) {
  const auto thickness = wall_thickness(labels, wall, cavity);
  if (thickness.empty()) return;
  const std::string scope = region_name(tag(wall));
  for (const auto& [metric, q] :
       {std::pair{"wall_thickness_p05", 0.05}, {"wall_thickness_median", 0.5}, {"wall_thickness_p95", 0.95}})
    report.push_back({"labels", scope, metric, quantile(thickness, q), "mm", {}, {}});
}

}  // namespace

Report check_labels(const LabelVolume& labels, const std::vector<Region>& needed) {
  Report report;
  const auto sizes = component_sizes(labels);
  for (std::size_t region = 1; region < sizes.size(); ++region) {
    const bool is_needed = std::find(needed.begin(), needed.end(), static_cast<Region>(region)) != needed.end();
    if (sizes[region].empty() && !is_needed) continue;
    double total = 0, largest = 0;
    for (const auto size : sizes[region]) {
      total += static_cast<double>(size);
      largest = std::max(largest, static_cast<double>(size));
    }
    const std::string scope = region_name(static_cast<std::int32_t>(region));
    report.push_back({"labels", scope, "volume", total * labels.grid.voxel_volume_mm3() / mm3_per_ml, "ml", {}, {}});
    if (sizes[region].empty()) continue;
    report.push_back({"labels", scope, "components", static_cast<double>(sizes[region].size()), "count", {}, {}});
    report.push_back({"labels", scope, "largest_component", largest / total, "1", {}, {}});
  }
  add_thickness(report, labels, Region::lv_myocardium, Region::lv_blood);
  add_thickness(report, labels, Region::rv_myocardium, Region::rv_blood);
  add_thickness(report, labels, Region::la_wall, Region::la_blood);
  add_thickness(report, labels, Region::ra_wall, Region::ra_blood);
  return judged(std::move(report), {});
}

}  // namespace heartgen::validation
