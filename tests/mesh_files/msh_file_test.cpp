// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh_files/msh_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <initializer_list>

#include "model/error.hpp"
#include "model/text.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace {

using namespace heartgen;

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
  const auto path = heartgen::testing::scratch_root() / (name + ".msh");
  write_text(path, text);
  return path;
}

TEST(Msh, BothVersionsAreRead) {
  for (const auto& text : {version_2, version_4}) {
    const auto mesh = mesh_files::read_msh(file_with("both", text));
    ASSERT_EQ(mesh.points.size(), 5U);
    EXPECT_EQ(mesh.points[4], (Vec3{1, 1, 1.5}));
    EXPECT_EQ(mesh.tets, (std::vector<Cell>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    EXPECT_EQ(mesh.cell_scalars.at("region")[0], 7);
    EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 1, 2}}));
    EXPECT_EQ(mesh.face_scalars.at("region"), std::vector<double>{9});
    EXPECT_EQ(mesh.names.at({3, 7}), "left wall");
  }
}

/// Values as they lie in the memory of a machine of either byte order.
struct Bytes {
  bool is_swapped = false;
  std::string text{};

  template <class T>
  Bytes& put(std::initializer_list<T> values) {
    for (const T value : values) {
      std::array<char, sizeof(T)> bytes;
      std::memcpy(bytes.data(), &value, sizeof(T));
      if (is_swapped) std::reverse(bytes.begin(), bytes.end());
      text.append(bytes.data(), bytes.size());
    }
    return *this;
  }
  Bytes& ints(std::initializer_list<std::int32_t> values) { return put(values); }
  Bytes& longs(std::initializer_list<std::int64_t> values) { return put(values); }
  Bytes& reals(std::initializer_list<double> values) { return put(values); }
  Bytes& say(const std::string& words) {
    text += words;
    return *this;
  }
};

const std::string names = "$PhysicalNames\n2\n3 7 \"left wall\"\n2 9 \"skin\"\n$EndPhysicalNames\n";

/// The mesh of version_2, its node 10 where the bytes of "$Elements\n" make a coordinate.
std::string binary_version_2(bool is_swapped) {
  Bytes file{is_swapped};
  file.say("$MeshFormat\n2.2 1 8\n").ints({1}).say("\n$EndMeshFormat\n" + names + "$Nodes\n5\n");
  file.ints({10}).say("$Element").say("s\n$Nodes").reals({0}).ints({20}).reals({1, 0, 0}).ints({30}).reals({0, 1, 0});
  file.ints({40}).reals({0, 0, 1}).ints({50}).reals({1, 1, 1.5}).say("\n$EndNodes\n$Elements\n4\n");
  file.ints({15, 1, 2, 1, 0, 1, 10}).ints({2, 1, 2, 2, 9, 1, 10, 20, 30});
  file.ints({4, 2, 2, 3, 7, 1, 10, 20, 30, 40, 4, 8, 2, 20, 30, 40, 50});
  return file.say("\n$EndElements\n").text;
}

std::string binary_version_4(bool is_swapped) {
  Bytes file{is_swapped};
  file.say("$MeshFormat\n4.1 1 8\n").ints({1}).say("\n$EndMeshFormat\n" + names + "$Entities\n").longs({1, 0, 1, 2});
  file.ints({5}).reals({0, 0, 0}).longs({0});
  file.ints({4}).reals({0, 0, 0, 1, 1, 1}).longs({1}).ints({9}).longs({0});
  file.ints({1}).reals({0, 0, 0, 1, 1, 1}).longs({1}).ints({7}).longs({1}).ints({4});
  file.ints({2}).reals({0, 0, 0, 1, 1, 1}).longs({0, 1}).ints({4}).say("\n$EndEntities\n$Nodes\n");
  file.longs({2, 5, 10, 50}).ints({2, 4, 0}).longs({3, 10, 20, 30}).reals({0, 0, 0, 1, 0, 0, 0, 1, 0});
  file.ints({3, 1, 0}).longs({2, 40, 50}).reals({0, 0, 1, 1, 1, 1.5}).say("\n$EndNodes\n$Elements\n");
  file.longs({4, 4, 1, 4}).ints({0, 5, 15}).longs({1, 9, 10}).ints({2, 4, 2}).longs({1, 1, 10, 20, 30});
  file.ints({3, 1, 4}).longs({1, 2, 10, 20, 30, 40}).ints({3, 2, 4}).longs({1, 3, 20, 30, 40, 50});
  return file.say("\n$EndElements\n").text;
}

