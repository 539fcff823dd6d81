// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The transcendental functions, whose last bit is the same on every processor. The C library chooses among several
/// versions by what the processor can do, and they round differently; these come from SLEEF's scalar functions with
/// consistent results and without fused multiply-add (Shibata and Petrogalli, IEEE Transactions on Parallel and
/// Distributed Systems 31, 2020), at most one unit in the last place off.
///
/// Our code calls them by these names and never std::sin and the like (tests/model/mathematics_test.cpp looks). A
/// program that links this unit has them under the C library's names too, so that headers and shared libraries of
/// others (Eigen, CGAL, Ceres, ITK, VTK) compute with the same ones. Square roots, remainders and rounding are exact
/// everywhere and stay the C library's.
#pragma once
#include <cmath>

namespace heartgen::math {

double exp(double x);
double exp2(double x);
double log(double x);
double log2(double x);
double log10(double x);
double pow(double x, double y);
double cbrt(double x);
double sin(double radians);
double cos(double radians);
double tan(double radians);
double asin(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);
double sinh(double x);
double cosh(double x);
double tanh(double x);
double erfc(double x);

/// sqrt(x * x + y * y) without overflow.
double hypot(double x, double y);

/// sqrt(x * x + y * y + z * z) without overflow.
inline double hypot(double x, double y, double z) { return std::hypot(x, y, z); }  // the library's header: square roots

}  // namespace heartgen::math
