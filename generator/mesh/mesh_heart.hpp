// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// One conforming tetrahedral mesh of a label map, and the meshes of the bundle cut out of it: the heart inside the
/// torso has the same nodes and cells as the heart alone. Thesis 8.3. Nodes in LPS mm. Not collective: call on one
/// rank.
#pragma once
#include <map>
#include <span>
#include <string>

#include "generator/mesh/lattice_cells.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::mesh {

/// Throws UserError for an unknown back end, edge lengths that are not positive and what else no label map makes good.
void check_settings(const MeshSettings& settings);

/// Meshes every labelled region of `labels`. Each outer boundary face and each interface face is listed once, with its
/// surface; the rims of valve orifices and of the ends of aorta and pulmonary artery are node sets. Regions that the
/// smoothing wipes out (islands of a voxel) have no cells. Throws UserError for an empty label map, an unknown label,
/// and edge lengths that are not positive. `own_edges_mm` is the user's size field: an image of edge lengths, 0 where
/// nothing is wished (own_edges.hpp). `report` is filled by the lattice back end.
TetMesh mesh_labels(const LabelVolume& labels, const MeshSettings& settings, LatticeReport* report = nullptr,
                    const Volume<float>* own_edges_mm = nullptr);

/// The same of a domain that is at hand; its level sets are what the settings ask for. The lattice back end ends
/// vessels at `ends`.
TetMesh mesh_domain(const MeshDomain& domain, const MeshSettings& settings, LatticeReport* report = nullptr,
                    const Volume<float>* own_edges_mm = nullptr, const std::vector<HeartEnd>& ends = {});

/// Walls and blood of a label map, 0 elsewhere.
LabelVolume heart_only(const LabelVolume& labels);

/// The cells of `regions` with the nodes they use, in the order they have in `mesh`; parent_node and parent_cell hold
/// their ids there. Faces between a kept and a dropped region keep their surface. Empty when no cell is kept.
TetMesh extract_regions(const TetMesh& mesh, std::span<const Region> regions);

/// The meshes among "myocardium" (walls and papillary muscles), "chambers" (blood and great vessels) and "torso"
/// (everything) that settings.meshes names, out of one mesh. Without "torso" only the heart is meshed.
/// parent ids point into the torso when it is made, and are empty otherwise. The walls have the chambers' cavities.
/// Throws UserError when the map lacks lv_myocardium, rv_myocardium or lv_blood and these are needed.
std::map<std::string, TetMesh> mesh_heart(const LabelVolume& labels, const MeshSettings& settings,
                                          const Volume<float>* own_edges_mm = nullptr);

}  // namespace heartgen::mesh
