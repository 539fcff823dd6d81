// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/wall_thickness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "generator/anatomy/wall_band.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/morphology.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"
#include "model/mesh_queries/corners.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double cell_mm = 2;         // places along the wall
constexpr double band_mm = 3;         // thicknesses differ by this from their mean at most,
constexpr double deviation_mm = 1;    // and by this usually;
constexpr double misplaced_mm = 1.5;  // the wall between right ventricle and atrium by this from where they are divided
constexpr double place_reach_mm = 10;  // voxels farther from the wall's end need no thickness
constexpr double alone_mm = 1;         // other walls end at least this far off
constexpr double off_left_mm = 4;      // for the free wall those beside left atrium and aorta, thick and blurred; not
                                       // for the septum: it grows thin beside the aortic root, which it alone shows
constexpr std::size_t bins = 30;
constexpr double bin_mm = 2 * band_mm / bins;

using Corners = std::array<std::pair<std::size_t, float>, 8>;

/// Places: a lattice of cells over the image; a voxel belongs to where its normal meets the end of the mean wall.
struct Places {
  Grid grid;
  const Volume<float>& distance_mm;
  double mean_mm;

  Places(const Volume<float>& distance, double mean) : grid(distance.grid), distance_mm(distance), mean_mm(mean) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double spacing = distance.grid.spacing_mm[static_cast<int>(axis)];
      grid.size[axis] =
          static_cast<std::int64_t>(static_cast<double>(distance.grid.size[axis] - 1) * spacing / cell_mm) + 2;
      grid.spacing_mm[static_cast<int>(axis)] = cell_mm;
    }
  }

  double off_mm(const Index3& at) const { return static_cast<double>(distance_mm(at[0], at[1], at[2])) - mean_mm; }

  /// In cells.
  Vec3 place(const Index3& at) const {
    constexpr double no_normal = 0.3;
    const Vec3 slope = gradient(distance_mm, at);
    const double length = norm(slope);
    Vec3 place;
    for (int axis = 0; axis < 3; ++axis) {
      double mm = static_cast<double>(at[static_cast<std::size_t>(axis)]) * distance_mm.grid.spacing_mm[axis];
      if (length > no_normal) mm -= off_mm(at) * slope[axis] / length;
      place[axis] =
          std::clamp(mm / cell_mm, 0.0, static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 1.001);
    }
    return place;
  }

  /// Cells around a place with their weights of linear interpolation.
  Corners corners(const Vec3& place) const {
    Corners result;
    std::size_t corner = 0;
    mesh_queries::for_corners(place, [&](double weight, std::int64_t i, std::int64_t j, std::int64_t k) {
      result[corner++] = {static_cast<std::size_t>(grid.offset(i, j, k)), static_cast<float>(weight)};
    });
    return result;
  }
};

template <class Body>
void for_each_near(const Places& places, double reach_mm, const Body& body) {
  const auto& size = places.distance_mm.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i)
        if (std::abs(places.off_mm({i, j, k})) < reach_mm) body(Index3{i, j, k});
}

/// A surface of the wall: blood begins (`sign` 1) or ends (-1) there, beyond what is looked for.
struct Face {
  double beyond_mm = 0;
  float sign = 1;
};

/// What is looked for: one number a place, of which the wall's faces follow.
struct Sought {
  std::vector<Face> faces;
  double prior_mm = 1;  ///< standard deviation around 0
};

/// Nats per place (one volume) and bin, summed so that what lies beyond a bin speaks for that bin.
std::vector<Volume<float>> sum_evidence(const Volume<float>& hu, const Mask& speaks, const Places& places,
                                        const FaintContrast& contrast, const Sought& sought) {
  std::vector<Volume<float>> sums(bins, Volume<float>(places.grid));
  const double voxel_mm3 = hu.grid.voxel_volume_mm3();
  double reach_mm = band_mm;
  for (const Face& face : sought.faces) reach_mm = std::max(reach_mm, band_mm + std::abs(face.beyond_mm));
  for_each_near(places, reach_mm, [&](const Index3& at) {
    if (!speaks(at[0], at[1], at[2])) return;
    const auto nats = static_cast<float>(grey_evidence(hu(at[0], at[1], at[2]), contrast) * voxel_mm3);
    const auto corners = places.corners(places.place(at));
    for (const Face& face : sought.faces) {
      const double off_mm = places.off_mm(at) - face.beyond_mm + band_mm;
      if (!(off_mm > 0 && off_mm < 2 * band_mm)) continue;
      const auto bin = std::min(static_cast<std::size_t>(off_mm / bin_mm), bins - 1);
      for (const auto& [cell, weight] : corners) sums[bin].voxels[cell] += face.sign * weight * nats;
    }
  });
  return sums;
}

