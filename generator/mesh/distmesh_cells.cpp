// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/distmesh_cells.hpp"

#include <algorithm>

#include "generator/distmesh/tetrahedra.hpp"
#include "generator/stuffing/isosurface_stuffing.hpp"
#include "generator/surface_fit/self_intersections.hpp"
#include "generator/surface_fit/volume_correction.hpp"

namespace heartgen::mesh {
LabelledCells distmesh_cells(const MeshDomain& domain, const Volume<float>& sizes_mm,
                             std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells, LatticeReport* report) {
  StepWatch watch{report};
  const auto materials = materials_of(domain, sizes_mm);
  auto complex = stuffing::stuff_isosurfaces(materials, {});
  settle(complex, manifold_sets, crumb_cells);
  watch.note("stuff");
  auto relaxing = distmesh::default_settings(distmesh::Dimension::three);
  relaxing.on_tenth = [&] { watch.note("truss"); };
  const auto truss = distmesh::relax({std::move(complex.nodes_mm), std::move(complex.touches)}, materials,
                                     distmesh::Dimension::three, relaxing);
  watch.note("finish");
  complex = distmesh::complex_of(truss, materials);
  settle(complex, manifold_sets, crumb_cells);
  watch.note("settle");
  const tetmesh::RepairSettings settings;
  const auto below = repair_on_curves(complex, materials, settings);
  watch.note("repair");
  surface_fit::correct_surface_volumes(complex, materials, settings.least);
  surface_fit::resolve_self_intersections(complex, settings.least);
  tetmesh::compress(complex);
  watch.note("balance");
  if (report != nullptr) report->cells_below_goal = below;
  return collect(complex, domain.grid);
}

}  // namespace heartgen::mesh
