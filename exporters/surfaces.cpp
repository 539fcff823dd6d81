// SPDX-License-Identifier: GPL-3.0-or-later
// Every named surface in a file of its own, NAME_SURFACE.*, as printers and viewers read it: STL (binary, 32-bit), PLY
// (binary, 64-bit), OBJ (text), VTP. Triangles look out of the mesh, between two regions out of the lower one. Then
// each cavity, NAME_CAVITY.*, closed, its triangles out of the blood; and its caps alone, NAME_CAVITY_CAP.*.
#include <algorithm>
#include <map>
#include <numeric>

#include "exporters/files.hpp"
#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "model/labels.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::exporters {
namespace {

/// Triangles on their own points.
struct Patch {
  std::vector<Vec3> points;
  std::vector<Face> faces;
};

Patch patch_of(const TetMesh& mesh, const std::vector<Face>& faces) {
  std::vector<std::int32_t> nodes;
  for (const auto& face : faces) nodes.insert(nodes.end(), face.begin(), face.end());
  sort_unique(nodes);
  Patch patch;
  for (const auto node : nodes) patch.points.push_back(mesh.nodes_mm[static_cast<std::size_t>(node)]);
  for (Face own : faces) {
    for (auto& node : own) node = static_cast<std::int32_t>(std::ranges::lower_bound(nodes, node) - nodes.begin());
    patch.faces.push_back(own);
  }
  return patch;
}

std::vector<Face> picked(const TetMesh& mesh, const std::vector<std::size_t>& ids) {
  std::vector<Face> faces;
  for (const auto f : ids) faces.push_back(mesh.faces[f]);
  return faces;
}

std::array<float, 3> as_floats(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

std::filesystem::path write_stl(const std::filesystem::path& path, const Patch& patch) {
  OutFile file(path);
  std::string head = "heartgen";  // must not begin with "solid"
  head.resize(80, ' ');
  file.raw(std::span<const char>(head));
  file.raw(static_cast<std::uint32_t>(patch.faces.size()));
  for (const auto& face : patch.faces) {
    const auto at = [&](std::size_t i) { return patch.points[static_cast<std::size_t>(face[i])]; };
    const Vec3 normal = cross(at(1) - at(0), at(2) - at(0));
    file.raw(as_floats(norm(normal) > 0 ? normal / norm(normal) : normal));
    for (std::size_t i = 0; i < 3; ++i) file.raw(as_floats(at(i)));
    file.raw(std::uint16_t{0});
  }
  return file.close();
}

std::filesystem::path write_ply(const std::filesystem::path& path, const Patch& patch) {
  OutFile file(path);
  file.print(FMT_COMPILE("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\n"
                         "property double y\nproperty double z\nelement face {}\n"
                         "property list uchar int vertex_indices\nend_header\n"),
             patch.points.size(), patch.faces.size());
  for (const auto& p : patch.points) file.raw(std::array{p.x, p.y, p.z});
  for (const auto& face : patch.faces) {
    file.raw(std::uint8_t{3});
    file.raw(face);
  }
  return file.close();
}

std::filesystem::path write_obj(const std::filesystem::path& path, const Patch& patch) {
  OutFile file(path);
  for (const auto& p : patch.points) file.print(FMT_COMPILE("v {} {} {}\n"), p.x, p.y, p.z);
  for (const auto& f : patch.faces) file.print(FMT_COMPILE("f {} {} {}\n"), f[0] + 1, f[1] + 1, f[2] + 1);
  return file.close();
}

struct NamedFaces {
  std::string name;
  std::vector<Face> faces;
  std::vector<std::int32_t> surface;  ///< per face
};

/// Surfaces of the mesh, then each cavity as one closed surface, then its caps alone.
std::vector<NamedFaces> named_faces(const TetMesh& mesh) {
  std::vector<NamedFaces> all;
  const auto names = surfaces_of(mesh);
  for (const auto& [tag, ids] : faces_by_surface(mesh))
    all.push_back({names.at(tag), picked(mesh, ids), std::vector<std::int32_t>(ids.size(), tag)});
  for (const auto& cavity : mesh.cavities) {
    all.push_back({cavity.name, cavity.faces, cavity.surface});
    std::map<std::int32_t, std::vector<Face>> caps;
    for (std::size_t f = 0; f < cavity.faces.size(); ++f)
      if (is_cap(cavity.surface[f])) caps[cavity.surface[f]].push_back(cavity.faces[f]);
    for (auto& [tag, faces] : caps) {
      const std::vector<std::int32_t> surface(faces.size(), tag);
      all.push_back({cavity.name + "_" + surface_name(tag), std::move(faces), surface});
    }
  }
  return all;
}

template <class Write>
Files each_patch(const ExportTask& task, const char* extension, const Write& write) {
  Files files;
  for (const auto& named : named_faces(task.mesh))
    files.push_back(write(task.folder / (task.mesh_name + "_" + in_file_name(named.name) + extension),
                          patch_of(task.mesh, named.faces)));
  return files;
}

}  // namespace

Files export_stl(const ExportTask& task) { return each_patch(task, ".stl", &write_stl); }
Files export_ply(const ExportTask& task) { return each_patch(task, ".ply", &write_ply); }
Files export_obj(const ExportTask& task) { return each_patch(task, ".obj", &write_obj); }

Files export_vtp(const ExportTask& task) {
  Files files;
  TetMesh patch;
  patch.nodes_mm = task.mesh.nodes_mm;
  for (auto& named : named_faces(task.mesh)) {
    patch.faces = std::move(named.faces);
    patch.surface = std::move(named.surface);
    std::vector<std::size_t> all(patch.faces.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    files.push_back(task.folder / (task.mesh_name + "_" + in_file_name(named.name) + ".vtp"));
    adapters::write_vtp(files.back(), patch, all, {});
  }
  return files;
}

}  // namespace heartgen::exporters
