// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/region_checks.hpp"

#include <algorithm>

namespace heartgen::validation {
namespace {

/// Whether no cell lies in another region too.
bool is_alone(const TetMesh& mesh, const UserRegion& region) {
  for (const auto& other : mesh.user_regions)
    for (std::size_t c = 0; c < mesh.cells.size() && other.tag != region.tag; ++c)
      if (region.fraction[c] > 0 && other.fraction[c] > 0) return false;
  return true;
}

}  // namespace

Report check_user_regions(const std::map<std::string, TetMesh>& meshes) {
  constexpr double mm3_per_ml = 1000;
  Report report;
  for (const auto& [name, mesh] : meshes)
    for (const auto& region : mesh.user_regions) {
      double volume = 0, tagged = 0;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const bool counts = mesh.user_region[c] == region.tag;
        if (!counts && region.fraction[c] == 0) continue;
        const double of_cell = cell_volume_mm3(mesh, mesh.cells[c]);
        volume += static_cast<double>(region.fraction[c]) * of_cell;
        if (counts) tagged += of_cell;
      }
      const auto add = [&, scope = name + "/" + region.name](const char* metric, double value, const char* unit) {
        report.push_back({"regions", scope, metric, value, unit, {}, {}});
      };
      add("volume", volume / mm3_per_ml, "ml");
      add("cells", static_cast<double>(std::count(mesh.user_region.begin(), mesh.user_region.end(), region.tag)),
          "count");
      if (volume > 0 && is_alone(mesh, region)) add("tagged_difference", 100 * (tagged / volume - 1), "%");
    }
  return report;
}

}  // namespace heartgen::validation
