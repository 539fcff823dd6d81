// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes of openCARP, TetGen, Chaste and Medit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>

#include "generator/mesh_files/carp_file.hpp"
#include "generator/mesh_files/medit_file.hpp"
#include "generator/mesh_files/tetgen_file.hpp"
#include "model/text.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;
using Labels = std::vector<double>;

const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1.5}};
const std::vector<Cell> cells{{0, 1, 2, 3}, {1, 2, 3, 4}};
const std::vector<Vec3> fibers{{1, 0, 0}, {0, 0.5, 0}};

void expect_mesh(const UnstructuredData& mesh) {
  EXPECT_EQ(mesh.points, corners);
  EXPECT_EQ(mesh.tets, cells);
  EXPECT_EQ(mesh.cell_scalars.at("region"), (Labels{7, 8}));
}

bool says(const UnstructuredData& mesh, const std::string& words) {
  return std::any_of(mesh.remarks.begin(), mesh.remarks.end(),
                     [&](const auto& remark) { return remark.find(words) != std::string::npos; });
}

/// Every file of the mesh cut off anywhere must be refused, or be the same mesh.
template <class Read>
void expect_cut_files_are_refused(const fs::path& file, const Read& read) {
  const auto whole = testing::bytes_of(file);
  for (std::size_t size = 0; size + 4 < whole.size(); size += 1 + whole.size() / 300) {
    write_text(file, whole.substr(0, size));
    EXPECT_THROW(read(), UserError) << file << " cut to " << size << " of " << whole.size();
  }
  write_text(file, whole);
}

void write_carp_text(const fs::path& base) {
  write_text(base.string() + ".pts", "5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\r\n1 1 1.5\n");
  write_text(base.string() + ".elem", "4\nTt 0 1 2 3 7\nLn 0 1 9\nTr 0 1 2 21\nTt 1 2 3 4 8\n");
  write_text(base.string() + ".lon", "2\n1 0 0 0 1 0\n9 9 9 9 9 9\n0 0 1 1 0 0\n0 0.5 0 0 0 1\n");
}

TEST(Carp, TextIsRead) {
  const auto base = testing::scratch_folder("carp_text") / "m";
  write_carp_text(base);
  for (const char* ending : {".pts", ".elem", ".lon"}) {
    const auto mesh = mesh_files::read_carp(base.string() + ending);
    expect_mesh(mesh);
    EXPECT_EQ(mesh.cell_vectors.at("fiber"), fibers);
    EXPECT_EQ(mesh.cell_vectors.at("sheet"), (std::vector<Vec3>{{0, 1, 0}, {0, 0, 1}}));
    EXPECT_EQ(mesh.face_scalars.at("region"), Labels{21});
    EXPECT_EQ(mesh.face_vectors.at("fiber"), (std::vector<Vec3>{{0, 0, 1}}));
    EXPECT_TRUE(says(mesh, "left out: 1 line"));
  }
  const auto read = [&] { mesh_files::read_carp(base.string() + ".pts"); };
  for (const char* ending : {".pts", ".elem", ".lon"}) expect_cut_files_are_refused(base.string() + ending, read);
  write_text(base.string() + ".lon", "1 0 0\n9 9 9\n0 0 1\n0 0.5 0\n");
  EXPECT_EQ(mesh_files::read_carp(base.string() + ".pts").cell_vectors.at("fiber"), fibers) << "no header, one axis";
  fs::remove(base.string() + ".lon");
  EXPECT_TRUE(mesh_files::read_carp(base.string() + ".pts").cell_vectors.empty());
}

template <class T>
std::string bytes(std::initializer_list<T> values, bool is_swapped) {
  std::string text;
  for (const T value : values) {
    std::array<char, sizeof(T)> one;
    std::memcpy(one.data(), &value, sizeof(T));
    if (is_swapped) std::reverse(one.begin(), one.end());
    text.append(one.data(), one.size());
  }
  return text;
}

std::string header(std::string text) {
  text.resize(1024, '\0');
  return text;
}

