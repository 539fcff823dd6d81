// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/surface_fit/feature_projection.hpp"

#include <bit>

#include "generator/tetmesh/feature.hpp"
#include "model/contract.hpp"

namespace heartgen::surface_fit {

void project_to_curves(tetmesh::Complex& complex, const tetmesh::Materials& materials, double min_quality) {
  HEARTGEN_INVARIANT(tetmesh::touches_hold_labels(complex));
  constexpr int rounds = 3;  // nodes make room for each other
  constexpr int newton_steps = 5, tries = 4;
  constexpr double near = 0.02, far = 0.7;  // of the lattice's width: there already, and another curve
  for (int round = 0; round < rounds; ++round)
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(complex.nodes_mm.size()); ++n) {
      if (std::popcount(complex.bits(n) & ~tetmesh::side_bits) < 3 || complex.is_frozen(n) || complex.star(n).empty())
        continue;
      const Vec3 way = tetmesh::project(materials, complex.bits(n), complex.at(n), newton_steps) - complex.at(n);
      const double share = norm(way) / static_cast<double>(complex.spacing_mm[static_cast<std::size_t>(n)]);
      if (share > near && share < far) tetmesh::shift_node(complex, n, way, tries, min_quality);
    }
}

}  // namespace heartgen::surface_fit
