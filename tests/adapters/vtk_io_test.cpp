// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/vtk_io.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include "model/error.hpp"
#include "support/comma_locale.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/two_region_mesh.hpp"

namespace heartgen::adapters {
namespace {

using testing::bytes_of;
using testing::scratch_folder;
using testing::two_region_mesh;
using testing::write_bytes;

void expect_equal(const FiberField& a, const FiberField& b) {
  EXPECT_EQ(a.fiber, b.fiber);
  EXPECT_EQ(a.sheet, b.sheet);
  EXPECT_EQ(a.sheet_normal, b.sheet_normal);
}

void expect_equal(const TetMesh& a, const TetMesh& b) {
  EXPECT_EQ(a.nodes_mm, b.nodes_mm);
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.region, b.region);
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(a.surface, b.surface);
  expect_equal(a.node_fibers, b.node_fibers);
  expect_equal(a.cell_fibers, b.cell_fibers);
  EXPECT_EQ(a.fiber_source, b.fiber_source);
  EXPECT_EQ(a.parent_node, b.parent_node);
  EXPECT_EQ(a.parent_cell, b.parent_cell);
  EXPECT_EQ(a.rule_difference_deg, b.rule_difference_deg);
  ASSERT_EQ(a.rims.size(), b.rims.size());
  for (std::size_t r = 0; r < a.rims.size(); ++r) {
    EXPECT_EQ(a.rims[r].name, b.rims[r].name);
    EXPECT_EQ(a.rims[r].tag, b.rims[r].tag);
    EXPECT_EQ(a.rims[r].nodes, b.rims[r].nodes);
  }
}

TetMesh round_trip(const TetMesh& mesh, const std::string& name) {
  const auto folder = scratch_folder(name);
  write_vtu(folder / "a.vtu", mesh);
  write_vtp(folder / "a.vtp", mesh);
  TetMesh back = read_vtu(folder / "a.vtu");
  read_surface(folder / "a.vtp", back);
  return back;
}

/// The message of the UserError that reading throws, or "" when none is thrown. VTK must print nothing.
template <class Read>
std::string error_of(const Read& read) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  std::string message;
  try {
    read();
  } catch (const UserError& error) {
    message = error.message;
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  return message;
}

const char* const ascii_atlas = R"(# vtk DataFile Version 3.0
two tetrahedra and a triangle
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 float
0 0 0  1.5 0 0  0 1 0  0 0 1  1 1 1
CELLS 3 14
3 0 1 2
4 0 1 2 3
4 1 2 3 4
CELL_TYPES 3
5 10 10
CELL_DATA 3
SCALARS part int 1
LOOKUP_TABLE default
7 8 9
POINT_DATA 5
VECTORS fibers float
1 0 0  0 1 0  0 0 1  1 0 0  0 1 0
)";

TEST(VtkIo, MeshComesBackBitForBit) {
  const TetMesh mesh = two_region_mesh(4);
  expect_equal(mesh, round_trip(mesh, "vtk_round_trip"));
}

TEST(VtkIo, MeshWithoutFibersRimsAndParents) {
  TetMesh mesh = two_region_mesh(2);
  mesh.node_fibers = mesh.cell_fibers = {};
  mesh.fiber_source.clear();
  mesh.parent_cell.clear();
  mesh.parent_node.clear();
  mesh.rims.clear();
  expect_equal(mesh, round_trip(mesh, "vtk_bare"));
}

TEST(VtkIo, SameBytesWhateverFolderAndLocale) {
  const TetMesh mesh = two_region_mesh(3);
  const auto first = scratch_folder("vtk_first"), second = scratch_folder("vtk_second");
  write_vtu(first / "a.vtu", mesh);
  write_vtp(first / "a.vtp", mesh);
  {
    const testing::CommaLocale comma;
    write_vtu(second / "b.vtu", mesh);
    write_vtp(second / "b.vtp", mesh);
    EXPECT_EQ(mesh.nodes_mm, read_vtu(first / "a.vtu").nodes_mm);
    write_bytes(first / "a.vtk", ascii_atlas);
    EXPECT_EQ(read_unstructured(first / "a.vtk").points[1], (Vec3{1.5, 0, 0}));
  }
  EXPECT_EQ(bytes_of(first / "a.vtu"), bytes_of(second / "b.vtu"));
  EXPECT_EQ(bytes_of(first / "a.vtp"), bytes_of(second / "b.vtp"));
}

