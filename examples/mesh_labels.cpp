// SPDX-License-Identifier: GPL-3.0-or-later
// A label map of a sphere in a box, meshed, checked and written for two programs.
#include <heartgen/checks.hpp>
#include <heartgen/export.hpp>
#include <heartgen/mesh_labels.hpp>
#include <numbers>

#include "images.hpp"

int main() {
  using namespace heartgen;
  LabelVolume labels(grid_of(40, 40));
  for (std::int64_t k = 0; k < 40; ++k)
    for (std::int64_t j = 0; j < 40; ++j)
      for (std::int64_t i = 0; i < 40; ++i)
        labels(i, j, k) = tag(radius_at(labels.grid, i, j, k) < 12 ? Region::lv_blood : Region::torso);
  MeshSettings settings;
  settings.blood_edge_mm = 3;
  settings.torso_edge_mm = 6;
  const TetMesh mesh = mesh_labels(labels, settings);
  double volume = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(Region::lv_blood)) volume += cell_volume_mm3(mesh, mesh.cells[c]);
  const Report report = check_mesh("sphere", mesh, bounds_of(Recipe{}));
  std::printf("%zu nodes, %zu cells, %lld rows of the check failed\n", mesh.nodes_mm.size(), mesh.cells.size(),
              static_cast<long long>(count_of(report, Verdict::failed)));
  for (const char* format : {"vtu", "msh"}) export_mesh(format, mesh, "sphere", "sphere");
  return expect_near("ball, mm3", volume, 4 * std::numbers::pi / 3 * 12 * 12 * 12, 0.02) + !all_passed(report);
}
