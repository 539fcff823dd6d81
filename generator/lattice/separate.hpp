// Where the outside is narrow, two sheets of the outer surface can pass through each other: no cell lies between them
// that would turn over. Every cell is sound then, but the mesh overlaps itself.
#pragma once
#include <cstdint>

#include "generator/lattice/complex.hpp"
#include "generator/lattice/materials.hpp"

namespace heart::lattice {

/// Looks at the outer faces before which the outside is narrower than an edge. Draws outer faces that meet others
/// without sharing what they meet in back into the mesh, where no cell falls below `least_quality` or, if it is below
/// already, gets worse. Returns how many pairs of faces still meet. The same result for any number of threads.
std::int64_t separate_sheets(Complex& complex, const Materials& materials, double least_quality);

}  // namespace heart::lattice
