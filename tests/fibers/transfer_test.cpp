// SPDX-License-Identifier: GPL-3.0-or-later
// Fibres from one block to another that divides the same cube otherwise, against closed forms.
#include "generator/fibers/transfer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "tetmesh/blocks.hpp"

namespace heartgen {
namespace {

constexpr double anywhere_mm = 1e9;

struct Frame {
  Vec3 fiber, sheet;
};

/// A fibre that turns in the x-y plane, and a sheet that tilts about it: smooth, orthonormal. The angles are curved:
/// of angles linear in space the error falls faster.
Frame turning(const Vec3& p) {
  const double turn = 0.3 * p.z + 0.5 * p.x * p.z + 0.6 * p.y * p.y, tilt = 0.5 * p.y - 0.4 * p.z * p.z;
  const Vec3 fiber{std::cos(turn), std::sin(turn), 0}, across{-std::sin(turn), std::cos(turn), 0};
  return {fiber, std::cos(tilt) * across + std::sin(tilt) * Vec3{0, 0, 1}};
}

Frame straight(const Vec3&) { return {normalized({1, 2, -1}), normalized({1, -1, -1})}; }

/// The cube [0, 2]^3 in n × n × n blocks of cells.
TetMesh cube(int n, Frame (*frame_at)(const Vec3&)) {
  const auto block = testing::block(n);
  TetMesh mesh;
  mesh.cells = block.cells;
  for (const auto& node : block.nodes) {
    mesh.nodes_mm.push_back((2.0 / n) * node);
    const Frame frame = frame_at(mesh.nodes_mm.back());
    mesh.node_fibers.fiber.push_back(frame.fiber);
    mesh.node_fibers.sheet.push_back(frame.sheet);
    mesh.node_fibers.sheet_normal.push_back(cross(frame.fiber, frame.sheet));
    mesh.fiber_source.push_back(
        static_cast<std::uint8_t>(mesh.nodes_mm.back().x < 1 ? FiberSource::atlas : FiberSource::rule));
  }
  return mesh;
}

/// Another division of the same cube, its inner nodes anywhere.
TetMesh target() {
  auto block = testing::block(7);
  testing::shake(block, 0.2, 3, [&](std::size_t i) { return !block.on_border(i); });
  TetMesh mesh;
  mesh.cells = block.cells;
  for (const auto& node : block.nodes) mesh.nodes_mm.push_back((2.0 / 7) * node);
  return mesh;
}

Vec3 middle_of(const TetMesh& mesh, const Cell& cell) {
  Vec3 sum;
  for (const auto n : cell) sum += 0.25 * mesh.nodes_mm[static_cast<std::size_t>(n)];
  return sum;
}

fibers::TransferredFibers onto(const TetMesh& to, const TetMesh& from, double reach_mm = anywhere_mm) {
  return fibers::transfer_fibers(from, to.nodes_mm, to.cells, reach_mm);
}

/// Mean angle between axes, radians.
double mean_error(const TetMesh& mesh, const fibers::TransferredFibers& carried) {
  double sum = 0;
  const auto add = [&](const FiberField& field, std::size_t i, const Vec3& p) {
    const Frame exact = turning(p);
    sum += norm(cross(field.fiber[i], exact.fiber)) + norm(cross(field.sheet[i], exact.sheet));
  };
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) add(carried.node, n, mesh.nodes_mm[n]);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) add(carried.cell, c, middle_of(mesh, mesh.cells[c]));
  return sum / (2 * static_cast<double>(mesh.nodes_mm.size() + mesh.cells.size()));
}

void expect_orthonormal(const FiberField& field) {
  for (std::size_t i = 0; i < field.fiber.size(); ++i) {
    const Vec3 &f = field.fiber[i], &s = field.sheet[i], &t = field.sheet_normal[i];
    for (const Vec3& axis : {f, s, t}) EXPECT_NEAR(norm(axis), 1, 1e-12);
    EXPECT_NEAR(dot(f, s), 0, 1e-12);
    EXPECT_NEAR(norm(cross(f, s) - t), 0, 1e-12);
  }
}

