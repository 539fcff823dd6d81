#include "generator/segment/faint_blood.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "generator/segment/distance.hpp"
#include "generator/segment/gaussian.hpp"
#include "generator/segment/morphology.hpp"
#include "generator/segment/total_variation.hpp"

namespace heart::segment {
namespace {

constexpr float fat_hu = -90;
constexpr double smoothing_mm = 1;       // of the image before fat and muscle are told apart
constexpr double papillary_mm = 6;       // half the width of the gaps in the left ventricle's blood that are closed
constexpr double rv_wall_mm = 3.5;       // free wall of an adult's right ventricle, 3 to 4 mm
constexpr double thin_wall_mm = 2;       // atria, arteries
constexpr double blurred_mm = 1.8;       // nearer to fat and bright blood the grey value is a mixture
constexpr double sharp_mm = 3;           // farther from them it is not
constexpr double wall_weight = 0.02;     // nats per mm³: what usual anatomy says for muscle in the walls
constexpr double cavity_weight = 0.015;  // and for blood inside, where muscles and the valves' rings are as well
constexpr double anatomy_slack_mm = 1;   // walls differ from their usual thickness by this
constexpr double most_evidence = 1;      // nats per mm³: no single voxel decides alone
constexpr int sweeps = 200;

double median_of(std::vector<float>& values, double otherwise) {
  if (values.empty()) return otherwise;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// Distance from the left ventricle's blood at which half as much of a shell lies outside as at its greatest.
double usual_lv_wall(const Volume<float>& from_lv, const Mask& outside) {
  constexpr double bin_mm = 0.5, thinnest_mm = 4, thickest_mm = 20, otherwise_mm = 10;
  constexpr auto bins = static_cast<std::size_t>(thickest_mm / bin_mm);
  std::vector<double> all(bins, 0), dark(bins, 0);
  for (std::size_t v = 0; v < outside.voxels.size(); ++v) {
    const auto bin = static_cast<std::size_t>(static_cast<double>(from_lv.voxels[v]) / bin_mm);
    if (bin >= bins) continue;
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
  weight = gaussian(weight, sigma_mm);
  sum = gaussian(sum, sigma_mm);
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
  const auto overlap = [](double variance) { return std::pow(2 * std::numbers::pi * variance, -1.5); };
  return deviation * deviation / (overlap(2 * a * a) - 2 * overlap(a * a + b * b) + overlap(2 * b * b));
}

/// Nats per mm² of contour: chance agreements of noise (3 standard deviations) in balls of 1.5 mm do not pay.
double contour_cost(double information) {
  constexpr double least = 0.03;
  return std::max(0.57 * std::sqrt(information), least);
}

}  // namespace

WallDistances measure_walls(const Volume<float>& hu, const Mask& lv, const Mask& other_left, double muscle_hu) {
  // Clipped before it is smoothed: neither lung behind thin fat nor bright blood inside a thin wall moves the edge.
  Volume<float> tissue = hu;
  for (float& v : tissue.voxels) v = std::clamp(v, fat_hu, std::max(static_cast<float>(muscle_hu), fat_hu));
  tissue = gaussian(tissue, smoothing_mm);
  const double outside_hu = 0.5 * (muscle_hu + static_cast<double>(fat_hu));
  const Mask cavity = close(lv, papillary_mm);
  Mask outside(hu.grid);
  for (std::size_t v = 0; v < outside.voxels.size(); ++v)
    outside.voxels[v] = static_cast<double>(tissue.voxels[v]) < outside_hu && !cavity.voxels[v];
  WallDistances walls{distance_to(outside), distance_to(cavity), distance_to(other_left)};
  walls.lv_wall_mm = usual_lv_wall(walls.from_lv, outside);
  return walls;
}

Volume<float> usual_cavity(const WallDistances& walls, const Mask& thin_walled) {
  Volume<float> inside(thin_walled.grid);
  // Surfaces lie between voxel centres: by half a voxel along the grid's axes, by less where they run obliquely.
  const double inset_mm = 0.25 * thin_walled.grid.spacing_mm.x;
  for (std::size_t v = 0; v < inside.voxels.size(); ++v) {
    const double free_wall = thin_walled.voxels[v] ? thin_wall_mm : rv_wall_mm;
    inside.voxels[v] =
        static_cast<float>(std::min({static_cast<double>(walls.from_outside.voxels[v]) - free_wall,
                                     static_cast<double>(walls.from_lv.voxels[v]) - walls.lv_wall_mm,
                                     static_cast<double>(walls.from_other_left.voxels[v]) - thin_wall_mm}) -
                           inset_mm);
  }
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

Volume<float> faint_blood(const Volume<float>& hu, const WallDistances& walls, const Volume<float>& space,
                          const Mask& compartment, const FaintContrast& contrast) {
  constexpr double reach_mm = 6, least_septum_mm = 3, least_power = 1;
  const double difference = contrast.difference_hu(), middle = contrast.muscle_hu + difference / 2;
  const double power = std::max(contrast.noise_power, least_power);
  const Mask near = dilate(compartment, reach_mm);
  Volume<float> evidence(hu.grid);
  Mask possible(hu.grid);
  for (std::size_t v = 0; v < hu.voxels.size(); ++v) {
    possible.voxels[v] = near.voxels[v] && static_cast<double>(walls.from_outside.voxels[v]) > blurred_mm &&
                         static_cast<double>(walls.from_other_left.voxels[v]) > blurred_mm &&
                         static_cast<double>(walls.from_lv.voxels[v]) > least_septum_mm;
    const double grey = difference * (static_cast<double>(hu.voxels[v]) - middle) / power;
    const auto off_edges = static_cast<double>(std::min(walls.from_outside.voxels[v], walls.from_other_left.voxels[v]));
    const double trust = std::clamp((off_edges - blurred_mm) / (sharp_mm - blurred_mm), 0.0, 1.0);
    const double usual = std::clamp(static_cast<double>(space.voxels[v]) / anatomy_slack_mm, -1.0, 1.0);
    const double sum =
        trust * std::clamp(grey, -most_evidence, most_evidence) + (usual > 0 ? cavity_weight : wall_weight) * usual;
    evidence.voxels[v] = possible.voxels[v] ? static_cast<float>(sum) : -static_cast<float>(most_evidence);
  }
  const double information = std::min(difference * difference / (2 * power), most_evidence);
  auto slab = parallel::scatter(evidence, parallel::self());
  total_variation_l2(slab, {.lambda = 0.5 / contour_cost(information), .iterations = sweeps}, parallel::self());
  Volume<float> blood = parallel::gather(slab, parallel::self());
  // The same height on both sides of the contour, so that its interpolation lies half-way between two voxels.
  const double height = 0.5 * (information + cavity_weight);
  for (std::size_t v = 0; v < blood.voxels.size(); ++v) {
    const double value = possible.voxels[v] ? static_cast<double>(blood.voxels[v]) / height : -1;
    blood.voxels[v] = static_cast<float>(std::clamp(value, -1.0, 1.0));
  }
  return blood;
}

}  // namespace heart::segment
