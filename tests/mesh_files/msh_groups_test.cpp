// SPDX-License-Identifier: GPL-3.0-or-later
// Groups, partitions, views and the looks of .msh files, as gmsh and others write them.
#include <gtest/gtest.h>

#include <algorithm>

#include "generator/mesh_files/msh_file.hpp"
#include "model/text.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

using Labels = std::vector<double>;

const std::string format_2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string format_4 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";

/// Five nodes and two tetrahedra that share a face.
const std::string nodes_2 = "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1.5\n$EndNodes\n";
const std::string nodes_4 = "$Nodes\n1 5 1 5\n3 1 0 5\n1\n2\n3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1.5\n$EndNodes\n";

/// A tetrahedron in each of the volumes 1 and 2, a triangle in surface 6.
const std::string elements_4 =
    "$Elements\n3 3 1 3\n3 1 4 1\n1 1 2 3 4\n3 2 4 1\n2 2 3 4 5\n2 6 2 1\n3 1 2 3\n$EndElements\n";

/// The entities of that with the groups "count tag ..." of the surface and both volumes.
std::string entities(const std::string& surface, const std::string& first, const std::string& second) {
  return "$Entities\n0 0 1 2\n6 0 0 0 1 1 1 " + surface + " 0\n1 0 0 0 1 1 1 " + first + " 1 6\n2 0 0 0 1 1 1 " +
         second + " 1 6\n$EndEntities\n";
}

UnstructuredData read(const std::string& text) {
  const auto path = testing::scratch_folder("msh_groups") / "mesh.msh";
  write_text(path, text);
  return mesh_files::read_msh(path);
}

bool says(const UnstructuredData& mesh, const std::string& words) {
  return std::any_of(mesh.remarks.begin(), mesh.remarks.end(),
                     [&](const auto& remark) { return remark.find(words) != std::string::npos; });
}

TEST(MshGroups, AnEntityWithoutAGroupIsARegionOfItsOwn) {
  const auto mesh = read(format_4 + entities("0", "1 2", "0") + nodes_4 + elements_4);
  EXPECT_EQ(mesh.cell_scalars.at("region"), (Labels{2, 3})) << "entity 1 is group 2, entity 2 has none";
  EXPECT_TRUE(says(mesh, "volume 2 has no physical group: its region is 3"));
  const auto plain = read(format_4 + entities("0", "0", "0") + nodes_4 + elements_4);
  EXPECT_EQ(plain.cell_scalars.at("region"), (Labels{1, 2})) << "without any group entities are what there is";
  EXPECT_EQ(plain.face_scalars.at("region"), Labels{6});
  EXPECT_TRUE(plain.remarks.empty());
  const auto second = read(format_2 + nodes_2 + "$Elements\n2\n1 4 2 2 1 1 2 3 4\n2 4 2 0 2 2 3 4 5\n$EndElements\n");
  EXPECT_EQ(second.cell_scalars.at("region"), (Labels{2, 3})) << "2.2 writes group 0 for none";
}

TEST(MshGroups, ANegativeGroupTakesTheSurfaceTurnedOver) {
  const auto mesh = read(format_4 + entities("1 -21", "1 11", "1 12") + nodes_4 + elements_4);
  EXPECT_EQ(mesh.face_scalars.at("region"), Labels{21});
  EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 2, 1}}));
  EXPECT_EQ(mesh.cell_scalars.at("region"), (Labels{11, 12}));
}

TEST(MshGroups, OfSeveralGroupsTheFirstIsTakenAloud) {
  const auto mesh = read(format_4 + entities("2 21 22", "1 11", "2 13 12") + nodes_4 + elements_4);
  EXPECT_EQ(mesh.cell_scalars.at("region"), (Labels{11, 13}));
  EXPECT_TRUE(says(mesh, "volume 2 is in the groups 13, 12: its region is 13"));
  EXPECT_TRUE(says(mesh, "surface 6 is in the groups 21, 22: its label is 21"));
  const auto twice = read(format_2 + nodes_2 +
                          "$Elements\n3\n1 4 2 11 1 1 2 3 4\n2 4 2 12 1 4 3 2 1\n3 4 2 12 2 2 3 4 5\n$EndElements\n");
  EXPECT_EQ(twice.cell_scalars.at("region"), (Labels{11, 12})) << "2.2 writes an element once per group";
  EXPECT_TRUE(says(twice, "1 tetrahedra stand there again"));
}

