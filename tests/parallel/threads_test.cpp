#include "generator/parallel/threads.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace heart::parallel {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnceInContiguousPieces) {
  for (const int threads : {1, 2, 3, 7}) {
    set_thread_count(threads);
    for (const std::int64_t size : {0, 1, 2, 5, 1000}) {
      std::vector<int> visits(static_cast<std::size_t>(size), 0);
      std::atomic<int> pieces = 0;
      parallel_for(10, 10 + size, [&](std::int64_t begin, std::int64_t end) {
        ++pieces;
        for (auto i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i - 10)];
      });
      EXPECT_EQ(visits, std::vector<int>(visits.size(), 1));
      EXPECT_EQ(pieces, std::min<std::int64_t>(threads, size));
    }
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
}  // namespace heart::parallel
