// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fibres of the atria by rule (Piersanti et al. 2021): Laplace problems between the openings of a chamber divide its
/// wall into bundles; in each, fibres run along the wall and across the rise of the function that the bundle follows.
#pragma once
#include "generator/fibers/rule.hpp"
#include "model/recipe.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::fibers {

/// Axes of all nodes of la_wall's cells (`left`) or of ra_wall's. Veins are found as holes where the endocardium meets
/// the outer surface, told apart by their side (left and right, above and below). Where none is open, the part of the
/// wall that lies farthest that way stands for it; so does the part farthest in front for the appendage's tip. The
/// ring of the tricuspid valve is halved towards the left atrium. Empty where the mesh has no such wall.
RuleField atrial_rule(const TetMesh& mesh, bool left, const RuleSettings& settings);

}  // namespace heartgen::fibers
