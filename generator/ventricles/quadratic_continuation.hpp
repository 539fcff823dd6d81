// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Continues two functions known at scattered points by local quadratic fits: a surface's distance is quadratic along
/// it (its curvature), which a linear continuation over several mm misses. Not collective; deterministic.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "model/vec.hpp"

namespace heartgen::ventricles {

struct DistanceSamples {
  std::vector<Vec3> points_mm;
  std::vector<std::array<double, 2>> values;
};

struct QuadraticFit {
  std::array<double, 2> value;
  std::array<Vec3, 2> gradient;  ///< per mm
};

class QuadraticContinuation {
 public:
  explicit QuadraticContinuation(DistanceSamples samples);
  ~QuadraticContinuation();
  QuadraticContinuation(const QuadraticContinuation&) = delete;
  QuadraticContinuation& operator=(const QuadraticContinuation&) = delete;

  /// Weighted least squares over the samples within 18 mm, the second derivatives damped a little; empty where there
  /// are fewer than twenty. May be called from several threads.
  std::optional<QuadraticFit> operator()(const Vec3& point_mm) const;

 private:
  struct Index;
  std::unique_ptr<const Index> index_;
};

}  // namespace heartgen::ventricles
