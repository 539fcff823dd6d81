// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Exchanges of cells that fill the same space: an edge or a face disappears, others appear. Freitag and
/// Ollivier-Gooch 1997; Shewchuk 2002; edges on interfaces and on the outer surface are exchanged too, where the new
/// faces stay on the surface. An exchange is made only where it raises the worst cell concerned.
#pragma once
#include <cstdint>

#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"
#include "generator/tetmesh/surface_tolerance.hpp"

namespace heartgen::tetmesh {

bool remove_edge(Complex& complex, const Materials& materials, std::int32_t a, std::int32_t b,
                 const SurfaceTolerance& tolerance);

/// Two cells at the face opposite to `corner` (0 to 3) become three.
bool remove_face(Complex& complex, std::int32_t cell, std::size_t corner);

/// A cell without a frozen node takes a label of its neighbours, where no set of materials changes its topology; for
/// label 0 it is removed.
bool relabel(Complex& complex, std::int32_t cell, int label);

/// A cell at the thin tip or edge of a material takes the label of a neighbour, where no set of materials changes its
/// topology. Nothing moves; but surfaces meet less sharply there, and the nodes are freer afterwards.
bool relabel_spike(Complex& complex, std::int32_t cell);

}  // namespace heartgen::tetmesh
