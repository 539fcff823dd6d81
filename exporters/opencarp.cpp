// SPDX-License-Identifier: GPL-3.0-or-later
// openCARP: points, elements (tag = region), fibre and sheet per element (zero where there is no muscle), as text
// (.pts .elem .lon) or binary (.bpts .belem .blon); per surface the nodes (.vtx) and triangles (.surf), per rim the
// nodes, per cavity its closed surface (.surf), out of the blood. Ids are 0-based. Its reader keeps numbers as 32-bit
// floats: they are written as the shortest text that gives the same float. Binary files have a header of 1024
// characters: counts, byte order (0: little-endian), a check number; then 32-bit floats, and per element its kind (0:
// tetrahedron), nodes and tag as 32-bit integers. So meshtool writes them: writePointsBinary, writeElementsBinary and
// writeFibersBinary in its io_utils.cpp.
#include <bit>
#include <set>

#include "exporters/files.hpp"
#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"

namespace heartgen::exporters {
namespace {

constexpr std::size_t header_bytes = 1024;
constexpr int check_number = 666;
constexpr std::int32_t tetrahedron = 0;
static_assert(std::endian::native == std::endian::little, "the binary files say that they are little-endian");

std::array<float, 3> as_floats(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

void write_header(OutFile& file, std::string text) {
  text.resize(header_bytes, '\0');
  file.raw(std::span<const char>(text));
}

std::filesystem::path named(const ExportTask& task, const std::string& ending) {
  return task.folder / (task.mesh_name + ending);
}

template <class Ids>
std::filesystem::path write_vtx(const ExportTask& task, const std::string& name, const Ids& ids) {
  OutFile file(named(task, "_" + in_file_name(name) + ".vtx"));
  file.print(FMT_COMPILE("{}\nextra\n"), ids.size());
  for (const auto id : ids) file.print(FMT_COMPILE("{}\n"), id);
  return file.close();
}

std::filesystem::path write_surf(const ExportTask& task, const std::string& name, const std::vector<Face>& faces) {
  OutFile file(named(task, "_" + in_file_name(name) + ".surf"));
  file.print(FMT_COMPILE("{}\n"), faces.size());
  for (const Face& n : faces) file.print(FMT_COMPILE("Tr {} {} {}\n"), n[0], n[1], n[2]);
  return file.close();
}

Files write_surfaces(const ExportTask& task) {
  Files files;
  const auto names = surfaces_of(task.mesh);
  for (const auto& [tag, ids] : faces_by_surface(task.mesh)) {
    std::vector<Face> faces;
    for (const auto f : ids) faces.push_back(task.mesh.faces[f]);
    std::set<std::int32_t> nodes;
    for (const auto& face : faces) nodes.insert(face.begin(), face.end());
    files.push_back(write_vtx(task, names.at(tag), nodes));
    files.push_back(write_surf(task, names.at(tag), faces));
  }
  for (const auto& cavity : task.mesh.cavities) files.push_back(write_surf(task, cavity.name, cavity.faces));
  for (const auto& rim : task.mesh.rims) files.push_back(write_vtx(task, rim.name, rim.nodes));
  return files;
}

std::filesystem::path write_pts(const ExportTask& task) {
  OutFile file(named(task, ".pts"));
  file.print(FMT_COMPILE("{}\n"), task.mesh.nodes_mm.size());
  for (const auto& node : task.mesh.nodes_mm) {
    const auto p = as_floats(node);
    file.print(FMT_COMPILE("{} {} {}\n"), p[0], p[1], p[2]);
  }
  return file.close();
}

std::filesystem::path write_elem(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  OutFile file(named(task, ".elem"));
  file.print(FMT_COMPILE("{}\n"), mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const Cell& n = mesh.cells[c];
    file.print(FMT_COMPILE("Tt {} {} {} {} {}\n"), n[0], n[1], n[2], n[3], mesh.region[c]);
  }
  return file.close();
}

std::filesystem::path write_lon(const ExportTask& task) {
  const FiberField axes = cell_axes(task.mesh, WithoutFibers::zero);
  OutFile file(named(task, ".lon"));
  file.print(FMT_COMPILE("2\n"));
  for (std::size_t c = 0; c < axes.fiber.size(); ++c) {
    const auto f = as_floats(axes.fiber[c]), s = as_floats(axes.sheet[c]);
    file.print(FMT_COMPILE("{} {} {} {} {} {}\n"), f[0], f[1], f[2], s[0], s[1], s[2]);
  }
  return file.close();
}

std::filesystem::path write_bpts(const ExportTask& task) {
  OutFile file(named(task, ".bpts"));
  write_header(file, fmt::format("{} 0 {}", task.mesh.nodes_mm.size(), check_number));
  for (const auto& node : task.mesh.nodes_mm) file.raw(as_floats(node));
  return file.close();
}

std::filesystem::path write_belem(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  OutFile file(named(task, ".belem"));
  write_header(file, fmt::format("{} 0 {}", mesh.cells.size(), check_number));
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    file.raw(tetrahedron);
    file.raw(mesh.cells[c]);
    file.raw(mesh.region[c]);
  }
  return file.close();
}

std::filesystem::path write_blon(const ExportTask& task) {
  const FiberField axes = cell_axes(task.mesh, WithoutFibers::zero);
  OutFile file(named(task, ".blon"));
  write_header(file, fmt::format("2 {} 0 {}", axes.fiber.size(), check_number));
  for (std::size_t c = 0; c < axes.fiber.size(); ++c) {
    file.raw(as_floats(axes.fiber[c]));
    file.raw(as_floats(axes.sheet[c]));
  }
  return file.close();
}

/// Elements of each region of the user's own: the list that openCARP's tagreg[] of type 4 takes as elemfile.
Files write_regele(const ExportTask& task) {
  Files files;
  for (const auto& [name, cells] : cells_by_user_region(task.mesh)) {
    OutFile file(named(task, "_" + in_file_name(name) + ".regele"));
    file.print(FMT_COMPILE("{}\n"), cells.size());
    for (const auto c : cells) file.print(FMT_COMPILE("{}\n"), c);
    files.push_back(file.close());
  }
  return joined(std::move(files), write_user_regions(task));
}

Files with_surfaces(const ExportTask& task, Files files) {
  files.push_back(write_markers(task));
  for (auto& file : write_regele(task)) files.push_back(std::move(file));
  for (auto& file : write_surfaces(task)) files.push_back(std::move(file));
  return files;
}

}  // namespace

Files export_opencarp(const ExportTask& task) {
  return with_surfaces(task, {write_pts(task), write_elem(task), write_lon(task)});
}

Files export_opencarp_binary(const ExportTask& task) {
  return with_surfaces(task, {write_bpts(task), write_belem(task), write_blon(task)});
}

}  // namespace heartgen::exporters
