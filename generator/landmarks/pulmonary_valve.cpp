// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/pulmonary_valve.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "generator/chest/working_image.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/sections.hpp"
#include "model/mathematics.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double step_mm = 2, walk_mm = 60;
constexpr std::array starts_beyond_mm{10.0, 4.0, 0.0};  // the first may lie in the bifurcation, where no walk begins
constexpr std::size_t enough_stations = 6;
constexpr double max_widening = 1.5;   // over the narrowest section so far: the ventricle's body begins
constexpr double longest_jump_mm = 6;  // of the section's centre: it slipped into another branch
constexpr double search_mm = 6;
constexpr double turn = 0.3;                            // share of the new direction per step
constexpr double ring_from_mm = 2.5, ring_to_mm = 5.5;  // outside the blood: the wall of an outflow tract
constexpr float min_muscle_hu = 20, max_muscle_hu = 180;

struct Station {
  image::Section section;
  Vec3 normal;         ///< downstream
  double muscle = 0;   ///< in its wall: a share, or the wall's grey value
  double beneath = 0;  ///< what lies beneath the wall is brighter by this, HU: blood, or muscle of a thick wall
};

/// What the walk looks at.
struct Scenery {
  const LabelVolume& chambers;
  const chest::WorkingImage& image;
  const std::optional<FaintRightHeart>& faint;
  Volume<float> blood;     ///< 1 in ventricle and artery
  Volume<float> distance;  ///< to that blood, mm
};

Scenery make_scenery(const LabelVolume& chambers, const chest::WorkingImage& image,
                     const std::optional<FaintRightHeart>& faint) {
  const Mask mask = chest::mask_where(chambers.grid, [&](const Vec3&, std::size_t v) {
    return chambers.voxels[v] == tag(Region::rv_blood) || chambers.voxels[v] == tag(Region::pulmonary_artery);
  });
  Volume<float> blood(mask.grid);
  std::copy(mask.voxels.begin(), mask.voxels.end(), blood.voxels.begin());
  return {chambers, image, faint, std::move(blood), image::distance_to(mask)};
}

/// Calls visit(offset) for the voxels nearest to a disc around a section, `beyond_mm` wider than the section.
template <class Visit>
void for_each_voxel_around(const Grid& grid, const image::Section& section, const Vec3& normal, double beyond_mm,
                           Visit&& visit) {
  constexpr double pixel_mm = 1.5;
  const image::PlaneFrame frame = image::frame_across(normal);
  const auto reach = static_cast<int>((0.7 * section.diameter_mm() + beyond_mm) / pixel_mm);
  for (int b = -reach; b <= reach; ++b)
    for (int a = -reach; a <= reach; ++a) {
      const auto at =
          chest::nearest_voxel(grid, section.centre_mm + (a * pixel_mm) * frame.u + (b * pixel_mm) * frame.v);
      if (grid.contains(at[0], at[1], at[2])) visit(static_cast<std::size_t>(grid.offset(at[0], at[1], at[2])));
    }
}

/// Share of muscle in the ring around a section, other chambers left out.
double muscle_around(const Scenery& scenery, const image::Section& section, const Vec3& normal) {
  double ring = 0, muscle = 0;
  for_each_voxel_around(scenery.chambers.grid, section, normal, ring_to_mm, [&](std::size_t v) {
    const float away = scenery.distance.voxels[v];
    if (away <= ring_from_mm || away > ring_to_mm || scenery.chambers.voxels[v] != 0) return;
    const float hu = scenery.image.smooth.voxels[v];
    ring += 1;
    muscle += hu > min_muscle_hu && hu < max_muscle_hu;
  });
  return ring > 0 ? muscle / ring : 0;
}

/// Mean grey values of the two outermost layers of tissue around a section, each two voxels thick, away from the left
/// heart.
struct WallLayers {
  double outermost_hu = 0, beneath_hu = 0;
};

