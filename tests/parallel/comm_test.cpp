// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/comm.hpp"

#include <gtest/gtest.h>

#include "model/error.hpp"

namespace heartgen::parallel {
namespace {

TEST(Comm, AloneWithoutALauncher) {
  const Comm comm = world();
  EXPECT_EQ(comm.rank, 0);
  EXPECT_EQ(comm.size, 1);
  EXPECT_TRUE(comm.is_root());
}

TEST(Comm, ReductionsOfOneRankAreTheValue) {
  EXPECT_EQ(max(self(), -3.5), -3.5);
  EXPECT_EQ(min(self(), -3.5), -3.5);
  EXPECT_EQ(sum_int64(self(), 9007199254740993), 9007199254740993);  // more than a double holds
}

TEST(Comm, SumsSlicesInOrder) {
  const std::vector<double> slices{1e16, 1.0, -1e16, 1.0};
  EXPECT_EQ(sum_by_slice(self(), slices), ((1e16 + 1.0) - 1e16) + 1.0);
}

TEST(RunOnRoot, ReturnsTheResultAndPassesErrorsOn) {
  EXPECT_EQ(run_on_root(self(), [] { return 42; }), 42);
  bool ran = false;
  run_on_root(self(), [&] { ran = true; });
  EXPECT_TRUE(ran);
  try {
    run_on_root(self(), [] { throw UserError("no seed", "recipe.toml", "add one"); });
    FAIL() << "nothing thrown";
  } catch (const UserError& error) {
    EXPECT_EQ(error.message, "recipe.toml: no seed (add one)");
  }
}

}  // namespace
}  // namespace heartgen::parallel
