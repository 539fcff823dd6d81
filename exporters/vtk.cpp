// SPDX-License-Identifier: GPL-3.0-or-later
// Legacy VTK of file version 3.0, by hand: VTK's own writer makes version 5.1, which few other readers know, and
// writes text with too few digits. Also its dialects for Cardioid / MFEM and cardiacFoam. And .vtu / .vtp.
#include <set>

#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"
#include "generator/adapters/vtk_io.hpp"

namespace heartgen::exporters {
namespace {

/// Numbers as text, a row a line, or as big-endian bytes.
class VtkFile {
 public:
  VtkFile(const std::filesystem::path& path, bool binary, const char* data_set) : out_(path), binary_(binary) {
    out_.print(FMT_COMPILE("# vtk DataFile Version 3.0\nheartgen\n{}\nDATASET {}\n"), binary ? "BINARY" : "ASCII",
               data_set);
  }

  template <class Format, class... Args>
  void line(const Format& format, const Args&... args) {
    out_.print(format, args...);
  }

  template <class T>
  void number(T value, char end = '\n') {
    if (binary_)
      out_.big_endian(value);
    else
      out_.print(FMT_COMPILE("{}{}"), value, end);
  }

  void vector(const Vec3& v) {
    number(v.x, ' ');
    number(v.y, ' ');
    number(v.z);
  }

  void end_block() { out_.print(FMT_COMPILE("\n")); }

  void points(const std::vector<Vec3>& points) {
    line(FMT_COMPILE("POINTS {} double\n"), points.size());
    for (const auto& point : points) vector(point);
    end_block();
  }

  template <std::size_t N>
  void cells(const char* keyword, const std::vector<std::array<std::int32_t, N>>& cells) {
    line(FMT_COMPILE("{} {} {}\n"), keyword, cells.size(), (N + 1) * cells.size());
    for (const auto& cell : cells) {
      number(static_cast<std::int32_t>(N), ' ');
      for (std::size_t i = 0; i < N; ++i) number(cell[i], i + 1 < N ? ' ' : '\n');
    }
    end_block();
  }

  void scalars(const char* name, const std::vector<std::int32_t>& values) {
    line(FMT_COMPILE("SCALARS {} int 1\nLOOKUP_TABLE default\n"), name);
    for (const auto value : values) number(value);
    end_block();
  }

  void scalars(const std::string& name, const std::vector<float>& values) {
    line(FMT_COMPILE("SCALARS {} float 1\nLOOKUP_TABLE default\n"), name);
    for (const auto value : values) number(value);
    end_block();
  }

  void vectors(const char* name, const std::vector<Vec3>& values) {
    if (values.empty()) return;
    line(FMT_COMPILE("VECTORS {} double\n"), name);
    for (const auto& value : values) vector(value);
    end_block();
  }

  void axes(const FiberField& fibers) {
    vectors("fiber", fibers.fiber);
    vectors("sheet", fibers.sheet);
    vectors("sheet_normal", fibers.sheet_normal);
  }

  std::filesystem::path close() { return out_.close(); }

 private:
  OutFile out_;
  bool binary_;
};

enum class PointArrays { none, fibers };

std::filesystem::path write_volume(const ExportTask& task, bool binary, const char* region_array, PointArrays points) {
  const TetMesh& mesh = task.mesh;
  VtkFile file(task.folder / (task.mesh_name + ".vtk"), binary, "UNSTRUCTURED_GRID");
  file.points(mesh.nodes_mm);
  file.cells("CELLS", mesh.cells);
  file.line(FMT_COMPILE("CELL_TYPES {}\n"), mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) file.number(std::int32_t{10});
  file.end_block();
  file.line(FMT_COMPILE("CELL_DATA {}\n"), mesh.cells.size());
  file.scalars(region_array, mesh.region);
  file.axes(mesh.cell_fibers);
  if (!mesh.user_region.empty()) file.scalars("user_region", mesh.user_region);
  for (const auto& region : mesh.user_regions) file.scalars(fraction_name(region), region.fraction);
  if (points == PointArrays::fibers && !mesh.node_fibers.fiber.empty()) {
    file.line(FMT_COMPILE("POINT_DATA {}\n"), mesh.nodes_mm.size());
    file.axes(mesh.node_fibers);
    if (!mesh.fiber_source.empty())
      file.scalars("fiber_source", std::vector<std::int32_t>(mesh.fiber_source.begin(), mesh.fiber_source.end()));
  }
  return file.close();
}

/// The faces on the points of the whole mesh: ids agree with the volume's file.
std::filesystem::path write_faces(const ExportTask& task, bool binary) {
  VtkFile file(task.folder / (task.mesh_name + "_surfaces.vtk"), binary, "POLYDATA");
  file.points(task.mesh.nodes_mm);
  file.cells("POLYGONS", task.mesh.faces);
  file.line(FMT_COMPILE("CELL_DATA {}\n"), task.mesh.faces.size());
  file.scalars("surface", task.mesh.surface);
  return file.close();
}

Files export_legacy(const ExportTask& task, bool binary) {
  return {write_volume(task, binary, "region", PointArrays::fibers), write_faces(task, binary), write_markers(task)};
}

}  // namespace

Files export_vtk_binary(const ExportTask& task) { return export_legacy(task, true); }
Files export_vtk_ascii(const ExportTask& task) { return export_legacy(task, false); }

Files export_cardioid(const ExportTask& task) {
  return {write_volume(task, false, "material", PointArrays::none), write_markers(task)};
}

Files export_cardiacfoam(const ExportTask& task) {
  return {write_volume(task, false, "tags", PointArrays::none), write_markers(task)};
}

Files export_vtu(const ExportTask& task) {
  const auto volume = task.folder / (task.mesh_name + ".vtu");
  const auto faces = task.folder / (task.mesh_name + ".vtp");
  adapters::write_vtu(volume, task.mesh);
  adapters::write_vtp(faces, task.mesh);
  Files files = {volume, faces, write_markers(task)};
  if (task.mesh.cavities.empty()) return files;
  files.push_back(task.folder / (task.mesh_name + "_cavities.vtp"));
  adapters::write_cavities(files.back(), task.mesh);
  return files;
}

}  // namespace heartgen::exporters