WallLayers wall_layers(const Scenery& scenery, const image::Section& section, const Vec3& normal) {
  constexpr double beyond_mm = 8, off_left_mm = 5;
  constexpr float layer_mm = 2.2F;
  const auto& walls = scenery.faint->walls;
  std::array<double, 2> voxels{}, sum{};
  for (const double along_mm : {-1.5, 0.0, 1.5}) {
    const image::Section beside{section.area_mm2, section.centre_mm + along_mm * normal};
    for_each_voxel_around(scenery.chambers.grid, beside, normal, beyond_mm, [&](std::size_t v) {
      const float outside = walls.from_outside.voxels[v];
      if (outside <= 0 || outside > 2 * layer_mm || static_cast<double>(scenery.distance.voxels[v]) > beyond_mm) return;
      if (static_cast<double>(std::min(walls.from_other_left.voxels[v], walls.from_lv.voxels[v])) < off_left_mm) return;
      const std::size_t layer = outside > layer_mm;
      voxels[layer] += 1;
      sum[layer] += static_cast<double>(scenery.image.hu.voxels[v]);
    });
  }
  const auto mean = [&](std::size_t layer) { return voxels[layer] > 0 ? sum[layer] / voxels[layer] : 0; };
  return {mean(0), mean(1)};
}

Station station_at(const Scenery& scenery, const image::Section& section, const Vec3& normal) {
  if (!scenery.faint) return {section, normal, muscle_around(scenery, section, normal), 0};
  const WallLayers wall = wall_layers(scenery, section, normal);
  return {section, normal, wall.outermost_hu, wall.beneath_hu - wall.outermost_hu};
}

/// Stations every 2 mm, from the artery upstream; the plane turns with the centre line.
std::vector<Station> walk_upstream(const Scenery& scenery, const ValvePatch& start, double start_beyond_mm) {
  std::vector<Station> stations;
  Vec3 normal = start.normal, at = start.centre_mm + start_beyond_mm * normal;
  double narrowest = 1e9;
  const int steps = 1 + static_cast<int>((walk_mm + start_beyond_mm) / step_mm);
  for (int step = 0; step < steps; ++step) {
    const auto section = image::section_at(scenery.blood, at, normal, search_mm);
    if (!section || section->diameter_mm() > max_widening * narrowest) break;
    const bool first = stations.empty();  // may lie in the bifurcation, beside the artery's centre line
    if (!first && norm(section->centre_mm - at) > longest_jump_mm) break;
    narrowest = std::min(narrowest, section->diameter_mm());
    stations.push_back(station_at(scenery, *section, normal));
    if (stations.size() > 1) {
      const Vec3 line = normalized(stations[stations.size() - 2].section.centre_mm - section->centre_mm);
      normal = normalized((1 - turn) * normal + turn * line);
    }
    at = section->centre_mm - step_mm * normal;
  }
  return stations;
}

/// The first walk that gets anywhere, else the last.
std::vector<Station> first_long_walk(const Scenery& scenery, const ValvePatch& start) {
  std::vector<Station> stations;
  for (const double beyond_mm : starts_beyond_mm) {
    stations = walk_upstream(scenery, start, beyond_mm);
    if (stations.size() >= enough_stations) break;
  }
  return stations;
}

/// Middle of the blood within a disc somewhat larger than the section.
Vec3 blood_middle(const Scenery& scenery, const image::Section& section, const Vec3& normal) {
  constexpr double pixel_mm = 1.5, larger = 1.2;
  const image::PlaneFrame frame = image::frame_across(normal);
  const double radius_mm = 0.5 * larger * section.diameter_mm();
  const auto reach = static_cast<int>(radius_mm / pixel_mm);
  Vec3 sum;
  double pixels = 0;
  for (int b = -reach; b <= reach; ++b)
    for (int a = -reach; a <= reach; ++a) {
      if (math::hypot(a, b) * pixel_mm > radius_mm) continue;
      const Vec3 p = section.centre_mm + (a * pixel_mm) * frame.u + (b * pixel_mm) * frame.v;
      const auto at = chest::nearest_voxel(scenery.blood.grid, p);
      if (!scenery.blood.grid.contains(at[0], at[1], at[2]) || scenery.blood(at[0], at[1], at[2]) == 0) continue;
      sum += p;
      pixels += 1;
    }
  return pixels > 0 ? sum / pixels : section.centre_mm;
}

