#include "generator/mesh/lattice_cells.hpp"

#include <array>
#include <chrono>

#include "generator/lattice/balance.hpp"
#include "generator/lattice/repair.hpp"
#include "generator/lattice/stuff.hpp"
#include "generator/mesh/size_field.hpp"

namespace heart::mesh {
namespace {

/// Continuous index of a position in mm along the grid's axes, voxel (0, 0, 0) at the origin.
Vec3 index_of(const Grid& grid, const Vec3& p) {
  return {p.x / grid.spacing_mm.x, p.y / grid.spacing_mm.y, p.z / grid.spacing_mm.z};
}

lattice::Materials materials_of(const MeshDomain& domain, const Volume<float>& sizes) {
  const Grid& grid = domain.grid;
  lattice::Materials materials;
  for (int axis = 0; axis < 3; ++axis) {
    materials.box_min_mm[axis] = -0.5 * grid.spacing_mm[axis];
    materials.box_max_mm[axis] =
        (static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5) * grid.spacing_mm[axis];
  }
  materials.label_at = [&domain](const Vec3& p) { return region_at(domain, index_of(domain.grid, p)); };
  materials.edge_mm = [&domain, &sizes](const Vec3& p) {
    return edge_at(sizes, lps_from_index(domain.grid, index_of(domain.grid, p)));
  };
  materials.equations_at = [&domain](lattice::LabelBits labels, const Vec3& p, std::span<lattice::Equation> equations) {
    std::array<SurfaceEquation, lattice::most_equations> found;
    const auto wanted = std::span(found).first(equations.size());
    const int count = equations_at(domain, labels, index_of(domain.grid, p), wanted);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      equations[i] = {found[i].value, found[i].gradient};
    return count;
  };
  return materials;
}

void settle(lattice::Complex& complex, std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells) {
  std::vector<std::int32_t> label(complex.label.begin(), complex.label.end());
  settle_labels(complex.nodes_mm, complex.cells, label, manifold_sets, crumb_cells);
  for (std::size_t c = 0; c < label.size(); ++c) complex.label[c] = static_cast<std::uint8_t>(label[c]);
}

adapters::LabelledCells collect(const lattice::Complex& complex, const Grid& grid) {
  adapters::LabelledCells result;
  for (const auto& p : complex.nodes_mm) result.nodes_mm.push_back(lps_from_index(grid, index_of(grid, p)));
  result.cells = complex.cells;
  result.label.assign(complex.label.begin(), complex.label.end());
  return result;
}

}  // namespace

adapters::LabelledCells lattice_cells(const MeshDomain& domain, const Volume<float>& sizes_mm,
                                      std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells,
                                      LatticeReport* report) {
  using Clock = std::chrono::steady_clock;
  auto last = Clock::now();
  const auto note = [&](const char* step) {
    const auto now = Clock::now();
    if (report != nullptr) report->seconds.emplace_back(step, std::chrono::duration<double>(now - last).count());
    last = now;
  };
  const auto materials = materials_of(domain, sizes_mm);
  auto complex = lattice::stuff(materials, {});
  note("stuff");
  settle(complex, manifold_sets, crumb_cells);
  note("settle");
  lattice::derive_touches(complex);
  lattice::compress(complex);
  const lattice::RepairSettings settings;
  const auto below = lattice::repair(complex, materials, settings);
  note("repair");
  lattice::balance_surfaces(complex, materials, settings.least);
  lattice::compress(complex);
  note("balance");
  if (report != nullptr) report->cells_below_goal = below;
  return collect(complex, domain.grid);
}

}  // namespace heart::mesh
