// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/label_repair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "mesh/labelled_cube.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

TEST(SettleLabels, CrumbsGoToTheirNeighbour) {
  auto mesh = cube(6, 3);
  const auto whole = mesh.label;
  std::size_t inside = 0;
  while (mesh.label[inside] != 1) ++inside;
  mesh.label[inside + 40] = 2;  // one cell in the lower half
  EXPECT_NE(mesh.label, whole);
  EXPECT_EQ(mesh::repair_labels(mesh.nodes_mm, mesh.cells, mesh.label, {}, 5), 1);
  EXPECT_EQ(mesh.label, whole);
}

// Sizes of the pieces of one label that hang together through faces, but for those of label 0 that reach the hull.
std::vector<int> piece_sizes(const LabelledCells& mesh) {
  const auto faces = mesh::cell_faces(mesh.cells);
  std::vector<std::vector<std::int32_t>> beside(mesh.cells.size());
  std::vector<bool> is_outside(mesh.cells.size()), is_seen(mesh.cells.size());
  for (const auto& f : faces) {
    const auto cell = static_cast<std::size_t>(f.cell);
    if (f.other < 0) {
      is_outside[cell] = is_outside[cell] || mesh.label[cell] == 0;
      continue;
    }
    if (mesh.label[cell] != mesh.label[static_cast<std::size_t>(f.other)]) continue;
    beside[cell].push_back(f.other);
    beside[static_cast<std::size_t>(f.other)].push_back(f.cell);
  }
  std::vector<int> sizes;
  for (std::size_t seed = 0; seed < mesh.cells.size(); ++seed) {
    std::vector<std::size_t> open{seed};
    int size = 0;
    bool is_inside = true;
    while (!open.empty()) {
      const auto at = open.back();
      open.pop_back();
      if (is_seen[at]) continue;
      is_seen[at] = true;
      ++size;
      is_inside = is_inside && !is_outside[at];
      for (const auto next : beside[at]) open.push_back(static_cast<std::size_t>(next));
    }
    if (size > 0 && is_inside) sizes.push_back(size);
  }
  return sizes;
}

TEST(SettleLabels, NoPieceIsLeftWithAsFewCellsAsACrumb) {
  for (const int crumb : {0, 1, 7, 30}) {
    auto mesh = cube(10, 5);
    std::uint32_t state = 7;
    for (auto& label : mesh.label) {
      state = 1664525 * state + 1013904223;
      if (state >> 24U < 40) label = static_cast<std::int32_t>((state >> 16U) % 3);
    }
    const auto whole = mesh.label;
    const auto before = piece_sizes(mesh);
    ASSERT_GT(std::ranges::count(before, 1), 100);
    ASSERT_GT(std::ranges::count_if(before, [](int size) { return size > 1 && size < 8; }), 20);
    mesh::repair_labels(mesh.nodes_mm, mesh.cells, mesh.label, {}, crumb);
    const auto after = piece_sizes(mesh);
    EXPECT_GT(*std::ranges::min_element(after), crumb);
    EXPECT_EQ(mesh.label == whole, crumb == 0);
    // Twice the same: what is left stays.
    EXPECT_EQ(mesh::repair_labels(mesh.nodes_mm, mesh.cells, mesh.label, {}, crumb), 0);
  }
}

TEST(SettleLabels, BodiesThatTouchInAnEdgeOrACornerArePartedOrJoined) {
  for (const bool corner : {false, true}) {
    auto mesh = cube(8, 8);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      const auto block = static_cast<int>(c / 6);
      const int i = block % 8, j = block / 8 % 8, k = block / 64;
      const bool low = i >= 2 && i < 4 && j >= 2 && j < 4 && k >= 2 && k < 4;
      const bool high = i >= 4 && i < 6 && j >= 4 && j < 6 && (corner ? k >= 4 && k < 6 : k >= 2 && k < 4);
      mesh.label[c] = low || high ? 1 : 0;
    }
    mesh::LabelSet one{};
    one[1] = true;
    EXPECT_GT(mesh::repair_labels(mesh.nodes_mm, mesh.cells, mesh.label, std::span(&one, 1), 0), 0);
    std::map<std::set<std::int32_t>, int> edges;
    for (const auto& f : interface_faces(mesh))
      for (const auto dropped : f) {
        auto edge = f;
        edge.erase(dropped);
        ++edges[edge];
      }
    for (const auto& [edge, count] : edges) ASSERT_EQ(count, 2);
    EXPECT_NEAR(volume_of(mesh, 1), 16, 2.5);
  }
}

// Nodes where the surface of a set of labels is not one closed fan of faces.
int nodes_not_manifold(const LabelledCells& mesh, const mesh::LabelSet& set) {
  const auto inside = [&](std::int32_t cell) {
    return cell >= 0 && set[static_cast<std::size_t>(mesh.label[static_cast<std::size_t>(cell)])];
  };
  std::map<std::int32_t, std::map<std::int32_t, std::vector<std::int32_t>>> fans;  // per node: sides opposite to it
  for (const auto& f : mesh::cell_faces(mesh.cells)) {
    if (inside(f.cell) == inside(f.other)) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      auto& fan = fans[f.nodes[i]];
      const auto a = f.nodes[(i + 1) % 3], b = f.nodes[(i + 2) % 3];
      fan[a].push_back(b);
      fan[b].push_back(a);
    }
  }
  int found = 0;
  for (const auto& [node, fan] : fans) {
    std::set<std::int32_t> reached;
    std::vector<std::int32_t> open{fan.begin()->first};
    bool is_fan = true;
    while (!open.empty()) {
      const auto at = open.back();
      open.pop_back();
      if (!reached.insert(at).second) continue;
      is_fan = is_fan && fan.at(at).size() == 2;
      for (const auto next : fan.at(at)) open.push_back(next);
    }
    found += is_fan && reached.size() == fan.size() ? 0 : 1;
  }
  return found;
}

// Of a wall, blood and both together: what one of them fills another one may take away again, for ever.
TEST(SettleLabels, SetsThatShareLabelsAllBecomeManifold) {
  std::array<mesh::LabelSet, 3> sets{};
  sets[0][1] = sets[0][2] = sets[1][1] = sets[2][2] = true;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    auto mesh = cube(9, 9);
    std::uint32_t state = seed;
    for (auto& label : mesh.label) {
      state = 1664525 * state + 1013904223;
      if (label != 0) label = static_cast<std::int32_t>((state >> 16U) % 3);
    }
    ASSERT_GT(nodes_not_manifold(mesh, sets[0]), 100);
    mesh::repair_labels(mesh.nodes_mm, mesh.cells, mesh.label, sets, 0);
    for (const auto& set : sets) EXPECT_EQ(nodes_not_manifold(mesh, set), 0) << seed;
    EXPECT_GT(volume_of(mesh, 1) + volume_of(mesh, 2), 20) << seed;
  }
}

}  // namespace