/// Where the artery or the ventricle seems to hang together with tissue before it, such as a chest wall it touches,
/// sections widen or slip long before the valve usually comes. These are left out, and the walk goes on through the
/// middle of what lies within a disc, until it has passed the usual place.
void go_on_within_a_disc(const Scenery& scenery, const Vec3& typical_mm, std::vector<Station>& stations) {
  constexpr double early_mm = 2, beyond_mm = 12, slipped = 1.15;
  const auto left_mm = [&] { return dot(stations.back().section.centre_mm - typical_mm, stations.back().normal); };
  if (stations.size() < enough_stations || left_mm() < early_mm) return;
  double narrowest = 1e9;
  for (const Station& station : stations) narrowest = std::min(narrowest, station.section.diameter_mm());
  while (stations.back().section.diameter_mm() > slipped * narrowest) stations.pop_back();
  for (int step = 0; step < static_cast<int>(walk_mm / step_mm) && left_mm() > -beyond_mm; ++step) {
    const Station& last = stations.back();
    image::Section next{last.section.area_mm2, last.section.centre_mm - step_mm * last.normal};
    next.centre_mm = blood_middle(scenery, next, last.normal);
    const Vec3 normal =
        normalized((1 - turn) * last.normal + turn * normalized(last.section.centre_mm - next.centre_mm));
    stations.push_back(station_at(scenery, next, normal));
  }
}

/// Where a step function fits the muscle shares from station `first` on best (least squares): the number of stations
/// before the step, which must rise by at least 0.1; 0 where there is no such step.
std::size_t muscle_begins_after(std::size_t first, const std::vector<Station>& stations) {
  constexpr std::size_t fewest = 3;
  constexpr double min_rise = 0.1;
  std::size_t best = 0;
  double best_gain = 0;
  for (std::size_t cut = first + fewest; cut + fewest <= stations.size(); ++cut) {
    double before = 0, after = 0;
    for (std::size_t n = first; n < stations.size(); ++n) (n < cut ? before : after) += stations[n].muscle;
    const double n_before = static_cast<double>(cut - first), n_after = static_cast<double>(stations.size() - cut);
    const double rise = after / n_after - before / n_before;
    const double gain = rise * rise * n_before * n_after;  // how much the step lowers the sum of squares, times n
    if (rise < min_rise || gain <= best_gain) continue;
    best_gain = gain;
    best = cut;
  }
  return best;
}

/// The same without the first stations where these hide the step: in the bifurcation, or where the field of view cuts
/// the artery short and sections are slanted, neighbours look like muscle around it.
std::size_t muscle_begins(const std::vector<Station>& stations) {
  for (const std::size_t left_out : {0U, 2U, 4U, 6U})
    if (const auto cut = muscle_begins_after(left_out, stations)) return cut;
  return 0;
}

constexpr std::size_t window = 3;  // stations on either side of a rise

/// Up to 1: in known hearts the valve lies within 16 mm of the usual place.
double plausibility(const Vec3& valve_mm, const std::optional<Vec3>& typical_mm) {
  constexpr double deviation_mm = 15;
  const double off = typical_mm ? norm(valve_mm - *typical_mm) / deviation_mm : 0;
  return math::exp(-0.5 * off * off);
}

/// The number of stations before the sharpest plausible rise of the wall's grey value between 6 mm downstream and 6 mm
/// upstream; 0 where it nowhere rises by 4 HU. It rises beside the bifurcation as well, where neighbours are seen. The
/// more contrast blood has with muscle, the more counts beside it how what lies beneath turns from blood to muscle:
/// bright blood shows through the artery's thin wall, which then is no darker than the ventricle's.
std::size_t wall_brightens(const std::vector<Station>& stations, double contrast_hu,
                           const std::optional<Vec3>& typical_mm) {
  constexpr double min_rise_hu = 4, full_contrast_hu = 40;
  const double weight = std::clamp(contrast_hu / full_contrast_hu, -1.0, 1.0);
  const auto told = [&](const Station& station) { return station.muscle - weight * station.beneath; };
  std::size_t best = 0;
  double sharpest = 0;
  for (std::size_t cut = window; cut + window <= stations.size(); ++cut) {
    double rise = 0;
    for (std::size_t n = 0; n < window; ++n) rise += told(stations[cut + n]) - told(stations[cut - 1 - n]);
    const double plausible_rise = rise * plausibility(stations[cut].section.centre_mm, typical_mm);
    if (rise <= min_rise_hu * window || plausible_rise <= sharpest) continue;
    sharpest = plausible_rise;
    best = cut;
  }
  return best;
}

