// SPDX-License-Identifier: GPL-3.0-or-later
// FEBio .feb 4.0 with the mesh alone, NAME.feb, to be included by a model: nodes, tet4 elements in a part per region,
// surfaces and node sets by name, and in MeshData the material axes per element (a: fibre, d: sheet) of every part with
// fibres. Ids are 1-based. So FEBio reads them: FEBioMeshSection4.cpp and FEBioMeshDataSection4.cpp in its FEBioXML/.
#include <set>

#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"

namespace heartgen::exporters {
namespace {

using Groups = std::map<std::int32_t, std::vector<std::size_t>>;

void write_nodes(OutFile& file, const TetMesh& mesh) {
  file.print(FMT_COMPILE("    <Nodes name=\"all_nodes\">\n"));
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    const Vec3& p = mesh.nodes_mm[n];
    file.print(FMT_COMPILE("      <node id=\"{}\">{},{},{}</node>\n"), n + 1, p.x, p.y, p.z);
  }
  file.print(FMT_COMPILE("    </Nodes>\n"));
}

void write_elements(OutFile& file, const TetMesh& mesh, const Groups& parts) {
  const auto names = regions_of(mesh);
  for (const auto& [tag, cells] : parts) {
    file.print(FMT_COMPILE("    <Elements type=\"tet4\" name=\"{}\">\n"), names.at(tag));
    for (const auto c : cells) {
      const Cell& n = mesh.cells[c];
      file.print(FMT_COMPILE("      <elem id=\"{}\">{},{},{},{}</elem>\n"), c + 1, n[0] + 1, n[1] + 1, n[2] + 1,
                 n[3] + 1);
    }
    file.print(FMT_COMPILE("    </Elements>\n"));
  }
}

void write_surface(OutFile& file, const TetMesh& mesh, const std::string& name, const std::vector<std::size_t>& faces) {
  std::set<std::int32_t> nodes;
  std::size_t id = 0;
  file.print(FMT_COMPILE("    <Surface name=\"{}\">\n"), name);
  for (const auto f : faces) {
    const Face& n = mesh.faces[f];
    nodes.insert(n.begin(), n.end());
    file.print(FMT_COMPILE("      <tri3 id=\"{}\">{},{},{}</tri3>\n"), ++id, n[0] + 1, n[1] + 1, n[2] + 1);
  }
  file.print(FMT_COMPILE("    </Surface>\n    <NodeSet name=\"{}\">"), name);
  std::string_view comma;
  for (const auto node : nodes) {
    file.print(FMT_COMPILE("{}{}"), comma, node + 1);
    comma = ",";
  }
  file.print(FMT_COMPILE("</NodeSet>\n"));
}

void write_element_sets(OutFile& file, const TetMesh& mesh) {
  for (const auto& [name, cells] : cells_by_user_region(mesh)) {
    file.print(FMT_COMPILE("    <ElementSet name=\"{}\">"), name);
    std::string_view comma;
    for (const auto c : cells) {
      file.print(FMT_COMPILE("{}{}"), comma, c + 1);
      comma = ",";
    }
    file.print(FMT_COMPILE("</ElementSet>\n"));
  }
}

void write_axes(OutFile& file, const FiberField& axes, const std::string& part, const std::vector<std::size_t>& cells) {
  if (axes.fiber[cells.front()] == Vec3{}) return;
  file.print(FMT_COMPILE("    <ElementData type=\"mat_axis\" elem_set=\"{}\">\n"), part);
  std::size_t id = 0;
  for (const auto c : cells) {
    const Vec3 &f = axes.fiber[c], &s = axes.sheet[c];
    file.print(FMT_COMPILE("      <e lid=\"{}\"><a>{},{},{}</a><d>{},{},{}</d></e>\n"), ++id, f.x, f.y, f.z, s.x, s.y,
               s.z);
  }
  file.print(FMT_COMPILE("    </ElementData>\n"));
}

}  // namespace

Files export_febio(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  const Groups parts = cells_by_region(mesh);
  const auto surfaces = surfaces_of(mesh), regions = regions_of(mesh);
  OutFile file(task.folder / (task.mesh_name + ".feb"));
  file.print(FMT_COMPILE("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<febio_spec version=\"4.0\">\n  <Mesh>\n"));
  write_nodes(file, mesh);
  write_elements(file, mesh, parts);
  for (const auto& [tag, faces] : faces_by_surface(mesh)) write_surface(file, mesh, surfaces.at(tag), faces);
  write_element_sets(file, mesh);
  file.print(FMT_COMPILE("  </Mesh>\n"));
  if (has_fibers(mesh)) {
    file.print(FMT_COMPILE("  <MeshData>\n"));
    for (const auto& [tag, cells] : parts) write_axes(file, mesh.cell_fibers, regions.at(tag), cells);
    file.print(FMT_COMPILE("  </MeshData>\n"));
  }
  file.print(FMT_COMPILE("</febio_spec>\n"));
  return joined({file.close(), write_markers(task)}, write_user_regions(task));
}

}  // namespace heartgen::exporters
