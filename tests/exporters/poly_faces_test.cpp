// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/poly_faces.hpp"

#include <gtest/gtest.h>

#include <tuple>

#include "exporters/registry.hpp"
#include "model/error.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/two_region_mesh.hpp"

namespace heartgen::exporters {
namespace {

using testing::two_region_mesh;

TEST(PolyFaces, AreUpperTriangularAndThenByPatch) {
  const TetMesh mesh = two_region_mesh(3, Region::la_wall);
  const PolyFaces faces = poly_faces(mesh);
  const std::size_t inner = faces.neighbour.size();
  EXPECT_EQ(faces.nodes.size() + inner, 4 * mesh.cells.size()) << "an inner face counts for two cells";
  for (std::size_t f = 0; f < inner; ++f) ASSERT_LT(faces.owner[f], faces.neighbour[f]);
  for (std::size_t f = 1; f < inner; ++f)
    ASSERT_LT(std::tie(faces.owner[f - 1], faces.neighbour[f - 1]), std::tie(faces.owner[f], faces.neighbour[f]));
  for (std::size_t f = inner + 1; f < faces.nodes.size(); ++f)
    ASSERT_LE(std::tie(faces.surface[f - 1], faces.owner[f - 1]), std::tie(faces.surface[f], faces.owner[f]));
}

TEST(PolyFaces, LookOutOfTheirOwners) {
  const TetMesh mesh = two_region_mesh(2);
  const PolyFaces faces = poly_faces(mesh);
  for (std::size_t f = 0; f < faces.nodes.size(); ++f) {
    const auto at = [&](std::int32_t node) { return mesh.nodes_mm[static_cast<std::size_t>(node)]; };
    const auto& [a, b, c] = faces.nodes[f];
    Vec3 middle;
    for (const auto node : mesh.cells[static_cast<std::size_t>(faces.owner[f])]) middle += at(node) / 4;
    ASSERT_GT(dot(cross(at(b) - at(a), at(c) - at(a)), at(a) - middle), 0);
  }
}

TEST(PolyFaces, EveryLabelledFaceKeepsItsLabel) {
  const TetMesh mesh = two_region_mesh(2);
  const PolyFaces faces = poly_faces(mesh);
  EXPECT_EQ(
      static_cast<std::size_t>(std::count_if(faces.surface.begin(), faces.surface.end(), [](auto s) { return s; })),
      mesh.faces.size());
}

TEST(PolyFaces, ThreeCellsOnAFaceAreRefused) {
  TetMesh mesh = two_region_mesh(1);
  mesh.cells.push_back(mesh.cells[0]);
  mesh.cells.push_back(mesh.cells[0]);
  mesh.region.insert(mesh.region.end(), 2, mesh.region[0]);
  EXPECT_THROW(poly_faces(mesh), UserError);
}

TEST(OpenFoam, ZonesAndPatchesHaveTheirNames) {
  const auto folder = testing::scratch_folder("openfoam_names");
  export_mesh("openfoam", two_region_mesh(1, Region::la_wall), "m", folder);
  const auto text = [&](const char* name) { return testing::bytes_of(folder / "m/constant/polyMesh" / name); };
  for (const char* region : {"lv_myocardium\n{", "la_wall\n{"})
    EXPECT_NE(text("cellZones").find(region), std::string::npos) << region;
  EXPECT_NE(text("faceZones").find("atrioventricular_junction\n{"), std::string::npos);
  EXPECT_NE(text("boundary").find("epicardium\n{\n    type patch;\n    nFaces 20;\n"), std::string::npos);
  EXPECT_EQ(text("boundary").find("atrioventricular_junction"), std::string::npos) << "no patch inside the mesh";
  EXPECT_NE(testing::bytes_of(folder / "m/0/fiber").find("class       volVectorField"), std::string::npos);
}

}  // namespace
}  // namespace heartgen::exporters
