// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/contract.hpp"
#include "model/mathematics.hpp"
#include "model/quantile.hpp"

namespace heartgen::image {
namespace {

/// One Jacobi rotation of the symmetric matrix `m` that clears m[p][q]; columns of `v` turn with it.
void rotate(Mat3& m, Mat3& v, int p, int q) {
  if (std::abs(m[p][q]) < 1e-300) return;
  const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
  const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1), s = t * c;
  for (int k = 0; k < 3; ++k) {
    const double a = m[k][p], b = m[k][q];
    m[k][p] = c * a - s * b;
    m[k][q] = s * a + c * b;
  }
  for (int k = 0; k < 3; ++k) {
    const double a = m[p][k], b = m[q][k];
    m[p][k] = c * a - s * b;
    m[q][k] = s * a + c * b;
    const double d = v[k][p], e = v[k][q];
    v[k][p] = c * d - s * e;
    v[k][q] = s * d + c * e;
  }
}

}  // namespace

double quantile(std::vector<float>& values, double fraction) {
  HEARTGEN_EXPECTS(fraction >= 0 && fraction <= 1);
  return values.empty() ? 0 : static_cast<double>(heartgen::quantile(values, fraction));
}

TwoLevels two_medians(std::vector<float>& values, double low_quantile, double high_quantile) {
  HEARTGEN_EXPECTS(!values.empty());
  HEARTGEN_EXPECTS(low_quantile <= high_quantile);
  constexpr int max_steps = 80;  // each step moves the threshold one way only: a handful are needed
  std::sort(values.begin(), values.end());
  const auto value_at = [&](double index) { return static_cast<double>(values[static_cast<std::size_t>(index)]); };
  const double last = static_cast<double>(values.size() - 1);
  TwoLevels levels{value_at(low_quantile * last), value_at(high_quantile * last)};
  for (int step = 0; step < max_steps; ++step) {
    const auto cut = std::upper_bound(values.begin(), values.end(), static_cast<float>(levels.threshold()));
    const auto below = cut - values.begin();
    if (below == 0 || cut == values.end()) break;
    const auto below_middle = below / 2;
    const TwoLevels next{value_at(static_cast<double>(below_middle)),
                         value_at(static_cast<double>(below) + 0.5 * (last - static_cast<double>(below)))};
    if (next.low == levels.low && next.high == levels.high) break;
    levels = next;
  }
  return levels;
}

Vec3 mean(const std::vector<Vec3>& points) {
  Vec3 sum;
  for (const Vec3& p : points) sum += p;
  return points.empty() ? sum : sum / static_cast<double>(points.size());
}

PrincipalAxes principal_axes(const std::vector<Vec3>& points) {
  HEARTGEN_EXPECTS(!points.empty());
  const Vec3 centre = mean(points);
  Mat3 moment{{Vec3{}, Vec3{}, Vec3{}}}, turn;
  for (const Vec3& p : points)
    for (int r = 0; r < 3; ++r) moment[r] += (p - centre)[r] * (p - centre);
  constexpr int sweeps = 20;  // a 3x3 matrix converges in five
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    rotate(moment, turn, 0, 1);
    rotate(moment, turn, 0, 2);
    rotate(moment, turn, 1, 2);
  }
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return moment[a][a] > moment[b][b]; });
  PrincipalAxes result;
  for (std::size_t n = 0; n < 3; ++n) {
    const int column = order[n];
    result.axis[n] = {turn[0][column], turn[1][column], turn[2][column]};
    const double variance = moment[column][column] / std::max<double>(1, static_cast<double>(points.size()));
    result.deviation[n] = std::sqrt(std::max(variance, 0.0));
  }
  return result;
}

double angle_deg(const Vec3& a, const Vec3& b) {
  const double cosine = dot(a, b) / std::max(norm(a) * norm(b), 1e-300);
  return math::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

}  // namespace heartgen::image