/// Evidence of all bins, those of one place beside each other: they are asked for together.
struct PlaceEvidence {
  Grid grid;
  std::vector<float> nats;

  explicit PlaceEvidence(const std::vector<Volume<float>>& of_bins)
      : grid(of_bins.front().grid), nats(of_bins.front().voxels.size() * bins) {
    const auto places = of_bins.front().voxels.size();
    parallel::parallel_for(0, static_cast<std::int64_t>(places), [&](std::int64_t begin, std::int64_t end) {
      for (auto place = static_cast<std::size_t>(begin); place < static_cast<std::size_t>(end); ++place)
        for (std::size_t bin = 0; bin < bins; ++bin) nats[place * bins + bin] = of_bins[bin].voxels[place];
    });
  }

  /// Interpolated linearly inside the grid.
  std::array<double, bins> at(const Vec3& place) const {
    std::array<double, bins> sum{};
    mesh_queries::for_corners(place, [&](double weight, std::int64_t i, std::int64_t j, std::int64_t k) {
      if (weight == 0) return;
      const float* here = nats.data() + static_cast<std::size_t>(grid.offset(i, j, k)) * bins;
      for (std::size_t bin = 0; bin < bins; ++bin) sum[bin] += weight * static_cast<double>(here[bin]);
    });
    return sum;
  }
};

/// A Gaussian along the line through a cell; a single weight where `along_mm` is 0.
struct LineWeights {
  std::vector<double> weights;
  std::int64_t reach = 0;

  explicit LineWeights(double along_mm) {
    reach = static_cast<std::int64_t>(2.5 * along_mm / cell_mm);
    for (std::int64_t n = -reach; n <= reach; ++n) {
      const double at = static_cast<double>(n) * cell_mm / std::max(along_mm, cell_mm);
      weights.push_back(math::exp(-0.5 * at * at));
    }
  }
};

/// Posterior mean, mm, for a prior around 0. `nats`: evidence per bin, used up.
double posterior_mean(std::array<double, bins + 1>& nats, double prior_mm) {
  double beyond = 0, top = -std::numeric_limits<double>::infinity();
  const auto off_mm = [](std::size_t n) { return static_cast<double>(n) * bin_mm - band_mm; };
  for (std::size_t n = bins + 1; n-- > 0;) {
    beyond += nats[n];
    const double prior = off_mm(n) / prior_mm;
    nats[n] = beyond - prior * prior / 2;
    top = std::max(top, nats[n]);
  }
  double sum = 0, weighted = 0;
  for (std::size_t n = 0; n <= bins; ++n) {
    const double likely = math::exp(nats[n] - top);
    sum += likely;
    weighted += likely * off_mm(n);
  }
  return weighted / sum;
}

/// Sums over neighbouring places as a Gaussian of height 1 on the wall, at one cell.
std::array<double, bins + 1> neighbours_sum(const PlaceEvidence& smooth, const Index3& cell,
                                            const WallNeighbours& neighbours, const LineWeights& line) {
  const Grid& grid = smooth.grid;
  double total = 0;
  for (const double weight : line.weights) total += weight;
  const double ratio = neighbours.along_mm / neighbours.across_mm;
  const double height = math::pow(2 * std::numbers::pi * neighbours.across_mm * neighbours.across_mm, 1.5) /
                        (cell_mm * cell_mm * cell_mm) * std::sqrt(1 + ratio * ratio) / total;
  std::array<double, bins + 1> nats{};
  for (std::int64_t n = -line.reach; n <= line.reach; ++n) {
    Vec3 at;
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      at[axis] = static_cast<double>(cell[a]) + static_cast<double>(n) * neighbours.along[axis];
      inside = inside && at[axis] >= 0 && at[axis] <= static_cast<double>(grid.size[a] - 1);
    }
    if (!inside) continue;
    const double weight = height * line.weights[static_cast<std::size_t>(n + line.reach)];
    const auto here = smooth.at(at);
    for (std::size_t bin = 0; bin < bins; ++bin) nats[bin] += weight * here[bin];
  }
  return nats;
}

/// What is no mixture, and wall or blood of the one wall only.
struct Speakers {
  Mask free, left;
};