TEST(Transfer, EqualAxesStayAsTheyAre) {
  const TetMesh to = target();
  const auto carried = onto(to, cube(3, straight));
  ASSERT_EQ(carried.node.fiber.size(), to.nodes_mm.size());
  ASSERT_EQ(carried.cell.fiber.size(), to.cells.size());
  const Frame exact = straight({});
  for (const auto* field : {&carried.node, &carried.cell})
    for (std::size_t i = 0; i < field->fiber.size(); ++i) {
      EXPECT_NEAR(std::abs(dot(field->fiber[i], exact.fiber)), 1, 1e-12);
      EXPECT_NEAR(std::abs(dot(field->sheet[i], exact.sheet)), 1, 1e-12);
    }
  EXPECT_LE(carried.farthest_mm, 1e-12);
  EXPECT_EQ(carried.beyond_nodes, 0);
}

TEST(Transfer, ErrorFallsWithTheSquareOfTheEdge) {
  const TetMesh to = target();
  const double coarse = mean_error(to, onto(to, cube(8, turning)));
  const double middle = mean_error(to, onto(to, cube(16, turning)));
  const double fine = mean_error(to, onto(to, cube(32, turning)));
  EXPECT_NEAR(std::log2(coarse / middle), 2, 0.25) << coarse << " " << middle;
  EXPECT_NEAR(std::log2(middle / fine), 2, 0.25) << middle << " " << fine;
}

TEST(Transfer, NodesOfTheMeshItselfKeepTheirAxes) {
  const TetMesh mesh = cube(6, turning);
  const auto carried = onto(mesh, mesh);
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    EXPECT_NEAR(std::abs(dot(carried.node.fiber[n], mesh.node_fibers.fiber[n])), 1, 1e-12);
    EXPECT_EQ(carried.source[n], mesh.fiber_source[n]);
  }
}

TEST(Transfer, CellsOfTheMeshItselfKeepTheirOwnAxes) {
  TetMesh mesh = cube(6, turning);
  for (const auto& cell : mesh.cells) {  // as different from the corners' axes as can be
    const Frame frame = turning(middle_of(mesh, cell));
    mesh.cell_fibers.fiber.push_back(frame.sheet);
    mesh.cell_fibers.sheet.push_back(frame.fiber);
  }
  const auto carried = onto(mesh, mesh);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    EXPECT_NEAR(std::abs(dot(carried.cell.fiber[c], mesh.cell_fibers.fiber[c])), 1, 1e-12);
    EXPECT_NEAR(std::abs(dot(carried.cell.sheet[c], mesh.cell_fibers.sheet[c])), 1, 1e-12);
  }
  expect_orthonormal(carried.cell);
}

TEST(Transfer, SignsOfTheGivenAxesChangeNothing) {
  const TetMesh to = target();
  TetMesh from = cube(5, turning);
  const auto plain = onto(to, from);
  testing::Shaking noise;
  for (auto* axes : {&from.node_fibers.fiber, &from.node_fibers.sheet, &from.node_fibers.sheet_normal})
    for (auto& axis : *axes)
      if (noise.next() < 0) axis = -axis;
  const auto flipped = onto(to, from);
  EXPECT_EQ(plain.node.fiber, flipped.node.fiber);
  EXPECT_EQ(plain.node.sheet, flipped.node.sheet);
  EXPECT_EQ(plain.cell.sheet_normal, flipped.cell.sheet_normal);
}

TEST(Transfer, FramesAreOrthonormalEvenOfRoughFields) {
  TetMesh from = cube(4, straight);
  testing::Shaking noise;
  for (auto* axes : {&from.node_fibers.fiber, &from.node_fibers.sheet})
    for (auto& axis : *axes) axis = normalized({noise.next(), noise.next(), noise.next()});
  const auto carried = onto(target(), from);
  expect_orthonormal(carried.node);
  expect_orthonormal(carried.cell);
}

