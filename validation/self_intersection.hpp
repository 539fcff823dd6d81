// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Triangles that cross, touch or lie on one another although they should not. Decided exactly.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::validation {

/// Pairs of faces, ascending, that have more in common than the nodes that they share. Faces without area count as
/// their edges do; the same face listed twice is no pair. About 1 microsecond a face.
std::vector<std::pair<std::int32_t, std::int32_t>> intersecting_faces(const std::vector<Vec3>& nodes_mm,
                                                                      const std::vector<Face>& faces);

}  // namespace heartgen::validation
