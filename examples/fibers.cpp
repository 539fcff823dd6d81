// SPDX-License-Identifier: GPL-3.0-or-later
// Fibres of the stand-in atlas on a mesh of another heart, and from there on a coarser mesh of the same heart.
#include <cmath>
#include <heartgen/fibers.hpp>
#include <heartgen/mesh_labels.hpp>
#include <heartgen/meshes.hpp>
#include <heartgen/phantom.hpp>

#include "images.hpp"

namespace {

using namespace heartgen;

TetMesh ventricles_of(const LabelVolume& labels, double edge_mm) {
  MeshSettings settings;
  settings.heart_edge_mm = edge_mm;
  settings.blood_edge_mm = settings.torso_edge_mm = 8;
  return only_regions(mesh_labels(labels, settings), regions_named(std::vector<std::string>{"walls"}));
}

}  // namespace

int main() {
  PhantomSettings of;
  of.size = {64, 64, 56};
  of.spacing_mm = {3, 3, 3};
  of.companions = false;
  const auto heart = make_phantom(of);
  FiberSettings settings;
  settings.grid_mm = 4;
  settings.depth_grid_mm = 2.5;
  settings.demons_iterations = {4, 2, 1};
  const auto mapped =
      map_fibers(ventricles_of(heart.labels, 5), heart.labels, heart.landmarks, standin_atlas(), settings);
  std::printf("%zu nodes with fibres; the walls overlap by %.2f\n", mapped.mesh.node_fibers.fiber.size(),
              mapped.atlas_overlap);
  for (const auto& warning : mapped.warnings) std::printf("%s\n", warning.text.c_str());
  const auto coarse = ventricles_of(heart.labels, 7);
  const auto carried = transfer_fibers(mapped.mesh, coarse.nodes_mm, coarse.cells, 5);
  double units = 0;
  for (const auto& axis : carried.node.fiber) units += norm(axis);
  return expect_near("nodes with a unit axis", units, static_cast<double>(coarse.nodes_mm.size()), 0.02) +
         (mapped.atlas_overlap < 0.6);
}
