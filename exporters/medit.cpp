// SPDX-License-Identifier: GPL-3.0-or-later
// Medit .mesh (version 2, text) for FreeFEM, mmg and TetGen: tetrahedra with reference = region, triangles (outer ones
// and interfaces) with reference = surface; ids 1-based. Fibres: NAME_fiber.txt, NAME_sheet.txt, the number of
// tetrahedra and a vector for each, in the mesh's order.
#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"

namespace heartgen::exporters {
namespace {

std::filesystem::path write_mesh(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  OutFile file(task.folder / (task.mesh_name + ".mesh"));
  file.print(FMT_COMPILE("MeshVersionFormatted 2\nDimension 3\nVertices\n{}\n"), mesh.nodes_mm.size());
  for (const auto& p : mesh.nodes_mm) file.print(FMT_COMPILE("{} {} {} 0\n"), p.x, p.y, p.z);
  file.print(FMT_COMPILE("Tetrahedra\n{}\n"), mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const Cell& n = mesh.cells[c];
    file.print(FMT_COMPILE("{} {} {} {} {}\n"), n[0] + 1, n[1] + 1, n[2] + 1, n[3] + 1, mesh.region[c]);
  }
  file.print(FMT_COMPILE("Triangles\n{}\n"), mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& n = mesh.faces[f];
    file.print(FMT_COMPILE("{} {} {} {}\n"), n[0] + 1, n[1] + 1, n[2] + 1, mesh.surface[f]);
  }
  file.print(FMT_COMPILE("End\n"));
  return file.close();
}

std::filesystem::path write_axes(const ExportTask& task, const char* name, const std::vector<Vec3>& axes) {
  OutFile file(task.folder / (task.mesh_name + "_" + name + ".txt"));
  file.print(FMT_COMPILE("{}\n"), axes.size());
  for (const auto& v : axes) file.print(FMT_COMPILE("{} {} {}\n"), v.x, v.y, v.z);
  return file.close();
}

}  // namespace

Files export_medit(const ExportTask& task) {
  return joined(with_axes({write_mesh(task), write_markers(task)}, task, write_axes), write_user_regions(task));
}

}  // namespace heartgen::exporters
