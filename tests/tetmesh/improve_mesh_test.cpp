// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/improve_mesh.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/orient.hpp"
#include "generator/tetmesh/quality.hpp"
#include "model/error.hpp"
#include "tetmesh/blocks.hpp"
#include "validation/cell_quality.hpp"
#include "validation/mesh_checks.hpp"

namespace {

using namespace heartgen;
using heartgen::testing::Block;
using heartgen::testing::block;

tetmesh::ImprovedMesh improved(const Block& b, const tetmesh::ImproveSettings& settings) {
  return tetmesh::improve_mesh(b.nodes, b.cells, b.region, settings);
}

double worst_quality(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells) {
  double worst = 9;
  for (const auto& c : cells) {
    const auto at = [&](std::size_t i) { return nodes[static_cast<std::size_t>(c[i])]; };
    worst = std::min(worst, tetmesh::cell_quality(at(0), at(1), at(2), at(3)));
  }
  return worst;
}

double smallest_angle(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells) {
  double least = 180;
  for (const auto& c : cells) {
    const auto at = [&](std::size_t i) { return nodes[static_cast<std::size_t>(c[i])]; };
    least = std::min(least, validation::cell_quality({at(0), at(1), at(2), at(3)}).min_dihedral_deg);
  }
  return least;
}

std::map<std::int32_t, double> volumes(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells,
                                       const std::vector<std::int32_t>& region) {
  std::map<std::int32_t, double> sum;
  for (std::size_t c = 0; c < cells.size(); ++c) sum[region[c]] += heartgen::testing::volume(nodes, cells[c]);
  return sum;
}

/// Faces of one cell or between two regions, as places: what must stay.
std::set<std::array<std::array<double, 3>, 3>> surface(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells,
                                                       const std::vector<std::int32_t>& region) {
  std::map<Face, std::vector<std::int32_t>> sides;
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i) {
      Face face{cells[c][(i + 1) % 4], cells[c][(i + 2) % 4], cells[c][(i + 3) % 4]};
      std::sort(face.begin(), face.end());
      sides[face].push_back(region[c]);
    }
  std::set<std::array<std::array<double, 3>, 3>> places;
  for (const auto& [face, regions] : sides) {
    if (regions.size() == 2 && regions[0] == regions[1]) continue;
    std::array<std::array<double, 3>, 3> place;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = nodes[static_cast<std::size_t>(face[i])];
      place[i] = {p.x, p.y, p.z};
    }
    std::sort(place.begin(), place.end());
    places.insert(place);
  }
  return places;
}

Block shaken_ball(int n, double amplitude) {
  auto b = block(n);
  heartgen::testing::round_off(b);
  const Block even = block(n);
  heartgen::testing::shake(b, amplitude, 7, [&](std::size_t i) { return !even.on_border(i); });
  return b;
}

TEST(Improve, ShakenBallGetsBetterInsideItsSurface) {
  const auto b = shaken_ball(8, 0.3);
  ASSERT_LT(smallest_angle(b.nodes, b.cells), 5);
  const auto mesh = improved(b, {.goal_deg = 15});
  EXPECT_GT(smallest_angle(mesh.nodes_mm, mesh.cells), smallest_angle(b.nodes, b.cells));
  EXPECT_GT(worst_quality(mesh.nodes_mm, mesh.cells), worst_quality(b.nodes, b.cells));
  EXPECT_TRUE(mesh.is_fixed);
  EXPECT_EQ(surface(mesh.nodes_mm, mesh.cells, mesh.region), surface(b.nodes, b.cells, b.region));
}

TEST(Improve, ShakenBlockReachesTheGoal) {
  auto b = block(6, 3);
  heartgen::testing::shake(b, 0.36, 3, [&](std::size_t i) { return !b.on_border(i) && b.nodes[i].z != 3; });
  ASSERT_LT(smallest_angle(b.nodes, b.cells), 5);
  const auto mesh = improved(b, {.goal_deg = 20});
  EXPECT_EQ(mesh.cells_below_goal, 0);
  EXPECT_GE(smallest_angle(mesh.nodes_mm, mesh.cells), 20 - 1e-4);
  EXPECT_EQ(surface(mesh.nodes_mm, mesh.cells, mesh.region), surface(b.nodes, b.cells, b.region));
  const auto sizes = volumes(mesh.nodes_mm, mesh.cells, mesh.region);
  EXPECT_NEAR(sizes.at(5), 6 * 6 * 3, 1e-9);
  EXPECT_NEAR(sizes.at(7), 6 * 6 * 3, 1e-9);
}

