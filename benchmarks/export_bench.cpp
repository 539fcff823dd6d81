// SPDX-License-Identifier: GPL-3.0-or-later
// Every export format with a mesh as large as the thesis's myocardium.
#include <fmt/format.h>

#include <filesystem>

#include "benchmarks/benchmarks.hpp"
#include "exporters/registry.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"

namespace heartgen::benchmarks {
namespace {

namespace fs = std::filesystem;

constexpr int cubes = 47;  ///< 12 × 47³ = 1.25 million cells

/// Shaken a little, so that no coordinate is a short number.
Vec3 node_at(int i, int j, int k) {
  const double shake = 0.05 * math::sin(12.9898 * i + 78.233 * j + 37.719 * k);
  return {1.1 * i + shake, j - shake, 0.9 * k + 0.5 * shake};
}

FiberField axes_at(const std::vector<Vec3>& points) {
  FiberField field;
  for (const auto& p : points) {
    const double angle = 0.02 * p.z + 0.003 * p.x;
    const Vec3 fiber{math::cos(angle) * 0.8, math::sin(angle) * 0.8, 0.6};
    const Vec3 sheet = normalized(cross(fiber, {0, 0, 1}));
    field.fiber.push_back(fiber);
    field.sheet.push_back(sheet);
    field.sheet_normal.push_back(cross(fiber, sheet));
  }
  return field;
}

void add_outer_faces(TetMesh& mesh, const std::vector<std::int8_t>& sides_of_node) {
  constexpr std::size_t corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (const auto& cell : mesh.cells)
    for (const auto& c : corners) {
      const Face face{cell[c[0]], cell[c[1]], cell[c[2]]};
      int common = ~0;
      for (const auto node : face) common &= sides_of_node[static_cast<std::size_t>(node)];
      if (common == 0) continue;
      mesh.faces.push_back(face);
      mesh.surface.push_back(*surface_from_name("epicardium"));
    }
}

/// A block of two regions with fibres everywhere.
TetMesh block() {
  constexpr int paths[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};  // corners between 0 and 7
  TetMesh mesh;
  std::vector<std::int8_t> sides;
  for (int k = 0; k <= cubes; ++k)
    for (int j = 0; j <= cubes; ++j)
      for (int i = 0; i <= 2 * cubes; ++i) {
        mesh.nodes_mm.push_back(node_at(i, j, k));
        sides.push_back(static_cast<std::int8_t>((i == 0) | (i == 2 * cubes) << 1 | (j == 0) << 2 | (j == cubes) << 3 |
                                                 (k == 0) << 4 | (k == cubes) << 5));
      }
  const auto id = [](int i, int j, int k) { return (k * (cubes + 1) + j) * (2 * cubes + 1) + i; };
  std::vector<Vec3> middles;
  for (int k = 0; k < cubes; ++k)
    for (int j = 0; j < cubes; ++j)
      for (int i = 0; i < 2 * cubes; ++i)
        for (const auto& path : paths) {
          const auto corner = [&](int bits) { return id(i + (bits & 1), j + ((bits >> 1) & 1), k + (bits >> 2)); };
          mesh.cells.push_back({corner(0), corner(path[0]), corner(path[1]), corner(7)});
          if (cell_volume_mm3(mesh, mesh.cells.back()) < 0) std::swap(mesh.cells.back()[1], mesh.cells.back()[2]);
          mesh.region.push_back(tag(i < cubes ? Region::lv_myocardium : Region::rv_myocardium));
          middles.push_back(node_at(i, j, k));
        }
  add_outer_faces(mesh, sides);
  mesh.node_fibers = axes_at(mesh.nodes_mm);
  mesh.cell_fibers = axes_at(middles);
  mesh.fiber_source.assign(mesh.nodes_mm.size(), static_cast<std::uint8_t>(FiberSource::rule));
  return mesh;
}

double megabytes_of(const std::vector<fs::path>& files) {
  double bytes = 0;
  for (const auto& file : files) bytes += static_cast<double>(fs::file_size(file));
  return bytes / 1e6;
}

}  // namespace

Table bench_exports(const Settings&, const parallel::Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;
  const TetMesh mesh = block();
  const auto folder = fs::temp_directory_path() / "heartgen_bench_exports";
  for (const auto& format : exporters::export_formats()) {
    fs::remove_all(folder);
    std::vector<fs::path> files;
    start_peak();
    const double elapsed_s = seconds([&] { files = exporters::export_mesh(format.name, mesh, "block", folder); });
    table.push_back({"exports", fmt::format("{}, {} cells", format.name, mesh.cells.size()), elapsed_s, "s",
                     fmt::format("{:.0f} MB on disk, {:.0f} MB of memory besides the mesh", megabytes_of(files),
                                 peak_bytes() / 1e6)});
  }
  fs::remove_all(folder);
  return table;
}

}  // namespace heartgen::benchmarks
