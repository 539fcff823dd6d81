// The faces on which surfaces end up.
#pragma once
#include <vector>

#include "generator/lattice/complex.hpp"

namespace heart::lattice {

/// A face between cells of two labels, or between a cell and the outside.
struct SurfaceFace {
  Face nodes;
  LabelBits labels = 0;  ///< on its two sides
};

/// All of them but those in the sides of the box, in the order of the cells.
std::vector<SurfaceFace> surface_faces(const Complex& complex);

}  // namespace heart::lattice
