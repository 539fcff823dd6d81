// SPDX-License-Identifier: GPL-3.0-or-later
// gmsh .msh 4.1 (text, binary) and 2.2 (text). One discrete entity and one physical group per region and per surface,
// both with the tag of the bundle, so that gmsh keeps the names when it writes the mesh again. Node ids are those of
// the bundle plus one, and nodes stand in that order: 4.1 wants them grouped by entity, so a run of neighbouring ids on
// one entity makes a block (meshio pairs coordinates and $NodeData by position in the file, gmsh by id; both are right
// only when the two orders agree). Fibres are views ($NodeData, $ElementData); a triangle shows those of the cell
// beside it. In 2.2 those of the cells have a file of their own. Tetrahedra come before triangles, in 2.2 in the order
// of the bundle, in 4.1 grouped by region.
#include <algorithm>
#include <limits>
#include <set>

#include "exporters/adjacency.hpp"
#include "exporters/cut.hpp"
#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"

namespace heartgen::exporters {
namespace {

struct Entity {
  int dimension = 0;
  std::int32_t tag = 0;
  std::string name;
  std::vector<std::size_t> elements;  ///< ids of cells or faces
  std::set<std::int32_t> boundary;    ///< tags of the surfaces around a volume
};

constexpr std::size_t unclassified = std::numeric_limits<std::size_t>::max();

/// Surfaces first, then volumes, each by tag.
struct MshModel {
  std::vector<Entity> entities;
  std::vector<std::size_t> entity_of_node;  ///< the surface, or else the volume, that the node is classified on
  std::vector<FaceCells> face_cells;
};

template <std::size_t N>
void add_entities(MshModel& model, int dimension, const std::map<std::int32_t, std::string>& names,
                  const std::vector<std::int32_t>& tags, const std::vector<std::array<std::int32_t, N>>& elements) {
  std::map<std::int32_t, std::size_t> position;
  for (const auto& [tag, name] : names) {
    position[tag] = model.entities.size();
    model.entities.push_back({dimension, tag, name, {}, {}});
  }
  for (std::size_t e = 0; e < elements.size(); ++e) model.entities[position.at(tags[e])].elements.push_back(e);
  // A node belongs to the first entity that touches it: surfaces before volumes, so that mesh optimisers hold it.
  for (const auto& [tag, at] : position)
    for (const auto e : model.entities[at].elements)
      for (const auto node : elements[e]) {
        auto& entity = model.entity_of_node[static_cast<std::size_t>(node)];
        entity = std::min(entity, at);
      }
}

MshModel msh_model(const TetMesh& mesh) {
  MshModel model;
  model.face_cells = cells_of_faces(mesh);
  model.entity_of_node.assign(mesh.nodes_mm.size(), unclassified);
  add_entities(model, 2, surfaces_of(mesh), mesh.surface, mesh.faces);
  add_entities(model, 3, regions_of(mesh), mesh.region, mesh.cells);
  for (auto& entity : model.entity_of_node) entity = std::min(entity, model.entities.size() - 1);  // nodes of no cell
  for (auto& entity : model.entities) {
    if (entity.dimension != 3) continue;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
      for (const auto cell : model.face_cells[f])
        if (cell >= 0 && mesh.region[static_cast<std::size_t>(cell)] == entity.tag)
          entity.boundary.insert(mesh.surface[f]);
  }
  return model;
}

/// Values as text separated by blanks, or as they lie in memory.
class MshFile {
 public:
  MshFile(const std::filesystem::path& path, bool binary) : out(path), binary_(binary) {}
  template <class T>
  void value(T v) {
    if (binary_)
      out.raw(v);
    else
      out.print(FMT_COMPILE("{} "), v);
  }
  void count(std::size_t v) { value(v); }
  void vector(const Vec3& v) {
    value(v.x);
    value(v.y);
    value(v.z);
  }
  void end_row() {
    if (!binary_) out.print(FMT_COMPILE("\n"));
  }
  void section(const char* name) { out.print(FMT_COMPILE("${}\n"), name); }
  void end_section(const char* name) { out.print(FMT_COMPILE("{}$End{}\n"), binary_ ? "\n" : "", name); }
  bool binary() const { return binary_; }

