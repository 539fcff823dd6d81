// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/quality.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace {

using namespace heartgen;
using Corners = std::array<Vec3, 4>;

constexpr double deg = 180 / std::numbers::pi;

void expect_range(const Corners& corners, double least, double greatest) {
  Corners p = corners;
  for (int turn = 0; turn < 4; ++turn, std::rotate(p.begin(), p.begin() + 1, p.end())) {  // both orientations
    const auto range = tetmesh::dihedral_range_deg(p);
    EXPECT_NEAR(range[0], least, 1e-9);
    EXPECT_NEAR(range[1], greatest, 1e-9);
  }
}

TEST(DihedralRange, OfCellsKnownInClosedForm) {
  const double regular = std::acos(1.0 / 3) * deg;
  expect_range({Vec3{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, regular, regular);
  expect_range({Vec3{}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, std::acos(1 / std::sqrt(3.0)) * deg, 90);
}

TEST(DihedralRange, OfAFlatCell) { expect_range({Vec3{}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 0, 180); }

}  // namespace
