// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What can be tried with a face that does not fit its surface.
#pragma once
#include <cstdint>

#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"

namespace heartgen::surface_fit {

/// One way of several, from 0 on: an edge of the face shrinks to a node, the longest edge gets a node in its middle,
/// the second, the third, the face itself gets one; then the same again and again, a little shaken up, with a seed. The
/// topology stays; cells may be bad afterwards, and nothing may have changed.
void change_face(tetmesh::Complex& part, const tetmesh::Materials& materials, const Face& face, int way,
                 std::uint32_t seed);

/// Whether that is a way by which an edge shrinks.
bool takes_node_away(int way);

}  // namespace heartgen::surface_fit
