// SPDX-License-Identifier: GPL-3.0-or-later
// What is in a bundle: open_bundle FOLDER. Its meshes go to openCARP, too.
#include <heartgen/bundle.hpp>
#include <heartgen/export.hpp>

#include "images.hpp"

int main(int argc, char** argv) {
  using namespace heartgen;
  const std::string folder = argc > 1 ? argv[1] : "bundle";
  for (const auto& problem : bundle::verify_bundle(folder))
    return std::printf("%s: %s\n", problem.file.c_str(), problem.what.c_str()), 1;
  const auto manifest = bundle::read_manifest(folder);
  std::printf("%s %s\n", manifest.name.c_str(), manifest.version.c_str());
  for (const auto& [name, entry] : manifest.meshes) {
    const auto mesh = bundle::read_mesh(folder, name);
    std::printf("  %s: %zu nodes, %zu cells, fibres on %zu nodes\n", name.c_str(), mesh.nodes_mm.size(),
                mesh.cells.size(), mesh.node_fibers.fiber.size());
    for (const auto& file : export_mesh("opencarp", mesh, name, folder + ".opencarp"))
      std::printf("    %s\n", file.c_str());
  }
  return manifest.meshes.empty() ? 1 : 0;
}
