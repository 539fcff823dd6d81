// SPDX-License-Identifier: GPL-3.0-or-later
// Atlases that are images: vectors, tensors, components, masks.
#include "generator/atlas/voxel_atlas.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "generator/adapters/itk_io.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "model/axis_tensor.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;
using testing::error_of;

constexpr std::int64_t n = 20;
constexpr double spacing_mm = 5;  // a block of 60 mm, which a heart could be

bool is_muscle(std::int64_t i, std::int64_t j, std::int64_t k) {
  return i >= 4 && i < 16 && j >= 4 && j < 16 && k >= 4 && k < 16;
}

Vec3 axis_at(std::int64_t i, std::int64_t j, std::int64_t k) {
  const double turn = 0.1 * static_cast<double>(i), lift = 0.05 * static_cast<double>(j + k);
  return {std::cos(turn) * std::cos(lift), std::sin(turn) * std::cos(lift), std::sin(lift)};
}

using Components = std::function<std::vector<double>(const Vec3& axis)>;

/// A NRRD file with the components of every voxel's axis, zeros outside of the muscle.
void write_nrrd(const fs::path& path, std::size_t count, const std::string& kind, const Components& components,
                const std::string& more = "", bool fill_outside = false) {
  std::string text = fmt::format(
      "NRRD0005\ntype: float\ndimension: 4\nspace: left-posterior-superior\nsizes: {} {} {} {}\nspace directions: none "
      "({},0,0) (0,{},0) (0,0,{})\nkinds: {} domain domain domain\nendian: little\nencoding: raw\nspace origin: "
      "(0,0,0)\n{}\n",
      count, n, n, n, spacing_mm, spacing_mm, spacing_mm, kind, more);
  for (std::int64_t k = 0; k < n; ++k)
    for (std::int64_t j = 0; j < n; ++j)
      for (std::int64_t i = 0; i < n; ++i) {
        auto values = components(axis_at(i, j, k));
        if (!fill_outside && !is_muscle(i, j, k)) values.assign(count, 0);
        for (const double value : values) {
          const auto number = static_cast<float>(value);
          char bytes[4];
          std::memcpy(bytes, &number, 4);
          text.append(bytes, 4);
        }
      }
  testing::write_bytes(path, text);
}

std::vector<double> vector_of(const Vec3& f) { return {3 * f.x, 3 * f.y, 3 * f.z}; }

/// A diffusion tensor: 2 along the fibre, 1 across.
std::vector<double> six_of(const Vec3& f) {
  return {1 + f.x * f.x, f.x * f.y, f.x * f.z, 1 + f.y * f.y, f.y * f.z, 1 + f.z * f.z};
}

std::vector<double> nine_of(const Vec3& f) {
  const auto t = six_of(f);
  return {t[0], t[1], t[2], t[1], t[3], t[4], t[2], t[4], t[5]};
}

std::vector<double> seven_of(const Vec3& f) {
  auto t = six_of(f);
  t.insert(t.begin(), 1);
  return t;
}

void expect_the_block(const FiberAtlas& atlas) {
  ASSERT_EQ(atlas.cells.size(), 6u * 12 * 12 * 12);
  ASSERT_EQ(atlas.cell_fiber.size(), atlas.cells.size());
  ASSERT_EQ(atlas.points_mm.size(), 13u * 13 * 13);
  double volume = 0, worst = 1;
  for (std::size_t c = 0; c < atlas.cells.size(); ++c) {
    const auto at = [&](std::size_t corner) {
      return atlas.points_mm[static_cast<std::size_t>(atlas.cells[c][corner])];
    };
    volume += dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) / 6;
    const Vec3 middle = (1 / spacing_mm) * 0.5 * (at(0) + at(3));  // of the cube: its diagonal is in all six cells
    const Vec3 known = axis_at(std::llround(middle.x), std::llround(middle.y), std::llround(middle.z));
    worst = std::min(worst, std::abs(dot(known, atlas.cell_fiber[c])));
  }
  EXPECT_NEAR(volume, std::pow(12 * spacing_mm, 3), 1e-6);
  EXPECT_GT(worst, 0.99999);
}

TEST(VoxelAtlas, VectorsAndTensorsGiveTheSameAxes) {
  const auto folder = testing::scratch_folder("voxel_atlas");
  write_nrrd(folder / "vector.nrrd", 3, "vector", vector_of);
  write_nrrd(folder / "six.nrrd", 6, "3D-symmetric-matrix", six_of);
  write_nrrd(folder / "seven.nrrd", 7, "3D-masked-symmetric-matrix", seven_of);
  write_nrrd(folder / "nine.nrrd", 9, "3D-matrix", nine_of);
  for (const char* name : {"vector", "six", "seven", "nine"}) {
    SCOPED_TRACE(name);
    expect_the_block(atlas::read_fiber_atlas((folder / (std::string(name) + ".nrrd")).string()));
  }
}

TEST(VoxelAtlas, AMeasurementFrameTurnsTheComponents) {
  const auto folder = testing::scratch_folder("voxel_atlas_frame");
  const std::string frame = "measurement frame: (0,1,0) (0,0,1) (1,0,0)\n";  // columns: what x, y, z of a file are
  write_nrrd(
      folder / "vector.nrrd", 3, "vector",
      [](const Vec3& f) {
        return vector_of({f.y, f.z, f.x});
      },
      frame);
  write_nrrd(
      folder / "six.nrrd", 6, "3D-symmetric-matrix",
      [](const Vec3& f) {
        return six_of({f.y, f.z, f.x});
      },
      frame);
  expect_the_block(atlas::read_fiber_atlas((folder / "vector.nrrd").string()));
  expect_the_block(atlas::read_fiber_atlas((folder / "six.nrrd").string()));
}

