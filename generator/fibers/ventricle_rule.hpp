// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fibres of the ventricles by rule: Laplace problems on the mesh (Bayer, Blake, Plank and Trayanova 2012), the outflow
/// tracts as in Doste et al. 2019, both as put together by Piersanti et al. 2021.
///
/// Two functions rise to 1 on one endocardium and are 0 on the other and on the epicardium; with the rest up to 1 they
/// are shares of the left endocardium, the right one and the epicardium in a place. The helix angle is the mean of
/// those prescribed there, weighted by the shares: linear across a wall, where Bayer's own interpolation is quadratic.
/// In the septum the two ventricles' rules describe one and the same axis, seen from its two sides. Where free walls
/// and septum meet, both are added as dyads, weighted by the squared slopes of the two functions, so that signs do not
/// matter.
#pragma once
#include "generator/fibers/rule.hpp"
#include "generator/ventricles/ventricles.hpp"
#include "model/recipe.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::fibers {

/// Axes of all nodes of the left and right ventricle's cells. The base is where the valves' rims and the atria are, or,
/// in a mesh without any, the flat cut across the frame's axis; the apex is the epicardium's farthest place below it.
/// Empty where the mesh has no surface of a ventricle's cavity or no epicardium. Threads; the same bits for any number.
RuleField ventricle_rule(const TetMesh& mesh, const ventricles::HeartFrame& frame, const RuleSettings& settings);

}  // namespace heartgen::fibers
