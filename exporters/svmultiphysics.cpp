// svMultiPhysics: NAME.vtu (the volume), NAME_fiber.vtu and NAME_sheet.vtu (cell array FIB_DIR, 3 × float64, per fibre
// family) and per surface NAME_SURFACE.vtp with the point array GlobalNodeID (int32, 1-based).
#include "exporters/formats.hpp"
#include "generator/adapters/vtk_io.hpp"

namespace heart::exporters {
namespace {

std::filesystem::path write_family(const ExportTask& task, const std::string& name, const std::vector<Vec3>& axes) {
  adapters::UnstructuredData data;
  data.points = task.mesh.nodes_mm;
  data.tets = task.mesh.cells;
  data.cell_vectors["FIB_DIR"] = axes;
  auto path = task.folder / (task.mesh_name + "_" + name + ".vtu");
  adapters::write_unstructured(path, data);
  return path;
}

}  // namespace

Files export_svmultiphysics(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  const auto volume = task.folder / (task.mesh_name + ".vtu");
  adapters::write_vtu(volume, mesh);
  Files files = {volume, write_markers(task)};
  if (has_fibers(mesh)) {
    files.push_back(write_family(task, "fiber", mesh.cell_fibers.fiber));
    files.push_back(write_family(task, "sheet", mesh.cell_fibers.sheet));
  }
  for (const auto& [tag, name] : surfaces_of(mesh)) {
    files.push_back(task.folder / (task.mesh_name + "_" + name + ".vtp"));
    adapters::write_vtp(files.back(), mesh, tag);
  }
  return files;
}

}  // namespace heart::exporters
