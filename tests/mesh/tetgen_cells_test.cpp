// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/tetgen_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "generator/mesh/mesh_heart.hpp"
#include "mesh/shapes.hpp"
#include "model/error.hpp"
#include "support/data.hpp"
#include "validation/mesh_checks.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;
using adapters::SurfaceComplex;

/// The surface of a cube whose sides are divided into `parts` times `parts` squares, of two triangles each.
void add_cube(SurfaceComplex& surfaces, const Vec3& corner, double width_mm, int parts) {
  std::map<std::tuple<int, int, int>, std::int32_t> id;
  const auto node = [&](int axis, int side, int u, int v) {
    std::array<int, 3> at{};
    at[static_cast<std::size_t>(axis)] = side * parts;
    at[static_cast<std::size_t>((axis + 1) % 3)] = u;
    at[static_cast<std::size_t>((axis + 2) % 3)] = v;
    const auto [found, is_new] =
        id.try_emplace({at[0], at[1], at[2]}, static_cast<std::int32_t>(surfaces.nodes_mm.size()));
    const double step = width_mm / parts;
    if (is_new) surfaces.nodes_mm.push_back(corner + Vec3{step * at[0], step * at[1], step * at[2]});
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int u = 0; u < parts; ++u)
        for (int v = 0; v < parts; ++v) {
          const auto a = node(axis, side, u, v), b = node(axis, side, u + 1, v);
          const auto c = node(axis, side, u + 1, v + 1), d = node(axis, side, u, v + 1);
          surfaces.faces.push_back({a, b, c});
          surfaces.faces.push_back({a, c, d});
        }
}

double volume_mm3(const LabelledCells& cells, std::int32_t label) {
  double volume = 0;
  for (std::size_t c = 0; c < cells.cells.size(); ++c) {
    const auto p = [&](std::size_t i) { return cells.nodes_mm[static_cast<std::size_t>(cells.cells[c][i])]; };
    const double six = dot(p(1) - p(0), cross(p(2) - p(0), p(3) - p(0)));
    EXPECT_GT(six, 0);
    if (cells.label[c] == label) volume += six / 6;
  }
  return volume;
}

/// The same everywhere.
Volume<float> edges_of(double edge_mm) {
  Grid grid;
  grid.size = {1, 1, 1};
  return Volume<float>(grid, static_cast<float>(edge_mm));
}

LabelledCells fill(const SurfaceComplex& surfaces, double edge_mm) {
  return adapters::fill_surfaces({surfaces, edges_of(edge_mm), {}});
}

/// A cube of 6 mm around one of 4 mm around one of 2 mm.
SurfaceComplex nested_cubes() {
  SurfaceComplex surfaces;
  add_cube(surfaces, {0, 0, 0}, 6, 6);
  add_cube(surfaces, {1, 1, 1}, 4, 5);
  add_cube(surfaces, {2, 2, 2}, 2, 3);
  surfaces.seeds = {{{0.5, 0.5, 0.5}, 7}, {{1.5, 1.5, 1.5}, 2}, {{3, 3, 3}, 5}};
  return surfaces;
}

TEST(Backends, AnUnknownOneIsAnsweredWithTheNamesOfAll) {
  MeshSettings settings;
  settings.backend = "latice";
  try {
    mesh::mesh_labels(label_cube(8, 2, [](const Vec3&) { return Region::torso; }), settings);
    FAIL() << "an unknown backend was accepted";
  } catch (const UserError& error) {
    for (const auto* name : {"latice", "\"lattice\"", "\"cgal\"", "\"tetgen\""})
      EXPECT_NE(error.message.find(name), std::string::npos) << error.message;
  }
}