/// Where, in stations, the wall's grey value crosses half-way up its rise before station `cut`: from the darkest
/// station of the vessel (farther on, blood and neighbours show through its thin wall) to the mean of the ventricle's,
/// less the first, which sees both walls. Half-way between the two stations where there is no crossing.
double half_risen(const std::vector<Station>& stations, std::size_t cut) {
  double vessel = stations[cut - 1].muscle, muscle = 0;
  for (std::size_t n = 1; n < window; ++n) {
    vessel = std::min(vessel, stations[cut - 1 - n].muscle);
    muscle += stations[cut + n].muscle / (window - 1);
  }
  const double level = 0.5 * (vessel + muscle);
  for (const std::size_t end : {cut, cut + 1, cut - 1}) {
    const double before = stations[end - 1].muscle, after = stations[end].muscle;
    if (before <= level && after > level) return static_cast<double>(end) - 1 + (level - before) / (after - before);
  }
  return static_cast<double>(cut) - 0.5;
}

/// The valve of a faint right heart: its blood has no sure shape that would tell more than its wall does. The walk's
/// direction is made of where it came from; the station after the valve knows the direction at the valve.
ValvePatch valve_where_wall_brightens(const std::vector<Station>& stations, std::size_t cut, ValvePatch valve) {
  const double at = half_risen(stations, cut);
  const auto before = std::min(static_cast<std::size_t>(at), stations.size() - window);
  const double t = at - static_cast<double>(before);
  const Station &vessel = stations[before], &ventricle = stations[before + 1];
  valve.centre_mm = (1 - t) * vessel.section.centre_mm + t * ventricle.section.centre_mm;
  valve.normal = normalized((1 - t) * ventricle.normal + t * stations[before + 2].normal);
  valve.diameter_mm = vessel.section.diameter_mm();
  return valve;
}

/// Where no wall tells: the end of the walk, where the ventricle widens, if the valve usually lies nearer to it than to
/// the start.
ValvePatch end_of_walk_or_start(const std::vector<Station>& stations, const ValvePatch& start,
                                const std::optional<Vec3>& typical_mm) {
  if (stations.empty() || !typical_mm) return start;
  const Station& last = stations.back();
  if (norm(last.section.centre_mm - *typical_mm) >= norm(start.centre_mm - *typical_mm)) return start;
  ValvePatch valve = start;
  valve.centre_mm = last.section.centre_mm;
  valve.normal = last.normal;
  valve.diameter_mm = last.section.diameter_mm();
  return valve;
}

}  // namespace

ValvePatch find_pulmonary_valve(const LabelVolume& chambers, const chest::WorkingImage& image,
                                const std::optional<FaintRightHeart>& faint, const ValvePatch& start,
                                const std::optional<Vec3>& typical_mm) {
  const Scenery scenery = make_scenery(chambers, image, faint);
  auto stations = first_long_walk(scenery, start);
  if (faint && typical_mm) go_on_within_a_disc(scenery, *typical_mm, stations);
  const std::size_t first_muscle =
      faint ? wall_brightens(stations, faint->contrast.difference_hu(), typical_mm) : muscle_begins(stations);
  if (first_muscle == 0) return end_of_walk_or_start(stations, start, typical_mm);
  if (faint) return valve_where_wall_brightens(stations, first_muscle, start);
  ValvePatch valve = start;
  const Station& station = stations[first_muscle];
  valve.centre_mm = station.section.centre_mm;
  valve.normal = station.normal;
  valve.diameter_mm = station.section.diameter_mm();
  if (const auto plane = image::tightest_plane(scenery.blood, valve.centre_mm, valve.normal, 0)) {
    valve.centre_mm = plane->section.centre_mm;
    valve.normal = plane->normal;
    valve.diameter_mm = plane->section.diameter_mm();
  }
  return valve;
}

}  // namespace heartgen::landmarks
