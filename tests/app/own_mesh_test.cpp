// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes of the user's own through improve, transfer, export and validate, as a user runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "generator/mesh_files/any_mesh.hpp"
#include "generator/mesh_files/msh_file.hpp"
#include "generator/mesh_files/surface_faces.hpp"
#include "support/data.hpp"
#include "support/diced_cubes.hpp"
#include "support/program.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

/// A cube of edge 40 in two regions, with fibres that turn, and its outer triangles: label 7, at z = 0 label 8.
UnstructuredData cube() {
  constexpr int n = 4;
  UnstructuredData mesh;
  mesh.points = testing::cube_corners(n);
  testing::dice_cubes(n, [&](const Cell& cell, int i, int, int) {
    mesh.tets.push_back(cell);
    mesh.cell_scalars["CellEntityIds"].push_back(i < n / 2 ? 1 : 2);
  });
  for (const auto& face : mesh_files::surface_faces(mesh.tets, {})) {
    const auto at_bottom = [&](std::int32_t node) { return mesh.points[static_cast<std::size_t>(node)].z == 0; };
    mesh.faces.push_back(face.nodes);
    mesh.face_scalars["CellEntityIds"].push_back(std::all_of(face.nodes.begin(), face.nodes.end(), at_bottom) ? 8 : 7);
  }
  mesh.integers.insert("CellEntityIds");
  for (auto& p : mesh.points) {
    p *= 10;
    mesh.point_vectors["fiber"].push_back({std::cos(p.z / 20), std::sin(p.z / 20), 0});
    mesh.point_vectors["sheet"].push_back({0, 0, 1});
  }
  return mesh;
}

std::int64_t count_of(const std::vector<double>& values, double wanted) {
  return std::count(values.begin(), values.end(), wanted);
}

TEST(OwnMesh, ImproveKeepsLabelsOfTrianglesAndFibresThroughFormats) {
  const auto folder = testing::scratch_folder("own_improve");
  const auto mesh = cube();
  mesh_files::write_any_mesh(folder / "in.vtk", mesh, "CellEntityIds");
  std::string from = "in.vtk";
  for (const std::string to : {"a.msh", "b.vtu", "c.vtk", "d.msh"}) {
    const auto run = testing::heartgen("improve " + from + " " + to + " --json", folder.string());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto out = mesh_files::read_any_mesh(folder / to);
    const auto labels = mesh_files::find_labels(out, "", to);
    EXPECT_EQ(out.faces.size(), mesh.faces.size()) << to;
    EXPECT_EQ(count_of(out.face_scalars.at(labels), 8), 32) << to;
    EXPECT_EQ(count_of(out.face_scalars.at(labels), 7), 160) << to;
    EXPECT_TRUE(out.integers.contains(labels)) << to;
    EXPECT_EQ(out.point_vectors.at("fiber").size(), out.points.size()) << to;
    from = to;
  }
}

/// Legacy .vtk with one tetrahedron and other cells behind it.
void write_with(const fs::path& path, int cells, int numbers, const std::string& connectivity,
                const std::string& types) {
  std::ofstream out(path);
  out << "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n0 0 0\n1 0 0\n0 1 0\n0 0 "
         "1\n";
  for (int i = 0; i < 6; ++i) out << i << " 2 3\n";
  out << "CELLS " << cells << ' ' << numbers << "\n4 0 1 2 3\n"
      << connectivity << "CELL_TYPES " << cells << "\n10\n"
      << types;
}

TEST(OwnMesh, WhatCannotBeCarriedIsRefusedAndTheRestCounted) {
  const auto folder = testing::scratch_folder("own_other_cells");
  const auto refusal = [&](const std::string& command) {
    const auto run = testing::heartgen(command, folder.string());
    EXPECT_EQ(run.exit_code, 2) << command;
    return run.errors;
  };
  write_with(folder / "quadratic.vtk", 3, 27, "10 0 1 2 3 4 5 6 7 8 9\n10 0 1 2 3 4 5 6 7 8 9\n", "24\n24\n");
  for (const std::string command :
       {"improve quadratic.vtk o.vtk", "validate quadratic.vtk", "transfer quadratic.vtk quadratic.vtk o.vtk"})
    EXPECT_NE(refusal(command).find("2 quadratic tetrahedra beside 1 linear tetrahedron"), std::string::npos)
        << command;
  write_with(folder / "hexahedron.vtk", 2, 14, "8 0 1 2 3 4 5 6 7\n", "12\n");
  EXPECT_NE(refusal("improve hexahedron.vtk o.vtk").find("1 hexahedron"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "o.vtk"));
  write_with(folder / "lines.vtk", 3, 11, "2 0 1\n2 1 2\n", "3\n3\n");
  const auto run = testing::heartgen("improve lines.vtk o.vtk", folder.string());
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_NE(run.output.find("left out: 2 lines"), std::string::npos) << run.output;
}

