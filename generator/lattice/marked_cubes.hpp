// Which parts of space some boxes may lie in.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "generator/lattice/box.hpp"

namespace heart::lattice {

/// Cubes of a coarse grid that some boxes meet, so that what meets none of them is told at a glance.
class MarkedCubes {
 public:
  explicit MarkedCubes(std::span<const Box> boxes);
  bool may_meet(const Box& box) const;

 private:
  static constexpr std::size_t side = 64;
  using Range = std::array<std::array<std::size_t, 2>, 3>;  // first and last cube along each axis
  Range range_of(const Box& box) const;
  template <class Visit>
  void for_cubes(const Box& box, const Visit& visit) const;

  Box all_;
  Vec3 per_mm_;  // cubes
  std::vector<std::uint8_t> marked_;
};

}  // namespace heart::lattice
