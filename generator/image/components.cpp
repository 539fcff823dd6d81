// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/components.hpp"

#include <algorithm>
#include <numeric>

namespace heartgen::image {
namespace {

/// A maximal stretch [begin, end) of equal voxels along i in one row.
struct Run {
  std::int64_t row = 0;
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

struct Runs {
  std::vector<Run> runs;
  std::vector<std::size_t> first_of_row;  // rows + 1 entries
  std::vector<std::size_t> parent;        // union-find; the root is the first run of the component
};

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t a) {
  while (parent[a] != a) {
    parent[a] = parent[parent[a]];
    a = parent[a];
  }
  return a;
}

void join(std::vector<std::size_t>& parent, std::size_t a, std::size_t b) {
  a = root_of(parent, a);
  b = root_of(parent, b);
  if (a == b) return;
  if (a < b)
    parent[b] = a;
  else
    parent[a] = b;
}

void join_rows(Runs& r, std::size_t row, std::size_t other) {
  std::size_t a = r.first_of_row[row];
  std::size_t b = r.first_of_row[other];
  while (a < r.first_of_row[row + 1] && b < r.first_of_row[other + 1]) {
    if (r.runs[a].begin < r.runs[b].end && r.runs[b].begin < r.runs[a].end) join(r.parent, a, b);
    if (r.runs[a].end < r.runs[b].end)
      ++a;
    else
      ++b;
  }
}

/// Runs of voxels whose mask is set (or unset), joined over faces; within slices only when `in_slices`.
Runs connected_runs(const Mask& mask, bool set, bool in_slices) {
  const auto [nx, ny, nz] = mask.grid.size;
  Runs r;
  r.first_of_row.reserve(static_cast<std::size_t>(ny * nz + 1));
  for (std::int64_t row = 0; row < ny * nz; ++row) {
    r.first_of_row.push_back(r.runs.size());
    const std::uint8_t* v = mask.voxels.data() + row * nx;
    for (std::int64_t i = 0; i < nx;) {
      while (i < nx && (v[i] != 0) != set) ++i;
      const std::int64_t begin = i;
      while (i < nx && (v[i] != 0) == set) ++i;
      if (i > begin) r.runs.push_back({row, begin, i});
    }
  }
  r.first_of_row.push_back(r.runs.size());
  r.parent.resize(r.runs.size());
  std::iota(r.parent.begin(), r.parent.end(), std::size_t{0});
  for (std::int64_t row = 0; row < ny * nz; ++row) {
    if (row % ny > 0) join_rows(r, static_cast<std::size_t>(row), static_cast<std::size_t>(row - 1));
    if (!in_slices && row >= ny) join_rows(r, static_cast<std::size_t>(row), static_cast<std::size_t>(row - ny));
  }
  for (std::size_t a = 0; a < r.runs.size(); ++a) r.parent[a] = root_of(r.parent, a);
  return r;
}

/// Voxels of the component of each root run; 0 for other runs.
std::vector<std::int64_t> component_sizes(const Runs& r) {
  std::vector<std::int64_t> size(r.runs.size(), 0);
  for (std::size_t a = 0; a < r.runs.size(); ++a) size[r.parent[a]] += r.runs[a].end - r.runs[a].begin;
  return size;
}

void write_run(Mask& mask, const Run& run) {
  std::uint8_t* row = mask.voxels.data() + run.row * mask.grid.size[0];
  std::fill(row + run.begin, row + run.end, std::uint8_t{1});
}

Mask only_root(const Mask& mask, const Runs& r, std::size_t root) {
  Mask result(mask.grid);
  for (std::size_t a = 0; a < r.runs.size(); ++a)
    if (r.parent[a] == root) write_run(result, r.runs[a]);
  return result;
}

Mask filled(const Mask& mask, bool in_slices) {
  const auto [nx, ny, nz] = mask.grid.size;
  const Runs r = connected_runs(mask, false, in_slices);
  std::vector<std::uint8_t> open(r.runs.size(), 0);
  for (std::size_t a = 0; a < r.runs.size(); ++a) {
    const Run& run = r.runs[a];
    const std::int64_t j = run.row % ny;
    const std::int64_t k = run.row / ny;
    const bool in_plane_border = run.begin == 0 || run.end == nx || j == 0 || j == ny - 1;
    if (in_plane_border || (!in_slices && (k == 0 || k == nz - 1))) open[r.parent[a]] = 1;
  }
  Mask result = mask;
  for (std::size_t a = 0; a < r.runs.size(); ++a)
    if (!open[r.parent[a]]) write_run(result, r.runs[a]);
  return result;
}

}  // namespace

Components connected_components(const Mask& mask) {
  const Runs r = connected_runs(mask, true, false);
  Components result{Volume<std::int32_t>(mask.grid), {0}};
  std::vector<std::int32_t> number(r.runs.size(), 0);
  for (std::size_t a = 0; a < r.runs.size(); ++a) {
    const Run& run = r.runs[a];
    std::int32_t& label = number[r.parent[a]];
    if (label == 0) {
      label = static_cast<std::int32_t>(result.voxel_count.size());
      result.voxel_count.push_back(0);
    }
    result.voxel_count[static_cast<std::size_t>(label)] += run.end - run.begin;
    std::int32_t* row = result.label.voxels.data() + run.row * mask.grid.size[0];
    std::fill(row + run.begin, row + run.end, label);
  }
  result.voxel_count[0] =
      mask.grid.voxel_count() - std::accumulate(result.voxel_count.begin(), result.voxel_count.end(), std::int64_t{0});
  return result;
}

Mask component_of(const Mask& mask, const Index3& seed, std::int64_t limit) {
  Mask empty(mask.grid);
  if (!mask.grid.contains(seed[0], seed[1], seed[2]) || !mask(seed[0], seed[1], seed[2])) return empty;
  const Runs r = connected_runs(mask, true, false);
  const auto row = static_cast<std::size_t>(seed[2] * mask.grid.size[1] + seed[1]);
  std::size_t a = r.first_of_row[row];
  while (r.runs[a].end <= seed[0]) ++a;
  const std::size_t root = r.parent[a];
  return component_sizes(r)[root] > limit ? empty : only_root(mask, r, root);
}

Mask largest_component(const Mask& mask) {
  const Runs r = connected_runs(mask, true, false);
  if (r.runs.empty()) return Mask(mask.grid);
  const auto size = component_sizes(r);
  return only_root(mask, r, static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin()));
}

Mask drop_small_components(const Mask& mask, std::int64_t minimum) {
  const Runs r = connected_runs(mask, true, false);
  const auto size = component_sizes(r);
  Mask result(mask.grid);
  for (std::size_t a = 0; a < r.runs.size(); ++a)
    if (size[r.parent[a]] >= minimum) write_run(result, r.runs[a]);
  return result;
}

Mask fill_holes(const Mask& mask) { return filled(mask, false); }
Mask fill_holes_in_slices(const Mask& mask) { return filled(mask, true); }

}  // namespace heartgen::image
