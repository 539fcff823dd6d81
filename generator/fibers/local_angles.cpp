#include "generator/fibers/local_angles.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

#include "generator/parallel/threads.hpp"

namespace heart::fibers {
namespace {

using atlas::AxisTensor;
constexpr double position_scale_mm = 2.5, depth_scale = 0.06, height_scale = 0.05, angle_scale = 0.15;
constexpr std::size_t neighbors = 48;
constexpr double doubtful_off_wall = 0.03;  // squared sine of 10 degrees
constexpr double farthest = 1;              // from the samples, scaled; a query beyond is looked up at their border
constexpr double wide_place = 0.25;  // places count so much where a border is sought: its depth must be the query's

constexpr std::size_t places = 3;  // of a feature's numbers; the last one is the depth

struct FeatureCloud {
  const std::vector<WallFeature>& points;
  double place_share = 1;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t n, std::size_t axis) const {
    return (axis < places ? place_share : 1) * points[n][axis];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, FeatureCloud>, FeatureCloud, 4,
                                                 std::size_t>;

struct Neighbor {
  std::size_t sample;
  double squared_distance;
};

/// Fibres lie along their wall. Where one does not, the wall's directions there are most likely wrong, as at corners
/// and ends of the wall, and so is the angle that was measured in them.
double trust(const AxisTensor& local) { return 1 / (1 + local.c[2] / doubtful_off_wall); }

/// Value at the query of a weighted linear fit. The slopes are damped, the more the farther the samples are, so that
/// far from all samples the fit falls back to their mean.
AxisTensor regressed(const AngleSamples& samples, const WallFeature& query, const std::vector<Neighbor>& near) {
  constexpr double damping = 0.02;
  using Row = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 6> right = Eigen::Matrix<double, 5, 6>::Zero();
  const double width2 = std::max(1.0, near.front().squared_distance);
  for (const Neighbor& n : near) {
    Row row;
    row(0) = 1;
    for (std::size_t axis = 0; axis < 4; ++axis)
      row(static_cast<Eigen::Index>(axis) + 1) = samples.feature[n.sample][axis] - query[axis];
    const double weight = trust(samples.tensor[n.sample]) * std::exp(-0.5 * n.squared_distance / width2);
    normal += weight * row * row.transpose();
    for (std::size_t c = 0; c < 6; ++c)
      right.col(static_cast<Eigen::Index>(c)) += weight * samples.tensor[n.sample].c[c] * row;
  }
  const double ridge = damping * normal(0, 0) * width2;
  for (Eigen::Index slope = 1; slope < 5; ++slope) normal(slope, slope) += ridge;
  const Eigen::Matrix<double, 5, 6> fit = normal.ldlt().solve(right);
  AxisTensor result;
  for (std::size_t c = 0; c < 6; ++c) result.c[c] = fit(0, static_cast<Eigen::Index>(c));
  return result;
}

/// A linear fit over the few millimetres that the nearest samples span says little far from them. Along a wall angles
/// change slowly, across it they do not: the query's place goes to where the wall still has samples at its depth.
WallFeature at_border(const AngleSamples& samples, const Tree& wide, WallFeature query) {
  WallFeature sought = query;
  for (std::size_t axis = 0; axis < places; ++axis) sought[axis] *= wide_place;
  std::size_t nearest = 0;
  double squared = 0;
  wide.knnSearch(sought.data(), 1, &nearest, &squared);
  const WallFeature& border = samples.feature[nearest];
  double away = 0;
  for (std::size_t axis = 0; axis < places; ++axis) away += (border[axis] - query[axis]) * (border[axis] - query[axis]);
  away = std::sqrt(away);
  if (away > farthest)
    for (std::size_t axis = 0; axis < places; ++axis)
      query[axis] += (1 - farthest / away) * (border[axis] - query[axis]);
  return query;
}

AxisTensor in_patient_frame(const AxisTensor& local, const atlas::WallPoint& at) {
  const Vec3 axis = atlas::leading_axis(local);
  return atlas::axis_tensor(normalized(axis.x * at.circumferential + axis.y * at.longitudinal + axis.z * at.normal));
}

}  // namespace

WallFeature place_feature(const Vec3& atlas_mm, double depth) {
  return {atlas_mm.x / position_scale_mm, atlas_mm.y / position_scale_mm, atlas_mm.z / position_scale_mm,
          depth / depth_scale};
}

Vec3 place_of(const WallFeature& place) { return position_scale_mm * Vec3{place[0], place[1], place[2]}; }

WallFeature coordinate_feature(const atlas::HeartFrame& frame, const Vec3& center_mm, const Vec3& point_mm,
                               double depth) {
  const double height = dot(point_mm - frame.base_point_mm, frame.long_axis) / frame.length_mm;
  const Vec3 from_center = point_mm - center_mm;
  const double x = dot(from_center, frame.rv_side), y = dot(from_center, cross(frame.long_axis, frame.rv_side));
  const double radius = std::max(std::sqrt(x * x + y * y), 1e-9);
  return {height / height_scale, x / radius / angle_scale, y / radius / angle_scale, depth / depth_scale};
}

std::vector<std::size_t> nearest_samples(const AngleSamples& samples, const std::vector<WallFeature>& features) {
  const FeatureCloud cloud{samples.feature};
  const Tree tree(4, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  std::vector<std::size_t> result(features.size());
  for (std::size_t f = 0; f < features.size(); ++f) {
    double squared = 0;
    tree.knnSearch(features[f].data(), 1, &result[f], &squared);
  }
  return result;
}

std::vector<AxisTensor> carry_local_angles(const AngleSamples& samples, const std::vector<AngleQuery>& queries) {
  const FeatureCloud cloud{samples.feature};
  const Tree tree(4, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  const FeatureCloud wide_cloud{samples.feature, wide_place};
  const Tree wide(4, wide_cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  std::vector<AxisTensor> result(queries.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(queries.size()), [&](std::int64_t begin, std::int64_t end) {
    std::array<std::size_t, neighbors> index;
    std::array<double, neighbors> squared;
    std::vector<Neighbor> near;
    for (auto q = static_cast<std::size_t>(begin); q < static_cast<std::size_t>(end); ++q) {
      WallFeature at = queries[q].feature;
      std::size_t found = tree.knnSearch(at.data(), neighbors, index.data(), squared.data());
      if (squared.front() > farthest * farthest) {
        at = at_border(samples, wide, at);
        found = tree.knnSearch(at.data(), neighbors, index.data(), squared.data());
      }
      near.clear();
      for (std::size_t n = 0; n < found; ++n) near.push_back({index[n], squared[n]});
      result[q] = in_patient_frame(regressed(samples, at, near), queries[q].at);
    }
  });
  return result;
}

}  // namespace heart::fibers
