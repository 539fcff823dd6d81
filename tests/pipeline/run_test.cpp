// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/run.hpp"

#include <gtest/gtest.h>

#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen::pipeline {
namespace {

TEST(Cache, WhatAKilledRunLeftHalfWrittenGoes) {
  const auto folder = testing::scratch_folder("cache");
  testing::write_bytes(folder / "0123.stage", "whole");
  testing::write_bytes(folder / ".partial.4567.stage", "half");
  pipeline::clear_unfinished_entries(folder);
  EXPECT_TRUE(std::filesystem::exists(folder / "0123.stage"));
  EXPECT_FALSE(std::filesystem::exists(folder / ".partial.4567.stage"));
  pipeline::clear_unfinished_entries(folder / "none");
  pipeline::clear_unfinished_entries("");
}

TEST(Cache, OnlyWhatTheLastFinishedBuildUsedStays) {
  const auto folder = testing::scratch_folder("cache_of_last");
  for (const char* name : {"0123.stage", "4567.stage", "89ab.stage", "notes.txt"})
    testing::write_bytes(folder / name, "x");
  pipeline::forget_other_entries(folder, {"4567", "89ab", "cdef"});
  EXPECT_FALSE(std::filesystem::exists(folder / "0123.stage"));
  for (const char* name : {"4567.stage", "89ab.stage", "notes.txt"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  pipeline::forget_other_entries(folder / "none", {});
  pipeline::forget_other_entries("", {});
  EXPECT_FALSE(std::filesystem::exists(folder / "none"));
}

}  // namespace
}  // namespace heartgen::pipeline
