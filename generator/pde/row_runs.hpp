// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: which voxels of each row a solver visits. Rows outside a domain cost nothing, rows partly
/// inside it only their runs.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

/// Voxels [begin, end) of a row.
struct Run {
  std::int64_t begin = 0, end = 0;
};
using Runs = std::vector<Run>;

/// Gaps up to this length are visited too: starting a run costs about as much as this many voxels.
inline constexpr std::int64_t longest_gap = 16;

/// Puts overlapping or nearly touching runs together; they are given in any order.
inline void merge_runs(Runs& runs) {
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.begin < b.begin; });
  std::size_t last = 0;
  for (std::size_t next = 1; next < runs.size(); ++next) {
    if (runs[next].begin <= runs[last].end + longest_gap)
      runs[last].end = std::max(runs[last].end, runs[next].end);
    else
      runs[++last] = runs[next];
  }
  if (!runs.empty()) runs.resize(last + 1);
}

/// The runs of all rows of a slab, those of its ghost slices too.
struct RowRuns {
  std::int64_t first_row = 0;  ///< number of the first stored row, counted over the image: slice * rows_per_slice + j
  std::int64_t rows_per_slice = 0;
  std::vector<Runs> rows;

  Runs& at(std::int64_t j, std::int64_t k) {
    return rows[static_cast<std::size_t>(k * rows_per_slice + j - first_row)];
  }
  const Runs& at(std::int64_t j, std::int64_t k) const {
    return rows[static_cast<std::size_t>(k * rows_per_slice + j - first_row)];
  }
};

/// Runs that hold every voxel for which active(value) is true.
template <class T, class Active>
RowRuns row_runs(const parallel::Slab<T>& slab, Active&& active) {
  const auto nx = slab.grid.size[0], ny = slab.grid.size[1];
  RowRuns result{(slab.first - slab.ghosts) * ny, ny, {}};
  if (slab.count == 0) return result;
  result.rows.resize(static_cast<std::size_t>((slab.count + 2 * slab.ghosts) * ny));
  const auto rows = static_cast<std::int64_t>(result.rows.size());
  parallel::parallel_for(0, rows, [&](std::int64_t from, std::int64_t to) {
    for (auto row = from; row < to; ++row) {
      const T* values = slab.values.data() + row * nx;
      auto& runs = result.rows[static_cast<std::size_t>(row)];
      for (std::int64_t i = 0; i < nx; ++i) {
        if (!active(values[i])) continue;
        if (!runs.empty() && i <= runs.back().end + longest_gap)
          runs.back().end = i + 1;
        else
          runs.push_back({i, i + 1});
      }
    }
  });
  return result;
}

/// Voxels with a link to a visited voxel. A voxel's dual vector points to its upper neighbours: it matters where the
/// voxel or one of those is visited.
template <class T>
RowRuns link_runs(const RowRuns& visited, const parallel::Slab<T>& slab) {
  RowRuns links = visited;
  if (slab.count == 0) return links;
  const auto ny = slab.grid.size[1];
  const auto first = (slab.first - 1) * ny;
  parallel::parallel_for(first, slab.end() * ny, [&](std::int64_t from, std::int64_t to) {
    for (auto r = from; r < to; ++r) {
      const auto k = (r - first) / ny + slab.first - 1, j = (r - first) % ny;
      auto& row = links.at(j, k);
      for (auto& run : row) run.begin = std::max<std::int64_t>(run.begin - 1, 0);
      if (j + 1 < ny) row.insert(row.end(), visited.at(j + 1, k).begin(), visited.at(j + 1, k).end());
      row.insert(row.end(), visited.at(j, k + 1).begin(), visited.at(j, k + 1).end());
      merge_runs(row);
    }
  });
  return links;
}

}  // namespace heartgen::pde
