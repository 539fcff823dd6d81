// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "validation/criteria_tables.hpp"

namespace heartgen::validation {
namespace {

constexpr const char* broken = "Every solver needs a mesh without this defect.";
constexpr const char* from_angles = "It follows from the dihedral angles, which are judged.";
constexpr const char* as_asked = "The recipe asks for the size of cells; what is fine enough depends on the use.";

/// What no mesh may have, anywhere.
constexpr const char* defects[] = {"invalid_ids",
                                   "inverted_cells",
                                   "orphan_nodes",
                                   "duplicate_nodes",
                                   "duplicate_cells",
                                   "boundary_open_edges",
                                   "boundary_faces_missing",
                                   "interface_faces_missing",
                                   "faces_repeated",
                                   "faces_without_cells",
                                   "faces_inside_regions",
                                   "faces_unlabelled",
                                   "self_intersections",
                                   "faces_of_more_than_two_cells"};

std::string angle_reason(const ValidationSettings& settings) {
  if (settings.minimum_dihedral_deg > 0)
    return fmt::format("The recipe or its mesher promises {:g} to {:g} degrees.", settings.minimum_dihedral_deg,
                       settings.maximum_dihedral_deg);
  return "Cells with small angles make stiffness matrices ill-conditioned, and with large ones they also interpolate "
         "badly (Shewchuk 2002); 5 and 175 degrees are our bounds.";
}

/// A bound of 0 stands for what no mesher may break.
double min_dihedral(const ValidationSettings& s) { return s.minimum_dihedral_deg > 0 ? s.minimum_dihedral_deg : 5; }
double max_dihedral(const ValidationSettings& s) { return s.maximum_dihedral_deg > 0 ? s.maximum_dihedral_deg : 175; }

}  // namespace

std::vector<Criterion> mesh_criteria(const ValidationSettings& settings) {
  std::vector<Criterion> rows;
  const auto add = [&](Where where, const char* metric, Bounds bounds, std::string reason) {
    rows.push_back({"mesh", where, "*", metric, bounds, std::move(reason)});
  };
  for (const char* defect : defects) add(Where::anywhere, defect, zero(), broken);
  add(Where::whole_mesh, "boundary_non_manifold_*", zero(), broken);
  add(Where::anywhere, "boundary_non_manifold_*", told(), "Regions of one mesh may touch along edges.");
  add(Where::anywhere, "boundary_euler_characteristic", told(), "Vessels and valves open a heart's surface.");
  add(Where::whole_mesh, "cells", at_least(1), broken);
  add(Where::whole_mesh, "floating_parts", zero(),
      "A part that shares no node with the rest and holds under a twentieth of the volume has no support in mechanics "
      "and never fires in an activation.");
  add(Where::anywhere, "parts", told(), "Left and right heart may be parts of their own.");
  add(Where::anywhere, "components", told(), "Parts that share no node at all are judged as floating parts.");
  add(Where::anywhere, "dihedral_min", at_least(min_dihedral(settings)), angle_reason(settings));
  add(Where::anywhere, "dihedral_max", at_most(max_dihedral(settings)), angle_reason(settings));
  for (const char* metric : {"dihedral_p*", "radius_ratio_*", "scaled_jacobian_*"})
    add(Where::anywhere, metric, told(), from_angles);
  add(Where::anywhere, "non_orthogonality_max", {{}, {}, 70.0, 89.0},
      "OpenFOAM's checkMesh calls faces beyond 70 degrees severely non-orthogonal.");
  add(Where::anywhere, "skewness_max", {{}, {}, 4.0, 20.0},
      "OpenFOAM's checkMesh reports faces beyond a skewness of 4.");
  for (const char* metric : {"non_orthogonality_mean", "skewness_mean"})
    add(Where::anywhere, metric, told(), "The worst face is what stops a finite-volume solver.");
  constexpr const char* locked =
      "A cell with all four nodes on one surface locks in mechanics and has no gradient in a Laplace problem.";
  for (const char* surface : {"*myocardium*/*_endocardium", "*myocardium*/epicardium", "chambers/*_endocardium"})
    rows.push_back({"mesh", Where::anywhere, surface, "locked_cell_share", {{}, {}, 0.01, 0.05}, locked});
  add(Where::anywhere, "locked_cell*", told(), "Their share is judged on the heart's own surfaces.");
  add(Where::anywhere, "layers_below_two", told(), "Whether one layer of cells is enough depends on the use.");
  add(Where::anywhere, "fov_cut_share", {{}, {}, 0.6, {}},
      "Where the image ends there is no skin: currents cannot flow on, and surface potentials are distorted.");
  for (const char* metric : {"nodes", "cells", "faces", "edge_*", "cell_volume_min", "layers_*"})
    add(Where::anywhere, metric, told(), as_asked);
  add(Where::anywhere, "volume", told(), "Volumes are judged against the label map and against published hearts.");
  add(Where::anywhere, "area", told(), "Areas of orifices are judged against published hearts.");
  return rows;
}

std::vector<Criterion> label_criteria(const ValidationSettings& settings) {
  std::vector<Criterion> rows;
  const auto add = [&](Where where, const char* scope, const char* metric, Bounds bounds, std::string reason) {
    rows.push_back({"mesh", where, scope, metric, bounds, std::move(reason)});
  };
  constexpr const char* coarse = "Around the heart the mesh is as coarse as the recipe asks.";
  constexpr const char* of_mesher =
      "It tells how well the mesher meets its own smoothed surface, not how far that is from the labels.";
  constexpr const char* same_place = "The mesh must hold the voxels of its label map.";
  constexpr const char* same_volume = "Smoothing must not make a region thinner or thicker.";
  constexpr const char* same_shape = "Pieces, holes and voids that the label map lacks are made by meshing alone.";
  add(Where::anywhere, "*", "*level_set*", told(), of_mesher);
  add(Where::outside_heart, "*", "*", told(), coarse);
  add(Where::anywhere, "*/papillary", "dice_with_labels", {0.6, 0.75, {}, {}}, same_place);
  add(Where::anywhere, "*/papillary", "volume_difference", between(-30, -15, 15, 30), same_volume);
  for (const char* vessel : {"*/aorta", "*/pulmonary_artery"}) {  // stumps: their ends are cut level, branches go
    add(Where::anywhere, vessel, "dice_with_labels", {0.7, 0.9, {}, {}}, same_place);
    add(Where::anywhere, vessel, "volume_difference", between(-30, -8, 8, 30), same_volume);
  }
  add(Where::wall, "*", "dice_with_labels", {0.8, 0.88, {}, {}}, same_place);
  add(Where::blood, "*", "dice_with_labels", {0.9, 0.94, {}, {}}, same_place);
  add(Where::wall, "*", "volume_difference", between(-12, -6, 6, 12), same_volume);
  add(Where::blood, "*", "volume_difference", between(-6, -3, 3, 6), same_volume);
  for (const char* part : {"*/papillary", "*/aorta", "*/pulmonary_artery"})  // strands, and stumps that are cut level
    add(Where::anywhere, part, "centroid_shift", warn_above(1), same_place);
  // Thin shells: coarse voxels and edges move their middles more.
  for (const char* part : {"*/la_wall", "*/ra_wall", "*/rv_myocardium"})
    add(Where::anywhere, part, "centroid_shift", {{}, {}, 0.6, 1.5}, same_place);
  add(Where::heart, "*", "centroid_shift", {{}, {}, 0.3, 0.6}, same_place);
  const double max_edges = settings.maximum_surface_distance;
  add(Where::heart, "*", "from_labels_p99_in_edges", {{}, {}, max_edges, 2 * max_edges},
      "A surface of the label map farther than an edge from the mesh's is lost, but for the steps of coarse voxels.");
  for (const char* metric : {"pieces_added", "pieces_lost"}) add(Where::heart, "*", metric, zero(), same_shape);
  add(Where::heart, "*", "handles_added", at_most(settings.maximum_handles_added), same_shape);
  add(Where::heart, "*", "cavities_added", warn_above(0), same_shape);
  for (const char* metric : {"volume_of_labels", "crumbs_of_labels", "pieces*", "handles*", "cavities*"})
    add(Where::anywhere, "*", metric, told(), "What the mesh makes of it is judged.");
  for (const char* metric : {"to_labels*", "from_labels*"})
    add(Where::anywhere, "*", metric, told(), "Voxels are steps: single distances tell less than volumes and Dice.");
  add(Where::anywhere, "*", "curve_*", told(), "Curves are as long as the heart has them.");
  return rows;
}

}  // namespace heartgen::validation