TEST(MshGroups, PartsOfPartitionsHaveTheGroupsOfTheWhole) {
  // Volume 1 (group 11) is cut into 7 and 8; 9 is the surface between them, 10 the part of surface 6 (group 21).
  const std::string parts =
      "$PartitionedEntities\n2\n1\n30 1\n0 0 2 2\n9 3 1 2 1 2 0 0 0 1 1 1 1 11 0\n10 2 6 1 1 0 0 0 1 1 1 0 0\n"
      "7 3 1 1 1 0 0 0 1 1 1 1 11 1 9\n8 3 1 1 2 0 0 0 1 1 1 2 40 11 1 9\n$EndPartitionedEntities\n";
  const std::string elements =
      "$Elements\n4 4 1 4\n3 7 4 1\n1 1 2 3 4\n3 8 4 1\n2 2 3 4 5\n2 9 2 1\n3 2 3 4\n2 10 2 1\n4 1 2 3\n$EndElements\n";
  const std::string names = "$PhysicalNames\n2\n3 11 \"wall\"\n3 40 \"_part{2}\"\n$EndPhysicalNames\n";
  const auto mesh = read(format_4 + names + entities("1 21", "1 11", "1 12") + parts + nodes_4 + elements);
  EXPECT_EQ(mesh.cell_scalars.at("region"), (Labels{11, 11}));
  EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 1, 2}}));
  EXPECT_EQ(mesh.face_scalars.at("region"), Labels{21});
  EXPECT_TRUE(says(mesh, "left out: 1 partition-boundary triangle"));
}

TEST(MshText, LineEndsBlanksCommentsAndGapsMakeNoDifference) {
  const std::string plain = format_2 + nodes_2 + "$Elements\n2\n1 4 2 7 1 1 2 3 4\n2 4 2 8 2 2 3 4 5\n$EndElements\n";
  const auto replaced = [&](const std::string& old, const std::string& by) {
    std::string text = plain;
    for (std::size_t at = 0; (at = text.find(old, at)) != std::string::npos; at += by.size())
      text.replace(at, old.size(), by);
    return text;
  };
  const auto expected = read(plain);
  for (const auto& text :
       {replaced("\n", "\r\n"), replaced("$Nodes\n", "$Nodes \n"), replaced("$EndNodes\n", "$EndNodes \t\n\n"),
        "$Comments\n$Nodes and more\n$EndComments\n" + plain,
        replaced("$Nodes\n", "$Comments\nx\n$EndComments\n$Nodes\n")}) {
    const auto mesh = read(text);
    EXPECT_EQ(mesh.points, expected.points);
    EXPECT_EQ(mesh.tets, expected.tets);
    EXPECT_EQ(mesh.cell_scalars, expected.cell_scalars);
    EXPECT_TRUE(mesh.remarks.empty());
  }
  const auto gapped = read(format_2 +
                           "$Nodes\n4\n900000000000 0 0 0\n5 1 0 0\n-3 0 1 0\n70 0 0 1\n$EndNodes\n"
                           "$Elements\n1\n1 4 2 7 1 900000000000 5 -3 70\n$EndElements\n");
  EXPECT_EQ(gapped.tets, (std::vector<Cell>{{0, 1, 2, 3}}));
}

