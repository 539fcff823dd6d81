// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The cells around an edge.
#pragma once
#include <array>
#include <cstdint>

#include "generator/tetmesh/complex.hpp"

namespace heartgen::tetmesh {

constexpr std::size_t longest_ring = 10;

/// Cell i lies between nodes i and i + 1, counter-clockwise seen from b. A closed ring ends with its first node again;
/// an open one lies on the outer surface. A ring with several labels starts where one of them starts.
struct Ring {
  std::size_t size = 0;  ///< cells; 0: the ring is too long or broken
  bool is_open = false;
  std::array<std::int32_t, longest_ring> cells;
  std::array<std::int32_t, longest_ring + 1> nodes;
  std::array<std::size_t, 4> arcs{};  ///< first cells of the runs of one label
  std::size_t arc_count = 0;          ///< counts up to 3 only: then nothing can be exchanged
};

Ring ring_around(const Complex& complex, std::int32_t a, std::int32_t b);

}  // namespace heartgen::tetmesh
