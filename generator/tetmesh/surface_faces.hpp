// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The faces on which surfaces end up.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "generator/tetmesh/complex.hpp"

namespace heartgen::tetmesh {

/// A face between cells of two labels, or between a cell and the outside.
struct SurfaceFace {
  Face nodes;
  LabelBits labels = 0;  ///< on its two sides
};

/// All of them but those in the sides of the box, in the order of the cells.
std::vector<SurfaceFace> surface_faces(const Complex& complex);

/// Those at a node.
std::vector<SurfaceFace> surface_faces_at(const Complex& complex, std::int32_t node);

/// Makes such a list right again after the cells around some nodes have changed: faces at these nodes, new ones
/// included, come last. No other cells may have changed.
void renew_faces(std::vector<SurfaceFace>& faces, const Complex& complex, std::span<const std::int32_t> nodes);

}  // namespace heartgen::tetmesh
