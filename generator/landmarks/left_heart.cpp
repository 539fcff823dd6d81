// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/left_heart.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generator/image/statistics.hpp"
#include "generator/landmarks/contact.hpp"
#include "generator/landmarks/search.hpp"
#include "model/mathematics.hpp"

namespace heartgen::landmarks {
namespace {

/// How much a basin looks like the left ventricle: muscle around it, large, on the left.
double ventricle_score(const Pool& pool) {
  constexpr double side_offset_mm = 5, side_width_mm = 10;
  const double on_left = 1 / (1 + math::exp(-(pool.left_mm - side_offset_mm) / side_width_mm));
  return pool.muscle_share * pool.muscle_share * std::sqrt(pool.volume_ml) * on_left;
}

bool may_be_ventricle(const Pool& pool) {
  constexpr double min_ml = 8, min_depth_mm = 7, farthest_mm = 75, max_fat = 0.45, min_front_mm = 35;
  return pool.volume_ml > min_ml && pool.depth_mm > min_depth_mm && pool.from_heart_mm < farthest_mm &&
         pool.fat_or_air_share < max_fat && pool.front_mm > min_front_mm;
}

std::vector<std::int32_t> candidates_by_score(const Pools& pools) {
  constexpr double min_muscle_share = 0.3;
  std::vector<std::int32_t> candidates;
  double best_share = 0;
  for (const auto& [label, pool] : pools) {
    if (!may_be_ventricle(pool)) continue;
    candidates.push_back(label);
    best_share = std::max(best_share, pool.muscle_share);
  }
  if (best_share < min_muscle_share)
    throw NotAHeart("no pool of bright blood with a wall of muscle is left of the spine",
                    "check that the image is not mirrored and that there is contrast in the left ventricle");
  std::stable_sort(candidates.begin(), candidates.end(), [&](std::int32_t a, std::int32_t b) {
    return ventricle_score(pools.at(a)) > ventricle_score(pools.at(b));
  });
  return candidates;
}

bool contains(const std::vector<std::int32_t>& set, std::int32_t label) {
  return std::find(set.begin(), set.end(), label) != set.end();
}

/// Widest way from a basin into the ventricle, mm and relative to the narrower one.
double widest(const image::Basins& basins, const std::vector<std::int32_t>& ventricle, std::int32_t label) {
  double best = 0;
  for (const auto part : ventricle) best = std::max(best, basins.width(label, part));
  return best;
}

/// Adds muscular basins that hang together with the main one: an apex behind large papillary muscles.
void grow_ventricle(const image::Basins& basins, const Pools& pools, std::vector<std::int32_t>& ventricle) {
  constexpr double min_muscle_share = 0.5, min_relative_width = 0.55;
  for (bool grown = true; grown;) {
    grown = false;
    for (const auto& [label, pool] : pools) {
      if (contains(ventricle, label) || pool.muscle_share < min_muscle_share || pool.left_mm < 0) continue;
      const bool attached = std::any_of(ventricle.begin(), ventricle.end(), [&, l = label](std::int32_t part) {
        return relative_width(basins, pools, l, part) > min_relative_width;
      });
      if (!attached) continue;
      ventricle.push_back(label);
      grown = true;
    }
  }
}

/// What hangs together with a basin through ways nearly as wide as itself, without the ventricle: the aortic root
/// is often a basin of its own, parted from the rest of the aorta at the sinotubular junction.
struct Group {
  std::vector<std::int32_t> members;
  double volume_ml = 0, top_mm = 0;
};

Group group_around(const image::Basins& basins, const Pools& pools, const std::vector<std::int32_t>& ventricle,
                   std::int32_t label) {
  constexpr double min_relative_width = 0.8;
  Group group{{label}, 0, pools.at(label).top_mm};
  for (std::size_t n = 0; n < group.members.size(); ++n) {
    const Pool& pool = pools.at(group.members[n]);
    group.volume_ml += pool.volume_ml;
    group.top_mm = std::max(group.top_mm, pool.top_mm);
    for (const auto& [other, ignored] : pools)
      if (!contains(ventricle, other) && !contains(group.members, other) &&
          relative_width(basins, pools, group.members[n], other) > min_relative_width)
        group.members.push_back(other);
  }
  return group;
}

/// The two large neighbours with the widest ways into the ventricle; fewer where there are fewer.
std::vector<std::int32_t> neighbours_of_ventricle(const image::Basins& basins, const Pools& pools,
                                                  const std::vector<std::int32_t>& ventricle) {
  constexpr double min_width_mm = 3, min_ml = 15, min_own_ml = 5, min_depth_mm = 8, max_muscle_share = 0.5;
  std::vector<std::int32_t> result;
  for (const auto& [label, pool] : pools)
    if (!contains(ventricle, label) && widest(basins, ventricle, label) > min_width_mm && pool.volume_ml > min_own_ml &&
        pool.depth_mm > min_depth_mm && pool.muscle_share < max_muscle_share &&
        group_around(basins, pools, ventricle, label).volume_ml > min_ml)
      result.push_back(label);
  std::stable_sort(result.begin(), result.end(), [&](std::int32_t a, std::int32_t b) {
    return widest(basins, ventricle, a) > widest(basins, ventricle, b);
  });
  if (result.size() > 2) result.resize(2);
  return result;
}

/// A ventricle has two ways out, an apex behind large papillary muscles but one, into the ventricle's base. Atria and
/// vessels have less muscle around them than a base has.
bool is_apex_alone(const Pools& pools, const std::vector<std::int32_t>& neighbours) {
  constexpr double min_muscle_share = 0.35;
  return neighbours.size() == 1 && may_be_ventricle(pools.at(neighbours.front())) &&
         pools.at(neighbours.front()).muscle_share > min_muscle_share;
}

/// The aorta reaches higher than the atrium, leaves the ventricle farther in front and lies farther in front.
double aorta_vote(const image::Basins& basins, const Pools& pools, std::int32_t label, const chest::Spine& spine,
                  const std::vector<std::int32_t>& ventricle) {
  constexpr double height_scale_mm = 20, contact_scale_mm = 10, centre_scale_mm = 20;
  const auto contact = contact_surface(
      basins.label, [&](std::int32_t l) { return l == label; }, [&](std::int32_t l) { return contains(ventricle, l); });
  const Pool& pool = pools.at(label);
  const Vec3 at = contact.points.empty() ? pool.centre_mm : image::mean(contact.points);
  const double top = group_around(basins, pools, ventricle, label).top_mm;
  return top / height_scale_mm + (spine.at(at.z).y - at.y) / contact_scale_mm + pool.front_mm / centre_scale_mm;
}

/// A long tube of even width beside the spine, behind the middle of the left atrium.
bool is_descending_aorta(const Pool& pool, const Pool& atrium, const chest::Spine& spine) {
  constexpr double min_ml = 5, shortest_mm = 45, thinnest_mm = 5, thickest_mm = 20, max_uneven_hu = 60;
  constexpr double right_mm = -10, left_mm = 40, from_spine_mm = 62, min_filling = 0.5, max_filling = 2.2;
  const double length = pool.top_mm - pool.bottom_mm + chest::working_spacing_mm;
  const double tube_ml = std::numbers::pi * pool.depth_mm * pool.depth_mm * length / 1000;
  const double filling = pool.volume_ml / tube_ml;
  const Vec3 off = pool.centre_mm - spine.at(pool.centre_mm.z);
  return pool.volume_ml >= min_ml && length > shortest_mm && pool.depth_mm > thinnest_mm &&
         pool.depth_mm < thickest_mm && filling > min_filling && filling < max_filling && pool.left_mm > right_mm &&
         pool.left_mm < left_mm && math::hypot(off.x, off.y) < from_spine_mm && pool.front_mm < atrium.front_mm &&
         pool.hu_deviation < max_uneven_hu;
}

}  // namespace

std::optional<LeftHeart> find_left_heart(const image::Basins& basins, const Pools& pools, const chest::Spine& spine,
                                         std::size_t choice) {
  const auto candidates = candidates_by_score(pools);
  if (choice >= candidates.size()) return std::nullopt;
  LeftHeart heart;
  heart.ventricle = {candidates[choice]};
  grow_ventricle(basins, pools, heart.ventricle);
  auto neighbours = neighbours_of_ventricle(basins, pools, heart.ventricle);
  if (is_apex_alone(pools, neighbours)) {
    heart.ventricle.push_back(neighbours.front());
    grow_ventricle(basins, pools, heart.ventricle);
    neighbours = neighbours_of_ventricle(basins, pools, heart.ventricle);
  }
  if (neighbours.size() < 2) return std::nullopt;
  heart.certainty = 1;
  for (const auto other : candidates)
    if (!contains(heart.ventricle, other))
      heart.certainty = std::min(
          heart.certainty, 1 - ventricle_score(pools.at(other)) / ventricle_score(pools.at(heart.ventricle.front())));
  heart.certainty = std::max(heart.certainty, 0.0);
  const auto vote = [&](std::int32_t label) { return aorta_vote(basins, pools, label, spine, heart.ventricle); };
  const bool first_is_aorta = vote(neighbours[0]) >= vote(neighbours[1]);
  heart.aorta = neighbours[first_is_aorta ? 0 : 1];
  heart.atrium = neighbours[first_is_aorta ? 1 : 0];
  for (const auto& [label, pool] : pools)
    if (!contains(heart.ventricle, label) && label != heart.aorta && label != heart.atrium &&
        is_descending_aorta(pool, pools.at(heart.atrium), spine))
      heart.descending_aorta.push_back(label);
  return heart;
}

}  // namespace heartgen::landmarks
