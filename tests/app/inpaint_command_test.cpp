// SPDX-License-Identifier: GPL-3.0-or-later
// inpaint as a user runs it.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "generator/adapters/itk_io.hpp"
#include "model/labels.hpp"
#include "support/data.hpp"
#include "support/program.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t across = 12;

/// A block of muscle with fibres along (3, 4, 0) but for a ball in its middle; around it one voxel of nothing.
void write_block(const fs::path& folder) {
  Grid grid;
  grid.size = {across, across, across};
  grid.spacing_mm = {1, 1, 1.5};
  LabelVolume labels(grid);
  Volume<float> x(grid), y(grid), z(grid);
  for (std::int64_t k = 1; k + 1 < across; ++k)
    for (std::int64_t j = 1; j + 1 < across; ++j)
      for (std::int64_t i = 1; i + 1 < across; ++i) {
        labels(i, j, k) = static_cast<std::uint8_t>(tag(Region::lv_myocardium));
        if (std::hypot(double(i) - 5, double(j) - 6, double(k) - 6) < 3.5) continue;
        x(i, j, k) = (i + j) % 2 ? 0.6F : -0.6F;  // the sign means nothing
        y(i, j, k) = (i + j) % 2 ? 0.8F : -0.8F;
      }
  adapters::write_volume((folder / "labels.nrrd").string(), labels);
  adapters::write_volume((folder / "fiber_x.nrrd").string(), x);
  adapters::write_volume((folder / "fiber_y.nrrd").string(), y);
  adapters::write_volume((folder / "fiber_z.nrrd").string(), z);
}

TEST(InpaintCommand, FillsTheGapsWithTheSameBytesOnAnyNumberOfRanks) {
  const auto folder = testing::scratch_folder("inpaint");
  write_block(folder);
  const auto one = testing::heartgen("inpaint . filled --labels labels.nrrd --iterations 30", folder.string());
  ASSERT_EQ(one.exit_code, 0) << one.errors;
  const auto many =
      testing::heartgen("inpaint . again --labels labels.nrrd --iterations 30", folder.string(), testing::on_ranks(3));
  ASSERT_EQ(many.exit_code, 0) << many.errors;
  const auto read = [&](const char* to, const char* name) {
    return adapters::read_image((folder / to / name).string());
  };
  for (const char* name : {"fiber_x.nrrd", "fiber_y.nrrd", "fiber_z.nrrd"})
    EXPECT_EQ(read("filled", name).voxels, read("again", name).voxels);
  EXPECT_NEAR(std::abs(read("filled", "fiber_x.nrrd")(5, 6, 6)), 0.6, 1e-6);
  EXPECT_NEAR(std::abs(read("filled", "fiber_y.nrrd")(5, 6, 6)), 0.8, 1e-6);
  EXPECT_EQ(read("filled", "fiber_x.nrrd")(0, 6, 6), 0);
}

TEST(InpaintCommand, FibresOfAnotherPlaceAreRefused) {
  const auto folder = testing::scratch_folder("inpaint_elsewhere");
  write_block(folder);
  auto labels = adapters::read_labels((folder / "labels.nrrd").string());
  labels.grid.origin_mm.x += 5;
  adapters::write_volume((folder / "labels.nrrd").string(), labels);
  const auto refused = testing::heartgen("inpaint . filled --labels labels.nrrd", folder.string());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("fiber_x.nrrd: does not lie on"), std::string::npos) << refused.errors;
}

TEST(InpaintCommand, WhatItCannotDoIsSaid) {
  const auto folder = testing::scratch_folder("inpaint_bad");
  write_block(folder);
  const auto region = testing::heartgen("inpaint . out --labels labels.nrrd --regions heart", folder.string());
  EXPECT_EQ(region.exit_code, 2);
  EXPECT_NE(region.errors.find("unknown region \"heart\""), std::string::npos) << region.errors;
  const auto none = testing::heartgen("inpaint . out --labels labels.nrrd --regions rv_myocardium", folder.string());
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.errors.find("no voxel of the regions has a fibre"), std::string::npos) << none.errors;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
}  // namespace heartgen
