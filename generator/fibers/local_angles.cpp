#include "generator/fibers/local_angles.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

#include "generator/atlas/distance_map.hpp"
#include "generator/parallel/threads.hpp"

namespace heart::fibers {
namespace {

using atlas::AxisTensor;
constexpr double position_scale_mm = 5, depth_scale = 0.04;
constexpr std::size_t neighbors = 24;
// Where the right wall joins the left one, a mesh with one vector per node mixes their directions within its cells.
constexpr double junction_mm = 6;

using Feature = std::array<double, 4>;

Feature feature_of(const Vec3& position_mm, double depth) {
  return {position_mm.x / position_scale_mm, position_mm.y / position_scale_mm, position_mm.z / position_scale_mm,
          depth / depth_scale};
}

struct FeatureCloud {
  std::vector<Feature> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t n, std::size_t axis) const { return points[n][axis]; }
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

/// Value at the query of a weighted linear fit. The slopes are damped, the more the farther the samples are, so that
/// far from all samples the fit falls back to their mean.
AxisTensor regressed(const AngleSamples& samples, const FeatureCloud& cloud, const Feature& query,
                     const std::vector<Neighbor>& near) {
  constexpr double damping = 0.02;
  using Row = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 6> right = Eigen::Matrix<double, 5, 6>::Zero();
  const double width2 = std::max(1.0, near.front().squared_distance);
  for (const Neighbor& n : near) {
    Row row;
    row(0) = 1;
    for (std::size_t axis = 0; axis < 4; ++axis)
      row(static_cast<Eigen::Index>(axis) + 1) = cloud.points[n.sample][axis] - query[axis];
    const double weight = std::exp(-0.5 * n.squared_distance / width2);
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

AxisTensor in_patient_frame(const AxisTensor& local, const atlas::WallPoint& at) {
  const Vec3 axis = atlas::leading_axis(local);
  return atlas::axis_tensor(normalized(axis.x * at.circumferential + axis.y * at.longitudinal + axis.z * at.normal));
}

}  // namespace

AngleSamples angle_samples(const atlas::AtlasImage& image, atlas::Part wall) {
  AngleSamples samples;
  const Grid& g = image.fiber.grid;
  const auto coordinates = wall_coordinates(image.ventricles, wall);
  const auto other = wall == atlas::Part::lv_wall ? atlas::Part::rv_wall : atlas::Part::lv_wall;
  const auto to_other =
      atlas::distance_to(atlas::mask_where(image.ventricles.parts, [&](auto v) { return is(v, other); }));
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        const Vec3 f = image.fiber(i, j, k);
        if (coordinates.known(i, j, k) != 1 || norm(f) < 0.5) continue;
        if (wall == atlas::Part::rv_wall && to_other(i, j, k) < junction_mm) continue;
        const Vec3 position =
            lps_from_index(g, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const auto at = atlas::wall_point(coordinates, image.ventricles.frame, position);
        if (!at) continue;
        samples.position_mm.push_back(position);
        samples.depth.push_back(at->depth);
        samples.tensor.push_back(
            atlas::axis_tensor({dot(f, at->circumferential), dot(f, at->longitudinal), dot(f, at->normal)}));
      }
  return samples;
}

std::vector<AxisTensor> carry_local_angles(const AngleSamples& samples, const std::vector<AngleQuery>& queries) {
  FeatureCloud cloud;
  for (std::size_t n = 0; n < samples.depth.size(); ++n)
    cloud.points.push_back(feature_of(samples.position_mm[n], samples.depth[n]));
  const Tree tree(4, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  std::vector<AxisTensor> result(queries.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(queries.size()), [&](std::int64_t begin, std::int64_t end) {
    std::array<std::size_t, neighbors> index;
    std::array<double, neighbors> squared;
    std::vector<Neighbor> near;
    for (auto q = static_cast<std::size_t>(begin); q < static_cast<std::size_t>(end); ++q) {
      const Feature feature = feature_of(queries[q].atlas_mm, queries[q].at.depth);
      const std::size_t found = tree.knnSearch(feature.data(), neighbors, index.data(), squared.data());
      near.clear();
      for (std::size_t n = 0; n < found; ++n) near.push_back({index[n], squared[n]});
      const AxisTensor local = regressed(samples, cloud, feature, near);
      result[q] = in_patient_frame(local, queries[q].at);
    }
  });
  return result;
}

}  // namespace heart::fibers
