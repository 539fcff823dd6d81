// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fewer and more nodes: edges shrink to a node, or get a node in the middle.
#pragma once
#include <cstdint>

#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/flips.hpp"
#include "generator/tetmesh/materials.hpp"

namespace heartgen::tetmesh {

/// Merges `gone` into `kept` where this raises the worst cell around `gone`, keeps the topology of all regions,
/// surfaces and curves, and leaves surfaces within the tolerance. `gone` must touch no label that `kept` does not.
bool collapse_edge(Complex& complex, const Materials& materials, std::int32_t kept, std::int32_t gone,
                   const SurfaceTolerance& tolerance);

/// Merges `gone` into `kept` wherever that keeps the topology and leaves sound cells, whatever becomes of their quality
/// and of surfaces.
bool shrink_edge(Complex& complex, const Materials& materials, std::int32_t kept, std::int32_t gone);

/// Puts a node on the edge, at the place of its surfaces near the middle. Returns the node, or -1 where the edge has to
/// stay or its cells cannot be told.
std::int32_t bisect_edge(Complex& complex, const Materials& materials, std::int32_t a, std::int32_t b);

/// Puts a node in a face between two labels, or a label and the outside: on its surface, where the normal at the face's
/// middle meets it. That finds the bottom of a crease, which lies beyond the middles of edges. Returns the node, or -1
/// where the surface is not near or the face has frozen nodes only.
std::int32_t split_face(Complex& complex, const Materials& materials, const Face& face);

/// Puts a node on the edge and moves it; undone where the cells around do not get better.
bool split_edge(Complex& complex, const Materials& materials, std::int32_t a, std::int32_t b, double goal,
                const SurfaceTolerance& tolerance);

}  // namespace heartgen::tetmesh