TEST(Carp, BinaryIsReadInEitherByteOrder) {
  for (const bool is_swapped : {false, true}) {
    const auto base = testing::scratch_folder("carp_binary") / "m";
    const std::string order = is_swapped ? " 1 666" : " 0 666";
    const auto reals = [&](std::initializer_list<float> values) { return bytes(values, is_swapped); };
    const auto ints = [&](std::initializer_list<std::int32_t> values) { return bytes(values, is_swapped); };
    write_text(base.string() + ".bpts", header("5" + order) + reals({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1.5F}));
    write_text(base.string() + ".belem",
               header("3" + order) + ints({0, 0, 1, 2, 3, 7, 6, 0, 1, 2, 21, 0, 1, 2, 3, 4, 8}));
    write_text(base.string() + ".blon", header("1 3" + order) + reals({1, 0, 0, 0, 0, 1, 0, 0.5F, 0}));
    const auto mesh = mesh_files::read_carp(base.string() + ".bpts");
    expect_mesh(mesh);
    EXPECT_EQ(mesh.cell_vectors.at("fiber"), fibers);
    EXPECT_EQ(mesh.face_scalars.at("region"), Labels{21});
    const auto read = [&] { mesh_files::read_carp(base.string() + ".belem"); };
    for (const char* ending : {".bpts", ".belem", ".blon"}) expect_cut_files_are_refused(base.string() + ending, read);
  }
}

TEST(Carp, WhatCannotBeIsRefused) {
  const auto base = testing::scratch_folder("carp_broken") / "m";
  const auto refusal = [&](const char* ending, const std::string& text) {
    write_carp_text(base);
    write_text(base.string() + ending, text);
    return testing::error_of([&] { mesh_files::read_carp(base.string() + ".pts"); });
  };
  EXPECT_NE(refusal(".elem", "1\nTt 0 1 2 5 7\n").find("names node 5"), std::string::npos);
  EXPECT_NE(refusal(".elem", "1\nTx 0 1 2 3 7\n").find("\"Tx\""), std::string::npos);
  EXPECT_NE(
      refusal(".elem", "2\nTt 0 1 2 3 7\nHx 0 1 2 3 4 0 1 2 8\n").find("1 hexahedron beside 1 linear tetrahedron"),
      std::string::npos);
  EXPECT_NE(refusal(".lon", "1\n1 0 0\n").find("too early"), std::string::npos);
  EXPECT_NE(refusal(".pts", "99999999999999\n0 0 0\n").find("too early"), std::string::npos);
  EXPECT_NE(refusal(".pts", "1\n0 0 nan\n").find("not finite"), std::string::npos);
}

TEST(Tetgen, NodesElementsAndFacesAreRead) {
  const auto base = testing::scratch_folder("tetgen") / "m";
  for (const int first : {0, 1}) {
    const auto id = [&](int n) { return std::to_string(n + first); };
    std::string nodes = "# made by hand\n5 3 1 1\n";
    for (int n = 0; n < 5; ++n) {
      const auto& p = corners[static_cast<std::size_t>(n)];
      nodes += id(n) + " " + number_text(p.x) + " " + number_text(p.y) + " " + number_text(p.z) +
               (n == 0 ? " 0.5 1  # a node\n" : " 0.5 1\n");
    }
    write_text(base.string() + ".node", nodes);
    write_text(base.string() + ".ele", "2 4 1\n" + id(0) + " " + id(0) + " " + id(1) + " " + id(2) + " " + id(3) +
                                           " 7\n\n" + id(1) + " " + id(1) + " " + id(2) + " " + id(3) + " " + id(4) +
                                           " 8\n");
    write_text(base.string() + ".face",
               "2 1\n0 " + id(0) + " " + id(1) + " " + id(2) + " 21\n1 " + id(1) + " " + id(2) + " " + id(3) + " 0\n");
    const auto mesh = mesh_files::read_tetgen(base.string() + ".ele");
    expect_mesh(mesh);
    EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 1, 2}}));
    EXPECT_EQ(mesh.face_scalars.at("region"), Labels{21});
    EXPECT_EQ(mesh.point_scalars.at("attribute_1"), Labels(5, 0.5));
    EXPECT_TRUE(says(mesh, "left out: 1 triangles without a marker"));
  }
  const auto read = [&] { mesh_files::read_tetgen(base.string() + ".node"); };
  for (const char* ending : {".node", ".ele", ".face"}) expect_cut_files_are_refused(base.string() + ending, read);
  write_text(base.string() + ".ortho", "2\n1 0 0 0 1 0 0 0 1\n0 0.5 0 0 0 1 1 0 0\n");
  const auto chaste = mesh_files::read_tetgen(base.string() + ".node");
  EXPECT_EQ(chaste.cell_vectors.at("fiber"), fibers);
  EXPECT_EQ(chaste.cell_vectors.at("sheet_normal"), (std::vector<Vec3>{{0, 0, 1}, {1, 0, 0}}));
  write_text(base.string() + ".ele", "3 10 0\n0 1 2 3 4 5 5 5 5 5 5\n");
  EXPECT_NE(testing::error_of(read).find("3 quadratic tetrahedra"), std::string::npos);
}

