// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/faint_blood.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "generator/image/distance.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/morphology.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/pde/fast_sweeping.hpp"
#include "generator/pde/total_variation.hpp"
#include "model/crop.hpp"
#include "model/mathematics.hpp"
#include "model/quantile.hpp"

namespace heartgen::anatomy {
namespace {

constexpr float fat_hu = -90;
constexpr double edge_smoothing_mm = 1;  // of the image before fat and muscle are told apart
constexpr double papillary_mm = 6;       // half the width of the gaps in the left ventricle's blood that are closed
constexpr double sharp_mm = 2.6;         // farther from them it is not
constexpr double max_evidence = 1;       // nats per mm³: no single voxel decides alone
constexpr double unseen_mm = 0.75;       // off the usual thin wall: less cannot be told from noise
constexpr float far_mm = 40;             // from walls no distance is asked for
constexpr int sweeps = 200;

double median_of(std::vector<float>& values, double otherwise) {
  return values.empty() ? otherwise : static_cast<double>(upper_median(values));
}

/// Distance from the left ventricle's blood at which half as much of a shell lies outside as at its greatest.
double typical_lv_wall(const Volume<float>& from_lv, const Mask& outside) {
  constexpr double bin_mm = 0.5, thinnest_mm = 4, thickest_mm = 20, otherwise_mm = 10;
  constexpr auto bins = static_cast<std::size_t>(thickest_mm / bin_mm);
  std::vector<double> all(bins, 0), dark(bins, 0);
  for (std::size_t v = 0; v < outside.voxels.size(); ++v) {
    const double at = static_cast<double>(from_lv.voxels[v]) / bin_mm;
    if (!(at >= 0 && at < static_cast<double>(bins))) continue;
    const auto bin = static_cast<std::size_t>(at);
    all[bin] += 1;
    dark[bin] += outside.voxels[v];
  }
  double greatest = 0;
  for (std::size_t n = 0; n < bins; ++n) greatest = std::max(greatest, all[n] > 0 ? dark[n] / all[n] : 0);
  for (std::size_t n = static_cast<std::size_t>(thinnest_mm / bin_mm); n < bins; ++n)
    if (greatest > 0 && all[n] > 0 && dark[n] / all[n] > greatest / 2) return (static_cast<double>(n) + 0.5) * bin_mm;
  return otherwise_mm;
}

/// Mean over the Gaussian neighbourhood inside the mask only.
Volume<float> mean_inside(const Volume<float>& hu, const Mask& mask, double sigma_mm) {
  Volume<float> weight(hu.grid), sum(hu.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v]) weight.voxels[v] = 1, sum.voxels[v] = hu.voxels[v];
  weight = image::gaussian(weight, sigma_mm);
  sum = image::gaussian(sum, sigma_mm);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v]) sum.voxels[v] /= weight.voxels[v];
  return sum;
}

/// Variance of the noise, per mm³, from what is left between two Gaussian means of width a and b in uniform blood.
double noise_power(const Volume<float>& hu, const Mask& uniform) {
  constexpr double a = 1.5, b = 4;
  const Volume<float> narrow = mean_inside(hu, uniform, a), wide = mean_inside(hu, uniform, b);
  std::vector<float> difference;
  for (std::size_t v = 0; v < uniform.voxels.size(); ++v)
    if (uniform.voxels[v]) difference.push_back(std::abs(narrow.voxels[v] - wide.voxels[v]));
  const double deviation = 1.48 * median_of(difference, 0);
  const auto overlap = [](double variance) { return math::pow(2 * std::numbers::pi * variance, -1.5); };
  return deviation * deviation / (overlap(2 * a * a) - 2 * overlap(a * a + b * b) + overlap(2 * b * b));
}

/// Nats per mm² of contour. Heights of a surface of stiffness mu vary by sqrt(log(extent / detail) / (2 pi mu)): 0.8 mm
/// of trabeculae and uneven walls make it 0.4. And chance agreements of noise (4 standard deviations) in single
/// voxels of 1 mm³ must not pay.
double contour_cost(double information) {
  constexpr double stiffness = 0.4, noise_blob = 1.2;
  return std::max(noise_blob * std::sqrt(information), stiffness);
}

/// Distance (mm) from where `level` is negative, sub-voxel; negative there.
Volume<float> distance_from_negative(const Volume<float>& level) {
  if (std::none_of(level.voxels.begin(), level.voxels.end(), [](float v) { return v < 0; }))
    return Volume<float>(level.grid, far_mm);
  return pde::fast_sweeping(level, far_mm);
}

