// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/gather.hpp"

#include <gtest/gtest.h>

namespace {

using namespace heartgen;

void squares(std::int64_t begin, std::int64_t end, std::vector<std::int64_t>& values) {
  for (auto i = begin; i < end; ++i)
    for (std::int64_t repeat = 0; repeat < i % 3; ++repeat) values.push_back(i * i % 101);
}

TEST(Gather, IsWhatOneThreadFinds) {
  for (const int threads : {1, 2, 3, 7}) {
    parallel::set_thread_count(threads);
    for (const std::int64_t last : {4, 6, 20, 1000}) {
      std::vector<std::int64_t> all;
      squares(3, last, all);
      EXPECT_EQ(parallel::gather<std::int64_t>(3, last, squares), all) << threads;
      sort_unique(all);
      EXPECT_EQ(parallel::gather_sorted<std::int64_t>(3, last, squares), all) << threads;
    }
    EXPECT_TRUE(parallel::gather<std::int64_t>(5, 5, squares).empty());
    EXPECT_TRUE(parallel::gather_sorted<std::int64_t>(5, 5, squares).empty());
  }
  parallel::set_thread_count(2);
}

}  // namespace