  OutFile out;

 private:
  bool binary_;
};

void write_format(MshFile& file, const char* version) {
  file.section("MeshFormat");
  file.out.print(FMT_COMPILE("{} {} 8\n"), version, file.binary() ? 1 : 0);
  if (file.binary()) {
    file.value(1);  // tells the reader the byte order
    file.out.print(FMT_COMPILE("\n"));
  }
  file.out.print(FMT_COMPILE("$EndMeshFormat\n"));
}

void write_physical_names(MshFile& file, const MshModel& model) {
  file.section("PhysicalNames");
  file.out.print(FMT_COMPILE("{}\n"), model.entities.size());
  for (const auto& entity : model.entities)
    file.out.print(FMT_COMPILE("{} {} \"{}\"\n"), entity.dimension, entity.tag, entity.name);
  file.out.print(FMT_COMPILE("$EndPhysicalNames\n"));
}

std::pair<Vec3, Vec3> bounding_box(const TetMesh& mesh, const Entity& entity) {
  const double far = 1e300;
  std::pair<Vec3, Vec3> box{{far, far, far}, {-far, -far, -far}};
  const auto include = [&](const auto& nodes) {
    for (const auto node : nodes)
      for (int axis = 0; axis < 3; ++axis) {
        const double x = mesh.nodes_mm[static_cast<std::size_t>(node)][axis];
        box.first[axis] = std::min(box.first[axis], x);
        box.second[axis] = std::max(box.second[axis], x);
      }
  };
  for (const auto e : entity.elements)
    if (entity.dimension == 3)
      include(mesh.cells[e]);
    else
      include(mesh.faces[e]);
  return box;
}

void write_entities(MshFile& file, const TetMesh& mesh, const MshModel& model) {
  const auto of_dimension = [&](int d) {
    return std::count_if(model.entities.begin(), model.entities.end(), [d](const auto& e) { return e.dimension == d; });
  };
  file.section("Entities");
  for (int d = 0; d <= 3; ++d) file.count(static_cast<std::size_t>(of_dimension(d)));
  file.end_row();
  for (const auto& entity : model.entities) {
    const auto [low, high] = bounding_box(mesh, entity);
    file.value(entity.tag);
    file.vector(low);
    file.vector(high);
    file.count(1);
    file.value(entity.tag);
    file.count(entity.boundary.size());
    for (const auto tag : entity.boundary) file.value(tag);
    file.end_row();
  }
  file.end_section("Entities");
}

/// Half-open ranges of nodes on one entity.
std::vector<std::pair<std::size_t, std::size_t>> node_runs(const MshModel& model) {
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  for (std::size_t n = 0; n < model.entity_of_node.size(); ++n) {
    if (runs.empty() || model.entity_of_node[n] != model.entity_of_node[runs.back().first]) runs.emplace_back(n, n);
    runs.back().second = n + 1;
  }
  return runs;
}

void write_nodes(MshFile& file, const TetMesh& mesh, const MshModel& model) {
  const auto runs = node_runs(model);
  const std::size_t total = mesh.nodes_mm.size();
  file.section("Nodes");
  for (const auto n : {runs.size(), total, std::size_t{1}, total}) file.count(n);
  file.end_row();
  for (const auto& [begin, end] : runs) {
    const Entity& entity = model.entities.at(model.entity_of_node[begin]);
    for (const int v : {entity.dimension, entity.tag, 0}) file.value(v);
    file.count(end - begin);
    file.end_row();
    for (std::size_t n = begin; n < end; ++n) {
      file.count(n + 1);
      file.end_row();
    }
    for (std::size_t n = begin; n < end; ++n) {
      file.vector(mesh.nodes_mm[n]);
      file.end_row();
    }
  }
  file.end_section("Nodes");
}

constexpr int msh_triangle = 2, msh_tetrahedron = 4;

/// Volumes first: element ids count them before the triangles.
template <class Visit>
void for_each_block(const MshModel& model, const Visit& visit) {
  for (const int dimension : {3, 2})
    for (const auto& entity : model.entities)
      if (entity.dimension == dimension) visit(entity);
}

void write_elements(MshFile& file, const TetMesh& mesh, const MshModel& model) {
  const std::size_t total = mesh.cells.size() + mesh.faces.size();
  file.section("Elements");
  for (const auto n : {model.entities.size(), total, std::size_t{1}, total}) file.count(n);
  file.end_row();
  std::size_t id = 0;
  const auto write = [&](const auto& nodes) {
    file.count(++id);
    for (const auto node : nodes) file.count(static_cast<std::size_t>(node) + 1);
    file.end_row();
  };
  for_each_block(model, [&](const Entity& entity) {
    for (const int v : {entity.dimension, entity.tag, entity.dimension == 3 ? msh_tetrahedron : msh_triangle})
      file.value(v);
    file.count(entity.elements.size());
    file.end_row();
    for (const auto e : entity.elements)
      if (entity.dimension == 3)
        write(mesh.cells[e]);
      else
        write(mesh.faces[e]);
  });
  file.end_section("Elements");
}

/// Opens a view; rows "id values" follow.
void begin_view(MshFile& file, const char* section, const char* name, int components, std::size_t rows) {
  file.section(section);
  file.out.print(FMT_COMPILE("1\n\"{}\"\n1\n0\n3\n0\n{}\n{}\n"), name, components, rows);
}

void write_node_view(MshFile& file, const char* name, const std::vector<Vec3>& values) {
  if (values.empty()) return;
  begin_view(file, "NodeData", name, 3, values.size());
  for (std::size_t n = 0; n < values.size(); ++n) {
    file.value(static_cast<int>(n + 1));
    file.vector(values[n]);
    file.end_row();
  }
  file.end_section("NodeData");
}

void write_source_view(MshFile& file, const std::vector<std::uint8_t>& sources) {
  if (sources.empty()) return;
  begin_view(file, "NodeData", "fiber_source", 1, sources.size());
  for (std::size_t n = 0; n < sources.size(); ++n) {
    file.value(static_cast<int>(n + 1));
    file.value(static_cast<double>(sources[n]));
    file.end_row();
  }
  file.end_section("NodeData");
}

/// Cells and faces in the order in which their elements were written.
struct ElementOrder {
  std::vector<std::size_t> cells, faces;
};

void write_element_view(MshFile& file, const char* name, const std::vector<Vec3>& values, const ElementOrder& order,
                        const std::vector<FaceCells>& face_cells) {
  if (values.empty()) return;
  begin_view(file, "ElementData", name, 3, order.cells.size() + order.faces.size());
  int id = 0;
  const auto row = [&](const Vec3& value) {
    file.value(++id);
    file.vector(value);
    file.end_row();
  };
  for (const auto c : order.cells) row(values[c]);
  for (const auto f : order.faces) {
    Vec3 value;
    for (const auto cell : face_cells[f])
      if (cell >= 0 && value == Vec3{}) value = values[static_cast<std::size_t>(cell)];
    row(value);
  }
  file.end_section("ElementData");
}

/// Numbers of cells; a triangle shows that of the first cell beside it.
template <class T>
void write_element_view(MshFile& file, const std::string& name, const std::vector<T>& values, const ElementOrder& order,
                        const std::vector<FaceCells>& face_cells) {
  if (values.empty()) return;
  begin_view(file, "ElementData", name.c_str(), 1, order.cells.size() + order.faces.size());
  int id = 0;
  const auto row = [&](double value) {
    file.value(++id);
    file.value(value);
    file.end_row();
  };
  for (const auto c : order.cells) row(static_cast<double>(values[c]));
  for (const auto f : order.faces)
    row(face_cells[f][0] < 0 ? 0.0 : static_cast<double>(values[static_cast<std::size_t>(face_cells[f][0])]));
  file.end_section("ElementData");
}

void write_node_views(MshFile& file, const TetMesh& mesh) {
  write_node_view(file, "fiber", mesh.node_fibers.fiber);
  write_node_view(file, "sheet", mesh.node_fibers.sheet);
  write_node_view(file, "sheet_normal", mesh.node_fibers.sheet_normal);
  write_source_view(file, mesh.fiber_source);
}

void write_element_views(MshFile& file, const TetMesh& mesh, const MshModel& model, const ElementOrder& order) {
  write_element_view(file, "fiber", mesh.cell_fibers.fiber, order, model.face_cells);
  write_element_view(file, "sheet", mesh.cell_fibers.sheet, order, model.face_cells);
  write_element_view(file, "sheet_normal", mesh.cell_fibers.sheet_normal, order, model.face_cells);
  write_element_view(file, "user_region", mesh.user_region, order, model.face_cells);
  for (const auto& region : mesh.user_regions)
    write_element_view(file, fraction_name(region), region.fraction, order, model.face_cells);
}

Files export_msh41(const ExportTask& task, bool binary) {
  const MshModel model = msh_model(task.mesh);
  MshFile file(task.folder / (task.mesh_name + ".msh"), binary);
  write_format(file, "4.1");
  write_physical_names(file, model);
  write_entities(file, task.mesh, model);
  write_nodes(file, task.mesh, model);
  write_elements(file, task.mesh, model);
  ElementOrder order;
  for_each_block(model, [&](const Entity& entity) {
    auto& target = entity.dimension == 3 ? order.cells : order.faces;
    target.insert(target.end(), entity.elements.begin(), entity.elements.end());
  });
  write_node_views(file, task.mesh);
  write_element_views(file, task.mesh, model, order);
  return {file.out.close()};
}

void write_elements22(MshFile& file, const TetMesh& mesh) {
  file.section("Elements");
  file.out.print(FMT_COMPILE("{}\n"), mesh.cells.size() + mesh.faces.size());
  std::size_t id = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto& n = mesh.cells[c];
    file.out.print(FMT_COMPILE("{} 4 2 {} {} {} {} {} {}\n"), ++id, mesh.region[c], mesh.region[c], n[0] + 1, n[1] + 1,
                   n[2] + 1, n[3] + 1);
  }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& n = mesh.faces[f];
    file.out.print(FMT_COMPILE("{} 2 2 {} {} {} {} {}\n"), ++id, mesh.surface[f], mesh.surface[f], n[0] + 1, n[1] + 1,
                   n[2] + 1);
  }
  file.end_section("Elements");
}