TEST(TetGen, FillsNestedShellsExactly) {
  const auto surfaces = nested_cubes();
  const auto cells = fill(surfaces, 1);
  EXPECT_NEAR(volume_mm3(cells, 7), 6 * 6 * 6 - 4 * 4 * 4, 1e-9);
  EXPECT_NEAR(volume_mm3(cells, 2), 4 * 4 * 4 - 2 * 2 * 2, 1e-9);
  EXPECT_NEAR(volume_mm3(cells, 5), 2 * 2 * 2, 1e-9);
}

TEST(TetGen, KeepsEveryNodeAndTriangleOfTheSurfaces) {
  const auto surfaces = nested_cubes();
  const auto cells = fill(surfaces, 1);
  ASSERT_GE(cells.nodes_mm.size(), surfaces.nodes_mm.size());
  EXPECT_TRUE(std::equal(surfaces.nodes_mm.begin(), surfaces.nodes_mm.end(), cells.nodes_mm.begin()));
  std::set<std::set<std::int32_t>> faces;
  for (const auto& c : cells.cells)
    for (std::size_t i = 0; i < 4; ++i) faces.insert({c[(i + 1) % 4], c[(i + 2) % 4], c[(i + 3) % 4]});
  for (const auto& f : surfaces.faces) EXPECT_EQ(faces.count({f[0], f[1], f[2]}), 1U);
}

TEST(TetGen, FollowsTheWantedEdge) {
  SurfaceComplex surfaces;
  add_cube(surfaces, {0, 0, 0}, 10, 10);
  surfaces.seeds = {{{5, 5, 5}, 1}};
  const auto coarse = fill(surfaces, 4);
  const auto fine = fill(surfaces, 1);
  EXPECT_GT(fine.cells.size(), 1.5 * static_cast<double>(coarse.cells.size()));
  for (const auto* cells : {&coarse, &fine}) EXPECT_NEAR(volume_mm3(*cells, 1), 1000, 1e-8);
}

TEST(TetGen, PiecesWithoutASeedStayEmpty) {
  auto surfaces = nested_cubes();
  surfaces.seeds.pop_back();
  const auto cells = fill(surfaces, 1);
  EXPECT_NEAR(volume_mm3(cells, 7), 6 * 6 * 6 - 4 * 4 * 4, 1e-9);
  EXPECT_NEAR(volume_mm3(cells, 2), 4 * 4 * 4 - 2 * 2 * 2, 1e-9);
  EXPECT_EQ(std::set<std::int32_t>(cells.label.begin(), cells.label.end()), (std::set<std::int32_t>{2, 7}));
}

TEST(TetGen, SameInputSameBits) {
  const auto surfaces = nested_cubes();
  const auto one = fill(surfaces, 1), other = fill(surfaces, 1);
  EXPECT_EQ(one.nodes_mm, other.nodes_mm);
  EXPECT_EQ(one.cells, other.cells);
  EXPECT_EQ(one.label, other.label);
}

TEST(TetGen, RefusesSurfacesThatCross) {
  SurfaceComplex surfaces;
  add_cube(surfaces, {0, 0, 0}, 3, 3);
  add_cube(surfaces, {1.55, 1.45, 1.35}, 3, 3);
  surfaces.seeds = {{{0.5, 0.5, 0.5}, 1}, {{4, 4, 4}, 2}};
  EXPECT_THROW(fill(surfaces, 1), UserError);
  EXPECT_NEAR(volume_mm3(fill(nested_cubes(), 1), 5), 8, 1e-9) << "and works on afterwards";
}

TEST(TetGen, EdgesFollowTheirField) {
  SurfaceComplex surfaces;
  add_cube(surfaces, {0, 0, 0}, 10, 10);
  surfaces.seeds = {{{5, 5, 5}, 1}};
  Grid grid;
  grid.size = {2, 1, 1};
  grid.spacing_mm = {10, 1, 1};
  Volume<float> edges(grid, 1.F);
  edges.voxels[1] = 4;  // on the right
  const auto cells = adapters::fill_surfaces({surfaces, edges, {}});
  std::array<std::size_t, 2> count{};
  for (const auto& cell : cells.cells) {
    double x = 0;
    for (const auto n : cell) x += cells.nodes_mm[static_cast<std::size_t>(n)].x / 4;
    if (std::abs(x - 5) < 4) ++count[x > 5];
  }
  EXPECT_GT(count[0], 1.2 * static_cast<double>(count[1]));
}

