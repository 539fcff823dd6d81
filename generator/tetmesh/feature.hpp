// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Surfaces, curves and points where materials meet, as the places where nodes may lie.
#pragma once
#include <array>
#include <bit>

#include "generator/tetmesh/materials.hpp"

namespace heartgen::tetmesh {

/// The equations of the place where all labels of `touches` meet: the sides of the box first.
struct Feature {
  std::array<Equation, max_equations> equations;
  int count = 0;
};
Feature feature_at(const Materials& materials, LabelBits touches, const Vec3& point);

/// Whether nodes that touch these labels lie on a surface, a curve or a point of the domain.
inline bool is_constrained(LabelBits touches) { return (touches & (touches - 1)) != 0; }

/// The shortest step that brings a point onto the feature, to first order (least squares where there are more than
/// three equations).
Vec3 step_to(const Feature& feature);

/// Newton's method: the point of the feature near `start`.
Vec3 project(const Materials& materials, LabelBits touches, const Vec3& start, int iterations);

/// Greatest distance (mm) to one of the feature's surfaces, to first order.
double distance_to(const Feature& feature);

/// Signed distance (mm) of a point to the surface between two labels, to first order, and the normal there, towards
/// where the distance grows.
struct Offset {
  double distance = 0;
  Vec3 normal;
};
Offset offset_at(const Materials& materials, LabelBits labels, const Vec3& point);

}  // namespace heartgen::tetmesh
