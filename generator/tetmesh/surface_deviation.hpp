// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How far faces are from their surfaces: which are misfits, and how badly a part of a mesh fits.
#pragma once
#include <array>
#include <vector>

#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"
#include "generator/tetmesh/surface_faces.hpp"

namespace heartgen::tetmesh {

Face sorted(Face face);  ///< nodes ascending

/// Those of some faces on surfaces of these labels that are farther off than `aim` (of their mean edges), nodes
/// ascending; the worst face first.
std::vector<Face> deviating_faces(const Complex& complex, const Materials& materials, double aim, LabelBits labels,
                                  const std::vector<SurfaceFace>& faces);

/// Whether a face's centre is within `limit` (of its mean edges) of its surface and of the regions on its two sides,
/// which `labels` are.
bool fits(const Materials& materials, LabelBits labels, const std::array<Vec3, 3>& corners, double limit);

/// Whether a face at `node` that fits would not do so with the node at `position`. Faces at `merged`, if that is a
/// node, are gone then.
bool makes_face_deviate(const Complex& complex, const Materials& materials, std::int32_t node, const Vec3& position,
                        std::int32_t merged, double limit);

/// How a part fits its surfaces.
struct Fitness {
  Face worst{-1, -1, -1};
  double error = 0;         ///< of the worst face
  double penalty = 0;       ///< sum of the squares of what errors have beyond the aim
  int deviating_faces = 0;  ///< faces beyond it
};

/// Of the faces of a part that can change. (Those where it was cut out have frozen nodes only, and no cell beyond.)
Fitness fitness_of(const Complex& part, const Materials& materials, double aim, LabelBits labels);

}  // namespace heartgen::tetmesh