/// The mask's voxel-sharp surface is smoothed by less than a voxel.
Volume<float> distance_from_mask(const Mask& mask) {
  constexpr double smoothing_voxels = 0.7;
  Volume<float> level(mask.grid);
  for (std::size_t v = 0; v < level.voxels.size(); ++v) level.voxels[v] = mask.voxels[v] ? -0.5F : 0.5F;
  return distance_from_negative(image::gaussian(level, smoothing_voxels * mask.grid.spacing_mm.x));
}

/// Grey values by distance from where a wall begins.
struct WallProfile {
  static constexpr double bin_mm = 0.1, longest_mm = 25;
  std::vector<double> volume_mm3, sum;  ///< per bin; of grey value times volume

  WallProfile() : volume_mm3(static_cast<std::size_t>(longest_mm / bin_mm), 0), sum(volume_mm3) {}
  void add(double distance_mm, double hu, double voxel_mm3) {
    const auto bin = static_cast<std::size_t>(distance_mm / bin_mm);
    if (bin >= sum.size()) return;
    volume_mm3[bin] += voxel_mm3;
    sum[bin] += voxel_mm3 * hu;
  }
};

/// The thickness that parts the profile into wall and blood best. Grey values that are not the same everywhere (by
/// `uneven_hu`) bound what a large shell can say: with hardly any contrast the wall stays near its usual thickness.
double likeliest_thickness(const WallProfile& profile, const FaintContrast& contrast, double typical_mm) {
  constexpr double deviation_mm = 0.7, uneven_hu = 1.5, alike_mm = 0.5;
  const double uneven = uneven_hu * uneven_hu * alike_mm / WallProfile::bin_mm;
  const double difference = contrast.difference_hu(), middle = contrast.muscle_hu + difference / 2;
  double best = -std::numeric_limits<double>::infinity(), thickness = typical_mm, beyond = 0;
  for (std::size_t n = profile.sum.size(); n-- > 0;) {
    const double volume = profile.volume_mm3[n];
    if (volume > 0)
      beyond += difference * (profile.sum[n] / volume - middle) / (contrast.noise_power / volume + uneven);
    const double at = static_cast<double>(n) * WallProfile::bin_mm, off = (at - typical_mm) / deviation_mm;
    if (beyond - off * off / 2 <= best) continue;
    best = beyond - off * off / 2;
    thickness = at;
  }
  return thickness;
}

/// div(∇f / |∇f|) of the smoothed function, 1/mm; no longer than the gradient where that is short.
Volume<float> divergence_of_normals(const Volume<float>& function) {
  constexpr double smoothing_mm = 1;
  const Volume<float> smooth = image::gaussian(function, smoothing_mm);
  const Grid& grid = function.grid;
  const auto difference = [&](const Volume<float>& f, const Index3& at, std::size_t axis) {
    Index3 low = at, high = at;
    low[axis] = std::max<std::int64_t>(low[axis] - 1, 0);
    high[axis] = std::min(high[axis] + 1, grid.size[axis] - 1);
    return 0.5 * static_cast<double>(f(high[0], high[1], high[2]) - f(low[0], low[1], low[2])) /
           grid.spacing_mm[static_cast<int>(axis)];
  };
  std::array<Volume<float>, 3> normal = {Volume<float>(grid), Volume<float>(grid), Volume<float>(grid)};
  Volume<float> divergence(grid);
  const auto for_each = [&](const auto& body) {
    parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t k = begin; k < end; ++k)
        for (std::int64_t j = 0; j < grid.size[1]; ++j)
          for (std::int64_t i = 0; i < grid.size[0]; ++i) body(Index3{i, j, k});
    });
  };
  for_each([&](const Index3& at) {
    const Vec3 slope{difference(smooth, at, 0), difference(smooth, at, 1), difference(smooth, at, 2)};
    const double length = std::max(norm(slope), 1.0);
    for (std::size_t axis = 0; axis < 3; ++axis)
      normal[axis](at[0], at[1], at[2]) = static_cast<float>(slope[static_cast<int>(axis)] / length);
  });
  for_each([&](const Index3& at) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) sum += difference(normal[axis], at, axis);
    divergence(at[0], at[1], at[2]) = static_cast<float>(sum);
  });
  return divergence;
}

/// The convex problem on the part of the grid where blood is possible; -1 elsewhere.
Volume<float> solve(const Volume<float>& evidence, const Mask& possible, double cost) {
  constexpr std::int64_t margin = 3;
  Volume<float> result(evidence.grid, -1);
  const Box box = bounding_box(possible, margin, [](std::uint8_t on) { return on != 0; });
  if (box.empty()) return result;
  auto slab = parallel::scatter(crop(evidence, box), parallel::self());
  pde::total_variation_l2(slab, {.lambda = 0.5 / cost, .iterations = sweeps}, parallel::self());
  paste(parallel::gather(slab, parallel::self()), box, result);
  return result;
}

}  // namespace

