// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Meshes of label maps. Not collective; everything throws UserError. The same label map and settings give the same
/// bits, for any number of threads.
#pragma once
#include "generator/mesh/slice_mesh.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen {

using mesh::mesh_slice;
using mesh::slice_at_height;
using mesh::SliceReport;
using mesh::SliceSettings;

/// One conforming mesh of every labelled region (tags 1 to 17 of model/labels.hpp), nodes in LPS mm. Each face of the
/// outer boundary and between regions is listed once, with its surface; rims of orifices are sets of nodes. Refuses
/// settings out of range, an empty map, unknown labels and what needs more memory than this machine has.
/// `own_edges_mm`: an image of wanted edge lengths, 0 where nothing is wished.
TetMesh mesh_labels(const LabelVolume& labels, const MeshSettings& settings = {},
                    const Volume<float>* own_edges_mm = nullptr);

/// The walls of the heart alone, with rounded rims: half the time, no blood.
TetMesh mesh_walls(const LabelVolume& labels, const MeshSettings& settings = {},
                   const Volume<float>* own_edges_mm = nullptr);

}  // namespace heartgen
