// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The faces of the image: where the field of view cuts the body flat.
///
/// The label map is continued beyond its border by a layer with labels of its own (region + beyond_border), which is
/// meshed and then dropped: the border becomes an interface like any other.
#pragma once
#include <cstdint>
#include <vector>

#include "generator/mesh/curves.hpp"
#include "generator/mesh/domain.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

constexpr std::int32_t beyond_border = 32;  ///< added to a region's tag in the layer around the image

/// How far (mm) a continuous index lies beyond the outer faces of the border voxels; at most 0 inside.
double beyond_border_mm(const Grid& grid, const Vec3& index);

/// Samples of the curves where surfaces meet the planes of the image border, and of the border's own edges inside the
/// body. The spacing is 0.8 of the local edge, and less around small sections.
std::vector<CurvePoint> border_curves(const MeshDomain& domain, const Volume<float>& sizes);

/// Points on the far side of the layer, about `apart_mm` from each other: first vertices, without which refinement
/// might never see the layer.
std::vector<Vec3> border_layer_points(const MeshDomain& domain, double layer_mm, double apart_mm);

/// Moves vertices of kept cells that lie beyond the border, or on a face against the layer but off the border's plane,
/// onto the plane, where this leaves every kept cell around them valid and no worse than 8 degrees or than before.
/// Returns how many stay off.
std::int64_t flatten_border(const Grid& grid, std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                            const std::vector<std::int32_t>& label);

/// What a surface is called in a plane of the border: walls of arteries their ends, all others fov_cut.
std::int32_t surface_at_border(std::int32_t surface);

/// Gives outer faces that lie in a plane of the border the surfaces that they have there.
void label_border_faces(TetMesh& mesh, const Grid& grid);

}  // namespace heartgen::mesh