/// Programs that are not TetGen's.
class OtherHelper : public ::testing::Test {
 protected:
  std::string message_of(const std::string& script) {
    const auto folder = scratch_folder("helper");
    const auto file = folder / "heartgen-tetgen";
    std::ofstream(file) << "#!/bin/sh\n" << script << "\n";
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    try {
      adapters::fill_surfaces({nested_cubes(), edges_of(1), {}}, file);
    } catch (const UserError& error) {
      EXPECT_EQ(error.message.find('\n'), std::string::npos);
      return error.message;
    }
    return "it worked";
  }
};

TEST_F(OtherHelper, ACrashIsOneMessage) {
  const auto message = message_of("echo 'at wits end' >&2; kill -SEGV $$");
  EXPECT_NE(message.find("gave up by signal 11: at wits end"), std::string::npos) << message;
  EXPECT_NE(message_of("exit 3").find("gave up with exit code 3"), std::string::npos);
}

TEST_F(OtherHelper, AnAnswerThatIsNoneIsRefused) {
  EXPECT_NE(message_of("true").find("its answer is cut off"), std::string::npos);
  EXPECT_NE(message_of("head -c 100 /dev/zero").find("its answer is of another version"), std::string::npos);
  EXPECT_NE(message_of("cat").find("its answer is"), std::string::npos) << "the task itself";
}

TEST_F(OtherHelper, OneThatCannotRunIsNamed) {
  EXPECT_THROW(adapters::fill_surfaces({nested_cubes(), edges_of(1), {}}, scratch_folder("none") / "heartgen-tetgen"),
               UserError);
}

TEST(TetGen, FillsTheSurfacesOfTheLattice) {
  // Two ventricles of a ball with a wall, in a body that the image cuts: the meeting of four labels and flat sides.
  const auto labels = label_cube(28, 1.5, [](const Vec3& p) {
    if (norm(p) >= 15) return std::hypot(p.x, p.y) < 19.5 ? Region::torso : Region::none;
    if (norm(p) >= 11) return p.z < 0 ? Region::lv_myocardium : Region::la_wall;
    return p.z < 0 ? Region::lv_blood : Region::la_blood;
  });
  MeshSettings settings;
  settings.heart_edge_mm = 3;
  settings.blood_edge_mm = 5;
  settings.torso_edge_mm = 8;
  const auto on_lattice = mesh::mesh_labels(labels, settings);
  settings.backend = "tetgen";
  mesh::LatticeReport steps;
  const auto mesh = mesh::mesh_labels(labels, settings, &steps);
  const auto report = validation::check_mesh("mesh", mesh, ValidationSettings{});
  EXPECT_TRUE(all_passed(report)) << failed_rows(report);
  EXPECT_TRUE(
      std::any_of(steps.seconds.begin(), steps.seconds.end(), [](const auto& s) { return s.first == "tetgen"; }));
  EXPECT_EQ(mesh.rims.size(), on_lattice.rims.size());
  const auto names = [](const TetMesh& m) {
    std::set<std::string> found;
    for (const auto& [name, count] : surface_counts(m)) found.insert(name);
    return found;
  };
  EXPECT_EQ(names(mesh), names(on_lattice));
  for (const auto region :
       {Region::lv_myocardium, Region::la_wall, Region::lv_blood, Region::la_blood, Region::torso}) {
    const double wanted = region_volume_mm3(on_lattice, region);
    EXPECT_NEAR(region_volume_mm3(mesh, region), wanted, 0.02 * wanted) << region_name(tag(region));
  }
}

}  // namespace
