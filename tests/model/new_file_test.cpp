// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/new_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "model/text.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::error_of;

std::ptrdiff_t entries_in(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

TEST(NewFile, TakesItsPlaceWhenItIsFinished) {
  const auto folder = testing::scratch_folder("new_file");
  testing::write_bytes(folder / "out.nii.gz", "old");
  NewFile file(folder / "out.nii.gz");
  EXPECT_TRUE(file.partial.string().ends_with(".nii.gz")) << file.partial;
  std::ofstream(file.partial) << "new";
  EXPECT_EQ(bytes_of(folder / "out.nii.gz"), "old");
  file.finish();
  EXPECT_EQ(bytes_of(folder / "out.nii.gz"), "new");
  EXPECT_EQ(entries_in(folder), 1);
}

TEST(NewFile, ThatIsNotFinishedLeavesWhatWasThere) {
  const auto folder = testing::scratch_folder("new_file_unfinished");
  testing::write_bytes(folder / "out.json", "old");
  std::ofstream(NewFile(folder / "out.json").partial) << "half";
  std::ofstream(NewFile(folder / "deep" / "other.json").partial) << "half";
  EXPECT_EQ(bytes_of(folder / "out.json"), "old");
  EXPECT_EQ(entries_in(folder), 2);
  EXPECT_TRUE(fs::is_empty(folder / "deep"));
}

TEST(NewFile, IsWrittenByOneAtATime) {
  const auto folder = testing::scratch_folder("new_file_two");
  {
    NewFile first(folder / "out.json");
    std::ofstream(first.partial) << "first";
    const auto refused = error_of([&] { write_text(folder / "out.json", "second"); });
    EXPECT_NE(refused.find("another run is writing this file"), std::string::npos) << refused;
    first.finish();
    write_text(folder / "other.json", "other");
  }
  EXPECT_EQ(bytes_of(folder / "out.json"), "first");
  write_text(folder / "out.json", "third");
  EXPECT_EQ(bytes_of(folder / "out.json"), "third");
  EXPECT_EQ(entries_in(folder), 2);
}

TEST(NewFile, TakesOverWhatAKilledProgramLeft) {
  const auto folder = testing::scratch_folder("new_file_killed");
  { std::ofstream(NewFile(folder / "out.json").partial) << "x"; }
  testing::write_bytes(folder / ".partial.out.json", "half of something long");
  write_text(folder / "out.json", "new");
  EXPECT_EQ(bytes_of(folder / "out.json"), "new");
  EXPECT_EQ(entries_in(folder), 1);
}

TEST(NewFile, WhatIsInTheWayOfItIsLeftAlone) {
  const auto folder = testing::scratch_folder("new_file_in_the_way");
  testing::write_bytes(folder / "mine", "mine");
  fs::create_symlink("mine", folder / ".partial.out.json");
  write_text(folder / "out.json", "new");
  EXPECT_EQ(bytes_of(folder / "out.json"), "new");
  EXPECT_EQ(bytes_of(folder / "mine"), "mine");
  EXPECT_EQ(entries_in(folder), 3);
}

TEST(NewFile, WritesThroughLinksAndIntoDevices) {
  const auto folder = testing::scratch_folder("new_file_link");
  testing::write_bytes(folder / "out.json", "old");
  fs::create_symlink("out.json", folder / "link.json");
  write_text(folder / "link.json", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link.json"));
  EXPECT_EQ(bytes_of(folder / "out.json"), "new");
  write_text("/dev/null", "nothing");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_NE(error_of([] { write_text("/dev/full", "too much"); }).find("is there room"), std::string::npos);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

}  // namespace
}  // namespace heartgen
