// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Small label maps with known volumes and contacts, and measures of meshes, for the tests of the mesher.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "model/labels.hpp"
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::testing {

/// A cube of voxels centred on the origin, labelled by `region_at` (LPS mm of the voxel's centre).
inline LabelVolume label_cube(std::int64_t voxels, double spacing_mm,
                              const std::function<Region(const Vec3&)>& region_at) {
  Grid grid;
  grid.size = {voxels, voxels, voxels};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  const double first = -0.5 * static_cast<double>(voxels - 1) * spacing_mm;
  grid.origin_mm = {first, first, first};
  LabelVolume labels(grid);
  for (std::int64_t k = 0; k < voxels; ++k)
    for (std::int64_t j = 0; j < voxels; ++j)
      for (std::int64_t i = 0; i < voxels; ++i)
        labels(i, j, k) = tag(
            region_at(lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})));
  return labels;
}

inline double region_volume_mm3(const TetMesh& mesh, Region region) {
  double volume = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(region)) volume += cell_volume_mm3(mesh, mesh.cells[c]);
  return volume;
}

inline double region_volume_mm3(const LabelVolume& labels, Region region) {
  return static_cast<double>(std::count(labels.voxels.begin(), labels.voxels.end(), tag(region))) *
         labels.grid.voxel_volume_mm3();
}

/// Faces per surface name.
inline std::map<std::string, int> surface_counts(const TetMesh& mesh) {
  std::map<std::string, int> counts;
  for (const auto surface : mesh.surface) ++counts[surface_name(surface)];
  return counts;
}

/// The value of a row; NaN where the report has none.
inline double row_value(const Report& report, const std::string& scope, const std::string& metric) {
  for (const auto& row : report)
    if (row.scope == scope && row.metric == metric) return row.value;
  return std::nan("");
}

inline std::string failed_rows(const Report& report) {
  std::string text;
  for (const auto& row : report)
    if (!row.passed()) text += row.scope + " " + row.metric + " " + std::to_string(row.value) + "\n";
  return text;
}

}  // namespace heartgen::testing
