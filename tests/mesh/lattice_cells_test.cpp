// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/lattice_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "generator/surface_fit/self_intersections.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

Complex mesh_solid(const std::function<double(const Vec3&)>& inside, double half_mm, double edge_mm) {
  auto m = materials_of({[](const Vec3&) { return 0.0; }, inside}, half_mm, edge_mm);
  m.finest_edge_mm = edge_mm;
  mesh::LabelSet solid{};
  solid[1] = true;
  return mesh::lattice_complex(m, std::span(&solid, 1), 30, nullptr, mesh::one_material);
}

// As cells of the wanted edge it would be a crumb, and go.
TEST(LatticeCells, APocketNarrowerThanCellsIsKeptByShorterEdges) {
  const Vec3 pocket{0.2, 0.1, -0.3};
  const double radius = 0.75;
  const auto c = mesh_solid([&](const Vec3& p) { return std::min(5 - norm(p), norm(p - pocket) - radius); }, 7, 1);
  int faces = 0;
  for (const auto& face : surface_fit::outer_faces(c))
    for (const auto n : face)
      if (norm(c.at(n) - pocket) < 2) {
        ++faces;
        EXPECT_NEAR(norm(c.at(n) - pocket), radius, 0.1);
      }
  EXPECT_GT(faces, 100);
  EXPECT_NEAR(volume_of(c, 1), 4 * std::numbers::pi / 3 * (125 - radius * radius * radius), 4);
}

TEST(LatticeCells, WhatFitsIntoTheLatticeKeepsItsEdges) {
  const auto c = mesh_solid([](const Vec3& p) { return 5 - norm(p); }, 7, 1);
  const auto narrowest = *std::min_element(c.spacing_mm.begin(), c.spacing_mm.end());
  const auto widest = *std::max_element(c.spacing_mm.begin(), c.spacing_mm.end());
  EXPECT_GT(narrowest, 0.9F * widest);
}

/// Cells apart from each other, in each of which two faces meet at one of the angles.
Complex cells_with(const std::vector<double>& angles_deg) {
  Complex c;
  for (const double angle_deg : angles_deg) {
    const auto first = static_cast<std::int32_t>(c.nodes_mm.size());
    const double x = 10.0 * static_cast<double>(c.cells.size()), height = 0.8,
                 angle = angle_deg * std::numbers::pi / 180;
    c.nodes_mm.insert(
        c.nodes_mm.end(),
        {{x, 0.5, 0}, {x, -0.5, 0}, {x + height, 0, 0}, {x + height * std::cos(angle), 0, height * std::sin(angle)}});
    c.cells.push_back({first, first + 1, first + 2, first + 3});
  }
  c.touches.assign(c.nodes_mm.size(), 0);
  c.spacing_mm.assign(c.nodes_mm.size(), 1);
  c.label.assign(c.cells.size(), 1);
  tetmesh::connect(c);
  return c;
}

TEST(FewBelow, AFewCellsWithAnglesThatSolversBearAreTolerated) {
  const double enough = mesh::LatticeAims{}.enough;
  EXPECT_TRUE(mesh::are_few_below(cells_with({70, 70, 70}), enough, 0));
  EXPECT_FALSE(mesh::are_few_below(cells_with({70, 28, 70}), enough, 0));
  EXPECT_TRUE(mesh::are_few_below(cells_with({70, 28, 27}), enough, 2));
  EXPECT_FALSE(mesh::are_few_below(cells_with({28, 28, 27}), enough, 2));
  EXPECT_FALSE(mesh::are_few_below(cells_with({70, 25, 70}), enough, 2));
  EXPECT_FALSE(mesh::are_few_below(cells_with({70, 146, 70}), enough, 2));
}

}  // namespace