TEST(VtkIo, OneSurfaceHasItsPointsOnly) {
  const TetMesh mesh = two_region_mesh(3);
  const auto folder = scratch_folder("vtk_one_surface");
  const auto tag = mesh.surface.front();
  std::vector<std::size_t> faces;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (mesh.surface[f] == tag) faces.push_back(f);
  write_vtp(folder / "a.vtp", mesh, faces, {});
  TetMesh back;
  back.nodes_mm = mesh.nodes_mm;
  read_surface(folder / "a.vtp", back);
  EXPECT_EQ(back.faces.size(), static_cast<std::size_t>(std::count(mesh.surface.begin(), mesh.surface.end(), tag)));
  EXPECT_EQ(std::set<std::int32_t>(back.surface.begin(), back.surface.end()), std::set<std::int32_t>{tag});
}

TEST(VtkIo, MissingFileAndFolderAreNamed) {
  const auto folder = scratch_folder("vtk_missing");
  EXPECT_NE(error_of([&] { read_vtu(folder / "none.vtu"); }).find("none.vtu"), std::string::npos);
  EXPECT_NE(error_of([&] { read_unstructured(folder); }).find("folder"), std::string::npos);
  write_bytes(folder / "file", "");
  EXPECT_NE(error_of([&] { write_vtu(folder / "file" / "a.vtu", two_region_mesh(1)); }).find("a.vtu"),
            std::string::npos);
  EXPECT_NO_THROW(write_vtu(folder / "not" / "there" / "a.vtu", two_region_mesh(1)));
}

TEST(VtkIo, EveryTruncationOfAVtuIsAnError) {
  const auto folder = scratch_folder("vtk_truncated");
  write_vtu(folder / "whole.vtu", two_region_mesh(3));
  const std::string whole = bytes_of(folder / "whole.vtu");
  for (const double share : {0.0, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97}) {
    write_bytes(folder / "part.vtu",
                whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    EXPECT_NE(error_of([&] { read_vtu(folder / "part.vtu"); }).find("part.vtu"), std::string::npos) << share;
  }
}

TEST(VtkIo, FlippedBytesNeverCrash) {
  const auto folder = scratch_folder("vtk_flipped");
  write_vtu(folder / "whole.vtu", two_region_mesh(1));
  const std::string whole = bytes_of(folder / "whole.vtu");
  for (std::size_t at = 0; at < whole.size(); at += 307) {
    std::string broken = whole;
    broken[at] = static_cast<char>(broken[at] ^ 0x11);
    write_bytes(folder / "broken.vtu", broken);
    error_of([&] { read_vtu(folder / "broken.vtu"); });  // an error, or a mesh: both are answers
  }
}

TEST(VtkIo, CountsThatTheFileCannotHoldAreRefusedBeforeTheyAreUsed) {
  const auto folder = scratch_folder("vtk_counts");
  const TetMesh mesh = two_region_mesh(2);
  write_vtu(folder / "whole.vtu", mesh);
  const std::string whole = bytes_of(folder / "whole.vtu");
  const auto refusal_with = [&](std::size_t at, const std::string& bytes) {
    std::string broken = whole;
    broken.replace(at, bytes.size(), bytes);
    write_bytes(folder / "broken.vtu", broken);
    return error_of([&] { read_vtu(folder / "broken.vtu"); });
  };
  for (const std::string key : {"NumberOfPoints=\"", "NumberOfCells=\""})
    EXPECT_NE(refusal_with(whole.find(key) + key.size(), "9999999999\"").find("claims 9999999999"), std::string::npos);
  const std::size_t first_array = whole.find("_", whole.find("<AppendedData")) + 1;
  EXPECT_NE(refusal_with(first_array, std::string(7, '\x7f')).find("blocks"), std::string::npos);
  EXPECT_NE(refusal_with(first_array + 8, std::string(7, '\x7f')).find("bytes in a block"), std::string::npos);
  EXPECT_NE(refusal_with(first_array + 24, std::string(7, '\x7f')).find("compressed block"), std::string::npos);
  write_bytes(folder / "legacy.vtk",
              "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n"
              "POINTS 88888888888888888888 double\n0 0 0\n");
  EXPECT_NE(error_of([&] { read_unstructured(folder / "legacy.vtk"); }).find("claims"), std::string::npos);
}

TEST(VtkIo, SurfaceOfAnotherMeshIsRefused) {
  const auto folder = scratch_folder("vtk_other");
  write_vtp(folder / "a.vtp", two_region_mesh(4));
  TetMesh small = two_region_mesh(1);
  EXPECT_NE(error_of([&] { read_surface(folder / "a.vtp", small); }).find("GlobalNodeID"), std::string::npos);
}

UnstructuredData sample_data() {
  const TetMesh mesh = two_region_mesh(2);
  UnstructuredData data;
  data.points = mesh.nodes_mm;
  data.tets = mesh.cells;
  data.point_vectors["fibers"] = mesh.node_fibers.fiber;
  data.cell_vectors["sheets"] = mesh.cell_fibers.sheet;
  data.cell_scalars["region"].assign(mesh.region.begin(), mesh.region.end());
  for (const auto& node : mesh.nodes_mm) data.point_tensors["dti"].push_back({{node, 2 * node, 3 * node}});
  return data;
}

void expect_equal(const UnstructuredData& a, const UnstructuredData& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.tets, b.tets);
  EXPECT_EQ(a.point_scalars, b.point_scalars);
  EXPECT_EQ(a.cell_scalars, b.cell_scalars);
  EXPECT_EQ(a.point_vectors, b.point_vectors);
  EXPECT_EQ(a.cell_vectors, b.cell_vectors);
  EXPECT_EQ(a.point_tensors, b.point_tensors);
  EXPECT_EQ(a.cell_tensors, b.cell_tensors);
}

