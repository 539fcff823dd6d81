// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/threads.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace heartgen::parallel {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnce) {
  for (const int threads : {1, 2, 3, 7}) {
    set_thread_count(threads);
    for (const std::int64_t size : {0, 1, 2, 5, 1000}) {
      std::vector<int> visits(static_cast<std::size_t>(size), 0);
      std::atomic<int> calls = 0;
      parallel_for(10, 10 + size, [&](std::int64_t begin, std::int64_t end) {
        ++calls;
        EXPECT_LT(begin, end);
        for (auto i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i - 10)];
      });
      EXPECT_EQ(visits, std::vector<int>(visits.size(), 1));
      EXPECT_GE(calls, std::min<std::int64_t>(threads, size));
      EXPECT_LE(calls, 4 * threads);
    }
  }
}

// The first part of the range waits for one that the same thread would do later.
TEST(ParallelFor, WhoIsDoneHelpsTheOthers) {
  using namespace std::chrono_literals;
  set_thread_count(2);
  std::atomic<bool> is_last_done = false, was_helped = false;
  parallel_for(0, 32, [&](std::int64_t begin, std::int64_t end) {
    if (end == 16) is_last_done = true;
    if (begin > 0) return;
    const auto start = std::chrono::steady_clock::now();
    while (!is_last_done && std::chrono::steady_clock::now() - start < 60s) std::this_thread::sleep_for(1ms);
    was_helped = is_last_done.load();
  });
  EXPECT_TRUE(was_helped);
}

TEST(ParallelFor, PiecesWithNumbersAreNotDivided) {
  for (const int threads : {1, 2, 3, 7}) {
    set_thread_count(threads);
    std::vector<std::atomic<int>> calls(static_cast<std::size_t>(threads));
    parallel_for(0, 1000, [&](std::int64_t, std::int64_t, int piece) { ++calls[static_cast<std::size_t>(piece)]; });
    for (const auto& of_piece : calls) EXPECT_EQ(of_piece, 1);
  }
}

TEST(ParallelFor, GivesEachPieceItsNumber) {
  set_thread_count(3);
  std::vector<int> owner(9, -1);
  parallel_for(0, 9, [&](std::int64_t begin, std::int64_t end, int piece) {
    for (auto i = begin; i < end; ++i) owner[static_cast<std::size_t>(i)] = piece;
  });
  EXPECT_EQ(owner, (std::vector<int>{0, 0, 0, 1, 1, 1, 2, 2, 2}));
}

TEST(ParallelFor, RethrowsTheFirstPiecesError) {
  set_thread_count(3);
  try {
    parallel_for(0, 3, [](std::int64_t begin, std::int64_t) {
      if (begin > 0) throw std::runtime_error("piece " + std::to_string(begin));
    });
    FAIL() << "nothing thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "piece 1");
  }
  int sum = 0;  // and the pool still works
  std::vector<int> values(3, 0);
  parallel_for(0, 3, [&](std::int64_t begin, std::int64_t) { values[static_cast<std::size_t>(begin)] = 1; });
  for (const int v : values) sum += v;
  EXPECT_EQ(sum, 3);
}

TEST(ParallelFor, LoopsInsideLoopsDoNotHang) {
  set_thread_count(2);
  std::vector<int> visits(16, 0);
  parallel_for(0, 4, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = begin; i < end; ++i)
      parallel_for(0, 4, [&](std::int64_t from, std::int64_t to) {
        for (auto j = from; j < to; ++j) ++visits[static_cast<std::size_t>(4 * i + j)];
      });
  });
  EXPECT_EQ(visits, std::vector<int>(16, 1));
}

}  // namespace
}  // namespace heartgen::parallel
