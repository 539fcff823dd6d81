// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Parametric snakes (thesis 4.1; Kass, Witkin and Terzopoulos 1988): closed curves v(s) in a 2D image that descend
///   E(v) = 1/2 ∮ tension |v'|² + rigidity |v''|² ds + ∮ P(v) ds,   P = attraction (h - 1),
/// h the edge function, so that P is low on edges. Semi-implicit: (1 - tension D² + rigidity D⁴) on the left, the
/// image's force -∇P and the balloon (along the outward normal, times h; Cohen 1991) on the right. The curve is
/// resampled to equal arc lengths after every step. A snake keeps its topology: it cannot split, merge or start from
/// within a gap, and is only drawn to edges that its ends of travel meet.
#pragma once
#include <vector>

#include "model/volume.hpp"

namespace heartgen::pde {

/// Millimetres along i and j from the centre of voxel (0, 0).
struct Point2 {
  double x = 0, y = 0;
};
using Curve = std::vector<Point2>;  ///< closed: the last point is joined to the first; counter-clockwise seen from +k

struct SnakeSettings {
  double tension_mm = 0.3;   ///< a circle of radius R shrinks at the speed tension / R
  double rigidity_mm3 = 1;   ///< and at rigidity / R³
  double attraction_mm = 4;  ///< weight of the edges
  double balloon = 0;        ///< outward speed where there is no edge; negative: inwards
  double spacing_mm = 0;     ///< between points; 0: the smallest pixel spacing
  int max_iterations = 20000;
  double tolerance_mm = 0.02;  ///< settled when no point moves farther in 50 steps
};

enum class SnakeEnd { settled, out_of_iterations, collapsed, left_the_image, crossed_itself };
const char* name_of(SnakeEnd end);

struct SnakeResult {
  Curve curve;
  SnakeEnd end = SnakeEnd::out_of_iterations;
  int iterations = 0;
  double time = 0;
};

/// A circle of n points in the slice's plane.
Curve circle(const Point2& center_mm, double radius_mm, int points);

double length_mm(const Curve& curve);
double area_mm2(const Curve& curve);  ///< negative for a clockwise curve
bool crosses_itself(const Curve& curve);

/// The curve with n points at equal arc lengths (cubic between its points).
Curve resampled(const Curve& curve, int points);

/// The descent from `start` on the edge function `h` of one slice. Deterministic; not collective. Throws UserError for
/// an image that is not one slice, a start with less than 8 points, and settings out of range.
SnakeResult evolve_snake(const Curve& start, const Volume<float>& h, const SnakeSettings& settings);

/// The pixels whose centre the curve encloses (even-odd rule).
Mask inside_of(const Curve& curve, const Grid& slice);

}  // namespace heartgen::pde