TEST(Improve, SlidingKeepsPlanesEdgesAndCorners) {
  auto b = block(5, 2);
  const double end = 5;
  Block even = b;
  heartgen::testing::Shaking noise{99};
  for (auto& p : b.nodes) {  // along the planes on which they lie
    const Vec3 by{0.3 * noise.next(), 0.3 * noise.next(), 0.3 * noise.next()};
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] != 0 && p[axis] != end && (axis != 2 || p[axis] != 2)) p[axis] += by[axis];
  }
  const auto mesh = improved(b, {.goal_deg = 25, .slide_mm = 0.01});
  EXPECT_FALSE(mesh.is_fixed);
  EXPECT_LE(mesh.drift_mm, 1e-9) << "planes stay planes";
  EXPECT_GT(worst_quality(mesh.nodes_mm, mesh.cells), worst_quality(b.nodes, b.cells));
  EXPECT_NE(surface(mesh.nodes_mm, mesh.cells, mesh.region), surface(b.nodes, b.cells, b.region)) << "nothing slid";
  const auto sizes = volumes(mesh.nodes_mm, mesh.cells, mesh.region);
  EXPECT_NEAR(sizes.at(5), 50, 1e-9);
  EXPECT_NEAR(sizes.at(7), 75, 1e-9);
  for (const auto& corner : {Vec3{0, 0, 0}, Vec3{5, 0, 0}, Vec3{0, 5, 5}, Vec3{5, 5, 5}, Vec3{5, 5, 2}})
    EXPECT_NE(std::find(mesh.nodes_mm.begin(), mesh.nodes_mm.end(), corner), mesh.nodes_mm.end());
}

TEST(Improve, SlidingOnACurvedSurfaceKeepsItsTolerance) {
  auto b = shaken_ball(8, 0.2);
  for (const double tolerance : {0.02, 0.2}) {
    const auto mesh = improved(b, {.goal_deg = 20, .slide_mm = tolerance});
    EXPECT_LE(mesh.drift_mm, tolerance);
    EXPECT_GE(worst_quality(mesh.nodes_mm, mesh.cells), worst_quality(b.nodes, b.cells));
  }
}

TEST(Improve, NeverMakesTheWorstCellWorse) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    auto b = block(4, 2);
    heartgen::testing::shake(b, 0.15 * seed, seed,
                             [&](std::size_t i) { return !b.on_border(i); });  // up to inverted cells
    for (const std::int64_t budget : {0, 1, 17, 300, 1'000'000}) {
      const auto mesh = improved(b, {.goal_deg = 30, .budget = budget});
      EXPECT_GE(worst_quality(mesh.nodes_mm, mesh.cells), worst_quality(b.nodes, b.cells)) << seed << " " << budget;
      EXPECT_EQ(volumes(mesh.nodes_mm, mesh.cells, mesh.region).size(), 2U);
    }
  }
}

TEST(Improve, NoBudgetChangesNothing) {
  const auto b = shaken_ball(4, 0.3);
  const auto mesh = improved(b, {.goal_deg = 30, .budget = 0});
  EXPECT_EQ(mesh.nodes_mm, b.nodes);
  EXPECT_EQ(mesh.cells, b.cells);
}

TEST(Improve, InvertedCellsAreTurned) {
  auto b = block(4);
  b.nodes[static_cast<std::size_t>((2 * 5 + 2) * 5 + 2)] +=
      Vec3{1.2, 0.9, 0.4};  // the middle, into a neighbour's cells
  ASSERT_LT(worst_quality(b.nodes, b.cells), 0);
  const auto mesh = improved(b, {.goal_deg = 20});
  EXPECT_GT(smallest_angle(mesh.nodes_mm, mesh.cells), 15);
  EXPECT_GT(worst_quality(mesh.nodes_mm, mesh.cells), 0);
}

TEST(Improve, TheOtherOrientationIsTurnedAround) {
  auto b = block(3);
  for (auto& cell : b.cells) std::swap(cell[0], cell[1]);
  const auto mesh = improved(b, {});
  EXPECT_GT(worst_quality(mesh.nodes_mm, mesh.cells), 0.5);
  EXPECT_EQ(mesh.cells.size(), b.cells.size());
}

TEST(Improve, CellsWrittenBothWaysAreTurnedToOneOrder) {
  auto b = block(4);
  b.nodes[static_cast<std::size_t>((2 * 5 + 2) * 5 + 2)] += Vec3{1.2, 0.9, 0.4};  // some are inverted in space besides
  ASSERT_LT(worst_quality(b.nodes, b.cells), 0);
  heartgen::testing::Shaking noise{5};
  for (auto& cell : b.cells)
    if (noise.next() < 0.2) std::swap(cell[1], cell[2]);
  const auto mesh = improved(b, {.goal_deg = 20});
  EXPECT_GT(smallest_angle(mesh.nodes_mm, mesh.cells), 15);
  EXPECT_GT(worst_quality(mesh.nodes_mm, mesh.cells), 0);
  EXPECT_NEAR(volumes(mesh.nodes_mm, mesh.cells, mesh.region).at(7), 4 * 4 * 4, 1e-9);
}