TEST(VtkIo, UnstructuredRoundTrip) {
  const auto folder = scratch_folder("vtk_unstructured");
  write_unstructured(folder / "a.vtk", sample_data());
  expect_equal(sample_data(), read_unstructured(folder / "a.vtk"));
}

TEST(VtkIo, UnstructuredReadsVtuToo) {
  const auto folder = scratch_folder("vtk_unstructured_vtu");
  const TetMesh mesh = two_region_mesh(2);
  write_vtu(folder / "a.vtu", mesh);
  const auto data = read_unstructured(folder / "a.vtu");
  EXPECT_EQ(data.tets, mesh.cells);
  EXPECT_EQ(data.point_vectors.at("fiber"), mesh.node_fibers.fiber);
  EXPECT_EQ(data.cell_scalars.at("region").size(), mesh.cells.size());
}

TEST(VtkIo, AsciiAtlasWithOtherCells) {
  const auto folder = scratch_folder("vtk_ascii");
  write_bytes(folder / "a.vtk", ascii_atlas);
  const auto data = read_unstructured(folder / "a.vtk");
  EXPECT_EQ(data.tets, (std::vector<Cell>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
  EXPECT_EQ(data.cell_scalars.at("part"), (std::vector<double>{8, 9}));
  EXPECT_EQ(data.point_vectors.at("fibers")[4], (Vec3{0, 1, 0}));
  EXPECT_EQ(data.points[1], (Vec3{1.5, 0, 0}));
}

TEST(VtkIo, TrianglesIntegersAndHalfFilledArraysComeBack) {
  const auto folder = scratch_folder("vtk_triangles");
  auto data = sample_data();
  data.faces = {{0, 1, 2}, {1, 2, 3}};
  data.face_scalars["label"] = {7, 8};
  data.face_vectors["only_faces"] = {{1, 2, 3}, {4, 5, 6}};
  data.cell_scalars["label"].assign(data.tets.size(), 1);
  data.integers = {"label"};
  for (const char* name : {"a.vtk", "a.vtu"}) {
    write_unstructured(folder / name, data);
    const auto back = read_unstructured(folder / name);
    EXPECT_EQ(back.faces, data.faces);
    EXPECT_EQ(back.tets, data.tets);
    EXPECT_EQ(back.face_scalars.at("label"), data.face_scalars.at("label"));
    EXPECT_EQ(back.cell_scalars.at("label"), data.cell_scalars.at("label"));
    EXPECT_EQ(back.face_vectors.at("only_faces"), data.face_vectors.at("only_faces"));
    EXPECT_EQ(back.cell_vectors.at("only_faces"), std::vector<Vec3>(data.tets.size()));
    EXPECT_EQ(back.integers, data.integers);
    EXPECT_TRUE(back.remarks.empty());
  }
}

TEST(VtkIo, WhatIsLeftOutIsSaid) {
  const auto folder = scratch_folder("vtk_left_out");
  write_bytes(folder / "a.vtk",
              std::string(ascii_atlas) + "SCALARS pair double 2\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8 9 10\n");
  const auto data = read_unstructured(folder / "a.vtk");
  ASSERT_EQ(data.remarks.size(), 1U) << data.remarks.front();
  EXPECT_EQ(data.remarks.front(), "left out: the array \"pair\" of 2 components");
}

TEST(VtkIo, BrokenAtlasesAreRefused) {
  const auto folder = scratch_folder("vtk_broken_atlas");
  const std::string whole = ascii_atlas;
  const auto refuse = [&](std::string text, const std::string& why) {
    write_bytes(folder / "b.vtk", text);
    EXPECT_NE(error_of([&] { read_unstructured(folder / "b.vtk"); }).find("b.vtk"), std::string::npos) << why;
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    return text.replace(text.find(from), from.size(), to);
  };
  refuse(whole.substr(0, whole.find("1 1 1\nCELLS")), "truncated points");
  refuse(whole.substr(0, whole.find("4 1 2 3 4")), "truncated cells");
  refuse(whole.substr(0, whole.find("1 0 0  0 1 0  0 0 1  1 0 0")) + "1 0 0 0", "truncated vectors");
  refuse(with("4 1 2 3 4", "4 1 2 3 9"), "node id out of range");
  refuse(with("1.5 0 0", "nan 0 0"), "not a number");
  refuse(with("UNSTRUCTURED_GRID", "POLYDATA"), "another data set");
  refuse(with("5 10 10", "5 5 5"), "no tetrahedron");
  refuse(with("POINTS 5", "POINTS 99999999999"), "absurd count");
  refuse("", "empty");
  refuse("PNG", "another file");
  write_unstructured(folder / "c.vtk", sample_data());
  const std::string binary = bytes_of(folder / "c.vtk");
  for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9})
    refuse(binary.substr(0, static_cast<std::size_t>(share * static_cast<double>(binary.size()))), "truncated binary");
}

