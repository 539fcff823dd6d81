// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/wavefront.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace heartgen::pde {
namespace {

/// What a walk visits, and whether everything it needs was visited before.
struct Visits {
  std::int64_t rows, slices;
  std::vector<int> count;  ///< iterations done of each row

  int& at(std::int64_t j, std::int64_t k) { return count[static_cast<std::size_t>(k * rows + j)]; }
  /// Whether iterations 0 .. n - 1 of a row were done; also where there is no such row.
  bool done(std::int64_t n, std::int64_t j, std::int64_t k) {
    return j < 0 || k < 0 || j >= rows || k >= slices || at(j, k) >= n;
  }
};

TEST(Wavefront, VisitsEveryRowOnceForEachIterationAfterWhatItNeeds) {
  for (const std::int64_t rows : {1, 2, 9, 20})
    for (const std::int64_t slices : {1, 3, 8})
      for (const std::int64_t block : {1, 3, 7, 64})
        for (const int depth : {1, 2, 5}) {
          Visits visits{rows, slices, std::vector<int>(static_cast<std::size_t>(rows * slices), 0)};
          pde::for_wavefront({0, slices}, rows, block, depth,
                             [&](std::int64_t n, std::int64_t from, std::int64_t to, std::int64_t k) {
                               for (auto j = from; j < to; ++j) {
                                 ASSERT_EQ(visits.at(j, k), n);
                                 EXPECT_TRUE(visits.done(n, j + 1, k) && visits.done(n, j, k + 1));
                                 EXPECT_TRUE(visits.done(n + 1, j - 1, k) && visits.done(n + 1, j, k - 1));
                                 ++visits.at(j, k);
                               }
                             });
          for (const int n : visits.count) ASSERT_EQ(n, depth) << rows << ' ' << slices << ' ' << block;
        }
}

TEST(Wavefront, IterationsGetLessFarWhereTheImageGoesOn) {
  const pde::Piece inner{10, 30, true, true}, whole{0, 20};
  EXPECT_EQ(inner.lower(3), 13);
  EXPECT_EQ(inner.upper(3), 27);
  EXPECT_EQ(whole.lower(3), 0);
  EXPECT_EQ(whole.upper(3), 20);
}

TEST(Wavefront, ThinSlabsGoBySingleIterations) {
  parallel::set_thread_count(1);
  const auto depth = [](std::int64_t slices, int iterations) {
    return pde::pass_depth(parallel::Slab<float>{{}, 0, slices, 1, {}}, iterations);
  };
  EXPECT_EQ(depth(0, 9), 1);
  EXPECT_EQ(depth(15, 9), 1);
  EXPECT_EQ(depth(16, 9), 2);
  EXPECT_EQ(depth(500, 3), 3);
  EXPECT_EQ(depth(500, 900), depth(400, 900));
  parallel::set_thread_count(8);
  EXPECT_EQ(depth(16, 9), 1);
}

}  // namespace
}  // namespace heartgen::pde
