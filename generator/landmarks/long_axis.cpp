// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/long_axis.hpp"

#include <algorithm>

#include "generator/image/statistics.hpp"
#include "generator/landmarks/contact.hpp"
#include "generator/landmarks/valve_patch.hpp"
#include "model/contract.hpp"
#include "model/labels.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double mitral_weight = 0.65;  // the middle of the base is nearer to the wider orifice
constexpr double tip_share = 0.003;     // of the ventricle's voxels: its tip
constexpr double longest_apex_mm = 25;  // muscle between the tip of the cavity and the epicardium, at most
constexpr double sure_muscle_mm = 2;    // from the tip outwards: partial volume with papillary muscles ignored
constexpr float fat_hu = 0;

std::vector<Vec3> voxels_of(const LabelVolume& chambers, Region region) {
  std::vector<Vec3> points;
  chest::for_each_voxel(chambers.grid, [&](const Vec3& p, std::size_t v) {
    if (chambers.voxels[v] == tag(region)) points.push_back(p);
  });
  return points;
}

/// Mean of the share of points with the greatest value.
template <class Value>
Vec3 mean_of_farthest(const std::vector<Vec3>& points, Value&& value) {
  std::vector<float> values;
  values.reserve(points.size());
  for (const Vec3& p : points) values.push_back(static_cast<float>(value(p)));
  const double limit = image::quantile(values, 1 - tip_share);
  std::vector<Vec3> farthest;
  for (const Vec3& p : points)
    if (static_cast<float>(value(p)) >= static_cast<float>(limit)) farthest.push_back(p);
  return image::mean(farthest);
}

Vec3 middle_of_base(const LabelVolume& chambers, const std::vector<Vec3>& ventricle) {
  const auto mitral = find_valve_patch(chambers, Region::lv_blood, Region::la_blood);
  const auto aortic = find_valve_patch(chambers, Region::lv_blood, Region::aorta);
  if (mitral && aortic) return mitral_weight * mitral->centre_mm + (1 - mitral_weight) * aortic->centre_mm;
  if (mitral) return mitral->centre_mm;
  return aortic ? aortic->centre_mm : image::mean(ventricle);
}

/// Line through the centres of slices across `axis`, between 20 and 85 % of the length: clear of base and tip.
Vec3 direction_of_centres(const std::vector<Vec3>& points, const Vec3& base, const Vec3& axis) {
  constexpr int slices = 8;
  constexpr double first = 0.2, last = 0.84;
  double length = 0;
  for (const Vec3& p : points) length = std::max(length, dot(p - base, axis));
  std::vector<std::vector<Vec3>> slice(slices);
  for (const Vec3& p : points) {
    const double t = (dot(p - base, axis) / length - first) / (last - first);
    if (t > 0 && t < 1) slice[static_cast<std::size_t>(t * slices)].push_back(p);
  }
  std::vector<Vec3> centres;
  for (const auto& s : slice)
    if (!s.empty()) centres.push_back(image::mean(s));
  const Vec3 line = image::principal_axes(centres).axis[0];
  return dot(line, axis) < 0 ? -line : line;
}

Vec3 leave_muscle(const Volume<float>& smooth, const Vec3& tip, const Vec3& direction) {
  constexpr double step_mm = 0.75;
  double way = sure_muscle_mm;
  while (way < longest_apex_mm && sample_linear(smooth, index_from_lps(smooth.grid, tip + way * direction)) >= fat_hu)
    way += step_mm;
  return tip + way * direction;
}

}  // namespace

LongAxis find_long_axis(const LabelVolume& chambers, const Volume<float>& smooth) {
  HEARTGEN_EXPECTS(chambers.grid == smooth.grid);
  const auto ventricle = voxels_of(chambers, Region::lv_blood);
  LongAxis axis;
  axis.base_mm = middle_of_base(chambers, ventricle);
  Vec3 tip = mean_of_farthest(ventricle, [&](const Vec3& p) { return norm(p - axis.base_mm); });
  constexpr int rounds = 3;  // the tip moves by less than a voxel after two
  for (int round = 0; round < rounds; ++round) {
    const Vec3 direction = normalized(tip - axis.base_mm);
    tip = mean_of_farthest(ventricle, [&](const Vec3& p) { return dot(p - axis.base_mm, direction); });
  }
  const Vec3 by_tip = normalized(tip - axis.base_mm);
  const Vec3 by_centres = direction_of_centres(ventricle, axis.base_mm, by_tip);
  axis.direction = normalized(by_tip + by_centres);
  axis.spread_deg = image::angle_deg(by_tip, by_centres);
  axis.apex_mm = leave_muscle(smooth, tip, axis.direction);
  return axis;
}

}  // namespace heartgen::landmarks
