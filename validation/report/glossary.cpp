// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/glossary.hpp"

#include <array>

namespace heartgen::report {
namespace {

struct Term {
  std::string_view name;
  std::string_view meaning;
};

// Without its statistic (see `statistics`); the first that the metric begins with, so longer names come first.
constexpr std::array terms = {
    Term{"affine_misfit",
         "Distance between matching points of atlas and heart after the affine step of the registration."},
    Term{"annulus_cells", "Cells of the layer that does not conduct."},
    Term{"area", "Area of the labelled faces."},
    Term{"atlas_helix", "The helix angle that the atlas itself has there."},
    Term{"axis_error",
         "Angle between the fibre and the reference's fibre; neither has a sign, so 90 degrees is the worst."},
    Term{"boundary_euler_characteristic",
         "Vertices minus edges plus faces of the boundary: 2 for each sphere, 0 for each torus."},
    Term{"boundary_faces_missing", "Outer faces of cells that the mesh does not list with a surface label."},
    Term{"boundary_non_manifold_edges", "Edges that four or more boundary faces share."},
    Term{"boundary_non_manifold_vertices", "Vertices where several sheets of the boundary touch in a point only."},
    Term{"boundary_open_edges", "Edges that an odd number of boundary faces share: the surface has a hole there."},
    Term{"cap_nodes_off_rims", "Nodes of caps that lie on no edge where the wall ends."},
    Term{"caps", "Openings of the chamber, each closed by a cap."},
    Term{"cavities", "Hollows inside a region that nothing connects with its outside."},
    Term{"cell_jump", "Angle between the fibres of neighbouring cells."},
    Term{"cell_volume", "Volume of a tetrahedron."},
    Term{"cells", "Number of tetrahedra."},
    Term{"compared_fraction", "Share of the reference's voxels where both sides have a fibre."},
    Term{"components", "Number of parts that hang together through faces. A whole heart wall is one."},
    Term{"crumbs", "Volume of specks of the label map too small for a mesh."},
    Term{"conducting_faces", "Faces with conducting muscle of an atrium on one side and of a ventricle on the other."},
    Term{"conducting_nodes", "Nodes of conducting muscle of both an atrium and a ventricle."},
    Term{"curve_from_labels", "Distance from where three regions of the label map meet to the mesh's curve there."},
    Term{"curve_from_level_set",
         "Distance from where three regions of the mesher's smoothed domain meet to the mesh's "
         "curve there."},
    Term{"curve_length", "Length of the curve where a labelled surface ends."},
    Term{"curve_to_labels", "Distance from the mesh's curve to where the same regions of the label map meet."},
    Term{"curve_to_level_set",
         "Distance from the mesh's curve to where the same regions of the mesher's smoothed "
         "domain meet."},
    Term{"centroid_shift", "Distance between the centres of the region in the mesh and in the label map."},
    Term{"dice", "Overlap of two regions: twice the common volume over the sum of both; 1 is the same, 0 is apart."},
    Term{"dihedral",
         "Angle between two faces of a tetrahedron. 70.5 degrees in a regular one; small and large ones cost "
         "solvers accuracy and iterations."},
    Term{"duplicate_cells", "Cells with exactly the nodes of another."},
    Term{"duplicate_nodes", "Nodes at exactly the place of another."},
    Term{"edge_distance", "Distance along the normal from the contour to the steepest change of grey value."},
    Term{"edge_found", "Share of the contour where the image has an edge to compare with."},
    Term{"edge", "Length of the edges of tetrahedra."},
    Term{"faces_inside_regions", "Labelled faces with the same region on both sides."},
    Term{"faces_of_more_than_two_cells", "Faces that three or more cells share: the mesh overlaps itself."},
    Term{"faces_repeated", "Labelled faces that are listed more than once."},
    Term{"faces_unlabelled", "Listed faces without a surface label."},
    Term{"faces_without_cells", "Labelled faces that no cell has."},
    Term{"faces", "Number of labelled triangles."},
    Term{"floating_parts", "Parts that nothing joins to the rest."},
    Term{"fov_cut_share", "Share of the body's outside where the image ends, not the skin."},
    Term{"from_level_set",
         "Distance from the mesher's own smoothed domain to the mesh's nearest face: how well the mesher "
         "did what it meant to, not how well the mesh fits the labels."},
    Term{"from_labels",
         "Distance from where the label map changes to the mesh's nearest face between the same regions."},
    Term{"handles", "Tunnels through a region: 0 for a ball, 1 for a ring."},
    Term{"helix_fall", "How far the helix angle falls from the inside of the wall to its outside."},
    Term{"helix",
         "Angle of a fibre in the wall's plane to the circumferential direction; positive where it climbs to "
         "the base counter-clockwise, seen from there. In a left ventricle about +60 degrees inside, -60 "
         "outside."},
    Term{"inpainted_fraction", "Share of the ventricles' nodes whose fibres do not come from the atlas."},
    Term{"interface_faces_missing", "Faces between two regions that the mesh does not list with a surface label."},
    Term{"invalid_ids", "Cells or faces that name a node that does not exist."},
    Term{"inverted_cells", "Cells of zero or negative volume. No solver accepts one."},
    Term{"jacobian", "Local change of volume by the registration; at or below 0 space folds over."},
    Term{"largest_component", "Share of the region that its largest connected part has."},
    Term{"layers_below_two", "Share of the wall's area where a single layer of cells joins its two sides."},
    Term{"layers", "Number of cells across a wall."},
    Term{"locked_cell", "Cells with all four nodes on one surface: where that is held fixed they cannot deform."},
    Term{"missing_regions", "Regions that a heart needs and the label map lacks."},
    Term{"missing_cells", "Cells of muscle without a fibre."},
    Term{"missing_nodes", "Nodes of muscle without a fibre."},
    Term{"missing", "What should be there and is not."},
    Term{"neighbour_jump", "Angle between the fibres of two nodes that an edge joins."},
    Term{"neighbour_turn", "The same per millimetre of the edge."},
    Term{"nodes_without_source", "Nodes of muscle that do not say where their fibre comes from."},
    Term{"nodes", "Number of nodes."},
    Term{"non_orthogonality",
         "Angle between a face's normal and the line that joins the centres of its two cells; what "
         "finite-volume solvers ask for."},
    Term{"non_manifold_edges", "Edges that more than two triangles share."},
    Term{"non_manifold_vertices", "Points in which the surface touches itself."},
    Term{"open_edges", "Edges with a triangle on one side alone."},
    Term{"orphan_nodes", "Nodes that no cell uses."},
    Term{"orthonormality_error", "How far fibre, sheet and sheet normal are from three perpendicular unit axes."},
    Term{"outside_walls", "Share of the region that lies in no cell of the heart's walls."},
    Term{"parts", "Number of parts that hang together. A whole heart wall is one."},
    Term{"pieces", "Number of connected parts of a region."},
    Term{"radius_ratio",
         "Three times the radius of the inscribed over that of the circumscribed sphere: 1 is regular, 0 "
         "is flat."},
    Term{"rule_difference",
         "Angle between the model's fibres and those of rules on the same mesh: how far two methods "
         "disagree."},
    Term{"scaled_jacobian", "Shape of a tetrahedron at its worst corner: 1 at best, 0 flat, negative inverted."},
    Term{"second_method_difference",
         "Angle between the fibres and those that the second way to carry the atlas gives."},
    Term{"self_intersections", "Pairs of boundary faces that cut each other."},
    Term{"septum_junction_turn", "Turn of the fibres per millimetre where the ventricles meet."},
    Term{"shared_faces", "Faces between muscle of an atrium and of a ventricle."},
    Term{"shared_nodes", "Nodes of muscle of both an atrium and a ventricle."},
    Term{"skewness", "How far from its centre a face is met by the line that joins the centres of its two cells."},
    Term{"surface_distance", "Distance between the surfaces of a region and of its reference."},
    Term{"to_level_set", "Distance from the mesh's faces to the mesher's own smoothed domain."},
    Term{"to_labels", "Distance from the mesh's faces to where the label map changes between the same regions."},
    Term{"tagged_difference", "Volume of the cells that count for the region against that of the region itself."},
    Term{"turned_edges", "Edges at which the two sides of the surface are exchanged."},
    Term{"turn_per_wall", "Turn of the fibres along an edge, per thickness of the wall."},
    Term{"volume_difference", "Volume of the mesh's region against the label map's."},
    Term{"volume", "Volume of the region."},
    Term{"wall_overlap_dice", "Overlap of the heart's walls with the atlas's after registration; 1 is the same."},
    Term{"wall_thickness", "Thickness of the wall, across it."},
};

constexpr std::array statistics = {
    Term{"_in_edges", "In units of the edges there."},
    Term{"_voxels", "In units of the voxel."},
    Term{"_of_labels", "Of the label map."},
    Term{"_added", "What the mesh has and the label map has not."},
    Term{"_lost", "What the label map has and the mesh has not."},
    Term{"_off_atlas", "Against what the atlas itself has."},
    Term{"_at_same_places", "At the places that the fibres were carried from."},
    Term{"_max", "The largest of all."},
    Term{"_min", "The smallest of all."},
    Term{"_mean", "The mean of all."},
    Term{"_rms", "Root mean square."},
    Term{"_median", "Half of all are smaller."},
    Term{"_p50", "Half of all are smaller."},
    Term{"_p05", "5 % of all are smaller."},
    Term{"_p5", "5 % of all are smaller."},
    Term{"_p95", "95 % of all are smaller."},
    Term{"_p99", "99 % of all are smaller."},
    Term{"_p01", "1 % of all are smaller."},
    Term{"_p1", "1 % of all are smaller."},
    Term{"endocardium", "At the inside of the wall."},
    Term{"midwall", "In the middle of the wall."},
    Term{"epicardium", "At the outside of the wall."},
};

}  // namespace

std::string meaning_of(std::string_view metric) {
  for (const Term& term : terms) {
    if (!metric.starts_with(term.name)) continue;
    std::string text(term.meaning);
    const std::string_view rest = metric.substr(term.name.size());
    for (const Term& statistic : statistics) {
      const auto at = rest.find(statistic.name);
      if (at == std::string_view::npos) continue;
      const auto end = at + statistic.name.size();
      if (end == rest.size() || rest[end] == '_') (text += ' ') += statistic.meaning;
    }
    return text;
  }
  return {};
}

}  // namespace heartgen::report