double grey_evidence(float hu, const FaintContrast& contrast) {
  constexpr double min_power = 1;
  const double difference = contrast.difference_hu(), middle = contrast.muscle_hu + difference / 2;
  const double evidence = difference * (static_cast<double>(hu) - middle) / std::max(contrast.noise_power, min_power);
  return std::clamp(evidence, -max_evidence, max_evidence);
}

double information(const FaintContrast& contrast) {
  return grey_evidence(static_cast<float>(contrast.blood_hu), contrast);
}

WallDistances measure_walls(const Volume<float>& hu, const Mask& lv, const Mask& other_left, double muscle_hu) {
  // Clipped before it is smoothed: neither lung behind thin fat nor bright blood inside a thin wall moves the edge.
  Volume<float> tissue = hu;
  for (float& v : tissue.voxels) v = std::clamp(v, fat_hu, std::max(static_cast<float>(muscle_hu), fat_hu));
  const Mask cavity = image::close(lv, papillary_mm);
  for (std::size_t v = 0; v < cavity.voxels.size(); ++v)
    if (cavity.voxels[v]) tissue.voxels[v] = static_cast<float>(muscle_hu);
  tissue = image::gaussian(tissue, edge_smoothing_mm);
  const auto outside_hu = static_cast<float>(0.5 * (muscle_hu + static_cast<double>(fat_hu)));
  for (float& v : tissue.voxels) v -= outside_hu;
  WallDistances walls{distance_from_negative(tissue), distance_from_mask(cavity), distance_from_mask(other_left)};
  Mask outside(hu.grid);
  for (std::size_t v = 0; v < outside.voxels.size(); ++v) outside.voxels[v] = tissue.voxels[v] < 0;
  walls.lv_wall_mm = typical_lv_wall(walls.from_lv, outside);
  return walls;
}

WallThickness prior_thickness(const WallDistances& walls) {
  WallThickness thickness;
  thickness.left_mm = walls.lv_wall_mm;
  return thickness;
}

Volume<float> prior_cavity(const WallDistances& walls, const Mask& thin_walled, const WallThickness& thickness) {
  Volume<float> inside(thin_walled.grid);
  for (std::size_t v = 0; v < inside.voxels.size(); ++v)
    inside.voxels[v] =
        static_cast<float>(std::min({static_cast<double>(walls.from_outside.voxels[v]) -
                                         (thin_walled.voxels[v] ? thickness.thin_mm : thickness.free_mm),
                                     static_cast<double>(walls.from_lv.voxels[v]) - thickness.left_mm,
                                     static_cast<double>(walls.from_other_left.voxels[v]) - thickness.double_mm}));
  return inside;
}

FaintContrast measure_faint_contrast(const Volume<float>& hu, const WallDistances& walls, const Volume<float>& space,
                                     const Mask& compartment) {
  constexpr float surely_blood_mm = 3;
  constexpr double off_blood_mm = 3, off_epicardium_mm = 2;
  std::vector<float> muscle, blood;
  Mask uniform(hu.grid);
  for (std::size_t v = 0; v < hu.voxels.size(); ++v) {
    const auto from_lv = static_cast<double>(walls.from_lv.voxels[v]);
    const bool in_wall = from_lv > off_blood_mm && from_lv < walls.lv_wall_mm - off_epicardium_mm;
    const bool off_edges = static_cast<double>(walls.from_outside.voxels[v]) > off_blood_mm &&
                           static_cast<double>(walls.from_other_left.voxels[v]) > off_blood_mm;
    if (in_wall && off_edges) muscle.push_back(hu.voxels[v]);
    if (!compartment.voxels[v]) continue;
    uniform.voxels[v] = space.voxels[v] > surely_blood_mm;
    if (uniform.voxels[v]) blood.push_back(hu.voxels[v]);
  }
  const double muscle_hu = median_of(muscle, 0);
  return {muscle_hu, median_of(blood, muscle_hu), noise_power(hu, uniform)};
}

Volume<float> prior_cavity(const WallDistances& walls, const Mask& thin_walled) {
  return prior_cavity(walls, thin_walled, prior_thickness(walls));
}

