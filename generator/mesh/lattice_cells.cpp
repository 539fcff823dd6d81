// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/lattice_cells.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "generator/mesh/size_field.hpp"
#include "generator/stuffing/background_lattice.hpp"
#include "generator/stuffing/isosurface_stuffing.hpp"
#include "generator/stuffing/refine.hpp"
#include "generator/stuffing/under_resolved.hpp"
#include "generator/surface_fit/feature_projection.hpp"
#include "generator/surface_fit/self_intersections.hpp"
#include "generator/surface_fit/surface_fitting.hpp"
#include "generator/surface_fit/tangential_relaxation.hpp"
#include "generator/surface_fit/volume_correction.hpp"
#include "generator/tetmesh/cavity.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/quality.hpp"
#include "generator/tetmesh/remesh_worst.hpp"

namespace heartgen::mesh {
namespace {

/// Continuous index of a position in mm along the grid's axes, voxel (0, 0, 0) at the origin.
Vec3 index_of(const Grid& grid, const Vec3& p) {
  return {p.x / grid.spacing_mm.x, p.y / grid.spacing_mm.y, p.z / grid.spacing_mm.z};
}

}  // namespace

tetmesh::Materials materials_of(const MeshDomain& domain, const Volume<float>& sizes) {
  const Grid& grid = domain.grid;
  tetmesh::Materials materials;
  for (int axis = 0; axis < 3; ++axis) {
    materials.box_min_mm[axis] = -0.5 * grid.spacing_mm[axis];
    materials.box_max_mm[axis] =
        (static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5) * grid.spacing_mm[axis];
  }
  materials.label_at = [&domain](const Vec3& p) { return region_at(domain, index_of(domain.grid, p)); };
  materials.edge_mm = [&domain, &sizes](const Vec3& p) {
    return edge_at(sizes, lps_from_index(domain.grid, index_of(domain.grid, p)));
  };
  materials.equations_at = [&domain](tetmesh::LabelBits labels, const Vec3& p, std::span<tetmesh::Equation> equations) {
    std::array<SurfaceEquation, tetmesh::max_equations> found;
    const auto wanted = std::span(found).first(equations.size());
    const int count = equations_at(domain, labels, index_of(domain.grid, p), wanted);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      equations[i] = {found[i].value, found[i].gradient};
    return count;
  };
  materials.finest_edge_mm = static_cast<double>(*std::min_element(sizes.voxels.begin(), sizes.voxels.end()));
  return materials;
}

void StepWatch::note(const std::string& step) {
  const auto now = std::chrono::steady_clock::now();
  if (report != nullptr) report->add(step, std::chrono::duration<double>(now - last).count());
  last = now;
}

std::int64_t repair_on_curves(tetmesh::Complex& complex, const tetmesh::Materials& materials,
                              const tetmesh::RepairSettings& settings) {
  surface_fit::project_to_curves(complex, materials, stuffing::StuffSettings{}.min_quality);
  const auto below_goal = tetmesh::repair(complex, materials, settings);
  surface_fit::project_to_curves(complex, materials, settings.least);
  return below_goal;
}

namespace {

// Cells of the outside are still there. Tells which have another label now.
std::vector<std::uint8_t> settle_cells(tetmesh::Complex& complex, std::span<const LabelSet> manifold_sets,
                                       std::int64_t crumb_cells) {
  std::vector<std::int32_t> label(complex.label.begin(), complex.label.end());
  repair_labels(complex.nodes_mm, complex.cells, label, manifold_sets, crumb_cells);
  std::vector<std::uint8_t> is_changed(label.size());
  for (std::size_t c = 0; c < label.size(); ++c) {
    is_changed[c] = label[c] != complex.label[c];
    complex.label[c] = static_cast<std::uint8_t>(label[c]);
  }
  tetmesh::derive_touches(complex);
  return is_changed;
}

}  // namespace

bool are_few_below(const tetmesh::Complex& c, double enough, int most) {
  constexpr double min_deg = 26, greatest_deg = 145;
  int below = 0;
  for (std::size_t t = 0; t < c.cells.size(); ++t) {
    const auto& cell = c.cells[t];
    if (cell[0] < 0 || static_cast<double>(c.quality[t]) >= enough) continue;
    const auto range = tetmesh::dihedral_range_deg({c.at(cell[0]), c.at(cell[1]), c.at(cell[2]), c.at(cell[3])});
    if (++below > most || range[0] < min_deg || range[1] > greatest_deg) return false;
  }
  return true;
}

void settle(tetmesh::Complex& complex, std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells) {
  settle_cells(complex, manifold_sets, crumb_cells);
  tetmesh::compress(complex);
}

namespace {

struct Attempt {
  tetmesh::Complex complex;
  std::int64_t below_goal = 0;
  std::int64_t meeting = std::numeric_limits<std::int64_t>::max();  // pairs of outer faces that pass through each other
  double worst = -1;                                                // quality
  bool is_good_enough = false;
  bool is_finished = false;
};

bool is_better(const Attempt& a, const Attempt& b) {
  return a.meeting != b.meeting ? a.meeting < b.meeting : a.worst > b.worst;
}

/// What every attempt at a mesh is told.
struct Task {
  tetmesh::Materials materials;  // with spots where edges as wanted were too long
  stuffing::WantedLevels wanted;
  std::span<const LabelSet> manifold_sets;
  std::int64_t crumb_cells;
  LatticeAims aims;
  tetmesh::RepairSettings repairing;
  StepWatch* watch;
};

std::vector<Vec3> places_of_meeting(const tetmesh::Complex& c) {
  const auto faces = surface_fit::outer_faces(c);
  std::vector<Vec3> places;
  for (const auto& [one, other] : surface_fit::self_intersecting_faces(c.nodes_mm, faces)) {
    const auto& face = faces[static_cast<std::size_t>(one)];
    places.push_back((c.at(face[0]) + c.at(face[1]) + c.at(face[2])) / 3);
  }
  return places;
}

void finish(Attempt& made, const Task& task) {
  auto& c = made.complex;
  const auto& materials = task.materials;
  tetmesh::remesh_worst(c, materials, task.repairing, kept_quality, tetmesh::OnFailure::go_on);
  task.watch->note("polish");
  surface_fit::relax_tangentially(c, materials, task.repairing.least, task.aims.fitted);
  task.watch->note("ease");
  surface_fit::FitSettings fitting;
  fitting.labels = task.aims.fitted;
  surface_fit::fit_surfaces(c, materials, task.repairing, fitting);
  task.watch->note("fit");
  surface_fit::equalize_volumes(c, materials, task.repairing.least);
  task.watch->note("even out");
  made.meeting = surface_fit::resolve_self_intersections(c, task.repairing.least);
  tetmesh::drop_unused(c);
  tetmesh::connect_stars(c);
  task.watch->note("separate");
  made.is_finished = true;
}

// Adds spots where labels do not fit into a lattice; whether there are any. Only its delicate part is stuffed for that.
bool find_spots(Task& task, const stuffing::Lattice& lattice, const stuffing::StuffSettings& stuffing) {
  const auto part = stuffing::under_resolved_part(lattice);
  auto complex = stuffing::stuff_isosurfaces(task.materials, part.lattice, stuffing);
  const auto is_changed = settle_cells(complex, task.manifold_sets, task.crumb_cells);
  auto strays = stuffing::far_mislabelled_cells(complex, task.materials, task.aims.fitted, is_changed);
  std::erase_if(strays, [&](const Vec3& p) { return !stuffing::is_in_core(part, p); });
  return stuffing::add_spots(task.materials, strays, 1);
}

tetmesh::Complex stuff_and_settle(Task& task, double reach) {
  stuffing::StuffSettings stuffing;
  stuffing.edge_reach = reach;
  auto lattice = stuffing::build_background_lattice(task.materials, task.wanted);
  if (task.aims.refines && task.materials.spots.empty()) {
    const bool is_refined = find_spots(task, lattice, stuffing);
    task.watch->note("find spots");
    if (is_refined) lattice = stuffing::build_background_lattice(task.materials, task.wanted);
  }
  auto complex = stuffing::stuff_isosurfaces(task.materials, lattice, stuffing);
  task.watch->note("stuff");
  settle(complex, task.manifold_sets, task.crumb_cells);
  task.watch->note("settle");
  return complex;
}

// Fits only what has no cell that is too bad: else another attempt follows, which may be better. Sheets that meet give
// way more easily before that.
Attempt attempt(Task& task, double reach) {
  const auto& materials = task.materials;
  auto& watch = *task.watch;
  Attempt made{stuff_and_settle(task, reach)};
  made.below_goal = repair_on_curves(made.complex, materials, task.repairing);
  watch.note("repair");
  surface_fit::correct_surface_volumes(made.complex, materials, task.repairing.least);
  watch.note("balance");
  const auto on_failure = task.aims.tolerated > 0 ? tetmesh::OnFailure::go_on : tetmesh::OnFailure::stop;
  tetmesh::remesh_worst(made.complex, materials, task.repairing, task.aims.enough, on_failure);
  made.is_good_enough = are_few_below(made.complex, task.aims.enough, task.aims.tolerated);
  watch.note("rescue");
  made.meeting = surface_fit::resolve_self_intersections_gently(made.complex, task.repairing.least);
  watch.note("separate");
  if (made.is_good_enough) finish(made, task);
  made.worst = tetmesh::worst_quality(made.complex);
  return made;
}

// How far nodes snap decides which configurations arise where several materials meet or the outside is narrow; another
// reach gives other ones. And where sheets meet, edges become shorter.
constexpr std::array reaches{0.5, 0.42, 0.36};

/// Long enough for cells of the edges there.
double stub_length_mm(const Volume<float>& sizes_mm, const std::vector<HeartEnd>& ends) {
  constexpr double edges = 2;
  double longest = 0;
  for (const auto& end : ends) longest = std::max(longest, edge_at(sizes_mm, end.plane.center_mm));
  return edges * longest;
}

tetmesh::LabelBits heart_bits() {
  tetmesh::LabelBits bits = 0;
  for (const auto& row : region_table())
    if (const auto region = static_cast<Region>(row.tag);
        is_label(region) && (is_myocardium(region) || is_blood(region)))
      bits |= tetmesh::bit_of(row.tag);
  return bits;
}

}  // namespace

LabelledCells collect(const tetmesh::Complex& complex, const Grid& grid) {
  LabelledCells result;
  for (const auto& p : complex.nodes_mm) result.nodes_mm.push_back(lps_from_index(grid, index_of(grid, p)));
  result.cells = complex.cells;
  result.label.assign(complex.label.begin(), complex.label.end());
  for (const auto bits : complex.touches) result.is_on_surface.push_back(tetmesh::is_constrained(bits) ? 1 : 0);
  return result;
}

tetmesh::Complex lattice_complex(const tetmesh::Materials& materials, std::span<const LabelSet> manifold_sets,
                                 std::int64_t crumb_cells, LatticeReport* report, const LatticeAims& aims) {
  StepWatch watch{report};
  Task task{materials, stuffing::wanted_levels(materials), manifold_sets, crumb_cells, aims, {}, &watch};
  Attempt best;
  const auto is_enough_with = [&](double reach) {
    auto made = attempt(task, reach);
    if (is_better(made, best)) best = std::move(made);
    return best.meeting == 0 && best.is_good_enough;
  };
  bool is_enough = is_enough_with(reaches[0]);
  auto& spots = task.materials.spots;
  if (!is_enough && !spots.empty()) {  // what shorter edges bring out may be too narrow even for them
    spots.clear();
    task.aims.refines = false;
    is_enough = is_enough_with(reaches[0]);
  }
  for (std::size_t i = 1; i < reaches.size() && !is_enough; ++i) {
    stuffing::add_spots(task.materials, places_of_meeting(best.complex), 2);
    is_enough = is_enough_with(reaches[i]);
  }
  if (!best.is_finished) finish(best, task);
  if (report != nullptr) report->cells_below_goal = best.below_goal;
  return std::move(best.complex);
}

LabelledCells lattice_cells(const MeshDomain& domain, const Volume<float>& sizes_mm,
                            std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells, LatticeReport* report,
                            const std::vector<HeartEnd>& ends) {
  const auto materials = with_ends(domain, materials_of(domain, sizes_mm), ends, stub_length_mm(sizes_mm, ends));
  LatticeAims aims;
  aims.fitted = heart_bits();  // the body's edges are too coarse for its creases
  aims.tolerated = 8;
  auto complex = lattice_complex(materials, manifold_sets, crumb_cells, report, aims);
  flatten_ends(complex, materials, domain, ends);
  return collect(complex, domain.grid);
}

}  // namespace heartgen::mesh