TEST(Msh, BinaryFilesAreReadInEitherByteOrder) {
  for (const bool is_swapped : {false, true})
    for (const auto& text : {binary_version_2(is_swapped), binary_version_4(is_swapped)}) {
      const auto mesh = mesh_files::read_msh(file_with("binary", text));
      ASSERT_EQ(mesh.points.size(), 5U);
      EXPECT_EQ(mesh.points[1], (Vec3{1, 0, 0}));
      EXPECT_EQ(mesh.points[4], (Vec3{1, 1, 1.5}));
      EXPECT_EQ(mesh.tets, (std::vector<Cell>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
      EXPECT_EQ(mesh.cell_scalars.at("region")[0], 7);
      EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 1, 2}}));
      EXPECT_EQ(mesh.face_scalars.at("region"), std::vector<double>{9});
      EXPECT_EQ(mesh.names.at({3, 7}), "left wall");
      EXPECT_EQ(mesh.names.at({2, 9}), "skin");
    }
}

TEST(Msh, BinaryFilesThatAreCutOffAreRefused) {
  for (const auto& whole : {binary_version_2(false), binary_version_4(false)}) {
    const auto end = whole.find("\n$EndElements");
    for (std::size_t size = 0; size <= end; ++size)
      EXPECT_THROW(mesh_files::read_msh(file_with("cut", whole.substr(0, size))), UserError) << size << " of " << end;
  }
}

TEST(Msh, WrittenFilesReadBackTheSame) {
  const auto mesh = mesh_files::read_msh(file_with("first", version_2));
  const auto path = file_with("second", "");
  mesh_files::write_msh(path, mesh, "region");
  const auto again = mesh_files::read_msh(path);
  EXPECT_EQ(again.points, mesh.points);
  EXPECT_EQ(again.tets, mesh.tets);
  EXPECT_EQ(again.cell_scalars, mesh.cell_scalars);
  EXPECT_EQ(again.faces, mesh.faces);
  EXPECT_EQ(again.face_scalars, mesh.face_scalars);
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
      {with(binary_version_2(false), "2.2 1 8", "2.2 1 4"), "binary"},
      {with(binary_version_4(false), "\n$EndNodes", "x\n$EndNodes"), "$Nodes"},
      {with(version_2, "10 20 30 40\n", "10 20 30 41\n"), "node 41"},
      {with(version_2, "50 1 1 1.5e0", "50 1 1 nan"), ""},
      {with(version_2, "20 1 0 0\n30", "10 1 0 0\n30"), "node 10"},
      {with(version_2, "$Nodes\n5\n", "$Nodes\n9\n"), "too early"},
      {with(version_4, "$Elements\n3 3 1 3\n", "$Elements\n-3 3 1 3\n"), "no count"},
      {with(with(version_2, "3 4 2 7", "3 11 2 7"), "4 4 2 8", "4 11 2 8"), "2 quadratic tetrahedra"}};
  for (const auto& [text, expected] : broken) {
    const auto path = file_with("broken", text);
    try {
      mesh_files::read_msh(path);
      ADD_FAILURE() << "accepted: " << expected;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
    }
  }
  EXPECT_THROW(mesh_files::read_msh("/nowhere/mesh.msh"), UserError);
}

}  // namespace
