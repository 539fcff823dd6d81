// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Clean topology for the labels of a tetrahedral mesh: a few cells change their label so that no region is left in
/// crumbs, and chosen sets of regions have manifold boundaries (no edge or vertex where a surface touches itself).
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

/// Labels that count as inside; labels are 0 (outside) to 63.
using LabelSet = std::array<bool, 64>;

/// `cells` fill a convex region around the mesh, with label 0 outside it. First, pieces of a label of at most
/// `crumb_cells` cells that hang together through faces take the label of the neighbour they share most area with.
/// Then, around every vertex where a set of labels or its complement falls apart, the smallest part changes sides.
/// Returns the number of cells that changed. Vertices that resist are left; the certificate counts them.
std::int64_t repair_labels(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                           std::vector<std::int32_t>& label, std::span<const LabelSet> manifold_sets,
                           std::int64_t crumb_cells);

}  // namespace heartgen::mesh