TEST(Improve, OnlyTheOrderOfNodesIsTurnedNotWhatIsInverted) {
  auto b = block(4);
  b.nodes[static_cast<std::size_t>((2 * 5 + 2) * 5 + 2)] += Vec3{1.2, 0.9, 0.4};
  auto mixed = b;
  for (std::size_t c = 0; c < mixed.cells.size(); c += 3) std::swap(mixed.cells[c][2], mixed.cells[c][3]);
  const auto cells = tetmesh::oriented_cells(b.nodes, mixed.cells);
  for (std::size_t c = 0; c < cells.size(); ++c)
    EXPECT_EQ(heartgen::testing::volume(b.nodes, cells[c]), heartgen::testing::volume(b.nodes, b.cells[c])) << c;
}

TEST(Improve, EveryPieceIsOrientedForItself) {
  auto b = block(2);
  const auto there = static_cast<std::int32_t>(b.nodes.size());
  const auto count = b.cells.size();
  for (std::int32_t n = 0; n < there; ++n) b.nodes.push_back(b.nodes[static_cast<std::size_t>(n)] + Vec3{9, 0, 0});
  for (std::size_t c = 0; c < count; ++c) {
    Cell cell = b.cells[c];
    for (auto& n : cell) n += there;
    std::swap(cell[0], cell[3]);
    b.cells.push_back(cell);
  }
  for (const auto& cell : tetmesh::oriented_cells(b.nodes, b.cells))
    EXPECT_GT(heartgen::testing::volume(b.nodes, cell), 0);
}

TEST(Improve, TheResultIsAValidMesh) {
  auto b = block(5, 2);
  heartgen::testing::shake(b, 0.35, 21, [&](std::size_t i) { return !b.on_border(i) && b.nodes[i].z != 2; });
  const auto mesh = improved(b, {.goal_deg = 25});
  TetMesh checked;
  checked.nodes_mm = mesh.nodes_mm;
  checked.cells = mesh.cells;
  checked.region = mesh.region;
  for (const auto& row : validation::check_mesh("mesh", checked, {})) {
    if (row.metric == "boundary_faces_missing" || row.metric == "interface_faces_missing") continue;  // none is listed
    EXPECT_TRUE(row.passed()) << row.scope << " " << row.metric << " " << row.value;
  }
}

TEST(Improve, SameBitsForAnyNumberOfThreads) {
  const auto b = shaken_ball(6, 0.3);
  const int threads = parallel::thread_count();
  parallel::set_thread_count(1);
  const auto one = improved(b, {.goal_deg = 25, .slide_mm = 0.05});
  parallel::set_thread_count(3);
  const auto three = improved(b, {.goal_deg = 25, .slide_mm = 0.05});
  parallel::set_thread_count(threads);
  EXPECT_EQ(one.nodes_mm, three.nodes_mm);
  EXPECT_EQ(one.cells, three.cells);
}

TEST(Improve, OldNodesComeFirstInTheirOrder) {
  const auto b = shaken_ball(6, 0.3);
  const auto mesh = improved(b, {.goal_deg = 25});
  ASSERT_EQ(mesh.old_node.size(), mesh.nodes_mm.size());
  bool is_new = false;
  for (std::size_t n = 0; n < mesh.old_node.size(); ++n) {
    is_new |= mesh.old_node[n] < 0;
    EXPECT_EQ(mesh.old_node[n] < 0, is_new);
    if (n > 0 && !is_new) {
      EXPECT_GT(mesh.old_node[n], mesh.old_node[n - 1]);
    }
  }
}

TEST(Improve, BadInputIsRefused) {
  auto b = block(2);
  EXPECT_THROW(improved(b, {.goal_deg = 0}), UserError);
  EXPECT_THROW(improved(b, {.goal_deg = 60}), UserError);
  EXPECT_THROW(improved(b, {.slide_mm = -1}), UserError);
  auto thrice = b;
  thrice.cells.push_back(b.cells[0]);
  thrice.cells.push_back(b.cells[0]);
  thrice.region.resize(thrice.cells.size(), 7);
  EXPECT_THROW(improved(thrice, {}), UserError);
  auto missing = b;
  missing.cells[3][2] = 99;
  EXPECT_THROW(improved(missing, {}), UserError);
  auto many = b;
  for (std::size_t c = 0; c < many.region.size(); ++c) many.region[c] = static_cast<std::int32_t>(c);
  EXPECT_THROW(improved(many, {}), UserError);
}

}  // namespace
