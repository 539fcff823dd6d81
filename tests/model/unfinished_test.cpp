// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/unfinished.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "model/new_file.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

TEST(Unfinished, GoesAndWhatIsFinishedStays) {
  const auto folder = testing::scratch_folder("unfinished");
  if (const auto child = fork(); child == 0) {  // nothing more can be written after it
    NewFile half(folder / "half.json"), whole(folder / "whole.json");
    std::ofstream(half.partial) << "half";
    std::ofstream(whole.partial) << "whole";
    whole.finish();
    note_unfinished(folder / "bundle");
    fs::create_directories(folder / "bundle" / "meshes");
    testing::write_bytes(folder / "bundle" / "meshes" / "half.vtu", "half");
    remove_unfinished();
    _exit(0);
  } else {
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
  EXPECT_EQ(testing::bytes_of(folder / "whole.json"), "whole");
}

}  // namespace
}  // namespace heartgen
