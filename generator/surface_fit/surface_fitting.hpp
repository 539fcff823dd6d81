// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Faces that leave their surface: where a surface has a crease or a bend narrower than an edge, all nodes of a face
/// can lie on it while its middle does not; and nodes can be off the curve where their regions meet, or on a tail
/// beyond the end of their region. Such places are divided and repaired apart from the rest, in several ways, and the
/// best outcome is put back.
#pragma once
#include <cstdint>

#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"
#include "generator/tetmesh/repair.hpp"

namespace heartgen::surface_fit {

struct FitSettings {
  double aim = 0.29;       ///< distance of a face's centre and nodes from their surfaces and regions, in its edges
  double enough = 0.5116;  ///< quality that the cells at such places must keep
  tetmesh::LabelBits labels = ~0U;  ///< only surfaces of these
  double max_work = 0.3;  ///< cells repaired at all places and tries together, over the mesh's cells (or 1.5 million),
                          ///< about: the worst faces come first, what is left then stays as it is
};

/// Needs `touches` to be what the cells make them (derive_touches). No cell ends below `enough`, or below the worst one
/// of its place if that was below already. Returns at how many places a face stays beyond the aim. The same result for
/// any number of threads.
std::int64_t fit_surfaces(tetmesh::Complex& complex, const tetmesh::Materials& materials,
                          const tetmesh::RepairSettings& repairing, const FitSettings& settings);

}  // namespace heartgen::surface_fit
