// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Which parts of space some boxes may lie in.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "generator/tetmesh/box.hpp"

namespace heartgen::surface_fit {

/// Cubes of a coarse grid that some boxes meet, so that what meets none of them is told at a glance.
class MarkedCubes {
 public:
  explicit MarkedCubes(std::span<const tetmesh::Box> boxes);
  bool may_meet(const tetmesh::Box& box) const;

 private:
  static constexpr std::size_t side = 64;
  using Range = std::array<std::array<std::size_t, 2>, 3>;  // first and last cube along each axis
  Range range_of(const tetmesh::Box& box) const;
  template <class Visit>
  void for_cubes(const tetmesh::Box& box, const Visit& visit) const;

  tetmesh::Box all_;
  Vec3 per_mm_;  // cubes
  std::vector<std::uint8_t> marked_;
};

}  // namespace heartgen::surface_fit
