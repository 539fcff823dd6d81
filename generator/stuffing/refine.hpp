// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Places where the lattice is too coarse for what it is told, and materials that wish shorter edges there.
#pragma once
#include <cstdint>
#include <vector>

#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"

namespace heartgen::stuffing {

/// Whether one of its nodes touches one label only.
bool has_free_node(const tetmesh::Complex& complex, std::int32_t cell);

/// The label at the centre of a cell that has its own nowhere in it; else its own.
int label_if_mislabelled(const tetmesh::Complex& complex, const tetmesh::Materials& materials, std::int32_t cell);

/// Centres (mm) of such cells that have their label nowhere near them either, of those that have, or lie in, one of
/// `labels`: what should be there is narrower than cells. Looks at cells whose label `is_changed` since the stuffing,
/// and at those without a free node: no others can be strays. Needs `touches` to be what the cells make them
/// (derive_touches).
std::vector<Vec3> far_mislabelled_cells(const tetmesh::Complex& complex, const tetmesh::Materials& materials,
                                        tetmesh::LabelBits labels, const std::vector<std::uint8_t>& is_changed);

/// Adds a spot of a few edges around each position, so much finer than it is there already (three halvings at most),
/// but where another one of the kind covers it well. Returns whether there are more spots now; none are added beyond a
/// number at which the whole would have to be finer.
bool add_spots(tetmesh::Materials& materials, const std::vector<Vec3>& positions_mm, int halvings);

}  // namespace heartgen::stuffing
