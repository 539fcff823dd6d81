// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh_files/msh_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "generator/mesh_files/msh_content.hpp"
#include "model/text.hpp"

namespace heartgen::mesh_files {
namespace {

using Scalars = std::map<std::string, std::vector<double>>;

std::vector<std::int32_t> labels_in(const Scalars& arrays, const std::string& name, std::size_t count) {
  const auto found = arrays.find(name);
  if (found == arrays.end()) return std::vector<std::int32_t>(count, 1);
  return {found->second.begin(), found->second.end()};
}

template <std::size_t N>
void add_elements(std::string& text, int type, const std::vector<std::array<std::int32_t, N>>& elements,
                  const std::vector<std::int32_t>& label, std::size_t& id) {
  for (std::size_t e = 0; e < elements.size(); ++e) {
    text += fmt::format("{} {} 2 {} {}", ++id, type, label[e], label[e]);
    for (const auto n : elements[e]) text += fmt::format(" {}", n + 1);
    text += '\n';
  }
}

void add_value(std::string& text, double value) { text += fmt::format(" {}", value); }
void add_value(std::string& text, const Vec3& v) { text += fmt::format(" {} {} {}", v.x, v.y, v.z); }
void add_value(std::string& text, const Mat3& m) {
  for (const auto& row : m.rows) add_value(text, row);
}

/// Rows "id value" for the values from `first_id` on.
template <class T>
void add_rows(std::string& text, const std::vector<T>& values, std::size_t first_id) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += std::to_string(first_id + i);
    add_value(text, values[i]);
    text += '\n';
  }
}

std::string view_head(const char* section, const std::string& name, std::size_t components, std::size_t rows) {
  return fmt::format("${}\n1\n\"{}\"\n1\n0\n3\n0\n{}\n{}\n", section, name, components, rows);
}

template <class T>
void add_node_views(std::string& text, const std::map<std::string, std::vector<T>>& arrays) {
  for (const auto& [name, values] : arrays) {
    text += view_head("NodeData", name, sizeof(T) / sizeof(double), values.size());
    add_rows(text, values, 1);
    text += "$EndNodeData\n";
  }
}

/// Views of tetrahedra and of triangles of one name are one view.
template <class T>
void add_element_views(std::string& text, const std::map<std::string, std::vector<T>>& on_cells,
                       const std::map<std::string, std::vector<T>>& on_faces, std::size_t cells,
                       const std::string& labels) {
  std::set<std::string> names;
  for (const auto* arrays : {&on_cells, &on_faces})
    for (const auto& [name, values] : *arrays)
      if (name != labels) names.insert(name);
  const std::vector<T> none;
  const auto values_of = [&none](const auto& arrays, const std::string& name) -> const std::vector<T>& {
    const auto found = arrays.find(name);
    return found != arrays.end() ? found->second : none;
  };
  for (const auto& name : names) {
    const auto &of_cells = values_of(on_cells, name), &of_faces = values_of(on_faces, name);
    text += view_head("ElementData", name, sizeof(T) / sizeof(double), of_cells.size() + of_faces.size());
    add_rows(text, of_cells, 1);
    add_rows(text, of_faces, cells + 1);
    text += "$EndElementData\n";
  }
}

}  // namespace

UnstructuredData read_msh(const std::filesystem::path& path) { return mesh_of(read_msh_content(path), path); }

void write_msh(const std::filesystem::path& path, const UnstructuredData& mesh, const std::string& labels) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  if (!mesh.names.empty()) {
    text += fmt::format("$PhysicalNames\n{}\n", mesh.names.size());
    for (const auto& [key, name] : mesh.names) text += fmt::format("{} {} \"{}\"\n", key.first, key.second, name);
    text += "$EndPhysicalNames\n";
  }
  text += fmt::format("$Nodes\n{}\n", mesh.points.size());
  add_rows(text, mesh.points, 1);
  text += fmt::format("$EndNodes\n$Elements\n{}\n", mesh.tets.size() + mesh.faces.size());
  std::size_t id = 0;
  add_elements(text, 4, mesh.tets, labels_in(mesh.cell_scalars, labels, mesh.tets.size()), id);
  add_elements(text, 2, mesh.faces, labels_in(mesh.face_scalars, labels, mesh.faces.size()), id);
  text += "$EndElements\n";
  add_node_views(text, mesh.point_scalars);
  add_node_views(text, mesh.point_vectors);
  add_node_views(text, mesh.point_tensors);
  add_element_views(text, mesh.cell_scalars, mesh.face_scalars, mesh.tets.size(), labels);
  add_element_views(text, mesh.cell_vectors, mesh.face_vectors, mesh.tets.size(), labels);
  add_element_views(text, mesh.cell_tensors, mesh.face_tensors, mesh.tets.size(), labels);
  write_text(path.string(), text);
}

}  // namespace heartgen::mesh_files