TEST(Transfer, SameBitsForAnyThreads) {
  const TetMesh to = target(), from = cube(5, turning);
  const int threads = parallel::thread_count();
  parallel::set_thread_count(1);
  const auto one = onto(to, from);
  parallel::set_thread_count(3);
  const auto three = onto(to, from);
  parallel::set_thread_count(threads);
  EXPECT_EQ(one.node.fiber, three.node.fiber);
  EXPECT_EQ(one.cell.sheet, three.cell.sheet);
  EXPECT_EQ(one.source, three.source);
}

TEST(Transfer, PlacesOutsideTakeTheNearestPlaceOfTheBoundary) {
  const TetMesh from = cube(5, turning);
  const std::vector<Vec3> outside{{-0.3, 0.7, 1.1}, {0.9, 2.4, 0.3}, {2.1, 2.2, 2.2}};
  const std::vector<Vec3> nearest{{0, 0.7, 1.1}, {0.9, 2, 0.3}, {2, 2, 2}};
  const auto at_outside = fibers::transfer_fibers(from, outside, {}, anywhere_mm);
  const auto at_nearest = fibers::transfer_fibers(from, nearest, {}, anywhere_mm);
  for (std::size_t i = 0; i < outside.size(); ++i)
    EXPECT_NEAR(std::abs(dot(at_outside.node.fiber[i], at_nearest.node.fiber[i])), 1, 1e-12);
  EXPECT_NEAR(at_outside.farthest_mm, 0.4, 1e-12);
}

TEST(Transfer, BeyondTheReachThereAreNoAxes) {
  const TetMesh from = cube(3, straight);
  const std::vector<Vec3> nodes{{1, 1, 1}, {1, 1, 2.5}, {1, 1, 4}, {5, 6, 2}};
  const auto carried = fibers::transfer_fibers(from, nodes, {{0, 1, 2, 3}}, 1);
  EXPECT_EQ(carried.beyond_nodes, 2);
  EXPECT_NEAR(carried.farthest_mm, 5, 1e-12);
  EXPECT_NEAR(norm(carried.node.fiber[1]), 1, 1e-12);
  EXPECT_EQ(carried.node.fiber[2], Vec3{});
  EXPECT_EQ(carried.node.sheet[3], Vec3{});
  EXPECT_EQ(carried.source[3], static_cast<std::uint8_t>(FiberSource::none));
  EXPECT_EQ(carried.cell.fiber.size(), 1U);
}

TEST(Transfer, SourcesAreNotMixed) {
  const auto carried = onto(target(), cube(4, straight));
  EXPECT_EQ(std::set<std::uint8_t>(carried.source.begin(), carried.source.end()),
            (std::set<std::uint8_t>{static_cast<std::uint8_t>(FiberSource::atlas),
                                    static_cast<std::uint8_t>(FiberSource::rule)}));
  TetMesh unknown = cube(4, straight);
  unknown.fiber_source.clear();
  EXPECT_TRUE(onto(target(), unknown).source.empty());
}

TEST(Transfer, AnotherUnitIsToldFromAPiece) {
  TetMesh from = cube(8, turning);
  for (auto& p : from.nodes_mm) p = 100 * p;  // as large as a heart
  const auto scaled = [&](double factor) {
    auto points = from.nodes_mm;
    for (auto& p : points) p *= factor;
    return points;
  };
  EXPECT_EQ(fibers::scale_onto(from, scaled(0.1), 5), 10) << "cm";
  EXPECT_EQ(fibers::scale_onto(from, scaled(0.001), 5), 1000) << "m";
  EXPECT_EQ(fibers::scale_onto(from, scaled(1000), 5), 0.001) << "um";
  EXPECT_FALSE(fibers::scale_onto(from, scaled(1), 5));
  auto piece = scaled(0.1);
  for (auto& p : piece) p += Vec3{40, 0, 0};
  EXPECT_FALSE(fibers::scale_onto(from, piece, 20)) << "a piece in mm";
}

TEST(Transfer, AMeshWithoutFibresIsRefused) {
  TetMesh from = cube(2, straight);
  from.node_fibers.sheet.clear();
  EXPECT_THROW(onto(target(), from), UserError);
  EXPECT_THROW(onto(target(), TetMesh{}), UserError);
}

}  // namespace
}  // namespace heartgen
