// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/local_angles.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

#include "generator/parallel/threads.hpp"
#include "model/contract.hpp"
#include "model/mathematics.hpp"
#include "model/quantile.hpp"

namespace heartgen::fibers {
namespace {

constexpr double position_scale_mm = 2.5, depth_scale = 0.06, height_scale = 0.05, angle_scale = 0.15;
constexpr double bend_scale = 0.06;
/// As far as a wall of 25 mm radius, which is a right ventricle's, turns over 1.8 mm: less than places count in, so
/// that of two pieces of wall that differ in both, the one that faces the same way is taken.
constexpr double normal_scale = 0.07;
constexpr std::size_t neighbors = 96;
constexpr double doubtful_off_wall = 0.06;  // squared sine of 14 degrees
constexpr double doubtful_residual = 0.3;   // of a dyad, as a norm: 12 degrees off what the samples around say
constexpr int rounds_of_distrust = 2;
constexpr double farthest = 1;       // from the samples, scaled; a query beyond is looked up at their border
constexpr double wide_place = 0.25;  // places count so much where a border is sought: its depth must be the query's

constexpr std::size_t places = 3, fitted = 4;   // of a feature's numbers: where, and where at which depth
constexpr std::size_t bending = 4, facing = 5;  // how much the wall bends; from here on: where it faces

/// The feature's number that a fit's slope is by.
constexpr std::size_t axis_of(std::size_t slope) { return slope < fitted ? slope : slope - fitted + facing; }

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

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, FeatureCloud>, FeatureCloud,
                                                 std::tuple_size_v<WallFeature>, std::size_t>;

struct Neighbor {
  std::size_t sample;
  double squared_distance;
};

double squared_distance(const WallFeature& a, const WallFeature& b) {
  double sum = 0;
  for (std::size_t axis = 0; axis < a.size(); ++axis) sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
  return sum;
}

/// The nearest samples of one query after another, nearest first. Queries come place by place, so those of the one
/// before are a first guess: what lies beyond the farthest of them is never looked at. That only saves time: the result
/// of a query does not depend on those before it.
class NearestSamples {
 public:
  using DistanceType = double;  // this and the public functions below `found` are what nanoflann asks of a result
  explicit NearestSamples(const AngleSamples& samples) : features_(&samples.feature) { near_.reserve(max_candidates); }

  const std::vector<Neighbor>& of([[maybe_unused]] const Tree& tree, const WallFeature& query) {
    worst_ = near_.size() < neighbors ? std::numeric_limits<double>::max() : 0;
    for (const Neighbor& n : near_) worst_ = std::max(worst_, widened(squared_distance((*features_)[n.sample], query)));
    near_.clear();
#ifndef __clang_analyzer__  // which takes a child of one of the library's nodes for null
    tree.findNeighbors(*this, query.data(), nanoflann::SearchParams());
#endif
    keep_nearest();
    std::sort(near_.begin(), near_.end(), is_nearer);
    return near_;
  }
  const std::vector<Neighbor>& found() const { return near_; }

  bool addPoint(double squared, std::size_t sample) {
    if (squared > worst_) return true;
    near_.push_back({sample, squared});
    if (near_.size() == max_candidates) keep_nearest();
    return true;
  }
  double worstDist() const { return worst_; }
  bool full() const { return near_.size() >= neighbors; }
  std::size_t size() const { return near_.size(); }

 private:
  static constexpr std::size_t max_candidates = 2 * neighbors;

  /// So that neither rounding nor equal distances decide what is looked at.
  static double widened(double squared) { return squared * (1 + 1e-9) + 1e-9; }

  static bool is_nearer(const Neighbor& a, const Neighbor& b) {
    return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance : a.sample < b.sample;
  }

  void keep_nearest() {
    if (near_.size() <= neighbors) return;
    std::nth_element(near_.begin(), near_.begin() + (neighbors - 1), near_.end(), is_nearer);
    near_.resize(neighbors);
    worst_ = std::min(worst_, widened(near_.back().squared_distance));
  }

