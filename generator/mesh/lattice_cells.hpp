// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The lattice back end for label maps: the domain of a label map as materials, stuffed, settled and repaired.
#pragma once
#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "generator/mesh/domain.hpp"
#include "generator/mesh/heart_ends.hpp"
#include "generator/mesh/label_repair.hpp"
#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/repair.hpp"
#include "model/labelled_cells.hpp"

namespace heartgen::mesh {

/// What one run of the mesher took and gave, for benchmarks and those who wait.
struct LatticeReport {
  std::vector<std::pair<std::string, double>> seconds;                   ///< wall time of each step, of each try
  std::int64_t cells_below_goal = 0;                                     ///< of the repair
  std::function<void(const std::string& step, double seconds)> on_step;  ///< called as steps end, if there is one
  void add(const std::string& step, double taken) {
    seconds.emplace_back(step, taken);
    if (on_step) on_step(step, taken);
  }
};

/// Tells a report, if there is one, what each step took.
struct StepWatch {
  LatticeReport* report;
  std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();
  void note(const std::string& step);
};

/// A little below the goal of repair: angles in [30.8, 143] degrees. What is above stays above.
constexpr double kept_quality = 0.5116;

/// What the mesh is made for.
struct LatticeAims {
  double enough = 0.4885;  ///< quality: where no cell is below, nothing is tried again: angles in [29, 145]
  tetmesh::LabelBits fitted =
      ~0U;               ///< surfaces of these are followed closely everywhere (surface_fit/surface_fitting.hpp)
  int tolerated = 0;     ///< nor where it is only so many (are_few_below)
  bool refines = false;  ///< where labels do not fit into the lattice, edges become shorter: for surfaces that are
                         ///< smooth, else too much does not fit
};
/// Where several materials meet in an edge it may be too much to ask of every cell.
constexpr LatticeAims one_material{kept_quality, ~0U, 0, true};

/// Whether at most so many cells are below a quality, and all of their angles are in [26, 145] degrees: where several
/// materials meet a few cells resist, and to make everything anew for these is not worth it.
bool are_few_below(const tetmesh::Complex& complex, double enough, int most);

/// The domain as materials, in mm along the axes of its grid. Both must outlive the result.
tetmesh::Materials materials_of(const MeshDomain& domain, const Volume<float>& sizes_mm);

/// Gives the cells of a complex that has just been stuffed their final labels (repair_labels) and drops those outside.
void settle(tetmesh::Complex& complex, std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells);

/// Repairs a settled complex, the nodes of its curves on them; returns how many cells stay below the goal.
std::int64_t repair_on_curves(tetmesh::Complex& complex, const tetmesh::Materials& materials,
                              const tetmesh::RepairSettings& settings);

/// The cells of a complex whose nodes are in mm along the axes of the grid.
LabelledCells collect(const tetmesh::Complex& complex, const Grid& grid);

/// Tries again with other settings where the worst cell is too bad, and keeps the best. `manifold_sets` as in
/// repair_labels.
tetmesh::Complex lattice_complex(const tetmesh::Materials& materials, std::span<const LabelSet> manifold_sets,
                                 std::int64_t crumb_cells, LatticeReport* report = nullptr,
                                 const LatticeAims& aims = {});

/// lattice_complex of a label map: cells with labels 1 to 17, and of artery_stub_label beyond `ends`, nodes in LPS mm;
/// the sides of the image and the ends are flat.
LabelledCells lattice_cells(const MeshDomain& domain, const Volume<float>& sizes_mm,
                            std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells,
                            LatticeReport* report = nullptr, const std::vector<HeartEnd>& ends = {});

}  // namespace heartgen::mesh
