// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/ventricles/compact_wall.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "generator/adapters/point_tree.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"
#include "model/quantile.hpp"

namespace heartgen::ventricles {
namespace {

constexpr double cell_mm = 1.2;
constexpr double fit_search_mm = 8;         // of a fit: a few ridges wide
constexpr std::size_t min_near = 12;        // samples that a fit needs
constexpr std::size_t samples_per_fit = 3;  // fits change slowly from sample to sample
constexpr double ridge_noises = 1.5;        // above its floor, in standard deviations of the samples, a ridge begins

/// Value and gradient (per mm) of a level set at a continuous index, by differences of half a voxel.
std::pair<double, Vec3> value_and_gradient(const LevelSet& surface, const Vec3& index) {
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 step;
    step[axis] = 0.5;
    gradient[axis] =
        (sample_linear(surface, index + step) - sample_linear(surface, index - step)) / surface.grid.spacing_mm.x;
  }
  return {sample_linear(surface, index), gradient};
}

struct CellSample {
  std::array<std::int64_t, 3> cell;
  Vec3 index;  ///< of the crossing
};

/// Where the zero set of `cavity` crosses edges between neighbouring voxels, of which at least one is `wanted`.
std::vector<CellSample> crossings(const LevelSet& cavity, const Mask& wanted) {
  const Grid& g = cavity.grid;
  const double cell_voxels = cell_mm / g.spacing_mm.x;
  std::vector<CellSample> result;
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        const double here = cavity(i, j, k);
        for (int axis = 0; axis < 3; ++axis) {
          const Index3 next{i + (axis == 0), j + (axis == 1), k + (axis == 2)};
          if (!g.contains(next[0], next[1], next[2])) continue;
          if (!wanted(i, j, k) && !wanted(next[0], next[1], next[2])) continue;
          const double there = cavity(next[0], next[1], next[2]);
          if ((here < 0) == (there < 0)) continue;
          CellSample crossing{{}, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}};
          crossing.index[axis] += here / (here - there);
          for (int a = 0; a < 3; ++a)
            crossing.cell[static_cast<std::size_t>(a)] =
                static_cast<std::int64_t>(std::floor(crossing.index[a] / cell_voxels));
          result.push_back(crossing);
        }
      }
  std::stable_sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.cell < b.cell; });
  return result;
}

struct Fit {
  double value = 0;
  Vec3 slope;
};

using Near = std::vector<std::pair<std::size_t, double>>;  ///< number and squared distance

/// One sample in a fit.
struct Observation {
  Eigen::Matrix<double, 4, 1> row;  ///< 1, then where it is off the fit's point, in units of the reach
  double thickness_mm = 0, nearness = 0;
};

/// Linear fit around `at`, again and again with less weight to what lies above it. `observations` is room to work in.
Fit floor_fit(const std::vector<ThicknessSample>& samples, const Near& near, const Vec3& at, double ridge_mm,
              std::vector<Observation>& observations) {
  constexpr int rounds = 8;
  constexpr double slope_damping = 0.02, first_quantile = 0.3, min_weight = 1e-6;
  using Row = Eigen::Matrix<double, 4, 1>;
  std::vector<double> sorted;
  observations.clear();
  for (const auto& [n, squared] : near) {
    const Vec3 d = (samples[n].point_mm - at) / fit_search_mm;
    const double nearness = 1 - squared / (fit_search_mm * fit_search_mm);
    observations.push_back({Row(1, d.x, d.y, d.z), samples[n].thickness_mm, nearness * nearness});
    sorted.push_back(samples[n].thickness_mm);
  }
  Row fit(quantile(sorted, first_quantile), 0, 0, 0);
  for (int round = 0; round < rounds; ++round) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Row right = Row::Zero();
    for (const Observation& o : observations) {
      const double above = (o.thickness_mm - fit.dot(o.row)) / ridge_mm;
      const double weight = o.nearness * (above > 0 ? math::exp(-0.5 * above * above) + min_weight : 1);
      normal.noalias() += weight * o.row * o.row.transpose();
      right += weight * o.thickness_mm * o.row;
    }
    for (int slope = 1; slope < 4; ++slope) normal(slope, slope) += slope_damping * normal(0, 0);
    fit = normal.ldlt().solve(right);
  }
  return {fit(0), Vec3{fit(1), fit(2), fit(3)} / fit_search_mm};
}

using Fits = std::vector<std::optional<Fit>>;

/// Fits at every third sample that has enough of them around.
Fits floor_fits(const std::vector<ThicknessSample>& samples, const adapters::PointTree& tree, double ridge_mm) {
  Fits fits(samples.size());
  const auto wanted = static_cast<std::int64_t>((fits.size() + samples_per_fit - 1) / samples_per_fit);
  parallel::parallel_for(0, wanted, [&](std::int64_t begin, std::int64_t end) {
    Near near;
    std::vector<Observation> observations;
    for (std::int64_t fit = begin; fit < end; ++fit) {
      const auto n = static_cast<std::size_t>(fit) * samples_per_fit;
      const Vec3& p = samples[n].point_mm;
      const std::array<double, 3> at{p.x, p.y, p.z};
      tree.radiusSearch(at.data(), fit_search_mm * fit_search_mm, near, nanoflann::SearchParams(32, 0, false));
      if (near.size() >= min_near) fits[n] = floor_fit(samples, near, p, ridge_mm, observations);
    }
  });
  return fits;
}

