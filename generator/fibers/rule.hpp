// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fibres by rule: what the rules of ventricles and atria give, and papillary muscles, which run along themselves.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::fibers {

struct RuleAxis {
  Vec3 fiber;       ///< unit
  Vec3 transmural;  ///< unit
};

/// What a rule says at some nodes of a mesh, and at the middles of cells where fibres turn through the wall: in a wall
/// of one or two cells the mean of a cell's nodes is none of its own axes.
struct RuleField {
  std::vector<std::int32_t> nodes;    ///< ascending
  std::vector<RuleAxis> axes;         ///< per entry of `nodes`; zero where the rule has no direction
  std::vector<std::int32_t> cells{};  ///< ascending; may be empty
  std::vector<RuleAxis> cell_axes{};
};

/// Per cell of the mesh: angle between its axis and the rule's; -1 for cells without one.
std::vector<float> differences_deg(const std::vector<Vec3>& cell_axes, const RuleField& rule);

/// Per entry of `nodes`: fiber = the direction in which papillary muscle within 6 mm extends most. `long_axis` stands
/// in where it extends equally in two directions. transmural points away from the muscle's local centre line.
std::vector<RuleAxis> papillary_axes(const TetMesh& mesh, const std::vector<std::int32_t>& nodes,
                                     const Vec3& long_axis);

}  // namespace heartgen::fibers
