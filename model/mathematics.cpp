// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mathematics.hpp"

#include <sleef.h>

namespace heartgen::math {

double exp(double x) { return Sleef_cinz_expd1_u10purec(x); }
double exp2(double x) { return Sleef_cinz_exp2d1_u10purec(x); }
double log(double x) { return Sleef_cinz_logd1_u10purec(x); }
double log2(double x) { return Sleef_cinz_log2d1_u10purec(x); }
double log10(double x) { return Sleef_cinz_log10d1_u10purec(x); }
double pow(double x, double y) { return Sleef_cinz_powd1_u10purec(x, y); }
double cbrt(double x) { return Sleef_cinz_cbrtd1_u10purec(x); }
double sin(double radians) { return Sleef_cinz_sind1_u10purec(radians); }
double cos(double radians) { return Sleef_cinz_cosd1_u10purec(radians); }
double tan(double radians) { return Sleef_cinz_tand1_u10purec(radians); }
double asin(double x) { return Sleef_cinz_asind1_u10purec(x); }
double acos(double x) { return Sleef_cinz_acosd1_u10purec(x); }
double atan(double x) { return Sleef_cinz_atand1_u10purec(x); }
double atan2(double y, double x) { return Sleef_cinz_atan2d1_u10purec(y, x); }
double sinh(double x) { return Sleef_cinz_sinhd1_u10purec(x); }
double cosh(double x) { return Sleef_cinz_coshd1_u10purec(x); }
double tanh(double x) { return Sleef_cinz_tanhd1_u10purec(x); }
double erfc(double x) { return Sleef_cinz_erfcd1_u15purec(x); }
double hypot(double x, double y) { return Sleef_cinz_hypotd1_u05purec(x, y); }

}  // namespace heartgen::math

// The same under the C library's names: a definition in the program comes before a shared library's, for the headers
// that the program is compiled with and for the libraries that it loads.
namespace math = heartgen::math;
extern "C" {
double exp(double x) noexcept { return math::exp(x); }
double exp2(double x) noexcept { return math::exp2(x); }
double exp10(double x) noexcept { return Sleef_cinz_exp10d1_u10purec(x); }
double expm1(double x) noexcept { return Sleef_cinz_expm1d1_u10purec(x); }
double log(double x) noexcept { return math::log(x); }
double log2(double x) noexcept { return math::log2(x); }
double log10(double x) noexcept { return math::log10(x); }
double log1p(double x) noexcept { return Sleef_cinz_log1pd1_u10purec(x); }
double pow(double x, double y) noexcept { return math::pow(x, y); }
double cbrt(double x) noexcept { return math::cbrt(x); }
double sin(double radians) noexcept { return math::sin(radians); }
double cos(double radians) noexcept { return math::cos(radians); }
void sincos(double radians, double* sine, double* cosine) noexcept {
  *sine = math::sin(radians);
  *cosine = math::cos(radians);
}
double tan(double radians) noexcept { return math::tan(radians); }
double asin(double x) noexcept { return math::asin(x); }
double acos(double x) noexcept { return math::acos(x); }
double atan(double x) noexcept { return math::atan(x); }
double atan2(double y, double x) noexcept { return math::atan2(y, x); }
double sinh(double x) noexcept { return math::sinh(x); }
double cosh(double x) noexcept { return math::cosh(x); }
double tanh(double x) noexcept { return math::tanh(x); }
double asinh(double x) noexcept { return Sleef_cinz_asinhd1_u10purec(x); }
double acosh(double x) noexcept { return Sleef_cinz_acoshd1_u10purec(x); }
double atanh(double x) noexcept { return Sleef_cinz_atanhd1_u10purec(x); }
double erf(double x) noexcept { return Sleef_cinz_erfd1_u10purec(x); }
double erfc(double x) noexcept { return math::erfc(x); }
double hypot(double x, double y) noexcept { return math::hypot(x, y); }
}
