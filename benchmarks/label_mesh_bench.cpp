// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes of label maps: heart and torso, trachea and carotid, the 2D slice.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "benchmarks/benchmarks.hpp"
#include "benchmarks/label_measures.hpp"
#include "benchmarks/mesh_measures.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/image/masks.hpp"
#include "generator/mesh/domain.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/mesh/mesh_vessel.hpp"
#include "generator/mesh/slice_mesh.hpp"
#include "generator/mesh/surfaces.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"

namespace heartgen::benchmarks {
namespace {

phantom::Phantom phantom_of(const Settings& settings) {
  phantom::PhantomSettings phantom;
  phantom.variant = settings.variant;
  phantom.fibers = false;
  return phantom::make_phantom(phantom);
}

LabelVolume labels_of(const Settings& settings) {
  return settings.labels.empty() ? phantom_of(settings).labels : adapters::read_labels(settings.labels);
}

bool is_heart(std::int32_t region) {
  return is_myocardium(static_cast<Region>(region)) || is_blood(static_cast<Region>(region));
}

struct LabelDistances {
  std::vector<double> heart, rest;  ///< shares of each face's mean edge
};

/// Of the faces' centres to the level set between the two regions that meet there, to first order.
LabelDistances distances_of(const TetMesh& mesh, const mesh::MeshDomain& domain) {
  LabelDistances found;
  const auto region = [&](std::int32_t cell) { return mesh.region[static_cast<std::size_t>(cell)]; };
  for (const auto& face : mesh::cell_faces(mesh.cells)) {
    if (face.other < 0 || region(face.cell) == region(face.other)) continue;
    const std::int32_t one = region(face.cell), other = region(face.other);
    std::array<Vec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = mesh.nodes_mm[static_cast<std::size_t>(face.nodes[i])];
    const double edge = (norm(p[1] - p[0]) + norm(p[2] - p[1]) + norm(p[0] - p[2])) / 3;
    std::array<mesh::SurfaceEquation, 1> equation;
    const auto bits = 1U << one | 1U << other;
    mesh::equations_at(domain, bits, index_from_lps(domain.grid, (p[0] + p[1] + p[2]) / 3), equation);
    const double distance = std::abs(equation[0].value) / std::max(norm(equation[0].gradient), 1e-3);
    (is_heart(one) || is_heart(other) ? found.heart : found.rest).push_back(distance / edge);
  }
  return found;
}

/// A mesh, what it was made of, and how long that took.
struct Made {
  mesh::MeshDomain domain;
  TetMesh mesh;
  mesh::LatticeReport report;
};

/// To first order.
void add_distances(Table& table, const char* bench, const Made& made) {
  auto distances = distances_of(made.mesh, made.domain);
  for (auto& [what, found] : {std::pair{"the heart's", &distances.heart}, {"other", &distances.rest}}) {
    const auto summary = summary_of(std::move(*found));
    table.push_back({bench, fmt::format("{} faces to the level set, p99", what), summary.p99, "edges", "at most 0.1"});
    table.push_back({bench, fmt::format("{} faces to the level set, greatest", what), summary.greatest, "edges",
                     "at most 0.3; to first order: too large where shares are flat"});
  }
}

void add_torso(Table& table, const LabelVolume& labels) {
  const char* bench = "mesh-torso";
  MeshSettings settings;
  settings.heart_edge_mm = 2;  // about 1.7 M cells on the phantom
  Made made;
  const double processor = processor_seconds();
  const double time = seconds([&] { made.mesh = mesh::mesh_labels(labels, settings, &made.report); });
  const double used = processor_seconds() - processor;
  const auto cells = static_cast<double>(made.mesh.cells.size());
  table.push_back({bench, "cells", cells / 1e6, "M", ""});
  table.push_back(
      {bench, "from label map to labelled mesh", time, "s",
       fmt::format("{:.1f} s of processor time; at most 10 for 1.7 M cells: {:.1f}", used, time * 1.7e6 / cells)});
  made.domain = mesh::make_domain(labels, settings);
  add_quality(table, bench, made.mesh, made.report, {"at least 25", "at most 145"});
  add_distances(table, bench, made);
  const auto label_at = [&](const Vec3& p) {
    return mesh::region_at(made.domain, index_from_lps(made.domain.grid, p));
  };
  add_regions(table, bench, made.mesh, volumes_of(made.domain.grid, label_at));
}

void add_vessel(Table& table, const Mask& lumen, Region vessel, MeshSettings settings, const char* backend) {
  settings.backend = backend;
  const std::string name = region_name(tag(vessel));
  const double edge = vessel == Region::trachea ? settings.trachea_edge_mm : settings.carotid_edge_mm;
  TetMesh mesh;
  const double time = seconds([&] { mesh = mesh::mesh_vessel(lumen, vessel, settings); });
  const auto angles = angles_of(mesh.nodes_mm, mesh.cells, [](std::size_t) { return true; });
  const auto cells = static_cast<double>(mesh.cells.size());
  table.push_back({"mesh-vessels", fmt::format("{}, {} mm, {}: cells", name, edge, backend), cells / 1e3, "k",
                   fmt::format("{:.2f} s, {} ends, angles {:.1f} to {:.1f} degrees (within [25, 145])", time,
                               mesh.rims.size(), angles.least, angles.greatest)});
}

std::int64_t slice_with_max_muscle(const LabelVolume& labels) {
  std::vector<std::int64_t> count(static_cast<std::size_t>(labels.grid.size[2]), 0);
  const auto per_slice = static_cast<std::size_t>(labels.grid.size[0] * labels.grid.size[1]);
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    count[v / per_slice] += is_myocardium(static_cast<Region>(labels.voxels[v]));
  return std::max_element(count.begin(), count.end()) - count.begin();
}

}  // namespace

Table bench_mesh_torso(const Settings& settings, const parallel::Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;
  parallel::set_thread_count(settings.threads);
  add_torso(table, labels_of(settings));
  return table;
}

Table bench_mesh_vessels(const Settings& settings, const parallel::Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;
  parallel::set_thread_count(settings.threads);
  const auto phantom = phantom_of(settings);
  const auto trachea = image::mask_of(settings.labels.empty() ? phantom.labels : labels_of(settings), Region::trachea);
  const auto carotid = image::mask_of(phantom.carotid_labels, Region::carotid);
  MeshSettings coarse, fine;
  fine.trachea_edge_mm = 0.8;
  fine.carotid_edge_mm = 0.58;  // about 540 k cells
  const bool has_trachea = std::find(trachea.voxels.begin(), trachea.voxels.end(), 1) != trachea.voxels.end();
  for (const char* backend : {"lattice", "cgal"}) {
    if (has_trachea) add_vessel(table, trachea, Region::trachea, coarse, backend);
    if (has_trachea) add_vessel(table, trachea, Region::trachea, fine, backend);
    add_vessel(table, carotid, Region::carotid, coarse, backend);
  }
  add_vessel(table, carotid, Region::carotid, fine, "lattice");
  return table;
}

Table bench_mesh_slice(const Settings& settings, const parallel::Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;
  parallel::set_thread_count(settings.threads);
  const auto labels = labels_of(settings);
  mesh::SliceSettings slice;
  slice.edge_mm = 0.34;
  mesh::SliceReport report;
  TriMesh mesh;
  const auto index = slice_with_max_muscle(labels);
  const double time = seconds([&] { mesh = mesh::mesh_slice(labels, index, slice, &report); });
  const auto add = [&](const char* what, double value, const char* unit, const std::string& note) {
    table.push_back({"mesh-slice", what, value, unit, note});
  };
  add("triangles", static_cast<double>(mesh.triangles.size()) / 1e3, "k", "the thesis: 163");
  add("from label map to mesh", time, "s", fmt::format("slice {}", index));
  add("least angle", report.min_angle_deg, "degrees", "at least 28");
  add("greatest angle", report.greatest_angle_deg, "degrees", "at most 120");
  add("edges to their curve, p99", report.distance_p99, "edges", "");
  add("edges to their curve, greatest", report.distance_max, "edges", "");
  return table;
}

}  // namespace heartgen::benchmarks