std::filesystem::path write_mesh22(const ExportTask& task, const MshModel& model) {
  const TetMesh& mesh = task.mesh;
  MshFile file(task.folder / (task.mesh_name + ".msh"), false);
  write_format(file, "2.2");
  write_physical_names(file, model);
  file.section("Nodes");
  file.out.print(FMT_COMPILE("{}\n"), mesh.nodes_mm.size());
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    const Vec3& p = mesh.nodes_mm[n];
    file.out.print(FMT_COMPILE("{} {} {} {}\n"), n + 1, p.x, p.y, p.z);
  }
  file.end_section("Nodes");
  write_elements22(file, mesh);
  write_node_views(file, mesh);
  return file.out.close();
}

/// A file of its own, to be merged: meshio 5 cannot read a 2.2 file with $ElementData.
std::filesystem::path write_cell_views22(const ExportTask& task, const MshModel& model) {
  MshFile file(task.folder / (task.mesh_name + "_cells.msh"), false);
  write_format(file, "2.2");
  ElementOrder order;
  for (std::size_t c = 0; c < task.mesh.cells.size(); ++c) order.cells.push_back(c);
  for (std::size_t f = 0; f < task.mesh.faces.size(); ++f) order.faces.push_back(f);
  write_element_views(file, task.mesh, model, order);
  return file.out.close();
}

}  // namespace

Files export_msh41_binary(const ExportTask& task) { return export_msh41(task, true); }
Files export_msh41_ascii(const ExportTask& task) { return export_msh41(task, false); }

Files export_msh22_ascii(const ExportTask& task) {
  const MshModel model = msh_model(task.mesh);
  Files files = {write_mesh22(task, model)};
  if (has_fibers(task.mesh) || !task.mesh.user_regions.empty()) files.push_back(write_cell_views22(task, model));
  return files;
}

Files export_dealii(const ExportTask& task) {
  const TetMesh outer = without_interfaces(task.mesh);
  return export_msh22_ascii({outer, task.mesh_name, task.folder, task.unit});
}

}  // namespace heartgen::exporters
