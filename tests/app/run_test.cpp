#include "generator/app/run.hpp"

#include <gtest/gtest.h>

#include "support/data.hpp"
#include "support/files.hpp"

namespace heart::app {
namespace {

TEST(Cache, WhatAKilledRunLeftHalfWrittenGoes) {
  const auto folder = testing::scratch_folder("cache");
  testing::write_bytes(folder / "0123.stage", "whole");
  testing::write_bytes(folder / "4567.99.partial", "half");
  clear_unfinished_entries(folder);
  EXPECT_TRUE(std::filesystem::exists(folder / "0123.stage"));
  EXPECT_FALSE(std::filesystem::exists(folder / "4567.99.partial"));
  clear_unfinished_entries(folder / "none");
  clear_unfinished_entries("");
}

}  // namespace
}  // namespace heart::app