const std::string medit =
    "MeshVersionFormatted 2\n# by hand\nDimension\n3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1.5 4\n"
    "Corners\n2\n1\n2\nTriangles\n1\n1 2 3 21\nEdges\n1\n1 2 5\nTetrahedra\n2\n1 2 3 4 7\n2 3 4 5 8\nEnd\n";

TEST(Medit, TextIsRead) {
  const auto path = testing::scratch_folder("medit") / "m.mesh";
  write_text(path, medit);
  const auto mesh = mesh_files::read_medit(path);
  expect_mesh(mesh);
  EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 1, 2}}));
  EXPECT_EQ(mesh.face_scalars.at("region"), Labels{21});
  EXPECT_EQ(mesh.point_scalars.at("vertex_reference"), (Labels{0, 0, 0, 0, 4}));
  EXPECT_TRUE(says(mesh, "left out: 1 line"));
  EXPECT_TRUE(says(mesh, "left out: section Corners"));
  const auto refusal = [&](const std::string& text) {
    write_text(path, text);
    return testing::error_of([&] { mesh_files::read_medit(path); });
  };
  EXPECT_NE(refusal("MFEM mesh v1.0\n").find("MeshVersionFormatted"), std::string::npos);
  EXPECT_NE(refusal(medit.substr(0, medit.size() - 12)).find("too early"), std::string::npos);
  auto wrong = medit;
  wrong.replace(wrong.find("2 3 4 5 8"), 9, "2 3 4 6 8");
  EXPECT_NE(refusal(wrong).find("names vertex 6"), std::string::npos);
}

TEST(Medit, BinaryIsReadInEveryVersionAndByteOrder) {
  const auto path = testing::scratch_folder("medit_binary") / "m.meshb";
  for (const bool is_swapped : {false, true})
    for (const std::int32_t version : {1, 2, 3, 4}) {
      std::string text = bytes({std::int32_t{1}, version}, is_swapped);
      const auto place = [&](std::size_t at) {
        return version >= 3 ? bytes({static_cast<std::int64_t>(at)}, is_swapped)
                            : bytes({static_cast<std::int32_t>(at)}, is_swapped);
      };
      const auto wholes = [&](std::initializer_list<std::int64_t> values) {
        std::string all;
        for (const auto v : values)
          all += version == 4 ? bytes({v}, is_swapped) : bytes({static_cast<std::int32_t>(v)}, is_swapped);
        return all;
      };
      const auto section = [&](std::int32_t code, const std::string& content) {
        text += bytes({code}, is_swapped);
        text += place(text.size() + place(0).size() + content.size()) + content;
      };
      section(3, bytes({std::int32_t{3}}, is_swapped));
      std::string vertices = wholes({5});
      for (const auto& p : corners)
        vertices += (version == 1 ? bytes({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
                                          is_swapped)
                                  : bytes({p.x, p.y, p.z}, is_swapped)) +
                    wholes({0});
      section(4, vertices);
      section(13, wholes({1, 1}));  // corners
      section(6, wholes({1, 1, 2, 3, 21}));
      section(8, wholes({2, 1, 2, 3, 4, 7, 2, 3, 4, 5, 8}));
      text += bytes({std::int32_t{54}}, is_swapped) + place(0);
      write_text(path, text);
      const auto mesh = mesh_files::read_medit(path);
      expect_mesh(mesh);
      EXPECT_EQ(mesh.face_scalars.at("region"), Labels{21});
      EXPECT_TRUE(says(mesh, "left out: section of kind 13"));
      write_text(path, text.substr(0, text.size() - 30));
      EXPECT_THROW(mesh_files::read_medit(path), UserError);
    }
}

}  // namespace
}  // namespace heartgen
