// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A last means for the few cells that repair leaves too bad: the places around them are repaired apart from the rest
/// in several ways, an edge divided or the nodes shaken up before, and the best outcome is put back.
#pragma once
#include <cstdint>

#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"
#include "generator/tetmesh/repair.hpp"

namespace heartgen::tetmesh {

/// What to do where a cell cannot be raised far enough: the whole is then as good as its worst cell whatever the others
/// do, so that a mesh which can be made in another way need not be mended any further.
enum class OnFailure { stop, go_on };

/// Works on the cells below `enough`, the worst first. What they end with is never worse. None where there are too many
/// of them. Returns how many are left. Needs `touches` to be what the cells make them (derive_touches). The same result
/// for any number of threads.
std::int64_t remesh_worst(Complex& complex, const Materials& materials, const RepairSettings& settings, double enough,
                          OnFailure on_failure);

}  // namespace heartgen::tetmesh
