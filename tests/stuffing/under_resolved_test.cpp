// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/under_resolved.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "generator/stuffing/isosurface_stuffing.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

constexpr Vec3 pocket{0.2, 0.1, -0.3};

// A ball with a pocket that is narrower than cells.
Materials ball_with_pocket() {
  auto m = materials_of(
      {[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return std::min(7 - norm(p), norm(p - pocket) - 0.75); }},
      9, 1);
  m.finest_edge_mm = 1;
  return m;
}

// Label and centre of the cells near the pocket.
std::vector<std::array<double, 4>> cells_at_pocket(const Complex& c) {
  std::vector<std::array<double, 4>> found;
  for (std::size_t i = 0; i < c.cells.size(); ++i) {
    const Cell& cell = c.cells[i];
    const Vec3 center = 0.25 * (c.at(cell[0]) + c.at(cell[1]) + c.at(cell[2]) + c.at(cell[3]));
    if (norm(center - pocket) < 1.5) found.push_back({static_cast<double>(c.label[i]), center.x, center.y, center.z});
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(Delicate, WhatIsStuffedOfAPartIsWhatTheWholeHasThere) {
  const auto m = ball_with_pocket();
  const auto lattice = stuffing::build_background_lattice(m);
  const auto whole = stuffing::stuff_isosurfaces(m, lattice, {});
  const auto part = stuffing::stuff_isosurfaces(m, stuffing::under_resolved_part(lattice).lattice, {});
  EXPECT_LT(2 * part.cells.size(), whole.cells.size());
  EXPECT_GT(cells_at_pocket(part).size(), 50U);
  EXPECT_EQ(cells_at_pocket(part), cells_at_pocket(whole));
}

TEST(Delicate, SmoothSurfacesAreNot) {
  const auto m = ball_with_pocket();
  const auto lattice = stuffing::build_background_lattice(m);
  const auto part = stuffing::under_resolved_part(lattice);
  const auto count = [](const std::vector<std::uint8_t>& is) { return std::count(is.begin(), is.end(), 1); };
  EXPECT_TRUE(stuffing::is_in_core(part, pocket));
  EXPECT_FALSE(stuffing::is_in_core(part, {0, 0, 5}));
  EXPECT_LT(5 * count(part.is_core), count(lattice.near.is_near));
  EXPECT_LT(count(part.is_core), count(part.lattice.near.is_near));
}

}  // namespace
