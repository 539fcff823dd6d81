// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the naming knows of each piece of blood. Everything that is summed over pieces is a whole number, so that a
/// piece can be given to a name and taken back without a trace, in any order.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "generator/naming/levels.hpp"
#include "generator/naming/pieces.hpp"
#include "generator/naming/priors.hpp"
#include "generator/naming/scene.hpp"

namespace heartgen::naming {

using Whole = std::int64_t;
constexpr double cost_unit = 1e-6;  ///< of costs that are kept as whole numbers

struct Neighbour {
  int piece = 0;
  Whole faces = 0;  ///< common voxel faces
  Whole cut = 0;    ///< in cost units, where the two have different names
};

struct Piece {
  Whole voxels = 0;
  std::array<Whole, 3> index_sum{}, square_sum{};  ///< of its voxels' indices
  Whole hu = 0;                                    ///< median, saturated
  double peak_mm = 0;                              ///< greatest depth
  double room_depth_mm = 0;                        ///< mean distance to the room's border
  double level = 0;                                ///< of the threshold, share of the contrast
  Vec3 from_spine_mm;                              ///< of the centre, from the spine at its height
  Whole shell = 0, muscle = 0;                     ///< voxels of its shell, and how many of them are muscle
  std::array<Whole, 6> border{};                   ///< faces on the image's border: -x, +x, -y, +y, -z, +z
  std::array<Whole, name_count> own_cost{};        ///< per name, in cost units
  std::vector<Neighbour> neighbours;

  double ml() const { return static_cast<double>(voxels) * spacing_mm * spacing_mm * spacing_mm / 1000; }
  Vec3 center_mm() const;  ///< from the first voxel of the scene
};

struct Problem {
  std::vector<Piece> pieces;
  double contrast_hu = 0;
  Vec3 view_from_mm, view_to_mm;  ///< the image, from the first voxel of the scene
};

Problem make_problem(const Scene& scene, const Levels& levels, const Pieces& pieces);

/// The same with left and right exchanged.
Problem mirrored(const Problem& problem);

}  // namespace heartgen::naming