TEST(VoxelAtlas, AMaskSaysWhereTheMuscleIs) {
  const auto folder = testing::scratch_folder("voxel_atlas_mask");
  write_nrrd(folder / "tensors.nrrd", 6, "3D-symmetric-matrix", six_of, "", true);
  Grid grid;
  grid.size = {n, n, n};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  Mask mask(grid);
  std::array<Volume<float>, 3> component{Volume<float>(grid), Volume<float>(grid), Volume<float>(grid)};
  for (std::int64_t k = 0; k < n; ++k)
    for (std::int64_t j = 0; j < n; ++j)
      for (std::int64_t i = 0; i < n; ++i) {
        mask(i, j, k) = is_muscle(i, j, k);
        for (int a = 0; a < 3; ++a)
          component[static_cast<std::size_t>(a)](i, j, k) = static_cast<float>(axis_at(i, j, k)[a]);
      }
  adapters::write_volume((folder / "heart_mask.nii.gz").string(), mask);
  expect_the_block(atlas::read_fiber_atlas(folder.string()));
  const auto parts = testing::scratch_folder("voxel_atlas_parts");
  for (std::size_t a = 0; a < 3; ++a)
    adapters::write_volume((parts / (std::string("fiber_") + "xyz"[a] + ".nrrd")).string(), component[a]);
  adapters::write_volume((parts / "mask.nrrd").string(), mask);
  expect_the_block(atlas::read_fiber_atlas(parts.string() + "/"));
}

TEST(VoxelAtlas, SmallVoxelsAreTakenTogether) {
  Grid grid;
  grid.size = {241, 30, 30};
  grid.spacing_mm = {0.25, 0.4, 0.5};
  Mask muscle(grid, 1);
  Volume<Vec3> axis(grid, Vec3{0, 0, 1});
  const auto atlas = atlas::atlas_of_voxels("fine", muscle, axis);
  EXPECT_EQ(atlas.cells.size(), 6u * 80 * 30 * 30) << "3 x 1 x 1; of the last one in 241 less than half is there";
  for (const std::size_t c : {std::size_t{0}, atlas.cells.size() - 1}) EXPECT_EQ(atlas.cell_fiber[c], (Vec3{0, 0, 1}));
}

TEST(VoxelAtlas, AMeshMayHaveTensorsInsteadOfVectors) {
  const auto folder = testing::scratch_folder("tensor_mesh");
  adapters::UnstructuredData data;
  data.points = {{0, 0, 0}, {60, 0, 0}, {0, 60, 0}, {0, 0, 60}};
  data.tets = {{0, 1, 2, 3}};
  for (std::int64_t p = 0; p < 4; ++p) {
    const auto t = nine_of(axis_at(p, 0, 2 * p));
    data.point_tensors["diffusion"].push_back(
        {{Vec3{t[0], t[1], t[2]}, Vec3{t[3], t[4], t[5]}, Vec3{t[6], t[7], t[8]}}});
  }
  for (const char* name : {"atlas.vtu", "atlas.vtk"}) {
    adapters::write_unstructured(folder / name, data);
    const auto atlas = atlas::read_fiber_atlas((folder / name).string());
    for (std::int64_t p = 0; p < 4; ++p)
      EXPECT_GT(std::abs(dot(atlas.fiber[static_cast<std::size_t>(p)], axis_at(p, 0, 2 * p))), 1 - 1e-6) << name;
  }
}

TEST(VoxelAtlas, WhatIsNoneIsRefusedByName) {
  const auto folder = testing::scratch_folder("voxel_atlas_refused");
  const auto expect_refused = [](const fs::path& path, const std::string& name, const std::string& what) {
    const auto error = error_of([&] { atlas::read_fiber_atlas(path.string()); });
    EXPECT_NE(error.find(name), std::string::npos) << error;
    EXPECT_NE(error.find(what), std::string::npos) << error;
  };
  expect_refused(folder, "refused", "0 images");
  write_nrrd(folder / "pair.nrrd", 2, "vector", [](const Vec3& f) { return std::vector<double>{f.x, f.y}; });
  expect_refused(folder / "pair.nrrd", "pair.nrrd", "2 components");
  write_nrrd(folder / "vector.nrrd", 3, "vector", vector_of);
  expect_refused(folder, "refused", "2 images");
  fs::remove(folder / "pair.nrrd");
  Grid other;
  other.size = {4, 4, 4};
  adapters::write_volume((folder / "mask.nrrd").string(), Mask(other, 1));
  expect_refused(folder, "mask.nrrd", "voxels");
  write_nrrd(folder / "nothing.nrrd", 3, "vector", [](const Vec3&) { return std::vector<double>(3, 0.0); });
  expect_refused(folder / "nothing.nrrd", "nothing.nrrd", "no tetrahedra");
  write_nrrd(folder / "nan.nrrd", 3, "vector", [](const Vec3&) { return std::vector<double>(3, std::nan("")); });
  expect_refused(folder / "nan.nrrd", "nan.nrrd", "NaN");
}

}  // namespace
}  // namespace heartgen
