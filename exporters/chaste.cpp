// SPDX-License-Identifier: GPL-3.0-or-later
// Chaste: NAME.node, .ele (attribute = region), .face (the outer boundary only: Chaste takes every face for boundary;
// attribute = surface), and .ortho: fibre, sheet and sheet normal per element. Ids are 0-based. Chaste wants
// orthonormal axes everywhere, so elements without fibres get the coordinate axes.
#include "exporters/adjacency.hpp"
#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"

namespace heartgen::exporters {
namespace {

std::filesystem::path write_faces(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  const auto sides = cells_of_faces(mesh);
  std::vector<std::size_t> outer;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (sides[f][1] < 0) outer.push_back(f);
  OutFile file(task.folder / (task.mesh_name + ".face"));
  file.print(FMT_COMPILE("{} 1\n"), outer.size());
  std::size_t id = 0;
  for (const auto f : outer) {
    const Face& n = mesh.faces[f];
    file.print(FMT_COMPILE("{} {} {} {} {}\n"), id++, n[0], n[1], n[2], mesh.surface[f]);
  }
  return file.close();
}

std::filesystem::path write_ortho(const ExportTask& task) {
  const FiberField axes = cell_axes(task.mesh, WithoutFibers::coordinate_axes);
  OutFile file(task.folder / (task.mesh_name + ".ortho"));
  file.print(FMT_COMPILE("{}\n"), axes.fiber.size());
  for (std::size_t c = 0; c < axes.fiber.size(); ++c) {
    const Vec3 &f = axes.fiber[c], &s = axes.sheet[c], &n = axes.sheet_normal[c];
    file.print(FMT_COMPILE("{} {} {} {} {} {} {} {} {}\n"), f.x, f.y, f.z, s.x, s.y, s.z, n.x, n.y, n.z);
  }
  return file.close();
}

}  // namespace

Files export_chaste(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  OutFile nodes(task.folder / (task.mesh_name + ".node"));
  nodes.print(FMT_COMPILE("{} 3 0 0\n"), mesh.nodes_mm.size());
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    const Vec3& p = mesh.nodes_mm[n];
    nodes.print(FMT_COMPILE("{} {} {} {}\n"), n, p.x, p.y, p.z);
  }
  OutFile elements(task.folder / (task.mesh_name + ".ele"));
  elements.print(FMT_COMPILE("{} 4 1\n"), mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const Cell& n = mesh.cells[c];
    elements.print(FMT_COMPILE("{} {} {} {} {} {}\n"), c, n[0], n[1], n[2], n[3], mesh.region[c]);
  }
  Files files = {nodes.close(), elements.close(), write_faces(task), write_markers(task)};
  if (has_fibers(mesh)) files.push_back(write_ortho(task));
  return joined(std::move(files), write_user_regions(task));
}

}  // namespace heartgen::exporters
