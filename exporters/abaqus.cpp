// SPDX-License-Identifier: GPL-3.0-or-later
// Abaqus and CalculiX, NAME.inp to be included by a model: nodes, C3D4 elements in an element set per region (and ALL),
// per surface a node set N_SURFACE and a face surface SURFACE (both sides' numbering starts at 1), and, where there are
// fibres, the orientation FIBERS: a distribution of fibre and sheet per element, coordinate axes where there is no
// muscle. CalculiX takes 20 characters a number, so real numbers have 13 digits.
#include <algorithm>
#include <set>

#include "exporters/adjacency.hpp"
#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"

namespace heartgen::exporters {
namespace {

/// Number of the face that lies opposite corner 0, 1, 2, 3 of a C3D4.
constexpr int face_opposite[4] = {3, 4, 2, 1};

int face_number(const Cell& cell, const Face& face) {
  for (std::size_t k = 0; k < 4; ++k)
    if (std::find(face.begin(), face.end(), cell[k]) == face.end()) return face_opposite[k];
  return 1;
}

void write_nodes(OutFile& file, const TetMesh& mesh) {
  file.print(FMT_COMPILE("*NODE, NSET=NALL\n"));
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    const Vec3& p = mesh.nodes_mm[n];
    file.print(FMT_COMPILE("{}, {:.13g}, {:.13g}, {:.13g}\n"), n + 1, p.x, p.y, p.z);
  }
}

void write_elements(OutFile& file, const TetMesh& mesh) {
  const auto names = regions_of(mesh);
  for (const auto& [tag, cells] : cells_by_region(mesh)) {
    file.print(FMT_COMPILE("*ELEMENT, TYPE=C3D4, ELSET={}\n"), names.at(tag));
    for (const auto c : cells) {
      const Cell& n = mesh.cells[c];
      file.print(FMT_COMPILE("{}, {}, {}, {}, {}\n"), c + 1, n[0] + 1, n[1] + 1, n[2] + 1, n[3] + 1);
    }
  }
  file.print(FMT_COMPILE("*ELSET, ELSET=ALL\n"));
  for (const auto& [tag, name] : names) file.print(FMT_COMPILE("{}\n"), name);
  for (const auto& [name, cells] : cells_by_user_region(mesh)) {
    file.print(FMT_COMPILE("*ELSET, ELSET={}\n"), name);
    for (const auto c : cells) file.print(FMT_COMPILE("{}\n"), c + 1);
  }
}

void write_surface(OutFile& file, const TetMesh& mesh, const std::string& name, const std::vector<std::size_t>& faces,
                   const std::vector<FaceCells>& sides) {
  std::set<std::int32_t> nodes;
  for (const auto f : faces) nodes.insert(mesh.faces[f].begin(), mesh.faces[f].end());
  file.print(FMT_COMPILE("*NSET, NSET=N_{}\n"), name);
  for (const auto node : nodes) file.print(FMT_COMPILE("{}\n"), node + 1);
  file.print(FMT_COMPILE("*SURFACE, NAME={}, TYPE=ELEMENT\n"), name);
  for (const auto f : faces) {
    const auto cell = sides[f][0];
    if (cell >= 0)
      file.print(FMT_COMPILE("{}, S{}\n"), cell + 1,
                 face_number(mesh.cells[static_cast<std::size_t>(cell)], mesh.faces[f]));
  }
}

void write_orientation(OutFile& file, const TetMesh& mesh) {
  const FiberField axes = cell_axes(mesh, WithoutFibers::coordinate_axes);
  file.print(
      FMT_COMPILE("*DISTRIBUTION TABLE, NAME=AXES_TABLE\nCOORD3D, COORD3D\n"
                  "*DISTRIBUTION, NAME=AXES, LOCATION=ELEMENT, TABLE=AXES_TABLE\n, 1, 0, 0, 0, 1, 0\n"));
  for (std::size_t c = 0; c < axes.fiber.size(); ++c) {
    const Vec3 &f = axes.fiber[c], &s = axes.sheet[c];
    file.print(FMT_COMPILE("{}, {:.13g}, {:.13g}, {:.13g}, {:.13g}, {:.13g}, {:.13g}\n"), c + 1, f.x, f.y, f.z, s.x,
               s.y, s.z);
  }
  file.print(FMT_COMPILE("*ORIENTATION, NAME=FIBERS\nAXES\n"));
}

}  // namespace

Files export_abaqus(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  const auto sides = cells_of_faces(mesh);
  const auto names = surfaces_of(mesh);
  OutFile file(task.folder / (task.mesh_name + ".inp"));
  write_nodes(file, mesh);
  write_elements(file, mesh);
  for (const auto& [tag, faces] : faces_by_surface(mesh)) write_surface(file, mesh, names.at(tag), faces, sides);
  if (has_fibers(mesh)) write_orientation(file, mesh);
  return joined({file.close(), write_markers(task)}, write_user_regions(task));
}

}  // namespace heartgen::exporters
