#include "generator/landmarks/pulmonary_valve.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "generator/landmarks/sections.hpp"
#include "generator/landmarks/working_image.hpp"
#include "generator/segment/distance.hpp"

namespace heart::landmarks {
namespace {

constexpr double step_mm = 2, walk_mm = 60;
constexpr std::array starts_beyond_mm{10.0, 4.0, 0.0};  // the first may lie in the bifurcation, where no walk begins
constexpr std::size_t enough_stations = 6;
constexpr double most_widening = 1.5;  // over the narrowest section so far: the ventricle's body begins
constexpr double longest_jump_mm = 6;  // of the section's centre: it slipped into another branch
constexpr double search_mm = 6;
constexpr double ring_from_mm = 2.5, ring_to_mm = 5.5;  // outside the blood: the wall of an outflow tract
constexpr float least_muscle_hu = 20, most_muscle_hu = 180;

struct Station {
  Section section;
  Vec3 normal;  ///< downstream
  double muscle_share = 0;
};

/// What the walk looks at.
struct Scenery {
  const LabelVolume& chambers;
  const Volume<float>& smooth;
  Volume<float> blood;     ///< 1 in ventricle and artery
  Volume<float> distance;  ///< to that blood, mm
};

Scenery make_scenery(const LabelVolume& chambers, const Volume<float>& smooth) {
  const Mask mask = mask_where(chambers.grid, [&](const Vec3&, std::size_t v) {
    return chambers.voxels[v] == tag(Region::rv_blood) || chambers.voxels[v] == tag(Region::pulmonary_artery);
  });
  Volume<float> blood(mask.grid);
  std::copy(mask.voxels.begin(), mask.voxels.end(), blood.voxels.begin());
  return {chambers, smooth, std::move(blood), segment::distance_to(mask)};
}

/// Share of muscle in the ring around a section, other chambers left out.
double muscle_around(const Scenery& scenery, const Section& section, const Vec3& normal) {
  constexpr double pixel_mm = 1.5;
  const PlaneFrame frame = frame_across(normal);
  const auto reach = static_cast<int>((0.7 * section.diameter_mm() + ring_to_mm) / pixel_mm);
  double ring = 0, muscle = 0;
  for (int b = -reach; b <= reach; ++b)
    for (int a = -reach; a <= reach; ++a) {
      const Vec3 p = section.centre_mm + (a * pixel_mm) * frame.u + (b * pixel_mm) * frame.v;
      const auto at = nearest_voxel(scenery.chambers.grid, p);
      if (!scenery.chambers.grid.contains(at[0], at[1], at[2])) continue;
      const float away = scenery.distance(at[0], at[1], at[2]);
      if (away <= ring_from_mm || away > ring_to_mm || scenery.chambers(at[0], at[1], at[2]) != 0) continue;
      const float hu = scenery.smooth(at[0], at[1], at[2]);
      ring += 1;
      muscle += hu > least_muscle_hu && hu < most_muscle_hu;
    }
  return ring > 0 ? muscle / ring : 0;
}

/// Stations every 2 mm, from the artery upstream; the plane turns with the centre line.
std::vector<Station> walk_upstream(const Scenery& scenery, const ValvePatch& start, double start_beyond_mm) {
  constexpr double turn = 0.3;  // share of the new direction per step
  std::vector<Station> stations;
  Vec3 normal = start.normal, at = start.centre_mm + start_beyond_mm * normal;
  double narrowest = 1e9;
  for (double way = 0; way <= walk_mm + start_beyond_mm; way += step_mm) {
    const auto section = section_at(scenery.blood, at, normal, search_mm);
    if (!section || section->diameter_mm() > most_widening * narrowest) break;
    const bool first = stations.empty();  // may lie in the bifurcation, beside the artery's centre line
    if (!first && norm(section->centre_mm - at) > longest_jump_mm) break;
    narrowest = std::min(narrowest, section->diameter_mm());
    stations.push_back({*section, normal, muscle_around(scenery, *section, normal)});
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

/// Where a step function fits the muscle shares best (least squares): the number of stations before the step, which
/// must rise by at least 0.1; 0 where there is no such step.
std::size_t muscle_begins(const std::vector<Station>& stations) {
  constexpr std::size_t fewest = 3;
  constexpr double least_rise = 0.1;
  std::size_t best = 0;
  double best_gain = 0;
  for (std::size_t cut = fewest; cut + fewest <= stations.size(); ++cut) {
    double before = 0, after = 0;
    for (std::size_t n = 0; n < stations.size(); ++n) (n < cut ? before : after) += stations[n].muscle_share;
    const double n_before = static_cast<double>(cut), n_after = static_cast<double>(stations.size() - cut);
    const double rise = after / n_after - before / n_before;
    const double gain = rise * rise * n_before * n_after;  // how much the step lowers the sum of squares, times n
    if (rise < least_rise || gain <= best_gain) continue;
    best_gain = gain;
    best = cut;
  }
  return best;
}

}  // namespace

ValvePatch find_pulmonary_valve(const LabelVolume& chambers, const Volume<float>& smooth, const ValvePatch& start) {
  const Scenery scenery = make_scenery(chambers, smooth);
  const auto stations = first_long_walk(scenery, start);
  const std::size_t first_muscle = muscle_begins(stations);
  if (first_muscle == 0) return start;
  const Station& station = stations[first_muscle];
  ValvePatch valve = start;
  valve.centre_mm = station.section.centre_mm;
  valve.normal = station.normal;
  valve.diameter_mm = station.section.diameter_mm();
  if (const auto plane = tightest_plane(scenery.blood, valve.centre_mm, valve.normal, 0)) {
    valve.centre_mm = plane->section.centre_mm;
    valve.normal = plane->normal;
    valve.diameter_mm = plane->section.diameter_mm();
  }
  return valve;
}

}  // namespace heart::landmarks