WallThickness measure_thickness(const Volume<float>& hu, const WallDistances& walls, const Mask& thin_walled,
                                const Mask& compartment, const WallThickness& usual, const FaintContrast& contrast) {
  constexpr double band_mm = 3, alone_mm = 5;
  const Mask near = image::dilate(compartment, blood_reach_mm);
  WallProfile free, left;
  const auto add = [&](WallProfile& profile, double distance_mm, double typical_mm, std::size_t v) {
    if (distance_mm < blurred_mm || std::abs(distance_mm - typical_mm) > band_mm) return;
    profile.add(distance_mm, static_cast<double>(hu.voxels[v]), hu.grid.voxel_volume_mm3());
  };
  for (std::size_t v = 0; v < hu.voxels.size(); ++v) {
    if (!near.voxels[v]) continue;
    const auto outside = static_cast<double>(walls.from_outside.voxels[v]);
    const auto from_lv = static_cast<double>(walls.from_lv.voxels[v]);
    if (static_cast<double>(walls.from_other_left.voxels[v]) - usual.double_mm < alone_mm) continue;
    if (from_lv - usual.left_mm > alone_mm && !thin_walled.voxels[v]) add(free, outside, usual.free_mm, v);
    if (outside - (thin_walled.voxels[v] ? usual.thin_mm : usual.free_mm) > alone_mm)
      add(left, from_lv, usual.left_mm, v);
  }
  WallThickness thickness = usual;
  thickness.free_mm = likeliest_thickness(free, contrast, usual.free_mm);
  thickness.left_mm = likeliest_thickness(left, contrast, usual.left_mm);
  return thickness;
}

Volume<float> faint_blood(const Volume<float>& hu, const WallDistances& walls, const Volume<float>& space,
                          const Mask& compartment, const FaintContrast& contrast, const AnatomyTrust& measured_trust,
                          const Mask& measured) {
  constexpr double min_septum_mm = 3;
  const double speaks = information(contrast), cost = contour_cost(speaks);
  const Mask near = image::dilate(compartment, blood_reach_mm);
  const Volume<float> parallels = divergence_of_normals(space);
  Volume<float> evidence(hu.grid);
  Mask possible(hu.grid);
  for (std::size_t v = 0; v < hu.voxels.size(); ++v) {
    const auto off_edges = static_cast<double>(std::min(walls.from_outside.voxels[v], walls.from_other_left.voxels[v]));
    possible.voxels[v] =
        near.voxels[v] && off_edges > blurred_mm && static_cast<double>(walls.from_lv.voxels[v]) > min_septum_mm;
    const AnatomyTrust trust = measured.voxels.empty() || measured.voxels[v] ? measured_trust : AnatomyTrust{};
    const double unmixed = std::clamp((off_edges - blurred_mm) / (sharp_mm - blurred_mm), 0.0, 1.0);
    const double usual = std::clamp(static_cast<double>(space.voxels[v]) / trust.slack_mm, -1.0, 1.0);
    const double sum = unmixed * grey_evidence(hu.voxels[v], contrast) +
                       (usual > 0 ? trust.cavity_weight : trust.wall_weight) * usual -
                       cost * static_cast<double>(parallels.voxels[v]);
    evidence.voxels[v] =
        static_cast<float>(possible.voxels[v] ? std::clamp(sum, -max_evidence, max_evidence) : -max_evidence);
  }
  Volume<float> blood = solve(evidence, possible, cost);
  // The same height on both sides of the contour, so that its interpolation lies half-way between two voxels.
  const double height = 0.5 * (speaks + measured_trust.cavity_weight);
  for (std::size_t v = 0; v < blood.voxels.size(); ++v) {
    const double value = possible.voxels[v] ? static_cast<double>(blood.voxels[v]) / height : -1;
    blood.voxels[v] = static_cast<float>(std::clamp(value, -1.0, 1.0));
  }
  return blood;
}

Volume<float> settle_thin_walls(Volume<float> blood, const Volume<float>& space, const Mask& thin_walled) {
  Mask inside(blood.grid);
  for (std::size_t v = 0; v < inside.voxels.size(); ++v) inside.voxels[v] = blood.voxels[v] > 0;
  const LevelSet contour = image::signed_distance(inside);
  for (std::size_t v = 0; v < blood.voxels.size(); ++v) {
    if (!thin_walled.voxels[v]) continue;
    const auto found = -static_cast<double>(contour.voxels[v]), usual = static_cast<double>(space.voxels[v]);
    const double agreement = std::clamp(2 - std::abs(found - usual) / unseen_mm, 0.0, 1.0);
    blood.voxels[v] = static_cast<float>(std::clamp(agreement * usual + (1 - agreement) * found, -1.0, 1.0));
  }
  return blood;
}

}  // namespace heartgen::anatomy
