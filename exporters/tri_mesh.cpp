// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/tri_mesh.hpp"

#include "exporters/out_file.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "model/error.hpp"

namespace heartgen::exporters {
namespace {

constexpr int msh_line = 1, msh_triangle = 2;

std::filesystem::path write_msh(const std::filesystem::path& path, const TriMesh& mesh) {
  OutFile out(path);
  out.print(FMT_COMPILE("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n"),
            mesh.curve_names.size() + mesh.region_names.size());
  for (const auto& [tag, name] : mesh.curve_names) out.print(FMT_COMPILE("1 {} \"{}\"\n"), tag, name);
  for (const auto& [tag, name] : mesh.region_names) out.print(FMT_COMPILE("2 {} \"{}\"\n"), tag, name);
  out.print(FMT_COMPILE("$EndPhysicalNames\n$Nodes\n{}\n"), mesh.nodes_mm.size());
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    const Vec3& p = mesh.nodes_mm[n];
    out.print(FMT_COMPILE("{} {} {} {}\n"), n + 1, p.x, p.y, p.z);
  }
  out.print(FMT_COMPILE("$EndNodes\n$Elements\n{}\n"), mesh.edges.size() + mesh.triangles.size());
  std::size_t id = 0;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    out.print(FMT_COMPILE("{} {} 2 {} {} {} {}\n"), ++id, msh_line, mesh.curve[e], mesh.curve[e], mesh.edges[e][0] + 1,
              mesh.edges[e][1] + 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& n = mesh.triangles[t];
    out.print(FMT_COMPILE("{} {} 2 {} {} {} {} {}\n"), ++id, msh_triangle, mesh.region[t], mesh.region[t], n[0] + 1,
              n[1] + 1, n[2] + 1);
  }
  out.print(FMT_COMPILE("$EndElements\n"));
  return out.close();
}

}  // namespace

std::vector<std::filesystem::path> write_tri_mesh(const std::filesystem::path& path, const TriMesh& mesh) {
  if (path.extension() == ".msh") return {write_msh(path, mesh)};
  if (path.extension() != ".vtu")
    throw UserError("unknown kind of mesh file", path.string(), "give a name that ends in .vtu or .msh");
  auto edges = path;
  edges.replace_extension(".vtp");
  adapters::write_vtu(path, mesh);
  adapters::write_vtp(edges, mesh);
  return {path, edges};
}

}  // namespace heartgen::exporters
