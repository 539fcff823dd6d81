// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Curvature div(∇phi / |∇phi|) on pixels: the three discretisations of thesis 3.4.
#pragma once
#include "benchmarks/study/field.hpp"

namespace heartgen::study {

/// Differences of phi that all schemes start from; across closed faces they are 0.
struct Differences {
  Field face_x, face_y;        ///< phi(i + 1, j) - phi(i, j), phi(i, j + 1) - phi(i, j)
  Field central_x, central_y;  ///< means of the two face differences of a pixel
};
void take_differences(const Field& phi, const Domain& domain, Differences& d);

/// Second derivatives by central differences (3.10), cut off at ±1, the curvature of the smallest circle that the grid
/// can hold. 0 where the central gradient is 0.
void curvature_central(const Differences& d, const Domain& domain, Field& curvature);

/// 1 / (|∇phi| + delta) on the faces. The difference along the face comes from the pixel before it (3.11) or, centred,
/// from both of its pixels (3.12). 0 on closed faces.
enum class FaceRule { one_sided, midpoint };
struct FaceCoefficients {
  Field x, y;
};
inline constexpr double flat_gradient = 1e-10;  ///< the usual delta: avoids divisions by 0
/// The delta for functions that are kept in a range of 1 or 2 and start flat: the semi-explicit scheme freezes what is
/// flat to within delta.
inline constexpr double flat_of_range = 0.02;
void face_coefficients(const Differences& d, const Domain& domain, FaceRule rule, double delta, FaceCoefficients& c);

/// The sum of the four fluxes coefficient × difference: the curvature in the sense of (3.11) and (3.12).
void curvature_flux(const Differences& d, const FaceCoefficients& c, Field& curvature);

/// |∇phi| by central differences: the factor of the curvature in (4.38).
void gradient_norm(const Differences& d, Field& norm);

/// |∇phi| as the factor of the force in (4.38), upwind (Osher and Sethian 1988): where the force lifts phi, only higher
/// neighbours count, where it lowers phi only lower ones. With the central gradient the force makes the explicit
/// schemes oscillate, and a lone pixel, whose central gradient is 0, never changes sides.
void upwind_norm(const Differences& d, const Field& force, Field& norm);

/// The root of the mean of the squares of the differences ahead and behind: |∇phi| for the semi-explicit scheme, which
/// needs one norm for curvature and force, for the damping of the one to bound the other.
void two_sided_norm(const Differences& d, Field& norm);

/// The common work space of the schemes.
struct Workspace {
  Differences d;
  FaceCoefficients c;
  Field curvature, norm, upwind, force;

  Workspace(int width, int height);
};

struct TimeStep {
  double length = 0.1;
  double mu = 1;
};

/// phi += dt (μ a curvature + b force) on the domain, with curvature and force of the work space.
void explicit_step(Field& phi, const Domain& domain, const Workspace& w, const TimeStep& step, const Field& a,
                   const Field& b);

/// The same with the pixel's own value in the curvature at the new time (3.14): with Σ over the four faces,
/// phi = (phi + dt (μ a Σ C neighbour + b force)) / (1 + dt μ a Σ C). All neighbours are old. Uses the work space's
/// differences and face coefficients and overwrites its curvature.
void semi_explicit_step(Field& phi, const Domain& domain, Workspace& w, const TimeStep& step, const Field& a,
                        const Field& b);

/// Flows with |∇phi| as their factor are the same for m phi, and phi may grow without bound: divides it by a power of
/// two, which changes no digit, where it is large. What would vanish keeps its sign.
void keep_finite(Field& phi);

}  // namespace heartgen::study
