// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/resolutions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "generator/fibers/transfer.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/stuffing/octree.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"
#include "model/memory.hpp"
#include "validation/fiber_checks.hpp"

namespace heartgen::pipeline {
namespace {

constexpr const char* key = "mesh.resolutions_mm";
constexpr double finest_edge_mm = 0.4, coarsest_edge_mm = 3;

void refuse_too_fine(double needed_bytes, double edge_mm, const char* setting, double memory_bytes) {
  if (memory_bytes <= 0 || needed_bytes <= memory_bytes) return;
  throw UserError(fmt::format("an edge of {:g} mm would need about {} of memory, and there are {}", edge_mm,
                              text_of_bytes(needed_bytes), text_of_bytes(memory_bytes)),
                  setting, "take a longer edge, or give it more memory");
}

/// At least what tetrahedra of that edge need to fill the voxels that `counts` chooses.
template <class Choice>
double min_bytes(const LabelVolume& labels, double edge_mm, Choice counts) {
  constexpr double volume_per_edge3 = 0.12, bytes_per_cell = 200;
  const auto voxels = std::count_if(labels.voxels.begin(), labels.voxels.end(), counts);
  return static_cast<double>(voxels) * labels.grid.voxel_volume_mm3() / (volume_per_edge3 * math::pow(edge_mm, 3)) *
         bytes_per_cell;
}

MeshSettings settings_at(MeshSettings settings, double edge_mm) {
  settings.meshes = {"myocardium"};
  settings.resolutions_mm.clear();
  settings.wall_layers = 0;  // the edge that was asked for, everywhere
  settings.heart_edge_mm = edge_mm;
  settings.blood_edge_mm = std::max(settings.blood_edge_mm, edge_mm);
  settings.torso_edge_mm = std::max(settings.torso_edge_mm, edge_mm);
  return settings;
}

}  // namespace

std::string resolution_name(double edge_mm) { return fmt::format("myocardium_{:g}mm", edge_mm); }

void check_resolutions(const MeshSettings& settings) {
  std::set<std::string> names;
  for (const double edge : settings.resolutions_mm) {
    if (!(edge >= finest_edge_mm && edge <= coarsest_edge_mm))
      throw UserError(
          fmt::format("the edge {:g} mm is outside {:g} to {:g} mm", edge, finest_edge_mm, coarsest_edge_mm), key,
          "correct the list");
    if (!names.insert(resolution_name(edge)).second)
      throw UserError(fmt::format("the edge {:g} mm is there twice", edge), key, "name every edge once");
  }
}

double estimate_bytes(const LabelVolume& labels, double edge_mm) {
  double walls = 0, blood = 0;  // voxels
  for (const auto voxel : labels.voxels) {
    walls += is_myocardium(static_cast<Region>(voxel));
    blood += is_blood(static_cast<Region>(voxel));
  }
  const auto& h = labels.grid.spacing_mm;
  const double wall_mm3 = walls * h.x * h.y * h.z, blood_mm3 = blood * h.x * h.y * h.z;
  // The blood's cells grow from the walls' on: those near count like an area over the square of the edge.
  constexpr double cells_per_square = 25, bytes_per_cell = 900;
  const double area_mm2 = 4 * math::pow(wall_mm3 + blood_mm3, 2.0 / 3);
  const double cells =
      stuffing::cells_per_cube * wall_mm3 / math::pow(edge_mm, 3) + cells_per_square * area_mm2 / math::pow(edge_mm, 2);
  return bytes_per_cell * cells;
}

void check_memory(const LabelVolume& labels, const MeshSettings& settings, double memory_bytes) {
  for (const double edge : settings.resolutions_mm)
    refuse_too_fine(estimate_bytes(labels, edge), edge, key, memory_bytes);
  const auto check = [&](double edge, const char* setting, auto counts) {
    refuse_too_fine(min_bytes(labels, edge, counts), edge, setting, memory_bytes);
  };
  check(settings.heart_edge_mm, "mesh.heart_edge_mm",
        [](std::uint8_t label) { return is_myocardium(static_cast<Region>(label)); });
  check(settings.blood_edge_mm, "mesh.blood_edge_mm",
        [](std::uint8_t label) { return is_blood(static_cast<Region>(label)); });
  check(settings.torso_edge_mm, "mesh.torso_edge_mm", [](std::uint8_t label) {
    const auto region = static_cast<Region>(label);
    return label != 0 && !is_myocardium(region) && !is_blood(region);
  });
}

Resolutions make_resolutions(const LabelVolume& labels, const MeshSettings& settings, const TetMesh& myocardium) {
  Resolutions result;
  for (const double edge : settings.resolutions_mm) {
    const std::string name = resolution_name(edge);
    TetMesh mesh = std::move(mesh::mesh_heart(labels, settings_at(settings, edge)).at("myocardium"));
    auto carried = fibers::transfer_fibers(myocardium, mesh.nodes_mm, mesh.cells, std::numeric_limits<double>::max());
    mesh.node_fibers = std::move(carried.node);
    mesh.cell_fibers = std::move(carried.cell);
    mesh.fiber_source = std::move(carried.source);
    result.meshes[name] = std::move(mesh);
    result.farthest_mm[name] = carried.farthest_mm;
  }
  return result;
}

Report check_resolution_fibers(const std::map<std::string, TetMesh>& meshes, const MeshSettings& mesh_settings,
                               const ValidationSettings& bounds) {
  Report report;
  for (const double edge : mesh_settings.resolutions_mm) {
    const auto found = meshes.find(resolution_name(edge));
    if (found == meshes.end()) continue;
    for (auto row : validation::check_fibers(found->second, {}, bounds)) {
      row.scope = row.scope == "myocardium" ? found->first : found->first + "/" + row.scope;
      report.push_back(std::move(row));
    }
  }
  return report;
}

Report resolution_distances(const Resolutions& resolutions) {
  Report report;
  for (const auto& [name, farthest_mm] : resolutions.farthest_mm)
    report.push_back({"fibers", name, "distance_to_main_mesh_max", farthest_mm, "mm", {}, {}});
  return report;
}

}  // namespace heartgen::pipeline
