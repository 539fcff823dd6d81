// SPDX-License-Identifier: GPL-3.0-or-later
#include <heartgen/mesh_labels.hpp>

#include "generator/mesh/mesh_heart.hpp"
#include "generator/mesh/walls.hpp"
#include "generator/pipeline/check_inputs.hpp"
#include "generator/pipeline/resolutions.hpp"
#include "model/memory.hpp"

namespace heartgen {
namespace {

void check(const LabelVolume& labels, const MeshSettings& settings) {
  pipeline::check_edges(settings);
  mesh::check_settings(settings);
  pipeline::check_memory(labels, settings, memory_bytes());
}

}  // namespace

TetMesh mesh_labels(const LabelVolume& labels, const MeshSettings& settings, const Volume<float>* own_edges_mm) {
  check(labels, settings);
  return mesh::mesh_labels(labels, settings, nullptr, own_edges_mm);
}

TetMesh mesh_walls(const LabelVolume& labels, const MeshSettings& settings, const Volume<float>* own_edges_mm) {
  check(labels, settings);
  return mesh::mesh_walls(mesh::wall_level_sets(labels, settings), settings, nullptr, own_edges_mm);
}

}  // namespace heartgen
