// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays, triangles and ids of a mesh, carried to the mesh that it became.
#include "generator/tetmesh/carry_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "generator/mesh_files/surface_faces.hpp"
#include "tetmesh/blocks.hpp"

namespace heartgen {
namespace {

/// A shaken block of two regions; its outer triangles have label 21 at z = 0 and 22 elsewhere.
UnstructuredData shaken_block() {
  auto b = testing::block(5, 2);
  testing::shake(b, 0.3, 5, [&](std::size_t i) { return !b.on_border(i) && b.nodes[i].z != 2; });
  UnstructuredData mesh;
  mesh.points = b.nodes;
  mesh.tets = b.cells;
  mesh.cell_scalars["region"] = {b.region.begin(), b.region.end()};
  for (const auto& face : mesh_files::surface_faces(b.cells, {})) {
    const auto at_bottom = [&](std::int32_t n) { return b.nodes[static_cast<std::size_t>(n)].z == 0; };
    mesh.faces.push_back(face.nodes);
    mesh.face_scalars["region"].push_back(std::all_of(face.nodes.begin(), face.nodes.end(), at_bottom) ? 21 : 22);
  }
  return mesh;
}

tetmesh::ImprovedMesh improved(const UnstructuredData& mesh, double slide = 0) {
  const auto& region = mesh.cell_scalars.at("region");
  return tetmesh::improve_mesh(mesh.points, mesh.tets, {region.begin(), region.end()},
                               {.goal_deg = 25, .slide_mm = slide});
}

double area(const UnstructuredData& mesh, double label) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto at = [&](std::size_t i) { return mesh.points[static_cast<std::size_t>(mesh.faces[f][i])]; };
    if (mesh.face_scalars.at("region")[f] == label) sum += 0.5 * norm(cross(at(1) - at(0), at(2) - at(0)));
  }
  return sum;
}

bool says(const UnstructuredData& mesh, const std::string& words) {
  return std::any_of(mesh.remarks.begin(), mesh.remarks.end(),
                     [&](const auto& remark) { return remark.find(words) != std::string::npos; });
}

TEST(CarriedMesh, AxesOfAnyLengthKeepIt) {
  auto mesh = shaken_block();
  for (const auto& p : mesh.points) mesh.point_vectors["f0"].push_back({37 * std::cos(p.z), 37 * std::sin(p.z), 0});
  for (std::size_t c = 0; c < mesh.tets.size(); ++c) mesh.cell_vectors["fiber"].push_back({0, 37, 0});
  const auto result = tetmesh::carried_mesh(mesh, "region", {}, improved(mesh));
  ASSERT_NE(result.points, mesh.points);
  for (const auto& f : result.point_vectors.at("f0")) EXPECT_NEAR(norm(f), 37, 1e-9);
  for (const auto& f : result.cell_vectors.at("fiber")) EXPECT_EQ(f, (Vec3{0, 37, 0}));
}

TEST(CarriedMesh, LabelledTrianglesStayAndInnerOnesAreCounted) {
  auto mesh = shaken_block();
  const auto outer = mesh.faces.size();
  const auto& cell = mesh.tets[200];  // inside region 7
  mesh.faces.push_back({cell[0], cell[1], cell[2]});
  mesh.face_scalars["region"].push_back(23);
  const auto result = tetmesh::carried_mesh(mesh, "region", {}, improved(mesh));
  EXPECT_GE(result.faces.size(), outer);
  EXPECT_EQ(result.faces.size() < mesh.faces.size(), says(result, "left out: 1 of 301 triangles"));
  EXPECT_NEAR(area(result, 21), 25, 1e-9);
  EXPECT_NEAR(area(result, 22), 125, 1e-9);
}

TEST(CarriedMesh, SurfacesThatMovedKeepTheirLabels) {
  const auto mesh = shaken_block();
  const auto better = improved(mesh, 0.05);
  ASSERT_FALSE(better.is_fixed);
  const auto result = tetmesh::carried_mesh(mesh, "region", {}, better);
  EXPECT_EQ(result.faces.size(), mesh_files::surface_faces(better.cells, {}).size());
  EXPECT_NEAR(area(result, 21), 25, 0.5);
  EXPECT_NEAR(area(result, 22), 125, 2);
}

TEST(CarriedMesh, IdsAreMadeAnewOrLeftOutAndAllAreNamed) {
  auto mesh = shaken_block();
  const auto count = [](std::size_t size, double first) {
    std::vector<double> values(size);
    std::iota(values.begin(), values.end(), first);
    return values;
  };
  mesh.point_scalars["GlobalNodeID"] = count(mesh.points.size(), 1);
  mesh.point_scalars["vtkOriginalPointIds"] = count(mesh.points.size(), 0);
  mesh.cell_scalars["GlobalElementID"] = count(mesh.tets.size(), 301);
  mesh.face_scalars["GlobalElementID"] = count(mesh.faces.size(), 1);
  auto backwards = count(mesh.tets.size(), 0);
  std::reverse(backwards.begin(), backwards.end());
  mesh.cell_scalars["old_cell"] = backwards;
  const auto ids = tetmesh::take_out_ids(mesh, "region");
  EXPECT_TRUE(says(mesh, "ids made anew: GlobalElementID, GlobalNodeID"));
  EXPECT_TRUE(says(mesh, "left out: old_cell, vtkOriginalPointIds"));
  const auto result = tetmesh::carried_mesh(mesh, "region", ids, improved(mesh));
  EXPECT_EQ(result.point_scalars.at("GlobalNodeID"), count(result.points.size(), 1));
  EXPECT_EQ(result.face_scalars.at("GlobalElementID"), count(result.faces.size(), 1));
  EXPECT_EQ(result.cell_scalars.at("GlobalElementID"),
            count(result.tets.size(), 1 + static_cast<double>(result.faces.size())));
  EXPECT_FALSE(result.cell_scalars.contains("old_cell"));
}

}  // namespace
}  // namespace heartgen
