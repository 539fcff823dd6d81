// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A heart as the priors have it, one piece of blood per name, for tests of the labelling.
#pragma once
#include <cmath>

#include "generator/naming/problem.hpp"
#include "model/mathematics.hpp"

namespace heartgen::naming {

/// A box of blood with the given centre, spread and volume.
inline Piece make_piece(const Vec3& center_mm, const Vec3& deviation_mm, double ml, Whole hu) {
  Piece piece;
  piece.voxels = std::llround(1000 * ml / (spacing_mm * spacing_mm * spacing_mm));
  for (int a = 0; a < 3; ++a) {
    const double center = center_mm[a] / spacing_mm, deviation = deviation_mm[a] / spacing_mm;
    const auto n = static_cast<std::size_t>(a);
    piece.index_sum[n] = std::llround(center * static_cast<double>(piece.voxels));
    piece.square_sum[n] = std::llround((center * center + deviation * deviation) * static_cast<double>(piece.voxels));
  }
  piece.hu = hu;
  piece.peak_mm = 10;
  piece.room_depth_mm = 40;
  piece.level = 0.4;
  piece.shell = 1000;
  return piece;
}

inline void add_contact(Problem& problem, int a, int b, double cm2) {
  const Whole faces = std::llround(100 * cm2 / (spacing_mm * spacing_mm));
  problem.pieces[static_cast<std::size_t>(a)].neighbours.push_back({b, faces, 0});
  problem.pieces[static_cast<std::size_t>(b)].neighbours.push_back({a, faces, 0});
}

/// Piece n is the one of name n + 1.
inline Problem usual_heart() {
  Problem problem;
  problem.contrast_hu = 250;
  problem.view_from_mm = {-300, -300, -300};
  problem.view_to_mm = {300, 300, 300};
  for (int n = 1; n < name_count; ++n) {
    const Usual& u = usual[static_cast<std::size_t>(n)];
    problem.pieces.push_back(make_piece(u.offset_mm, u.deviation_mm, u.ml, 350));
    problem.pieces.back().own_cost[0] = std::llround(8 / cost_unit);
  }
  problem.pieces.front().muscle = 900;
  problem.pieces.front().from_spine_mm = {60, -70, 0};
  for (const auto& [from, to, none] : openings)
    add_contact(problem, static_cast<int>(from) - 1, static_cast<int>(to) - 1, 4);
  return problem;
}

inline std::vector<Name> true_names() {
  std::vector<Name> names;
  for (int n = 1; n < name_count; ++n) names.push_back(static_cast<Name>(n));
  return names;
}

}  // namespace heartgen::naming
