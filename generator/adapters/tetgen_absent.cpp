// SPDX-License-Identifier: GPL-3.0-or-later
// Stands in for tetgen_mesher.cpp in a program built without TetGen.
#include "generator/adapters/tetgen_mesher.hpp"
#include "model/error.hpp"

namespace heartgen::adapters {

bool has_tetgen() { return false; }

LabelledCells fill_surfaces(const SurfaceComplex& /*surfaces*/, const std::function<double(const Vec3&)>& /*edge_mm*/,
                            const FillSettings& /*settings*/) {
  throw UserError("built without TetGen", "recipe, [mesh], backend = \"tetgen\"",
                  "configure with cmake -DHEARTGEN_TETGEN=ON (the program is then under the AGPL), or use \"lattice\"");
}

}  // namespace heartgen::adapters