  const std::vector<WallFeature>* features_;
  std::vector<Neighbor> near_;
  double worst_ = 0;
};

/// Fibres lie along their wall. Where one does not, the wall's directions there are most likely wrong, as at corners
/// and ends of the wall, and so is the angle that was measured in them.
double trust(const AxisTensor& local) { return 1 / (1 + local.c[2] / doubtful_off_wall); }

constexpr Eigen::Index terms = 8, facing_terms = 5;  // 1, then what is fitted: place, depth; from here on normal
using Terms = Eigen::Matrix<double, terms, 1>;
using Dyad = Eigen::Matrix<double, 6, 1>;
using Fit = Eigen::Matrix<double, terms, 6>;

/// One sample in a regression.
struct Observation {
  Terms terms;  ///< off the query
  Dyad dyad;
  double weight = 0;
  double share = 1;  ///< of its weight, by what the other samples say of it
};

void observe(const AngleSamples& samples, const WallFeature& query, const std::vector<Neighbor>& near, double width2,
             std::vector<Observation>& observations) {
  observations.resize(near.size());
  for (std::size_t n = 0; n < near.size(); ++n) {
    const WallFeature& feature = samples.feature[near[n].sample];
    const AxisTensor& tensor = samples.tensor[near[n].sample];
    Observation& o = observations[n];
    o.terms(0) = 1;
    for (std::size_t slope = 0; slope + 1 < terms; ++slope)
      o.terms(static_cast<Eigen::Index>(slope) + 1) = feature[axis_of(slope)] - query[axis_of(slope)];
    o.dyad = Eigen::Map<const Dyad>(tensor.c.data());
    o.share = 1;
    o.weight = trust(tensor) * math::exp(-0.5 * near[n].squared_distance / width2);
  }
}

/// Weighted linear fit. The slopes are damped, the more the farther the samples are, so that far from all samples the
/// fit falls back to their mean. Along a wall that bends, place and normal say nearly the same: slopes by the normal
/// are for what the place leaves over, and are damped far more.
Fit fit_to(const std::vector<Observation>& observations, double width2) {
  constexpr double damping = 0.01, facing_damping = 0.2;
  Eigen::Matrix<double, terms, terms> normal = Eigen::Matrix<double, terms, terms>::Zero();
  Fit right = Fit::Zero();
  for (const Observation& o : observations) {
    const Terms weighted = o.share * o.weight * o.terms;
    for (Eigen::Index c = 0; c < terms; ++c)  // its lower half is all that is read
      for (Eigen::Index r = c; r < terms; ++r) normal(r, c) += weighted(c) * o.terms(r);
    right.noalias() += weighted * o.dyad.transpose();
  }
  const double scale = normal(0, 0) * width2;
  for (Eigen::Index slope = 1; slope < terms; ++slope)
    normal(slope, slope) += (slope < facing_terms ? damping : facing_damping) * scale;
  return normal.ldlt().solve(right);
}

/// What most samples around do not bear out was measured in wrong directions, or belongs to another piece of wall.
/// Returns whether that changes the weights by enough to fit again.
bool distrust_outliers(const Fit& fit, std::vector<Observation>& observations) {
  constexpr double agrees = 0.9;
  double max_changed = 1;
  for (Observation& o : observations) {
    const Dyad off = fit.transpose() * o.terms - o.dyad;
    const double squared = off.squaredNorm() + off.tail<3>().squaredNorm();  // entries off the diagonal stand for two
    const double share = 1 / (1 + squared / (doubtful_residual * doubtful_residual));
    max_changed = std::min({max_changed, share / o.share, o.share / share});
    o.share = share;
  }
  return max_changed < agrees;
}

/// Linear fit around the query to the samples that agree. `observations` is room to work in.
Fit regressed(const AngleSamples& samples, const WallFeature& query, const std::vector<Neighbor>& near,
              std::vector<Observation>& observations) {
  const double width2 = std::max(1.0, near.front().squared_distance);
  observe(samples, query, near, width2, observations);
  Fit fit = fit_to(observations, width2);
  for (int round = 0; round < rounds_of_distrust && distrust_outliers(fit, observations); ++round)
    fit = fit_to(observations, width2);
  return fit;
}

AngleFit angle_fit(const WallFeature& feature, const Fit& fit, bool at_border) {
  AngleFit result{feature, {}, {}};
  for (Eigen::Index c = 0; c < 6; ++c) {
    const auto entry = static_cast<std::size_t>(c);
    result.tensor.c[entry] = fit(0, c);
    for (std::size_t slope = at_border ? places : 0; slope < result.slope.size(); ++slope)
      result.slope[slope][entry] = static_cast<float>(fit(static_cast<Eigen::Index>(slope) + 1, c));
  }
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

Vec3 normal_of(const WallFeature& place) {
  return normal_scale * Vec3{place[facing], place[facing + 1], place[facing + 2]};
}

}  // namespace

WallFeature place_feature(const Vec3& atlas_mm, double depth, double bend, const Vec3& atlas_normal) {
  const Vec3 place = atlas_mm / position_scale_mm, n = atlas_normal / normal_scale;
  return {place.x, place.y, place.z, depth / depth_scale, bend / bend_scale, n.x, n.y, n.z};
}

Vec3 place_of(const WallFeature& place) { return position_scale_mm * Vec3{place[0], place[1], place[2]}; }

WallFeature coordinate_feature(const ventricles::HeartFrame& frame, const Vec3& center_mm, const Vec3& point_mm,
                               double depth, double bend, const Vec3& normal) {
  const double height = dot(point_mm - frame.base_point_mm, frame.long_axis) / frame.length_mm;
  const Vec3 from_center = point_mm - center_mm;
  const Vec3 third = cross(frame.long_axis, frame.rv_side), n = normal / normal_scale;
  const double x = dot(from_center, frame.rv_side), y = dot(from_center, third);
  const double radius = std::max(std::sqrt(x * x + y * y), 1e-9);
  return {height / height_scale, x / radius / angle_scale, y / radius / angle_scale, depth / depth_scale,
          bend / bend_scale,     dot(n, frame.long_axis),  dot(n, frame.rv_side),    dot(n, third)};
}

std::vector<std::size_t> nearest_samples(const AngleSamples& samples, const std::vector<WallFeature>& features) {
  HEARTGEN_EXPECTS(!samples.feature.empty());
  const FeatureCloud cloud{samples.feature};
  const Tree tree(std::tuple_size_v<WallFeature>, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  std::vector<std::size_t> result(features.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(features.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      double squared = 0;
      tree.knnSearch(features[f].data(), 1, &result[f], &squared);
    }
  });
  return result;
}

WallFeature weighed(WallFeature feature, const ShapeShares& shares) {
  feature[bending] *= shares.bend;
  for (std::size_t axis = facing; axis < feature.size(); ++axis) feature[axis] *= shares.facing;
  return feature;
}

void weigh_shape(const ShapeShares& shares, AngleSamples& samples) {
  for (WallFeature& f : samples.feature) f = weighed(f, shares);
}

ShapeDifference shape_difference(const AngleSamples& samples, const std::vector<WallFeature>& features) {
  AngleSamples unaware{samples.feature, {}};
  weigh_shape({0, 0}, unaware);
  std::vector<WallFeature> sought = features;
  for (WallFeature& f : sought) f = weighed(f, {0, 0});
  const auto nearest = nearest_samples(unaware, sought);
  std::vector<double> bend(features.size()), normal(features.size());
  for (std::size_t n = 0; n < features.size(); ++n) {
    const WallFeature &own = features[n], &there = samples.feature[nearest[n]];
    bend[n] = std::abs(own[bending] - there[bending]) * bend_scale;
    normal[n] = norm(normal_of(own) - normal_of(there));
  }
  return {upper_median(bend), upper_median(normal)};
}

ShapeShares shares_of(const ShapeDifference& difference) {
  constexpr double most = 0.7;
  const auto share = [](double unit, double differs) { return unit / std::max(unit, most * differs); };
  return {share(bend_scale, difference.bend), share(normal_scale, difference.facing)};
}

std::vector<AngleFit> fit_local_angles(const AngleSamples& samples, const std::vector<WallFeature>& features) {
  HEARTGEN_EXPECTS(!samples.feature.empty());
  HEARTGEN_EXPECTS(samples.feature.size() == samples.tensor.size());
  const FeatureCloud cloud{samples.feature};
  const Tree tree(std::tuple_size_v<WallFeature>, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  const FeatureCloud wide_cloud{samples.feature, wide_place};
  const Tree wide(std::tuple_size_v<WallFeature>, wide_cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  std::vector<AngleFit> result(features.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(features.size()), [&](std::int64_t begin, std::int64_t end) {
    NearestSamples nearest(samples);
    std::vector<Observation> observations;
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      WallFeature at = features[f];
      const bool beyond = nearest.of(tree, at).front().squared_distance > farthest * farthest;
      if (beyond) {
        at = at_border(samples, wide, at);
        nearest.of(tree, at);
      }
      result[f] = angle_fit(features[f], regressed(samples, at, nearest.found(), observations), beyond);
    }
  });
  return result;
}

AxisTensor between_fits(const std::vector<const AngleFit*>& fits, const WallFeature& feature) {
  HEARTGEN_EXPECTS(!fits.empty());
  // Half of each fit's own slope and half of their mean one: a cubic along a line between two.
  constexpr std::size_t slopes = std::tuple_size_v<decltype(AngleFit::slope)>;
  const double share = 1 / static_cast<double>(fits.size());
  AxisTensor result;
  std::array<double, slopes> mean_offset{};
  for (const AngleFit* fit : fits) {
    result += share * fit->tensor;
    for (std::size_t s = 0; s < slopes; ++s) mean_offset[s] += share * (feature[axis_of(s)] - fit->feature[axis_of(s)]);
  }
  for (const AngleFit* fit : fits)
    for (std::size_t s = 0; s < slopes; ++s) {
      const double offset = 0.5 * (feature[axis_of(s)] - fit->feature[axis_of(s)] + mean_offset[s]);
      for (std::size_t c = 0; c < 6; ++c) result.c[c] += share * offset * double{fit->slope[s][c]};
    }
  return result;
}

AxisTensor in_patient_frame(const AxisTensor& local, const ventricles::WallPoint& at) {
  const Vec3 axis = leading_axis(local);
  return axis_tensor(normalized(axis.x * at.circumferential + axis.y * at.longitudinal + axis.z * at.normal));
}

}  // namespace heartgen::fibers
