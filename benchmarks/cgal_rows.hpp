// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// CGAL's Mesh_3 on the domain that the lattice mesher has just meshed.
#pragma once
#include <string>

#include "benchmarks/measure.hpp"
#include "generator/adapters/cgal_mesher.hpp"

namespace heartgen::benchmarks {

/// Meshes the domain with refinement, perturbation and exudation; adds speed and angles to the table.
void add_cgal_rows(Table& table, const char* bench, const adapters::ImplicitDomain& domain, const std::string& note,
                   double our_cells_per_second);

}  // namespace heartgen::benchmarks
