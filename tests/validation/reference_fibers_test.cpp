// SPDX-License-Identifier: GPL-3.0-or-later
// Fibres of a mesh against a known field on a coarse grid.
#include "validation/reference_fibers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "model/labels.hpp"

namespace heartgen::validation {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;

/// Turns by 30 degrees per mm along z, as in a thin wall.
Vec3 turning_axis(double z) { return {std::cos(30 * degree * z), std::sin(30 * degree * z), 0}; }

/// The axis in voxels of 1.5 mm at z = 0, 1.5 ... 7.5, every other one with its sign turned.
ReferenceFibers turning_field() {
  Grid grid;
  grid.size = {4, 4, 6};
  grid.spacing_mm = {1.5, 1.5, 1.5};
  ReferenceFibers field{Volume<float>(grid), Volume<float>(grid), Volume<float>(grid)};
  for (std::int64_t k = 0; k < 6; ++k)
    for (std::int64_t j = 0; j < 4; ++j)
      for (std::int64_t i = 0; i < 4; ++i) {
        const Vec3 axis = ((i + j + k) % 2 ? -1.0 : 1.0) * turning_axis(1.5 * static_cast<double>(k));
        field.x(i, j, k) = static_cast<float>(axis.x);
        field.y(i, j, k) = static_cast<float>(axis.y);
      }
  return field;
}

/// Cubes of 0.75 mm, six cells each, up the z axis from 0.375 mm below the field's first voxels to as much above its
/// last ones, and around (2.25, 2.25); the lower half left and the upper half right ventricle. Signs of the nodes
/// change.
TetMesh column(double error_deg) {
  constexpr int nx = 3, nz = 12;
  constexpr double edge = 0.75;
  constexpr int ways[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};
  TetMesh mesh;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < nx; ++j)
      for (int i = 0; i < nx; ++i) {
        mesh.nodes_mm.push_back({1.3 + edge * i, 1.3 + edge * j, -0.375 + edge * k});
        const double sign = (i + 2 * j + k) % 2 ? -1 : 1;
        mesh.node_fibers.fiber.push_back(sign * turning_axis(mesh.nodes_mm.back().z + error_deg / 30));
      }
  for (int k = 0; k + 1 < nz; ++k)
    for (int j = 0; j + 1 < nx; ++j)
      for (int i = 0; i + 1 < nx; ++i)
        for (const auto& way : ways) {
          const auto corner = [&](int bits) {
            return static_cast<std::int32_t>(((k + (bits >> 2)) * nx + j + ((bits >> 1) & 1)) * nx + i + (bits & 1));
          };
          mesh.cells.push_back({corner(0), corner(way[0]), corner(way[1]), corner(7)});
          mesh.region.push_back(tag(k < nz / 2 ? Region::lv_myocardium : Region::rv_myocardium));
        }
  return mesh;
}

std::map<std::string, double> rows_of(const Report& report, const std::string& metric) {
  std::map<std::string, double> rows;
  for (const auto& row : report)
    if (row.metric == metric) rows[row.scope] = row.value;
  return rows;
}

TEST(CompareFibers, RightFibresHaveNoErrorWhateverTheirSignsAndHoweverCoarseTheField) {
  const auto report = compare_fibers(column(0), turning_field());
  const auto mean = rows_of(report, "axis_error_mean");
  ASSERT_EQ(mean.size(), 3u);
  for (const auto& [scope, value] : mean) EXPECT_LT(value, 0.5) << scope;
  for (const auto& [scope, value] : rows_of(report, "compared_fraction")) EXPECT_EQ(value, 1) << scope;
}

TEST(CompareFibers, AConstantErrorIsFoundAndWhatIsUnknownIsLeftOut) {
  auto field = turning_field();
  for (std::int64_t j = 0; j < 4; ++j)
    for (std::int64_t i = 0; i < 4; ++i) field.x(i, j, 5) = field.y(i, j, 5) = 0;
  const auto report = compare_fibers(column(20), field);
  for (const auto& [scope, value] : rows_of(report, "axis_error_mean")) EXPECT_NEAR(value, 20, 0.5) << scope;
  for (const auto& [scope, value] : rows_of(report, "axis_error_p95")) EXPECT_NEAR(value, 20, 0.5) << scope;
  const auto share = rows_of(report, "compared_fraction");
  EXPECT_EQ(share.at("lv_myocardium"), 1);
  EXPECT_NEAR(share.at("rv_myocardium"), 2.0 / 3, 1e-12);  // of the voxels at 4.5, 6 and 7.5 mm
  EXPECT_NEAR(share.at("ventricles"), 5.0 / 6, 1e-12);
}

}  // namespace
}  // namespace heartgen::validation
