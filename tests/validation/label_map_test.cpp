// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/label_map.hpp"

#include <gtest/gtest.h>

#include "model/labels.hpp"
#include "validation/anatomy_checks.hpp"
#include "validation/contour_fit.hpp"

namespace heartgen::validation {
namespace {

LabelVolume halves() {
  Grid grid;
  grid.size = {4, 3, 3};
  grid.spacing_mm = {2, 1, 1};
  grid.origin_mm = {10, 0, 0};
  LabelVolume labels(grid);
  for (std::int64_t k = 0; k < 3; ++k)
    for (std::int64_t j = 0; j < 3; ++j)
      for (std::int64_t i = 0; i < 4; ++i) labels(i, j, k) = i < 2 ? 1 : 6;
  return labels;
}

TEST(LabelMap, TheSurfaceLiesBetweenVoxels) {
  const auto labels = halves();
  EXPECT_EQ(label_between_voxels(labels, {12, 1, 1}), 1);
  EXPECT_EQ(label_between_voxels(labels, {12.99, 1, 1}), 1);
  EXPECT_EQ(label_between_voxels(labels, {13.01, 1, 1}), 6);
  EXPECT_EQ(label_between_voxels(labels, {13, 1, 1}), 1) << "the smaller label where both are equal";
}

TEST(LabelMap, EndsHalfAVoxelBeyondTheOutermost) {
  const auto labels = halves();
  EXPECT_EQ(label_between_voxels(labels, {9.01, 1, 1}), 1);
  EXPECT_EQ(label_between_voxels(labels, {8.99, 1, 1}), 0);
  EXPECT_EQ(label_between_voxels(labels, {16.99, 2.49, 1}), 6);
  EXPECT_EQ(label_between_voxels(labels, {17.01, 1, 1}), 0);
}

TEST(Orifices, AClosedOneHasNoArea) {
  LabelVolume labels = halves();
  for (auto& label : labels.voxels) label = tag(label == 1 ? Region::la_blood : Region::lv_blood);
  TetMesh mesh;
  mesh.nodes_mm = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}};
  mesh.cells = {{0, 1, 2, 3}};
  mesh.region = {tag(Region::lv_blood)};
  mesh.faces = {{0, 1, 2}};
  mesh.surface = {*surface_from_name("mitral_orifice")};
  const auto value = [&](const TetMesh& of, const char* scope, const char* metric) -> double {
    for (const auto& row : check_orifices({{"chambers", of}}, labels))
      if (row.scope == scope && row.metric == metric) return row.value;
    return -1;
  };
  EXPECT_NEAR(value(mesh, "mitral_orifice", "area"), 0.5, 1e-12);
  EXPECT_EQ(value(mesh, "mitral_orifice", "missing"), 0);
  EXPECT_EQ(value(mesh, "aortic_orifice", "missing"), 1) << "there is no aorta";
  mesh.surface = {*surface_from_name("lv_endocardium")};
  EXPECT_EQ(value(mesh, "mitral_orifice", "area"), 0);
}

TEST(LabelAgreement, AVesselIsComparedAsFarAsTheModelHoldsIt) {
  Grid grid;
  grid.size = {5, 5, 40};
  LabelVolume ours(grid), truth(grid);
  for (std::int64_t k = 0; k < 40; ++k)
    for (std::int64_t j = 1; j < 4; ++j)
      for (std::int64_t i = 1; i < 4; ++i) {
        truth(i, j, k) = k < 10 ? tag(Region::lv_blood) : tag(Region::aorta);
        ours(i, j, k) = k < 10 ? tag(Region::lv_blood) : k < 20 ? tag(Region::aorta) : std::uint8_t{0};
      }
  truth(0, 0, 0) = tag(Region::carotid);
  for (const auto& row : compare_labels(ours, truth)) {
    EXPECT_NE(row.scope, "carotid") << "the model does not hold it";
    if (row.metric == "dice") {
      EXPECT_EQ(row.value, 1) << row.scope;
    }
  }
}

TEST(LabelAgreement, WholeVesselsInPiecesAreComparedWhole) {
  Grid grid;
  grid.size = {5, 5, 40};
  LabelVolume labels(grid);
  for (std::int64_t k = 0; k < 40; ++k)
    for (std::int64_t j = 1; j < 4; ++j)
      for (std::int64_t i = 1; i < 4; ++i)
        labels(i, j, k) = k < 10 ? tag(Region::lv_blood) : k < 20 || k > 30 ? tag(Region::aorta) : std::uint8_t{0};
  for (const auto& row : compare_labels(labels, labels)) {
    if (row.metric == "dice") {
      EXPECT_EQ(row.value, 1) << row.scope;
    }
  }
}

TEST(LabelAgreement, AnArchThatComesBackToTheHeartIsNoStump) {
  Grid grid;
  grid.size = {12, 5, 30};
  LabelVolume ours(grid), truth(grid);
  for (std::int64_t k = 0; k < 30; ++k)
    for (std::int64_t j = 1; j < 4; ++j)
      for (std::int64_t i = 1; i < 11; ++i) {
        const bool up = i < 4;
        const bool down = i > 6;
        const bool over = k > 26;
        if (up) truth(i, j, k) = ours(i, j, k) = k < 10 ? tag(Region::lv_blood) : tag(Region::aorta);
        if (over || down) truth(i, j, k) = tag(Region::aorta);
        if (up && k >= 20) ours(i, j, k) = 0;
      }
  for (const auto& row : compare_labels(ours, truth)) {
    if (row.metric == "dice") {
      EXPECT_EQ(row.value, 1) << row.scope;
    }
  }
}

}  // namespace
}  // namespace heartgen::validation
