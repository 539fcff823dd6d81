// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/ceres_pose.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <cmath>

#include "model/contract.hpp"

namespace heartgen::adapters {
namespace {

struct Sample {
  double value = 0;
  Vec3 gradient;  ///< per mm, in LPS
};

/// Trilinear value and gradient; outside the grid the border is continued (gradient 0 across it).
Sample sample_with_gradient(const Volume<float>& image, const Vec3& lps_mm) {
  const Vec3 index = index_from_lps(image.grid, lps_mm);
  std::int64_t base[3];
  double t[3];
  bool inside[3];
  for (int axis = 0; axis < 3; ++axis) {
    const auto last = image.grid.size[static_cast<std::size_t>(axis)] - 1;
    const double clamped = std::clamp(index[axis], 0.0, static_cast<double>(last));
    inside[axis] = clamped == index[axis];
    base[axis] = std::min<std::int64_t>(static_cast<std::int64_t>(clamped), last - 1);
    t[axis] = clamped - static_cast<double>(base[axis]);
  }
  Sample sample;
  Vec3 slope;
  for (int corner = 0; corner < 8; ++corner) {
    const int u[3] = {corner & 1, (corner >> 1) & 1, (corner >> 2) & 1};
    const double v = image(base[0] + u[0], base[1] + u[1], base[2] + u[2]);
    double w[3];
    for (int axis = 0; axis < 3; ++axis) w[axis] = u[axis] ? t[axis] : 1 - t[axis];
    sample.value += w[0] * w[1] * w[2] * v;
    slope.x += (u[0] ? v : -v) * w[1] * w[2];
    slope.y += (u[1] ? v : -v) * w[0] * w[2];
    slope.z += (u[2] ? v : -v) * w[0] * w[1];
  }
  for (int axis = 0; axis < 3; ++axis) slope[axis] = inside[axis] ? slope[axis] / image.grid.spacing_mm[axis] : 0;
  sample.gradient = lps_from_axes(image.grid, slope);
  return sample;
}

double scalar_part(double x) { return x; }
template <int N>
double scalar_part(const ceres::Jet<double, N>& x) {
  return x.a;
}

/// y = start.matrix * (scale * R * (I + A)) * (x - center) + start(center) + shift
template <class T>
void transformed(const AffineMap& start, const Vec3& center, const Vec3& x, const T* rotation, const T* log_scale,
                 const T* shear, const T* shift, T* y) {
  const Vec3 d = x - center;
  T stretched[3], rotated[3];
  for (int r = 0; r < 3; ++r)
    stretched[r] = d[r] + shear[3 * r] * d.x + shear[3 * r + 1] * d.y + shear[3 * r + 2] * d.z;
  ceres::AngleAxisRotatePoint(rotation, stretched, rotated);
  const T scale = exp(log_scale[0]);
  const Vec3 moved = start(center);
  for (int r = 0; r < 3; ++r)
    y[r] = scale * (start.matrix[r].x * rotated[0] + start.matrix[r].y * rotated[1] + start.matrix[r].z * rotated[2]) +
           moved[r] + shift[r];
}

struct ImageMisfit {
  const AffineMap* start;
  Vec3 center, point;
  const std::vector<const Volume<float>*>* targets;
  std::vector<double> values;

  template <class T>
  bool operator()(const T* rotation, const T* log_scale, const T* shear, const T* shift, T* residual) const {
    T y[3];
    transformed(*start, center, point, rotation, log_scale, shear, shift, y);
    const Vec3 at{scalar_part(y[0]), scalar_part(y[1]), scalar_part(y[2])};
    for (std::size_t c = 0; c < targets->size(); ++c) {
      const Sample sample = sample_with_gradient(*(*targets)[c], at);
      residual[c] = T(sample.value - values[c]);
      for (int axis = 0; axis < 3; ++axis) residual[c] += sample.gradient[axis] * (y[axis] - T(at[axis]));
    }
    return true;
  }
};

struct PointMisfit {
  const AffineMap* start;
  Vec3 center, from, to;

