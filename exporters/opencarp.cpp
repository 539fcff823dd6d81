// openCARP: NAME.pts, .elem (tag = region), .lon (fibre and sheet per element; zero where there is no muscle, which
// openCARP takes as bath), and per surface and rim a list of nodes NAME_SURFACE.vtx. Ids are 0-based.
#include <set>

#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"

namespace heart::exporters {
namespace {

template <class Ids>
std::filesystem::path write_vtx(const ExportTask& task, const std::string& name, const Ids& ids) {
  OutFile file(task.folder / (task.mesh_name + "_" + name + ".vtx"));
  file.print(FMT_COMPILE("{}\nextra\n"), ids.size());
  for (const auto id : ids) file.print(FMT_COMPILE("{}\n"), id);
  return file.close();
}

std::filesystem::path write_lon(const ExportTask& task) {
  OutFile file(task.folder / (task.mesh_name + ".lon"));
  const FiberField axes = cell_axes(task.mesh);
  file.print(FMT_COMPILE("2\n"));
  for (std::size_t c = 0; c < axes.fiber.size(); ++c) {
    const Vec3 &f = axes.fiber[c], &s = axes.sheet[c];
    file.print(FMT_COMPILE("{} {} {} {} {} {}\n"), f.x, f.y, f.z, s.x, s.y, s.z);
  }
  return file.close();
}

}  // namespace

Files export_opencarp(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  OutFile points(task.folder / (task.mesh_name + ".pts"));
  points.print(FMT_COMPILE("{}\n"), mesh.nodes_mm.size());
  for (const auto& p : mesh.nodes_mm) points.print(FMT_COMPILE("{} {} {}\n"), p.x, p.y, p.z);
  OutFile elements(task.folder / (task.mesh_name + ".elem"));
  elements.print(FMT_COMPILE("{}\n"), mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const Cell& n = mesh.cells[c];
    elements.print(FMT_COMPILE("Tt {} {} {} {} {}\n"), n[0], n[1], n[2], n[3], mesh.region[c]);
  }
  Files files = {points.close(), elements.close(), write_lon(task), write_markers(task)};
  std::map<std::int32_t, std::set<std::int32_t>> nodes_of;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    nodes_of[mesh.surface[f]].insert(mesh.faces[f].begin(), mesh.faces[f].end());
  for (const auto& [tag, name] : surfaces_of(mesh)) files.push_back(write_vtx(task, name, nodes_of.at(tag)));
  for (const auto& rim : mesh.rims) files.push_back(write_vtx(task, rim.name, rim.nodes));
  return files;
}

}  // namespace heart::exporters
