#include "generator/improve/msh_file.hpp"

#include <gtest/gtest.h>

#include "model/error.hpp"
#include "model/text.hpp"
#include "support/files.hpp"

namespace {

using namespace heart;

const std::string version_2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 7 \"left wall\"\n2 9 \"skin\"\n$EndPhysicalNames\n"
    "$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1.5e0\n$EndNodes\n"
    "$Elements\n4\n1 15 2 0 1 10\n2 2 2 9 1 10 20 30\n3 4 2 7 1 10 20 30 40\n4 4 2 8 2 20 30 40 50\n$EndElements\n";

const std::string version_4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 7 \"left wall\"\n$EndPhysicalNames\n"
    "$Entities\n1 0 1 2\n5 0 0 0 0\n4 0 0 0 1 1 1 1 9 0\n1 0 0 0 1 1 1 1 7 1 4\n2 0 0 0 1 1 1 0 1 4\n$EndEntities\n"
    "$Nodes\n2 5 10 50\n2 4 0 3\n10\n20\n30\n0 0 0\n1 0 0\n0 1 0\n3 1 0 2\n40\n50\n0 0 1\n1 1 1.5\n$EndNodes\n"
    "$Elements\n3 3 1 3\n2 4 2 1\n1 10 20 30\n3 1 4 1\n2 10 20 30 40\n3 2 4 1\n3 20 30 40 50\n$EndElements\n";

std::filesystem::path file_with(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::path(::testing::TempDir()) / ("heartgen_test_msh_" + name + ".msh");
  write_text(path, text);
  return path;
}

TEST(Msh, BothVersionsAreRead) {
  for (const auto& text : {version_2, version_4}) {
    const auto mesh = improve::read_msh(file_with("both", text));
    ASSERT_EQ(mesh.nodes.size(), 5U);
    EXPECT_EQ(mesh.nodes[4], (Vec3{1, 1, 1.5}));
    EXPECT_EQ(mesh.cells, (std::vector<Cell>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    EXPECT_EQ(mesh.region[0], 7);
    EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 1, 2}}));
    EXPECT_EQ(mesh.surface, std::vector<std::int32_t>{9});
    EXPECT_EQ(mesh.names.at({3, 7}), "left wall");
  }
}

TEST(Msh, WrittenFilesReadBackTheSame) {
  const auto mesh = improve::read_msh(file_with("first", version_2));
  const auto path = file_with("second", "");
  improve::write_msh(path, mesh);
  const auto again = improve::read_msh(path);
  EXPECT_EQ(again.nodes, mesh.nodes);
  EXPECT_EQ(again.cells, mesh.cells);
  EXPECT_EQ(again.region, mesh.region);
  EXPECT_EQ(again.faces, mesh.faces);
  EXPECT_EQ(again.surface, mesh.surface);
  EXPECT_EQ(again.names, mesh.names);
}

std::string with(std::string text, const std::string& old, const std::string& replacement) {
  const auto at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), replacement);
}

TEST(Msh, BrokenFilesAreRefusedByName) {
  const std::vector<std::pair<std::string, std::string>> broken = {
      {"not a mesh\n", "$MeshFormat"},
      {with(version_2, "2.2 0 8", "2.2 1 8"), "binary"},
      {with(version_2, "2.2 0 8", "3.0 0 8"), "version 3.0"},
      {with(version_2, "10 20 30 40\n", "10 20 30 41\n"), "node 41"},
      {with(version_2, "50 1 1 1.5e0", "50 1 1 nan"), ""},
      {with(version_2, "20 1 0 0\n30", "10 1 0 0\n30"), "node 10"},
      {with(version_2, "$Nodes\n5\n", "$Nodes\n9\n"), "too early"},
      {with(version_4, "$Elements\n3 3 1 3\n", "$Elements\n-3 3 1 3\n"), "no count"},
      {with(with(version_2, "3 4 2 7", "3 11 2 7"), "4 4 2 8", "4 11 2 8"), "no tetrahedron"}};
  for (const auto& [text, expected] : broken) {
    const auto path = file_with("broken", text);
    try {
      improve::read_msh(path);
      ADD_FAILURE() << "accepted: " << expected;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
    }
  }
  EXPECT_THROW(improve::read_msh("/nowhere/mesh.msh"), UserError);
}

}  // namespace
