// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A few cells cut out of a complex, to be worked on apart from the rest and put back.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "generator/tetmesh/complex.hpp"

namespace heartgen::tetmesh {

/// Some cells of a complex as a complex of their own, whose outer nodes are frozen.
struct Cavity {
  std::vector<std::int32_t> cells, nodes;  ///< ids in the whole, ascending; node n of the part is nodes[n]
  Complex part;
};

/// The cells that can be reached from a cell in so many steps over shared nodes, ascending; none where one of their
/// nodes is taken (by node; empty: no node is).
std::vector<std::int32_t> free_cells_around(const Complex& complex, std::int32_t cell, int rings,
                                            std::span<const std::uint8_t> is_taken = {});

/// Their nodes, ascending.
std::vector<std::int32_t> nodes_of(const Complex& complex, std::span<const std::int32_t> cells);

/// Some cells, ascending, as a place. Needs `touches` to be what the cells make them (derive_touches).
Cavity extract_cavity(const Complex& complex, std::vector<std::int32_t> cells);

/// All cells around a cell as a place.
Cavity cavity_around(const Complex& complex, std::int32_t cell, int rings);

/// Puts a changed copy of the part into the whole. Its frozen nodes have not moved.
void reinsert_cavity(Complex& complex, Cavity& place, const Complex& changed);

/// Moves every node of a part that may move by up to about `amplitude` (of the lattice's width), where no cell becomes
/// hopeless. Another seed, other ways.
void perturb(Complex& part, const Materials& materials, double amplitude, std::uint32_t seed);

double worst_quality(const Complex& complex);

}  // namespace heartgen::tetmesh
