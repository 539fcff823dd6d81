// Fibres against a known field on a coarse grid.
#include "validation/reference_fibers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "model/labels.hpp"

namespace heart::validation {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;

/// Turns by 30 degrees per mm along z, as in a thin wall.
Vec3 turning_axis(double z) { return {std::cos(30 * degree * z), std::sin(30 * degree * z), 0}; }

/// The axis in voxels of 1.5 mm, every other one with its sign turned.
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

/// Small tetrahedra up the z axis, the lower half left and the upper half right ventricle.
TetMesh column_of_cells() {
  TetMesh mesh;
  for (double z = 0; z < 7.4; z += 0.37) {
    const auto first = static_cast<std::int32_t>(mesh.nodes_mm.size());
    for (const Vec3& d : {Vec3{-.1, -.1, -.1}, Vec3{.3, -.1, -.1}, Vec3{-.1, .3, -.1}, Vec3{-.1, -.1, .3}})
      mesh.nodes_mm.push_back(Vec3{2.2, 2.4, z} + d);
    mesh.cells.push_back({first, first + 1, first + 2, first + 3});
    mesh.region.push_back(tag(z < 3.5 ? Region::lv_myocardium : Region::rv_myocardium));
    mesh.cell_fibers.fiber.push_back(turning_axis(z));
  }
  return mesh;
}

std::map<std::string, double> rows_of(const Report& report, const std::string& metric) {
  std::map<std::string, double> rows;
  for (const auto& row : report)
    if (row.metric == metric) rows[row.scope] = row.value;
  return rows;
}

TEST(CompareFibers, AFieldThatTurnsWithinAVoxelIsInterpolatedWhateverItsSigns) {
  const auto mean = rows_of(compare_fibers(column_of_cells(), turning_field()), "axis_error_mean");
  ASSERT_EQ(mean.size(), 3u);
  for (const auto& [scope, value] : mean) EXPECT_LT(value, 0.5) << scope;  // the nearest voxel alone: 11 degrees
}

TEST(CompareFibers, AConstantErrorIsFoundAndWhatIsUnknownIsLeftOut) {
  auto mesh = column_of_cells();
  for (auto& f : mesh.cell_fibers.fiber)
    f = {std::cos(20 * degree) * f.x - std::sin(20 * degree) * f.y,
         std::sin(20 * degree) * f.x + std::cos(20 * degree) * f.y, 0};
  auto field = turning_field();
  for (std::int64_t j = 0; j < 4; ++j)
    for (std::int64_t i = 0; i < 4; ++i)
      for (const std::int64_t k : {4, 5}) field.x(i, j, k) = field.y(i, j, k) = 0;
  const auto report = compare_fibers(mesh, field);
  const auto mean = rows_of(report, "axis_error_mean");
  EXPECT_NEAR(mean.at("lv_myocardium"), 20, 0.5);
  const auto share = rows_of(report, "compared_fraction");
  EXPECT_EQ(share.at("lv_myocardium"), 1);
  EXPECT_LT(share.at("rv_myocardium"), 0.6);
  EXPECT_GT(share.at("ventricles"), share.at("rv_myocardium"));
}

}  // namespace
}  // namespace heart::validation
