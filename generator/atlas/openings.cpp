#include "generator/atlas/openings.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/atlas/resample.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"

namespace heart::atlas {
namespace {

constexpr std::array<std::array<int, 3>, 6> faces{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

struct Valve {
  const char* name;
  Region ventricle, beyond;
  bool outflow;
};
constexpr std::array<Valve, 4> valves{{{"mitral", Region::lv_blood, Region::la_blood, false},
                                       {"aortic", Region::lv_blood, Region::aorta, true},
                                       {"tricuspid", Region::rv_blood, Region::ra_blood, false},
                                       {"pulmonary", Region::rv_blood, Region::pulmonary_artery, true}}};

/// How far to the side of a valve the muscle still ends at it, as at a cut. The fibrous plate of an inlet closes the
/// whole base, but farther out only a slab says so: beyond that height other walls may stand there. A root is a tube in
/// its own wall, and what it does not cover has an outer surface towards its neighbours.
bool lies_beyond(const Opening& opening, bool inlet, const Vec3& p) {
  constexpr double inlet_rim_mm = 12, plate_rim_mm = 30, plate_height_mm = 6, root_rim_mm = 4;
  const Vec3 d = p - opening.center_mm;
  const double height = dot(d, opening.normal);
  if (height <= 0) return false;
  const double outside_mm = norm(d - height * opening.normal) - opening.radius_mm;
  if (!inlet) return outside_mm < root_rim_mm;
  return outside_mm < inlet_rim_mm || (outside_mm < plate_rim_mm && height < plate_height_mm);
}

std::uint8_t nearest_label(const LabelVolume& labels, const Vec3& p) {
  const Vec3 index = index_from_lps(labels.grid, p);
  const auto i = std::llround(index.x), j = std::llround(index.y), k = std::llround(index.z);
  return labels.grid.contains(i, j, k) ? labels(i, j, k) : std::uint8_t{0};
}

}  // namespace

std::optional<Opening> contact_disc(const LabelVolume& labels, Region ventricle, Region beyond) {
  constexpr std::size_t least_voxels = 20;
  const Grid& g = labels.grid;
  std::vector<Vec3> points;
  Vec3 across, sum;
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        if (labels(i, j, k) != tag(ventricle)) continue;
        bool touches = false;
        for (const auto& s : faces) {
          if (!g.contains(i + s[0], j + s[1], k + s[2]) || labels(i + s[0], j + s[1], k + s[2]) != tag(beyond))
            continue;
          touches = true;
          across += lps_from_axes(g, {static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2])});
        }
        if (!touches) continue;
        points.push_back(voxel_center(g, g.offset(i, j, k)));
        sum += points.back();
      }
  if (points.size() < least_voxels || norm(across) < 1e-6) return std::nullopt;
  Opening opening{sum / static_cast<double>(points.size()), normalized(across)};
  for (const Vec3& p : points) opening.radius_mm = std::max(opening.radius_mm, norm(p - opening.center_mm));
  return opening;
}

std::map<std::string, Opening> openings_of(const LabelVolume& labels, const Landmarks& landmarks) {
  std::map<std::string, Opening> openings;
  for (const Valve& valve : valves) {
    if (const auto known = landmarks.valves.find(valve.name); known != landmarks.valves.end())
      openings[valve.name] = {known->second.center_mm, known->second.normal, known->second.radius_mm};
    else if (const auto found = contact_disc(labels, valve.ventricle, valve.beyond))
      openings[valve.name] = *found;
  }
  return openings;
}

void close_base(Volume<std::uint8_t>& parts, const std::map<std::string, Opening>& openings) {
  const auto beyond = [&](const Vec3& p) {
    return std::any_of(openings.begin(), openings.end(), [&](const auto& named) {
      return lies_beyond(named.second, named.first == "mitral" || named.first == "tricuspid", p);
    });
  };
  parallel::parallel_for(0, parts.grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t v = begin; v < end; ++v) {
      auto& part = parts.voxels[static_cast<std::size_t>(v)];
      if (is(part, Part::outside) || is(part, Part::other))
        part = tag(beyond(voxel_center(parts.grid, v)) ? Part::other : Part::outside);
    }
  });
}

Volume<std::uint8_t> blood_beyond(const LabelVolume& labels, const Grid& grid,
                                  const std::map<std::string, Opening>& openings) {
  constexpr double height_mm = 8;
  Volume<std::uint8_t> result(grid);
  for (const Valve& valve : valves) {
    const auto known = openings.find(valve.name);
    if (!valve.outflow || known == openings.end()) continue;
    const Opening& opening = known->second;
    const Part cavity = valve.ventricle == Region::lv_blood ? Part::lv_cavity : Part::rv_cavity;
    parallel::parallel_for(0, grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t v = begin; v < end; ++v) {
        const Vec3 p = voxel_center(grid, v), d = p - opening.center_mm;
        const double height = dot(d, opening.normal);
        if (height < -height_mm || height > height_mm || norm(d - height * opening.normal) > opening.radius_mm)
          continue;
        if (nearest_label(labels, p) == tag(valve.beyond)) result.voxels[static_cast<std::size_t>(v)] = tag(cavity);
      }
    });
  }
  return result;
}

}  // namespace heart::atlas