TEST(MshViews, BecomeArraysAndComeBack) {
  const auto view = [](const std::string& section, const std::string& name, const std::string& counts,
                       const std::string& rows) {
    return "$" + section + "\n1\n\"" + name + "\"\n1\n0\n3\n0\n" + counts + rows + "$End" + section + "\n";
  };
  const std::string mesh_text =
      format_2 + nodes_2 + "$Elements\n3\n4 4 2 7 1 1 2 3 4\n9 4 2 8 2 2 3 4 5\n2 2 2 5 1 1 2 3\n$EndElements\n";
  const auto mesh = read(mesh_text + view("ElementData", "fiber", "3\n3\n", "9 0 1 0\n4 1 0 0\n2 0 0 1\n") +
                         view("NodeData", "time", "1\n2\n", "5 2.5\n1 1.5\n") +
                         view("NodeData", "pair", "2\n1\n", "1 0 0\n") + "$Periodic\n0\n$EndPeriodic\n");
  EXPECT_EQ(mesh.cell_vectors.at("fiber"), (std::vector<Vec3>{{1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.face_vectors.at("fiber"), (std::vector<Vec3>{{0, 0, 1}}));
  EXPECT_EQ(mesh.point_scalars.at("time"), (Labels{1.5, 0, 0, 0, 2.5}));
  EXPECT_TRUE(says(mesh, "\"time\" has values at 2 of 5 places"));
  EXPECT_TRUE(says(mesh, "left out: the view \"pair\" of 2 components"));
  EXPECT_TRUE(says(mesh, "left out: 1 section $Periodic"));
  const auto path = testing::scratch_folder("msh_views") / "mesh.msh";
  mesh_files::write_msh(path, mesh, "region");
  const auto again = mesh_files::read_msh(path);
  EXPECT_EQ(again.cell_vectors, mesh.cell_vectors);
  EXPECT_EQ(again.face_vectors, mesh.face_vectors);
  EXPECT_EQ(again.point_scalars, mesh.point_scalars);
  EXPECT_EQ(again.face_scalars, mesh.face_scalars);
}

TEST(MshViews, TheMeshMayStandThereAgainBeforeThem) {
  const std::string mesh_text = format_2 + nodes_2 + "$Elements\n1\n4 4 2 7 1 1 2 3 4\n$EndElements\n";
  const std::string view = "$ElementData\n1\n\"a\"\n1\n0\n3\n0\n1\n1\n4 2.5\n$EndElementData\n";
  for (const auto& text : {mesh_text + mesh_text + view, mesh_text + format_2 + view}) {
    const auto mesh = read(text);
    EXPECT_EQ(mesh.points.size(), 5U);
    EXPECT_EQ(mesh.cell_scalars.at("a"), Labels{2.5});
    EXPECT_TRUE(mesh.remarks.empty());
  }
  auto other = mesh_text;
  other.replace(other.find("1 1 1.5"), 7, "1 1 1.6");
  EXPECT_NE(testing::error_of([&] { read(mesh_text + other); }).find("two different meshes"), std::string::npos);
}

TEST(MshElements, OtherVolumesAreRefusedAndLinesCounted) {
  const auto refusal = [&](const std::string& element) {
    return testing::error_of(
        [&] { read(format_2 + nodes_2 + "$Elements\n2\n1 4 2 7 1 1 2 3 4\n" + element + "\n$EndElements\n"); });
  };
  EXPECT_NE(refusal("2 11 2 7 1 1 2 3 4 5 5 5 5 5 5").find("1 quadratic tetrahedron beside 1 linear tetrahedron"),
            std::string::npos);
  EXPECT_NE(refusal("2 7 2 7 1 1 2 3 4 5").find("1 pyramid"), std::string::npos);
  EXPECT_NE(refusal("2 99 2 7 1 1 2 3 4 5").find("type 99"), std::string::npos);
  const auto lines =
      read(format_2 + nodes_2 + "$Elements\n3\n1 4 2 7 1 1 2 3 4\n2 1 2 7 1 1 2\n3 15 2 7 1 1\n$EndElements\n");
  EXPECT_TRUE(says(lines, "left out: 1 line, 1 point"));
}

}  // namespace
}  // namespace heartgen
