#include "generator/mesh/distmesh_cells.hpp"

#include <algorithm>
#include <chrono>

#include "generator/distmesh/tetrahedra.hpp"
#include "generator/lattice/balance.hpp"
#include "generator/lattice/draw.hpp"
#include "generator/lattice/repair.hpp"
#include "generator/lattice/separate.hpp"
#include "generator/lattice/stuff.hpp"

namespace heart::mesh {
adapters::LabelledCells distmesh_cells(const MeshDomain& domain, const Volume<float>& sizes_mm,
                                       std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells,
                                       LatticeReport* report) {
  using Clock = std::chrono::steady_clock;
  auto last = Clock::now();
  const auto note = [&](const char* step) {
    const auto now = Clock::now();
    if (report != nullptr) report->add(step, std::chrono::duration<double>(now - last).count());
    last = now;
  };
  const auto materials = materials_of(domain, sizes_mm);
  auto complex = lattice::stuff(materials, {});
  settle(complex, manifold_sets, crumb_cells);
  note("stuff");
  auto relaxing = distmesh::usual_settings(distmesh::Dimension::three);
  relaxing.on_tenth = [&] { note("truss"); };
  const auto truss = distmesh::relax({std::move(complex.nodes_mm), std::move(complex.touches)}, materials,
                                     distmesh::Dimension::three, relaxing);
  note("finish");
  complex = distmesh::complex_of(truss, materials);
  settle(complex, manifold_sets, crumb_cells);
  note("settle");
  const lattice::RepairSettings settings;
  lattice::draw_to_curves(complex, materials, lattice::StuffSettings{}.least_quality);
  const auto below = lattice::repair(complex, materials, settings);
  lattice::draw_to_curves(complex, materials, settings.least);
  note("repair");
  lattice::balance_surfaces(complex, materials, settings.least);
  lattice::separate_sheets(complex, settings.least);
  lattice::compress(complex);
  note("balance");
  if (report != nullptr) report->cells_below_goal = below;
  return collect(complex, domain.grid);
}

}  // namespace heart::mesh
