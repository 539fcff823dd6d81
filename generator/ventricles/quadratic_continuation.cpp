// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/ventricles/quadratic_continuation.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "generator/adapters/point_tree.hpp"
#include "model/mathematics.hpp"

namespace heartgen::ventricles {
namespace {

constexpr double search_mm = 18, smoothing_mm = 10;
constexpr double scale_mm = 10;  // of the fit's coordinates, so that damping has a meaning
constexpr double slope_damping = 1e-6, curvature_damping = 0.02;
constexpr std::size_t min_samples = 20;

}  // namespace

struct QuadraticContinuation::Index {
  adapters::PointCloud cloud;
  std::vector<std::array<double, 2>> values;
  adapters::PointTree tree;
  explicit Index(DistanceSamples samples)
      : cloud{std::move(samples.points_mm)}, values(std::move(samples.values)), tree(3, cloud, adapters::tree_leaves) {}
};

QuadraticContinuation::QuadraticContinuation(DistanceSamples samples)
    : index_(std::make_unique<const Index>(std::move(samples))) {}
QuadraticContinuation::~QuadraticContinuation() = default;

std::optional<QuadraticFit> QuadraticContinuation::operator()(const Vec3& point_mm) const {
  using Row = Eigen::Matrix<double, 10, 1>;
  if (index_->cloud.points.size() < min_samples) return std::nullopt;
  std::vector<std::pair<std::size_t, double>> near;
  const std::array<double, 3> at{point_mm.x, point_mm.y, point_mm.z};
  index_->tree.radiusSearch(at.data(), search_mm * search_mm, near, nanoflann::SearchParams(32, 0, false));
  if (near.size() < min_samples) return std::nullopt;
  const double nearest = std::ranges::min_element(near, {}, [](const auto& n) { return n.second; })->second;
  Eigen::Matrix<double, 10, 10> normal = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 2> right = Eigen::Matrix<double, 10, 2>::Zero();
  for (const auto& [n, squared] : near) {
    const Vec3 d = (index_->cloud.points[n] - point_mm) / scale_mm;
    Row row;
    row << 1, d.x, d.y, d.z, d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.x * d.z, d.y * d.z;
    const double weight = math::exp(-0.5 * (squared - nearest) / (smoothing_mm * smoothing_mm));
    const Row weighted = weight * row;
    for (int c = 0; c < 10; ++c)  // its lower half is all that is read
      for (int r = c; r < 10; ++r) normal(r, c) += weighted(c) * row(r);
    for (int c = 0; c < 2; ++c) right.col(c) += index_->values[n][static_cast<std::size_t>(c)] * weighted;
  }
  for (int c = 1; c < 10; ++c) normal(c, c) += (c < 4 ? slope_damping : curvature_damping) * normal(0, 0);
  const Eigen::Matrix<double, 10, 2> fit = normal.ldlt().solve(right);
  QuadraticFit result;
  for (int c = 0; c < 2; ++c) {
    result.value[static_cast<std::size_t>(c)] = fit(0, c);
    result.gradient[static_cast<std::size_t>(c)] = Vec3{fit(1, c), fit(2, c), fit(3, c)} / scale_mm;
  }
  return result;
}

}  // namespace heartgen::ventricles
