#include "generator/app/run.hpp"

#include <gtest/gtest.h>

#include "support/data.hpp"
#include "support/files.hpp"

namespace heart::app {
namespace {

TEST(Cache, WhatAKilledRunLeftHalfWrittenGoes) {
  const auto folder = testing::scratch_folder("cache");
  testing::write_bytes(folder / "0123.stage", "whole");
  testing::write_bytes(folder / ".partial.4567.stage", "half");
  clear_unfinished_entries(folder);
  EXPECT_TRUE(std::filesystem::exists(folder / "0123.stage"));
  EXPECT_FALSE(std::filesystem::exists(folder / ".partial.4567.stage"));
  clear_unfinished_entries(folder / "none");
  clear_unfinished_entries("");
}

TEST(Cache, OnlyWhatTheLastFinishedBuildUsedStays) {
  const auto folder = testing::scratch_folder("cache_of_last");
  for (const char* name : {"0123.stage", "4567.stage", "89ab.stage", "notes.txt"})
    testing::write_bytes(folder / name, "x");
  forget_other_entries(folder, {"4567", "89ab", "cdef"});
  EXPECT_FALSE(std::filesystem::exists(folder / "0123.stage"));
  for (const char* name : {"4567.stage", "89ab.stage", "notes.txt"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  forget_other_entries(folder / "none", {});
  forget_other_entries("", {});
  EXPECT_FALSE(std::filesystem::exists(folder / "none"));
}

}  // namespace
}  // namespace heart::app
