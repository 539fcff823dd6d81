// SPDX-License-Identifier: GPL-3.0-or-later
// Landmarks that can hardly be a heart's: refused with a picture, or accepted and marked.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "datasets/phantom/phantom.hpp"
#include "generator/pipeline/image_stages.hpp"
#include "model/error.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen::app {
namespace {

namespace fs = std::filesystem;

/// The patient's left and right exchanged: still somewhat like a heart.
pipeline::Staged<CtVolume> mirrored_phantom() {
  phantom::PhantomSettings settings;
  settings.size = {128, 128, 90};
  settings.spacing_mm = {2.8, 2.8, 3.4};
  settings.companions = settings.fibers = false;
  CtVolume ct = phantom::make_phantom(settings).ct;
  const auto row = static_cast<std::ptrdiff_t>(ct.grid.size[0]);
  for (auto at = ct.voxels.begin(); at != ct.voxels.end(); at += row) std::reverse(at, at + row);
  return {std::move(ct), ""};
}

TEST(DoubtfulLandmarks, AreRefusedWithAPictureUnlessTheyAreAccepted) {
  const auto ct = mirrored_phantom();
  const fs::path picture = testing::scratch_folder("doubtful_landmarks") / "found.png";
  heartgen::pipeline::Run run;
  run.comm = parallel::self();
  std::vector<Warning> warnings;
  const auto message = testing::error_of([&] {
    pipeline::complete_landmarks(run, ct, {}, warnings, {false, picture});
  });
  for (const char* part : {"can hardly be a heart", "found.png", "--accept-doubtful", "--landmarks"})
    EXPECT_NE(message.find(part), std::string::npos) << part << " in " << message;
  EXPECT_EQ(testing::bytes_of(picture).substr(1, 3), "PNG");
  EXPECT_TRUE(warnings.empty());
  EXPECT_TRUE(
      pipeline::chambers_are_marked(pipeline::complete_landmarks(run, ct, {}, warnings, {true, picture}).landmarks));
  EXPECT_EQ(warnings.at(0).code, "landmarks.doubtful");
  EXPECT_EQ(warnings.at(0).level, WarningLevel::doubt);
}

}  // namespace
}  // namespace heartgen::app