TEST(OwnMesh, ValidateAndExportTakeIt) {
  const auto folder = testing::scratch_folder("own_export");
  auto mesh = cube();
  mesh.names = {{{3, 1}, "left half"}, {{2, 8}, "base"}};
  mesh_files::write_any_mesh(folder / "mine.msh", mesh, "CellEntityIds");
  const auto rows = testing::heartgen("validate mine.msh --all", folder.string());
  EXPECT_EQ(rows.exit_code, 0) << rows.output << rows.errors;
  for (const char* scope : {"mine/left_half", "mine/region_2", "mine/base"})
    EXPECT_NE(rows.output.find(scope), std::string::npos) << scope << rows.output;
  EXPECT_EQ(rows.output.find("lv_myocardium"), std::string::npos) << "1 is no tag of ours here";
  ASSERT_EQ(testing::heartgen("export mine.msh --to opencarp,msh --output e", folder.string()).exit_code, 0);
  const auto carp = mesh_files::read_any_mesh(folder / "e/opencarp/mine.pts");
  EXPECT_EQ(carp.tets, mesh.tets);
  EXPECT_EQ(carp.cell_scalars.at("region"), mesh.cell_scalars.at("CellEntityIds"));
  for (std::size_t n = 0; n < carp.points.size(); ++n)
    EXPECT_NEAR(norm(carp.points[n] - 1000 * mesh.points[n]), 0, 1e-6) << "um";
  EXPECT_EQ(carp.cell_vectors.at("fiber").size(), mesh.tets.size());
  const auto msh = mesh_files::read_any_mesh(folder / "e/msh/mine.msh");
  EXPECT_EQ(msh.names.at({3, 1}), "left_half") << "names go into file names";
  EXPECT_EQ(msh.names.at({2, 8}), "base");
  // And from openCARP's files, which are in um, back to mm.
  ASSERT_EQ(testing::heartgen("export e/opencarp/mine.elem --to vtu --output f", folder.string()).exit_code, 0);
  const auto vtu = mesh_files::read_any_mesh(folder / "f/vtu/mine.vtu");
  for (std::size_t n = 0; n < vtu.points.size(); ++n) EXPECT_NEAR(norm(vtu.points[n] - mesh.points[n]), 0, 1e-9);
  EXPECT_EQ(testing::heartgen("export mine.stl --to vtu --output g", folder.string()).exit_code, 2);
}

TEST(OwnMesh, TransferRefusesAnotherUnitByItsFactor) {
  const auto folder = testing::scratch_folder("own_transfer");
  auto mesh = cube();
  for (auto& p : mesh.points) p -= Vec3{20, 20, 20};
  mesh_files::write_any_mesh(folder / "source.vtu", mesh, "CellEntityIds");
  auto in_cm = mesh;
  in_cm.point_vectors.clear();
  for (auto& p : in_cm.points) p *= 0.1;  // lies inside the source, by chance of the origin
  mesh_files::write_any_mesh(folder / "cm.vtk", in_cm, "CellEntityIds");
  const auto refused = testing::heartgen("transfer source.vtu cm.vtk out.vtu --reach 20", folder.string());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("is it in cm? scale it by 10"), std::string::npos) << refused.errors;
  auto piece = in_cm;
  for (auto& p : piece.points) p += Vec3{12, 0, 0};  // of the same size, elsewhere: scaled it would leave the source
  mesh_files::write_any_mesh(folder / "piece.msh", piece, "CellEntityIds");
  const auto run = testing::heartgen("transfer source.vtu piece.msh out.msh", folder.string());
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  const auto out = mesh_files::read_any_mesh(folder / "out.msh");
  EXPECT_EQ(out.face_scalars.at("region"), piece.face_scalars.at("CellEntityIds"));
  EXPECT_EQ(out.cell_vectors.at("fiber").size(), piece.tets.size());
}

}  // namespace
}  // namespace heartgen