/// How uneven the samples are, mm: ridges only thicken a wall, so what lies below the floor is chance.
std::optional<double> noise_below(const std::vector<ThicknessSample>& samples, const Fits& fits) {
  constexpr double normal_median = 0.6744898;  // of the size of a standard normal variable
  std::vector<double> below;
  for (std::size_t n = 0; n < fits.size(); ++n)
    if (fits[n] && samples[n].thickness_mm < fits[n]->value) below.push_back(fits[n]->value - samples[n].thickness_mm);
  if (below.empty()) return std::nullopt;
  return upper_median(below) / normal_median;
}

/// Where ridges begin, out of the samples themselves. Where nothing is uneven, as guessed.
double measured_ridge(const std::vector<ThicknessSample>& samples, const adapters::PointTree& tree, double guess_mm) {
  constexpr int rounds = 3;  // of guess and measure
  double ridge_mm = guess_mm;
  for (int round = 0; round < rounds; ++round) {
    const auto noise_mm = noise_below(samples, floor_fits(samples, tree, ridge_mm));
    ridge_mm = std::max(guess_mm, ridge_noises * noise_mm.value_or(0));
  }
  return ridge_mm;
}

}  // namespace

double distance_along_gradient(const LevelSet& surface, const Vec3& point_mm) {
  constexpr int steps = 3;
  constexpr double flat = 1e-6;
  const double spacing_mm = surface.grid.spacing_mm.x;
  const Vec3 from = index_from_lps(surface.grid, point_mm);
  Vec3 at = from;
  double value_mm = 0;
  for (int step = 0; step < steps; ++step) {
    const auto [value, gradient] = value_and_gradient(surface, at);
    if (step == 0) value_mm = value;
    const double squared = dot(gradient, gradient);
    if (squared < flat) return value_mm;
    at = at - (value / (squared * spacing_mm)) * gradient;
  }
  return std::copysign(norm(at - from) * spacing_mm, value_mm);
}

std::vector<ThicknessSample> endocardial_thickness(const LevelSet& cavity, const LevelSet& outer, const Mask& where) {
  const auto found = crossings(cavity, where);
  std::vector<double> thickness_mm(found.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(found.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      thickness_mm[n] = -distance_along_gradient(outer, lps_from_index(outer.grid, found[n].index));
  });
  std::vector<ThicknessSample> samples;
  for (std::size_t first = 0, last = 0; first < found.size(); first = last) {
    ThicknessSample sum;
    for (; last < found.size() && found[last].cell == found[first].cell; ++last) {
      sum.point_mm += lps_from_index(cavity.grid, found[last].index);
      sum.thickness_mm += thickness_mm[last];
    }
    const auto count = static_cast<double>(last - first);
    samples.push_back({sum.point_mm / count, sum.thickness_mm / count});
  }
  return samples;
}

struct CompactWall::Index {
  adapters::PointCloud cloud;
  std::vector<Fit> fits;
  adapters::PointTree tree;
  Index(adapters::PointCloud points, std::vector<Fit> values)
      : cloud(std::move(points)), fits(std::move(values)), tree(3, cloud, adapters::tree_leaves) {}
};

CompactWall::CompactWall(const std::vector<ThicknessSample>& samples, double ridge_mm) {
  if (samples.empty()) return;
  adapters::PointCloud all;
  for (const auto& sample : samples) all.points.push_back(sample.point_mm);
  const adapters::PointTree tree(3, all, adapters::tree_leaves);
  if (std::isfinite(ridge_mm)) ridge_mm = measured_ridge(samples, tree, ridge_mm);
  const Fits fits = floor_fits(samples, tree, ridge_mm);
  adapters::PointCloud points;
  std::vector<Fit> values;
  for (std::size_t n = 0; n < fits.size(); ++n) {
    if (!fits[n]) continue;
    points.points.push_back(all.points[n]);
    values.push_back(*fits[n]);
  }
  if (!values.empty()) index_ = std::make_unique<const Index>(std::move(points), std::move(values));
}

CompactWall::~CompactWall() = default;

std::optional<CompactWall::Thickness> CompactWall::at(const Vec3& point_mm) const {
  constexpr std::size_t most = 12;
  constexpr double smoothing_mm = 3;
  if (!index_) return std::nullopt;
  std::array<std::size_t, most> nearest{};
  std::array<double, most> squared{};
  const std::array<double, 3> at{point_mm.x, point_mm.y, point_mm.z};
  const std::size_t found = index_->tree.knnSearch(at.data(), most, nearest.data(), squared.data());
  Thickness sum;
  double total = 0;
  for (std::size_t n = 0; n < found; ++n) {
    const double weight = math::exp(-0.5 * (squared[n] - squared[0]) / (smoothing_mm * smoothing_mm));
    sum.mm += weight * index_->fits[nearest[n]].value;
    sum.gradient += weight * index_->fits[nearest[n]].slope;
    total += weight;
  }
  return Thickness{sum.mm / total, sum.gradient / total};
}

}  // namespace heartgen::ventricles