/// The library believes the number behind CELLS and writes beyond its place.
TEST(VtkIo, CellsThatDoNotFitTheirNumbersAreRefused) {
  const auto path = scratch_folder("vtk_cells") / "x.vtk";
  const auto message_of = [&](const std::string& keyword, const std::string& cells, const std::string& types) {
    write_bytes(path,
                "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
                "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n" +
                    keyword + " " + cells + "\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES " + types + "\n10\n10\n");
    return error_of([&] { read_unstructured(path); });
  };
  EXPECT_EQ(message_of("CELLS", "2 10", "2"), "");
  EXPECT_EQ(message_of("cells", "2 10", "2"), "");
  for (const char* cells : {"2 5", "2 0", "2 9", "2 11", "150 1", "150 10", "1 10", "-1 10", "2 -10", "2", "x y"})
    for (const char* keyword : {"CELLS", "cells"})
      EXPECT_NE(message_of(keyword, cells, "2").find(path.string()), std::string::npos) << keyword << " " << cells;
  for (const char* types : {"1", "3", "150", "-2"})
    EXPECT_NE(message_of("CELLS", "2 10", types).find(path.string()), std::string::npos) << types;
}

TEST(VtkIo, BinaryCellsThatDoNotFitTheirNumbersAreRefused) {
  const auto path = scratch_folder("vtk_binary_cells") / "x.vtk";
  UnstructuredData data;
  data.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  data.tets = {{0, 1, 2, 3}};
  write_unstructured(path, data);
  const std::string whole = bytes_of(path);
  EXPECT_EQ(error_of([&] { read_unstructured(path); }), "");
  const auto at = whole.find("CELLS 1 5\n");
  ASSERT_NE(at, std::string::npos);
  for (const char first : {'\x00', '\x05', '\x40', '\x7f', '\xff'}) {
    std::string bytes = whole;
    bytes[at + 13] = first;
    write_bytes(path, bytes);
    EXPECT_NE(error_of([&] { read_unstructured(path); }), "") << static_cast<int>(first);
  }
}

/// Without header_type, or with a table of zeros, the library divides by the size of a block.
TEST(VtkIo, BlocksOfNoBytesAreRefused) {
  const auto folder = scratch_folder("vtk_blocks");
  write_vtu(folder / "a.vtu", two_region_mesh(4));
  const std::string whole = bytes_of(folder / "a.vtu");
  const auto refused = [&](const std::string& bytes) {
    write_bytes(folder / "b.vtu", bytes);
    return !error_of([&] { read_unstructured(folder / "b.vtu"); }).empty();
  };
  EXPECT_FALSE(refused(whole));
  const std::string header_type = " header_type=\"UInt64\"";
  std::string other = whole;
  if (const auto at = other.find(header_type); at != std::string::npos) {
    EXPECT_TRUE(refused(other.erase(at, header_type.size())));
  } else {
    other.insert(other.find(" compressor="), header_type);
    EXPECT_TRUE(refused(other));
  }
  const std::size_t width = whole.find(header_type) == std::string::npos ? 4 : 8;
  other = whole;
  other.replace(other.find("_", other.find("<AppendedData")) + 1 + width, width, width, '\0');
  EXPECT_TRUE(refused(other));
}

TEST(VtkIo, AucklandVentricles) {
  const auto path = testing::real_data("auckland-heart/auckland_ventricles.vtk");
  if (path.empty()) GTEST_SKIP() << "auckland-heart is not on this machine";
  const auto data = read_unstructured(path);
  EXPECT_EQ(data.points.size(), 33100U);
  EXPECT_EQ(data.tets.size(), 174300U);
  EXPECT_EQ(data.point_vectors.at("fibers").size(), 33100U);
}

}  // namespace
}  // namespace heartgen::adapters
