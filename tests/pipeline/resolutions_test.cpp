// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/resolutions.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "model/error.hpp"
#include "model/labels.hpp"

namespace heartgen {
namespace {

/// 250 ml of wall around 650 ml of blood, in voxels of a millilitre.
LabelVolume typical_heart() {
  Grid grid;
  grid.size = {12, 12, 12};
  grid.spacing_mm = {10, 10, 10};
  LabelVolume labels(grid);
  for (std::size_t v = 0; v < 900; ++v) labels.voxels[v] = tag(v < 250 ? Region::lv_myocardium : Region::lv_blood);
  return labels;
}

MeshSettings with(std::vector<double> edges_mm) {
  MeshSettings settings;
  settings.resolutions_mm = std::move(edges_mm);
  return settings;
}

TEST(Resolutions, HaveShortNames) {
  EXPECT_EQ(pipeline::resolution_name(2), "myocardium_2mm");
  EXPECT_EQ(pipeline::resolution_name(0.8), "myocardium_0.8mm");
}

TEST(Resolutions, EdgesThatDoNotFitIntoMemoryAreRefusedByName) {
  constexpr double memory_bytes = 16e9;
  const LabelVolume heart = typical_heart();
  EXPECT_NO_THROW(pipeline::check_memory(heart, with({0.8, 2}), memory_bytes));
  EXPECT_NO_THROW(pipeline::check_memory(heart, with({0.4}), 0)) << "unknown";
  try {
    pipeline::check_memory(heart, with({2, 0.4}), memory_bytes);
    FAIL();
  } catch (const UserError& error) {
    EXPECT_NE(error.message.find("mesh.resolutions_mm"), std::string::npos);
    EXPECT_NE(error.problem.find("0.4 mm"), std::string::npos);
  }
}

TEST(Memory, EdgesOfTheMeshItselfAreRefusedByName) {
  constexpr double memory_bytes = 16e9;
  const LabelVolume heart = typical_heart();
  EXPECT_NO_THROW(pipeline::check_memory(heart, {}, memory_bytes));
  for (const auto& [edge, key] : {std::pair{&MeshSettings::heart_edge_mm, "mesh.heart_edge_mm"},
                                  {&MeshSettings::blood_edge_mm, "mesh.blood_edge_mm"}}) {
    MeshSettings settings;
    settings.*edge = 0.05;
    EXPECT_NO_THROW(pipeline::check_memory(heart, settings, 0)) << "unknown";
    try {
      pipeline::check_memory(heart, settings, memory_bytes);
      FAIL() << key;
    } catch (const UserError& error) {
      EXPECT_NE(error.message.find(key), std::string::npos) << error.message;
    }
  }
}

/// A heart of 254 ml of wall and 662 ml of blood was meshed at these edges, its blood with it.
TEST(Resolutions, TheEstimateIsNotBelowTheCellsOfMeshesThatWereMade) {
  constexpr double min_bytes_per_cell = 600;
  const LabelVolume heart = typical_heart();
  EXPECT_GT(pipeline::estimate_bytes(heart, 1.2), min_bytes_per_cell * 2193286);
  EXPECT_GT(pipeline::estimate_bytes(heart, 0.8), min_bytes_per_cell * 6521362);
}

}  // namespace
}  // namespace heartgen
