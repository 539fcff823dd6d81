// SPDX-License-Identifier: GPL-3.0-or-later
// MFEM mesh v1.0: elements with attribute = region, boundary triangles (outer ones and interfaces) with attribute =
// surface. Fibres as GridFunctions, NAME_fiber.gf, NAME_sheet.gf: one constant vector per element, in the mesh's order.
#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"

namespace heartgen::exporters {
namespace {

constexpr int triangle = 2, tetrahedron = 4;

std::filesystem::path write_mesh(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  OutFile file(task.folder / (task.mesh_name + ".mesh"));
  file.print(FMT_COMPILE("MFEM mesh v1.0\n\ndimension\n3\n\nelements\n{}\n"), mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const Cell& n = mesh.cells[c];
    file.print(FMT_COMPILE("{} {} {} {} {} {}\n"), mesh.region[c], tetrahedron, n[0], n[1], n[2], n[3]);
  }
  file.print(FMT_COMPILE("\nboundary\n{}\n"), mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& n = mesh.faces[f];
    file.print(FMT_COMPILE("{} {} {} {} {}\n"), mesh.surface[f], triangle, n[0], n[1], n[2]);
  }
  file.print(FMT_COMPILE("\nvertices\n{}\n3\n"), mesh.nodes_mm.size());
  for (const auto& p : mesh.nodes_mm) file.print(FMT_COMPILE("{} {} {}\n"), p.x, p.y, p.z);
  return file.close();
}

std::filesystem::path write_axes(const ExportTask& task, const char* name, const std::vector<Vec3>& axes) {
  OutFile file(task.folder / (task.mesh_name + "_" + name + ".gf"));
  file.print(FMT_COMPILE("FiniteElementSpace\nFiniteElementCollection: L2_3D_P0\nVDim: 3\nOrdering: 1\n\n"));
  for (const auto& v : axes) file.print(FMT_COMPILE("{} {} {}\n"), v.x, v.y, v.z);
  return file.close();
}

}  // namespace

Files export_mfem(const ExportTask& task) {
  return joined(with_axes({write_mesh(task), write_markers(task)}, task, write_axes), write_user_regions(task));
}

}  // namespace heartgen::exporters
