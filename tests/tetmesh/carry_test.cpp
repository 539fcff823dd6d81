// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "generator/tetmesh/carry_data.hpp"
#include "tetmesh/blocks.hpp"

namespace {

using namespace heartgen;

struct Carried : ::testing::Test {
  heartgen::testing::Block b = heartgen::testing::block(5, 2);
  tetmesh::ImprovedMesh mesh;
  std::vector<tetmesh::NodeSource> from;

  void SetUp() override {
    heartgen::testing::shake(b, 0.3, 5, [&](std::size_t i) { return !b.on_border(i); });
    mesh = tetmesh::improve_mesh(b.nodes, b.cells, b.region, {.goal_deg = 25});
    from = tetmesh::node_sources(b.nodes, b.cells, mesh);
    ASSERT_NE(mesh.nodes_mm, b.nodes);
  }
  template <class F>
  auto at_old(const F& f) const {
    std::vector<decltype(f(Vec3{}))> values;
    for (const auto& p : b.nodes) values.push_back(f(p));
    return values;
  }
};

TEST_F(Carried, LinearFunctionsAreExact) {
  const auto f = [](const Vec3& p) { return 0.3 + 2 * p.x - 0.7 * p.y + 0.11 * p.z; };
  const auto g = [](const Vec3& p) { return Vec3{p.y, 1.5 - p.z, 0.1 * p.x}; };
  const auto values = tetmesh::carried(at_old(f), from);
  const auto vectors = tetmesh::carried(at_old(g), from);
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    EXPECT_NEAR(values[n], f(mesh.nodes_mm[n]), 1e-9);
    EXPECT_NEAR(norm(vectors[n] - g(mesh.nodes_mm[n])), 0, 1e-9);
  }
}

TEST_F(Carried, NodesThatStayedKeepTheirBits) {
  std::vector<double> values(b.nodes.size());
  heartgen::testing::Shaking noise;
  for (auto& v : values) v = noise.next();
  const auto carried = tetmesh::carried(values, from);
  std::size_t stayed = 0;
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    const auto old = mesh.old_node[n];
    if (old < 0 || !(mesh.nodes_mm[n] == b.nodes[static_cast<std::size_t>(old)])) continue;
    EXPECT_EQ(carried[n], values[static_cast<std::size_t>(old)]);
    ++stayed;
  }
  EXPECT_GE(stayed, 152U) << "the border's nodes at least";
}

TEST_F(Carried, CodesAreNotMixed) {
  std::vector<double> codes;
  for (const auto& p : b.nodes) codes.push_back(p.x < 2.5 ? 3 : 8);
  for (const double v : tetmesh::carried(codes, from)) EXPECT_TRUE(v == 3 || v == 8) << v;
}

TEST_F(Carried, AxesHaveNoSign) {
  const auto axis = [](const Vec3& p) {
    const double angle = 0.3 * p.z + 0.1 * p.x;
    return Vec3{std::cos(angle), std::sin(angle), 0};
  };
  auto values = at_old(axis);
  const auto plain = tetmesh::carried_axes(values, from);
  heartgen::testing::Shaking noise;
  for (auto& v : values)
    if (noise.next() < 0) v = -v;
  const auto flipped = tetmesh::carried_axes(values, from);
  for (std::size_t n = 0; n < plain.size(); ++n) {
    EXPECT_NEAR(norm(plain[n]), 1, 1e-12);
    EXPECT_NEAR(std::abs(dot(plain[n], flipped[n])), 1, 1e-12);
    EXPECT_GT(std::abs(dot(plain[n], axis(mesh.nodes_mm[n]))), std::cos(0.05));
  }
}

TEST_F(Carried, FramesAreOrthonormalAgain) {
  std::vector<Vec3> first, second, third;
  heartgen::testing::Shaking noise;
  for (int i = 0; i < 50; ++i) {
    first.push_back(normalized({noise.next(), noise.next(), noise.next()}));
    second.push_back(normalized(cross(first.back(), {noise.next(), noise.next(), 1})) + 0.1 * first.back());
    third.push_back((i % 2 == 0 ? 1.0 : -1.0) * cross(first.back(), second.back()));
  }
  const auto sides = third;
  tetmesh::straighten(first, second, third);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_NEAR(dot(first[i], second[i]), 0, 1e-12);
    EXPECT_NEAR(dot(first[i], third[i]), 0, 1e-12);
    EXPECT_NEAR(norm(third[i]), 1, 1e-12);
    EXPECT_GT(dot(third[i], sides[i]), 0.9);
  }
}

TEST_F(Carried, CellsComeFromTheirOwnRegion) {
  const auto cells = tetmesh::cell_sources(b.nodes, b.cells, b.region, mesh);
  ASSERT_EQ(cells.size(), mesh.cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    EXPECT_EQ(b.region[static_cast<std::size_t>(cells[c])], mesh.region[c]);
}

TEST(Ids, AreToldFromCodesAndMeasures) {
  EXPECT_TRUE(tetmesh::are_ids({4, 9, 2, 1}));
  EXPECT_FALSE(tetmesh::are_ids({4, 9, 4, 1}));
  EXPECT_FALSE(tetmesh::are_ids({4, 9.5, 2, 1}));
  EXPECT_TRUE(tetmesh::are_codes({4, 9, 4, 1}));
}

}  // namespace
