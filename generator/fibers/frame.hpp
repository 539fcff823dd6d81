// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Orthonormal material axes from a fibre axis and the wall's normal, on nodes and on cells.
#pragma once
#include <vector>

#include "model/axis_tensor.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::fibers {

struct MaterialAxes {
  Vec3 fiber, sheet, sheet_normal;
};

/// fiber: the axis itself; sheet: the transmural direction made orthogonal to it (any orthogonal one where the two are
/// parallel); sheet_normal = fiber × sheet. Unit and orthogonal to rounding. `fiber` must not be zero.
MaterialAxes material_axes(const Vec3& fiber, const Vec3& transmural);

/// One frame per node.
FiberField node_frames(const std::vector<Vec3>& fiber, const std::vector<Vec3>& transmural);

/// One frame per cell: means of its nodes' fibre and sheet axes (as dyads, so that signs do not matter), made
/// orthogonal again.
FiberField cell_frames(const TetMesh& mesh, const FiberField& node);

}  // namespace heartgen::fibers
