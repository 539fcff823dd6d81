// SPDX-License-Identifier: GPL-3.0-or-later
// The cost of a labelling: nothing where all is as usual, the same however it came about, and its terms one by one.
#include "generator/naming/labelling.hpp"

#include <gtest/gtest.h>

#include "naming/usual_heart.hpp"

namespace heartgen::naming {
namespace {

TEST(Labelling, OfAUsualHeartCostsNothing) {
  const Problem problem = usual_heart();
  const Labelling labelling(problem, true_names());
  EXPECT_NEAR(labelling.energy(), 0, 0.05);
}

TEST(Labelling, NamesTakenBackLeaveNoTrace) {
  const Problem problem = usual_heart();
  Labelling labelling(problem, true_names());
  const double before = labelling.energy();
  for (int piece = 0; piece < labelling.size(); ++piece)
    for (int name = 0; name < name_count; ++name) labelling.set(piece, static_cast<Name>(name));
  for (int piece = labelling.size() - 1; piece >= 0; --piece) labelling.set(piece, static_cast<Name>(piece + 1));
  EXPECT_EQ(labelling.energy(), before);
}

TEST(Labelling, CostsTheSameWhereverTheHeartIs) {
  Problem problem = usual_heart();
  const double here = Labelling(problem, true_names()).energy();
  for (auto& piece : problem.pieces)
    for (std::size_t a = 0; a < 3; ++a) {
      const Whole shift = 20;
      piece.square_sum[a] += 2 * shift * piece.index_sum[a] + shift * shift * piece.voxels;
      piece.index_sum[a] += shift * piece.voxels;
    }
  EXPECT_NEAR(Labelling(problem, true_names()).energy(), here, 1e-6);
}

/// A turn of about one standard deviation costs about a half, not what the distances alone would.
TEST(Labelling, TurnedHeartsCostLittle) {
  Problem problem = usual_heart();
  const double c = math::cos(turn_sigma_rad), s = math::sin(turn_sigma_rad);
  for (int n = 1; n < name_count; ++n) {
    const Usual& u = usual[static_cast<std::size_t>(n)];
    const Vec3 turned{c * u.offset_mm.x - s * u.offset_mm.y, s * u.offset_mm.x + c * u.offset_mm.y, u.offset_mm.z};
    auto piece = make_piece(turned, u.deviation_mm, u.ml, 350);
    piece.neighbours = problem.pieces[static_cast<std::size_t>(n - 1)].neighbours;
    piece.muscle = n == 1 ? 900 : 0;
    problem.pieces[static_cast<std::size_t>(n - 1)] = piece;
  }
  const double cost = Labelling(problem, true_names()).terms().place;
  EXPECT_GT(cost, 0.1);
  EXPECT_LT(cost, 1.5);
}

TEST(Labelling, MirroredTwiceIsTheSame) {
  const Problem problem = usual_heart();
  const double cost = Labelling(problem, true_names()).energy();
  EXPECT_NEAR(Labelling(mirrored(mirrored(problem)), true_names()).energy(), cost, 1e-9);
  EXPECT_GT(Labelling(mirrored(problem), true_names()).energy(), cost + 10);
}

TEST(Labelling, EachTermSaysWhatIsWrong) {
  const Problem problem = usual_heart();
  auto names = true_names();
  std::swap(names[0], names[2]);  // left and right ventricle: no muscle, strangers touch, no openings
  const Terms swapped = Labelling(problem, names).terms();
  EXPECT_GT(swapped.shell, 10);
  EXPECT_GT(swapped.touch, 7);
  EXPECT_GT(swapped.opening, 7);
  EXPECT_GT(swapped.place, 2);
  names = true_names();
  names[1] = Name::other;
  const Terms missing = Labelling(problem, names).terms();
  EXPECT_NEAR(missing.missing, usual_of(Name::la).missing, 0.01);
  EXPECT_GT(missing.piece, 7);
}

/// What lies beyond the image's end cannot be found, and is not missed as much.
TEST(Labelling, MissesLessWhatTheImageDoesNotShow) {
  Problem problem = usual_heart();
  auto names = true_names();
  names[static_cast<std::size_t>(Name::pulmonary_artery) - 1] = Name::other;
  const double inside = Labelling(problem, names).terms().missing;
  problem.view_to_mm.z = 40;
  const double outside = Labelling(problem, names).terms().missing;
  EXPECT_NEAR(outside, missing_outside * inside, 1e-9);
}

/// What the image's border cuts may be smaller than usual, and not larger.
TEST(Labelling, CutBodiesMayBeSmall) {
  Problem problem = usual_heart();
  Piece& ventricle = problem.pieces.front();
  ventricle = make_piece({0, 0, 0}, {8, 8, 8}, 30, 350);
  ventricle.muscle = 900;
  const double whole = Labelling(problem, true_names()).terms().volume;
  ventricle.border[4] = 1000;
  const Terms cut = Labelling(problem, true_names()).terms();
  EXPECT_GT(whole, 3);
  EXPECT_LT(cut.volume, 0.1);
  ventricle.voxels *= 20;
  EXPECT_GT(Labelling(problem, true_names()).terms().volume, 3);
}

}  // namespace
}  // namespace heartgen::naming
