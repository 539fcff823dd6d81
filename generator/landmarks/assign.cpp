// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/assign.hpp"

#include <algorithm>
#include <queue>
#include <tuple>

#include "generator/chest/working_image.hpp"
#include "generator/image/distance.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double narrowest_mm = 2.5;        // two voxels: less may be partial volume
constexpr double min_relative_width = 0.3;  // valves are wider, breaks in a wall narrower
constexpr double largest_vein_ml = 15;      // the left atrium takes in its veins, not another chamber
constexpr double grey_tolerance = 0.2;      // relative difference at which a way counts half

/// Volume-weighted mean grey value of the seed basins of each chamber.
std::map<Region, double> seed_grey(const Pools& pools, const Assignment& seeds, const LeftHeart& left) {
  std::map<Region, std::pair<double, double>> sums;
  for (const auto& [label, region] : seeds) {
    const auto& tail = left.descending_aorta;
    if (std::find(tail.begin(), tail.end(), label) != tail.end()) continue;
    const Pool& pool = pools.at(label);
    sums[region].first += pool.volume_ml * pool.hu;
    sums[region].second += pool.volume_ml;
  }
  std::map<Region, double> grey;
  for (const auto& [region, sum] : sums) grey[region] = sum.first / sum.second;
  return grey;
}

using Neighbours = std::map<std::int32_t, std::vector<std::int32_t>>;

Neighbours neighbours_of(const image::Basins& basins, const Pools& pools) {
  Neighbours result;
  for (const auto& [pair, contact] : basins.contacts) {
    if (!pools.contains(pair.first) || !pools.contains(pair.second)) continue;
    result[pair.first].push_back(pair.second);
    result[pair.second].push_back(pair.first);
  }
  return result;
}

/// A chamber that would spread from one basin to the next, and how readily.
struct Step {
  double ease = 0;
  std::int32_t from = 0, to = 0;
  bool operator<(const Step& other) const {
    return std::tie(ease, other.from, other.to) < std::tie(other.ease, from, to);
  }
};

}  // namespace

std::int32_t find_right_heart(const image::Basins& basins, const Pools& pools, const LeftHeart& left) {
  constexpr double nearest_mm = 4.5, farthest_mm = 17;  // the septum, thin to thick
  constexpr double reach_mm = 80, min_depth_mm = 6, min_ml = 4;
  const auto is_ventricle = [&](std::int32_t label) {
    return std::find(left.ventricle.begin(), left.ventricle.end(), label) != left.ventricle.end();
  };
  const auto distance = image::distance_to(chest::mask_where(basins.label.grid, [&](const Vec3&, std::size_t v) {
    return basins.label.voxels[v] > 0 && is_ventricle(basins.label.voxels[v]);
  }));
  std::vector<std::int64_t> across(static_cast<std::size_t>(basins.count) + 1, 0);
  for (std::size_t v = 0; v < distance.voxels.size(); ++v)
    if (distance.voxels[v] > nearest_mm && distance.voxels[v] < farthest_mm)
      ++across[static_cast<std::size_t>(basins.label.voxels[v])];
  std::int32_t best = 0;
  double most = min_ml;
  for (const auto& [label, pool] : pools) {
    const auto& tail = left.descending_aorta;
    if (is_ventricle(label) || label == left.atrium || label == left.aorta ||
        std::find(tail.begin(), tail.end(), label) != tail.end() || pool.front_mm <= pools.at(left.atrium).front_mm ||
        pool.from_heart_mm >= reach_mm || pool.depth_mm <= min_depth_mm)
      continue;
    const double ml =
        static_cast<double>(across[static_cast<std::size_t>(label)]) * basins.label.grid.voxel_volume_mm3() / 1000;
    if (ml <= most) continue;
    most = ml;
    best = label;
  }
  return best;
}

Assignment assign_basins(const image::Basins& basins, const Pools& pools, const LeftHeart& left, std::int32_t right) {
  Assignment assigned;
  for (const auto label : left.ventricle) assigned[label] = Region::lv_blood;
  for (const auto label : left.descending_aorta) assigned[label] = Region::aorta;
  assigned[left.aorta] = Region::aorta;
  assigned[left.atrium] = Region::la_blood;
  if (right != 0) assigned[right] = Region::rv_blood;
  const auto grey = seed_grey(pools, assigned, left);
  const auto neighbours = neighbours_of(basins, pools);
  const auto ease = [&](std::int32_t from, std::int32_t to) {
    const double chamber = grey.at(assigned.at(from)), other = pools.at(to).hu;
    const double off = (other - chamber) / (grey_tolerance * std::min(chamber, other));
    return basins.width(from, to) / (1 + std::min(off * off, 9.0));
  };
  std::priority_queue<Step> steps;
  const auto offer_from = [&](std::int32_t from, double limit) {
    if (!neighbours.contains(from)) return;
    for (const auto to : neighbours.at(from))
      if (!assigned.contains(to)) steps.push({std::min(limit, ease(from, to)), from, to});
  };
  constexpr double no_limit = 1e9;
  for (const auto& [label, region] : Assignment(assigned)) offer_from(label, no_limit);
  while (!steps.empty()) {
    const Step step = steps.top();
    steps.pop();
    const Region region = assigned.at(step.from);
    const bool too_narrow = basins.width(step.from, step.to) < narrowest_mm ||
                            relative_width(basins, pools, step.from, step.to) < min_relative_width;
    const bool not_a_vein = region == Region::la_blood && pools.at(step.to).volume_ml > largest_vein_ml;
    if (assigned.contains(step.to) || too_narrow || region == Region::lv_blood || not_a_vein) continue;
    assigned[step.to] = region;
    offer_from(step.to, step.ease);
  }
  return assigned;
}

LabelVolume label_map(const image::Basins& basins, const Assignment& assignment) {
  std::vector<std::uint8_t> tags(static_cast<std::size_t>(basins.count) + 1, 0);
  for (const auto& [label, region] : assignment) tags[static_cast<std::size_t>(label)] = tag(region);
  LabelVolume map(basins.label.grid);
  for (std::size_t v = 0; v < map.voxels.size(); ++v)
    map.voxels[v] = tags[static_cast<std::size_t>(basins.label.voxels[v])];
  return map;
}

}  // namespace heartgen::landmarks
