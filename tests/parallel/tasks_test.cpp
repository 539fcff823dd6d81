// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/tasks.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "generator/parallel/threads.hpp"

namespace heartgen::parallel {
namespace {

struct Tasks : ::testing::TestWithParam<int> {
  int before = thread_count();
  void SetUp() override { set_thread_count(GetParam()); }
  void TearDown() override { set_thread_count(before); }
};

TEST_P(Tasks, EachRunsOnceWithTheLoopsInsideIt) {
  std::vector<std::atomic<int>> runs(37);
  std::vector<std::int64_t> sums(runs.size(), 0);
  std::vector<std::function<void()>> tasks;
  for (std::size_t t = 0; t < runs.size(); ++t)
    tasks.emplace_back([&, t] {
      ++runs[t];
      parallel_for(0, 100, [&](std::int64_t begin, std::int64_t end) {
        for (auto i = begin; i < end; ++i) sums[t] += i;  // one thread: no race
      });
    });
  run_tasks(tasks);
  for (std::size_t t = 0; t < runs.size(); ++t) {
    EXPECT_EQ(runs[t], 1);
    EXPECT_EQ(sums[t], 4950);
  }
  run_tasks({});
}

TEST_P(Tasks, TheFirstErrorInTheirOrderIsThrownAfterAllHaveRun) {
  std::atomic<int> done = 0;
  std::vector<std::function<void()>> tasks;
  for (int t = 0; t < 9; ++t)
    tasks.emplace_back([&done, t] {
      ++done;
      if (t == 3 || t == 7) throw std::runtime_error(std::to_string(t));
    });
  try {
    run_tasks(tasks);
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "3");
  }
  EXPECT_EQ(done, 9);
}

INSTANTIATE_TEST_SUITE_P(Threads, Tasks, ::testing::Values(1, 2, 5));

}  // namespace
}  // namespace heartgen::parallel