Speakers speakers(const WallDistances& walls, const Mask& thin_walled, const Mask& compartment,
                  const WallThickness& mean) {
  const Mask near = image::dilate(compartment, blood_reach_mm);
  Speakers result{Mask(near.grid), Mask(near.grid)};
  for (std::size_t v = 0; v < near.voxels.size(); ++v) {
    if (!near.voxels[v]) continue;
    const auto outside = static_cast<double>(walls.from_outside.voxels[v]);
    const auto from_lv = static_cast<double>(walls.from_lv.voxels[v]);
    const double other_left = static_cast<double>(walls.from_other_left.voxels[v]) - mean.double_mm;
    const bool thin = thin_walled.voxels[v] != 0;
    result.free.voxels[v] =
        other_left >= off_left_mm && !thin && from_lv - mean.left_mm > alone_mm && outside > blurred_mm;
    result.left.voxels[v] =
        other_left > alone_mm && from_lv > blurred_mm && outside - (thin ? mean.thin_mm : mean.free_mm) > alone_mm;
  }
  return result;
}

/// Of what is sought, at the place of every voxel within 10 mm of `mean_mm`; 0 elsewhere.
Volume<float> local_offset(const Volume<float>& hu, const Volume<float>& distance_mm, double mean_mm,
                           const Mask& speaks, const FaintContrast& contrast, const WallNeighbours& neighbours,
                           const Sought& sought) {
  const Places places(distance_mm, mean_mm);
  auto of_bins = sum_evidence(hu, speaks, places, contrast, sought);
  for (auto& bin : of_bins) bin = image::gaussian(bin, neighbours.across_mm);
  const PlaceEvidence evidence(of_bins);
  Mask used(places.grid);
  for_each_near(places, place_reach_mm, [&](const Index3& at) {
    for (const auto& [cell, weight] : places.corners(places.place(at)))
      if (weight > 0) used.voxels[cell] = 1;
  });
  Volume<float> off_mm(places.grid);
  const LineWeights line(neighbours.along_mm);
  parallel::parallel_for(0, places.grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < places.grid.size[1]; ++j)
        for (std::int64_t i = 0; i < places.grid.size[0]; ++i) {
          if (!used(i, j, k)) continue;
          auto nats = neighbours_sum(evidence, {i, j, k}, neighbours, line);
          off_mm(i, j, k) = static_cast<float>(posterior_mean(nats, sought.prior_mm));
        }
  });
  Volume<float> offset(hu.grid);
  for_each_near(places, place_reach_mm, [&](const Index3& at) {
    float& here = offset(at[0], at[1], at[2]);
    for (const auto& [cell, weight] : places.corners(places.place(at))) here += weight * off_mm.voxels[cell];
  });
  return offset;
}

}  // namespace

Volume<float> local_thickness(const Volume<float>& hu, const Volume<float>& distance_mm, double mean_mm,
                              const Mask& speaks, const FaintContrast& contrast, const WallNeighbours& neighbours) {
  const Sought thickness{.faces = {Face{}}, .prior_mm = deviation_mm};
  Volume<float> result = local_offset(hu, distance_mm, mean_mm, speaks, contrast, neighbours, thickness);
  for (float& mm : result.voxels) mm += static_cast<float>(mean_mm);
  return result;
}

Volume<float> local_middle(const Volume<float>& hu, const Volume<float>& distance_mm, double wall_mm,
                           const Mask& speaks, const FaintContrast& contrast, const WallNeighbours& neighbours) {
  const Sought middle{.faces = {{.beyond_mm = wall_mm / 2, .sign = 1}, {.beyond_mm = -wall_mm / 2, .sign = -1}},
                      .prior_mm = misplaced_mm};
  return local_offset(hu, distance_mm, 0, speaks, contrast, neighbours, middle);
}

Volume<float> measured_cavity(const Volume<float>& hu, const WallDistances& walls, const Mask& thin_walled,
                              const Mask& compartment, const WallThickness& mean, const FaintContrast& contrast,
                              const Vec3& long_axis) {
  // Trabeculae are a few mm wide and some cm long; the septum is smooth.
  const WallNeighbours trabeculae{.across_mm = 2, .along_mm = 8, .along = long_axis}, smooth{.across_mm = 6};
  const Speakers speak = speakers(walls, thin_walled, compartment, mean);
  const auto free = local_thickness(hu, walls.from_outside, mean.free_mm, speak.free, contrast, trabeculae);
  const auto left = local_thickness(hu, walls.from_lv, mean.left_mm, speak.left, contrast, smooth);
  Volume<float> inside(hu.grid);
  for (std::size_t v = 0; v < inside.voxels.size(); ++v) {
    const float wall = thin_walled.voxels[v] ? static_cast<float>(mean.thin_mm) : free.voxels[v];
    inside.voxels[v] = std::min({walls.from_outside.voxels[v] - wall, walls.from_lv.voxels[v] - left.voxels[v],
                                 walls.from_other_left.voxels[v] - static_cast<float>(mean.double_mm)});
  }
  return inside;
}

}  // namespace heartgen::anatomy
