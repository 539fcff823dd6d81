// SPDX-License-Identifier: GPL-3.0-or-later
// The search for the cheapest labelling, and how sure it is.
#include "generator/naming/solve.hpp"

#include <gtest/gtest.h>

#include "generator/naming/margins.hpp"
#include "generator/parallel/threads.hpp"
#include "naming/usual_heart.hpp"

namespace heartgen::naming {
namespace {

TEST(Solve, NamesAUsualHeart) { EXPECT_EQ(solve(usual_heart()), true_names()); }

TEST(Solve, FindsNothingWithoutMuscle) {
  Problem problem = usual_heart();
  for (auto& piece : problem.pieces) piece.muscle = 0;
  EXPECT_TRUE(solve(problem).empty());
}

/// A heart whose chambers are each cut into two, with blood of the lungs around it.
Problem shattered_heart() {
  const Problem whole = usual_heart();
  Problem problem = whole;
  problem.pieces.clear();
  for (int n = 1; n < name_count; ++n) {
    const Usual& u = usual[static_cast<std::size_t>(n)];
    const Vec3 half{0, 0, 0.8 * u.deviation_mm.z},
        deviation{u.deviation_mm.x, u.deviation_mm.y, 0.6 * u.deviation_mm.z};
    for (const double side : {-1., 1.}) {
      Piece piece = make_piece(u.offset_mm + side * half, deviation, 0.5 * u.ml, 350);
      piece.own_cost[0] = std::llround(4 / cost_unit);
      piece.muscle = n == 1 ? 900 : 0;
      piece.from_spine_mm = {60, -70, 0};
      problem.pieces.push_back(piece);
    }
  }
  for (int n = 0; n < name_count - 1; ++n) add_contact(problem, 2 * n, 2 * n + 1, 6);
  for (const auto& [from, to, none] : openings)
    add_contact(problem, 2 * static_cast<int>(from) - 1, 2 * static_cast<int>(to) - 2, 4);
  for (const double x : {-130., 90.})
    for (const double z : {0., 40., 80.}) problem.pieces.push_back(make_piece({x, 30, z}, {4, 4, 8}, 3, 350));
  return problem;
}

TEST(Solve, NamesPiecesTogether) {
  const auto names = solve(shattered_heart());
  ASSERT_EQ(std::ssize(names), 2 * (name_count - 1) + 6);
  for (int n = 0; n < 2 * (name_count - 1); ++n)
    EXPECT_EQ(static_cast<int>(names[static_cast<std::size_t>(n)]), n / 2 + 1) << n;
  for (std::size_t n = 2 * (name_count - 1); n < names.size(); ++n) EXPECT_EQ(names[n], Name::other) << n;
}

TEST(Solve, IsTheSameForAnyNumberOfThreads) {
  const Problem problem = shattered_heart();
  const int before = parallel::thread_count();
  parallel::set_thread_count(1);
  const auto judged = judge_margins(problem, solve(problem));
  parallel::set_thread_count(3);
  const auto again = judge_margins(problem, solve(problem));
  parallel::set_thread_count(before);
  EXPECT_EQ(judged.solution.names, again.solution.names);
  for (std::size_t n = 0; n < name_count; ++n) EXPECT_EQ(judged.margins[n].cost, again.margins[n].cost);
}

TEST(Margins, AreLargeForChambersAndSayTheRunnerUp) {
  const auto judged = judge_margins(usual_heart(), true_names());
  EXPECT_GT(judged.margins[static_cast<std::size_t>(Name::lv)].cost, 10);
  EXPECT_GT(judged.margins[static_cast<std::size_t>(Name::la)].cost, 5);
  EXPECT_GT(judged.margins[static_cast<std::size_t>(Name::svc)].cost, 1);
  EXPECT_LT(judged.margins[static_cast<std::size_t>(Name::svc)].cost,
            judged.margins[static_cast<std::size_t>(Name::lv)].cost);
}

TEST(Margins, ABetterLabellingTakesThePlaceOfAWorse) {
  auto names = true_names();
  std::swap(names[5], names[6]);  // pulmonary artery and superior vena cava
  const auto judged = judge_margins(usual_heart(), names);
  EXPECT_EQ(judged.solution.names, true_names());
}

}  // namespace
}  // namespace heartgen::naming
