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

/// The patient's left and right exchanged: still somewhat like a heart.
CtVolume mirrored_phantom() {
  phantom::PhantomSettings settings;
  settings.size = {128, 128, 90};
  settings.spacing_mm = {2.8, 2.8, 3.4};
  settings.companions = settings.fibers = false;
  CtVolume ct = phantom::make_phantom(settings).ct;
  const auto row = static_cast<std::ptrdiff_t>(ct.grid.size[0]);
  for (auto at = ct.voxels.begin(); at != ct.voxels.end(); at += row) std::reverse(at, at + row);
  return ct;
}

TEST(DoubtfulLandmarks, AreRefusedWithAPictureUnlessTheyAreAccepted) {
  pipeline::Build build;
  build.run.comm = parallel::self();
  build.ct.value = mirrored_phantom();
  build.options.output = testing::scratch_folder("doubtful_landmarks") / "bundle";
  const auto message = testing::error_of([&] { run_stages(pipeline::landmark_stages(), build); });
  for (const char* part : {"can hardly be a heart", "bundle.landmarks.png", "--accept-doubtful", "--landmarks"})
    EXPECT_NE(message.find(part), std::string::npos) << part << " in " << message;
  EXPECT_EQ(testing::bytes_of(pipeline::picture_beside(build.options)).substr(1, 3), "PNG");
  EXPECT_TRUE(build.run.notes.empty());
  build.options.accept_doubtful = true;
  run_stages(pipeline::landmark_stages(), build);
  EXPECT_TRUE(pipeline::chambers_are_marked(build.recipe.landmarks));
  EXPECT_EQ(build.run.notes.at(0).code, "landmarks.doubtful");
  EXPECT_EQ(build.run.notes.at(0).level, WarningLevel::doubt);
}

}  // namespace
}  // namespace heartgen::app