  template <class T>
  bool operator()(const T* rotation, const T* log_scale, const T* shear, const T* shift, T* residual) const {
    T y[3];
    transformed(*start, center, from, rotation, log_scale, shear, shift, y);
    for (int axis = 0; axis < 3; ++axis) residual[axis] = y[axis] - to[axis];
    return true;
  }
};

struct PoseParameters {
  double rotation[3] = {0, 0, 0};
  double log_scale[1] = {0};
  double shear[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  double shift[3] = {0, 0, 0};
};

// Eigen cuts its sums into blocks by the processor's cache sizes, which changes their order. One size for all: 32 KB,
// 256 KB and 2 MB. Ceres's own code takes it from the same place.
void fix_cache_sizes() { Eigen::setCpuCacheSizes(32 << 10, 256 << 10, 2 << 20); }

void hold_constant(ceres::Problem& problem, PoseParameters& p, PoseFreedom freedom) {
  if (freedom == PoseFreedom::affine) {
    problem.SetParameterBlockConstant(p.rotation);
    problem.SetParameterBlockConstant(p.log_scale);
  } else {
    problem.SetParameterBlockConstant(p.shear);
    if (freedom == PoseFreedom::rigid) problem.SetParameterBlockConstant(p.log_scale);
  }
}

AffineMap map_of(const AffineMap& start, const Vec3& center, const PoseParameters& p) {
  const auto at = [&](const Vec3& x) {
    double y[3];
    transformed<double>(start, center, x, p.rotation, p.log_scale, p.shear, p.shift, y);
    return Vec3{y[0], y[1], y[2]};
  };
  AffineMap map;
  const Vec3 zero = at({0, 0, 0});
  const Vec3 columns[3] = {at({1, 0, 0}) - zero, at({0, 1, 0}) - zero, at({0, 0, 1}) - zero};
  for (int r = 0; r < 3; ++r) map.matrix[r] = {columns[0][r], columns[1][r], columns[2][r]};
  map.offset_mm = zero;
  return map;
}

}  // namespace

PoseFit fit_pose(const AffineMap& start, const Vec3& center_mm, const std::vector<Vec3>& points_mm,
                 const std::vector<const Volume<float>*>& targets, const std::vector<std::vector<float>>& values,
                 PoseFreedom freedom) {
  HEARTGEN_EXPECTS(!points_mm.empty() && !targets.empty());
  HEARTGEN_EXPECTS(values.size() == targets.size());
  for (const auto& channel : values) HEARTGEN_EXPECTS(channel.size() == points_mm.size());
  for (const auto* target : targets) HEARTGEN_EXPECTS(target->grid == targets[0]->grid);
  PoseParameters p;
  ceres::Problem problem;
  const int channels = static_cast<int>(targets.size());
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    auto misfit = std::make_unique<ImageMisfit>(ImageMisfit{&start, center_mm, points_mm[i], &targets, {}});
    for (const auto& channel : values) misfit->values.push_back(channel[i]);
    using Cost = ceres::AutoDiffCostFunction<ImageMisfit, ceres::DYNAMIC, 3, 1, 9, 3>;
    problem.AddResidualBlock(new Cost(misfit.release(), channels), nullptr, p.rotation, p.log_scale, p.shear, p.shift);
  }
  hold_constant(problem, p, freedom);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.max_num_iterations = 40;
  options.function_tolerance = 1e-5;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  fix_cache_sizes();
  ceres::Solve(options, &problem, &summary);
  PoseFit fit;
  fit.map = map_of(start, center_mm, p);
  fit.iterations = static_cast<int>(summary.iterations.size());
  fit.rms = std::sqrt(2 * summary.final_cost / static_cast<double>(points_mm.size() * targets.size()));
  return fit;
}

PoseFit fit_points(const std::vector<Vec3>& from_mm, const std::vector<Vec3>& to_mm, PoseFreedom freedom) {
  HEARTGEN_EXPECTS(from_mm.size() >= 3 && from_mm.size() == to_mm.size());
  const auto middle = [](const std::vector<Vec3>& points) {
    Vec3 sum;
    for (const auto& p : points) sum += p / static_cast<double>(points.size());
    return sum;
  };
  const Vec3 center = middle(from_mm);
  AffineMap start;
  start.offset_mm = middle(to_mm) - center;
  PoseParameters p;
  ceres::Problem problem;
  for (std::size_t i = 0; i < from_mm.size(); ++i) {
    using Cost = ceres::AutoDiffCostFunction<PointMisfit, 3, 3, 1, 9, 3>;
    problem.AddResidualBlock(new Cost(new PointMisfit{&start, center, from_mm[i], to_mm[i]}), nullptr, p.rotation,
                             p.log_scale, p.shear, p.shift);
  }
  hold_constant(problem, p, freedom);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.max_num_iterations = 200;
  options.function_tolerance = options.parameter_tolerance = options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  fix_cache_sizes();
  ceres::Solve(options, &problem, &summary);
  PoseFit fit;
  fit.map = map_of(start, center, p);
  fit.iterations = static_cast<int>(summary.iterations.size());
  fit.rms = std::sqrt(2 * summary.final_cost / static_cast<double>(from_mm.size()));
  return fit;
}

}  // namespace heartgen::adapters
