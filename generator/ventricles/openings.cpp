// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/ventricles/openings.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/image/resample.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"
#include "model/priors.hpp"

namespace heartgen::ventricles {
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
  const Vec3 d = p - opening.center_mm;
  const double height = dot(d, opening.normal);
  if (height <= 0) return false;
  const double outside_mm = norm(d - height * opening.normal) - opening.radius_mm;
  if (!inlet) return outside_mm < priors::root_rim_mm;
  return outside_mm < priors::inlet_rim_mm || (outside_mm < priors::plate_rim_mm && height < priors::plate_height_mm);
}

std::uint8_t nearest_label(const LabelVolume& labels, const Vec3& p) {
  const Vec3 index = index_from_lps(labels.grid, p);
  const auto i = std::llround(index.x), j = std::llround(index.y), k = std::llround(index.z);
  return labels.grid.contains(i, j, k) ? labels(i, j, k) : std::uint8_t{0};
}

constexpr std::size_t min_contacts = 20;
constexpr double cut_tolerance_mm = 1.5;  // what lies nearer to the cut's plane is the cut

/// Faces between a cavity and the outside.
struct Contact {
  Index3 voxel;
  Vec3 across;  ///< sum of the faces' normals, outwards
};

std::vector<Contact> contacts_below(const Volume<std::uint8_t>& parts, Part cavity, const Plane& cut) {
  const Grid& g = parts.grid;
  std::vector<Contact> contacts;
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        if (!is(parts(i, j, k), cavity) ||
            depth_below_mm(cut, image::voxel_center(g, g.offset(i, j, k))) < cut_tolerance_mm)
          continue;
        Vec3 across;
        for (const auto& s : faces)
          if (g.contains(i + s[0], j + s[1], k + s[2]) && is(parts(i + s[0], j + s[1], k + s[2]), Part::outside))
            across += Vec3{static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2])};
        if (across != Vec3{}) contacts.push_back({{i, j, k}, across});
      }
  return contacts;
}

/// Groups of contacts that touch one another, by their numbers.
std::vector<std::vector<std::size_t>> groups_of(const Grid& grid, const std::vector<Contact>& contacts) {
  constexpr std::int32_t none = -1;
  Volume<std::int32_t> number(grid, none);
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    const auto& at = contacts[n].voxel;
    number(at[0], at[1], at[2]) = static_cast<std::int32_t>(n);
  }
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t first = 0; first < contacts.size(); ++first) {
    std::vector<std::size_t> group;
    const auto take = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      if (!grid.contains(i, j, k) || number(i, j, k) == none) return;
      group.push_back(static_cast<std::size_t>(number(i, j, k)));
      number(i, j, k) = none;
    };
    const auto& start = contacts[first].voxel;
    take(start[0], start[1], start[2]);
    for (std::size_t n = 0; n < group.size(); ++n) {
      const Index3 at = contacts[group[n]].voxel;
      for (int c = -1; c <= 1; ++c)
        for (int b = -1; b <= 1; ++b)
          for (int a = -1; a <= 1; ++a) take(at[0] + a, at[1] + b, at[2] + c);
    }
    if (group.size() >= min_contacts) groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<Opening> discs_of(const Grid& grid, const std::vector<Contact>& contacts) {
  const auto center = [&](std::size_t n) {
    const auto& at = contacts[n].voxel;
    return image::voxel_center(grid, grid.offset(at[0], at[1], at[2]));
  };
  std::vector<Opening> discs;
  for (const auto& group : groups_of(grid, contacts)) {
    Opening disc;
    Vec3 across;
    for (const auto n : group) {
      disc.center_mm += center(n) / static_cast<double>(group.size());
      across += contacts[n].across;
    }
    if (norm(across) < 1e-6) continue;
    disc.normal = normalized(across);
    for (const auto n : group) disc.radius_mm = std::max(disc.radius_mm, norm(center(n) - disc.center_mm));
    discs.push_back(disc);
  }
  return discs;
}

/// Whether the cut leaves all of a disc, so that its middle is the valve's.
bool is_whole(const Opening& opening, const Plane& cut) {
  const double slope = dot(opening.normal, cut.normal);
  const double reach_mm = opening.radius_mm * std::sqrt(std::max(0.0, 1 - slope * slope));
  return depth_below_mm(cut, opening.center_mm) - reach_mm > cut_tolerance_mm;
}

/// An inlet lies in a plate that is the lid of a wider cavity, an outlet at the end of a tube.
bool lies_in_plate(const Volume<std::uint8_t>& parts, Part cavity, const Opening& opening) {
  constexpr double min_share = 0.4;
  double ring = 0, blood = 0;
  for (std::int64_t v = 0; v < parts.grid.voxel_count(); ++v) {
    const Vec3 d = image::voxel_center(parts.grid, v) - opening.center_mm;
    const double height = dot(d, opening.normal);
    if (height < priors::plate_ring_bottom_mm || height > priors::plate_ring_top_mm) continue;
    const double beside = norm(d - height * opening.normal) - opening.radius_mm;
    if (beside < priors::plate_ring_from_mm || beside > priors::plate_ring_to_mm) continue;
    ++ring;
    blood += is(parts.voxels[static_cast<std::size_t>(v)], cavity);
  }
  return blood > min_share * ring;
}

struct Orifice {
  Part cavity;
  bool inlet;
  Opening opening;
};

std::vector<Orifice> orifices_below(const Volume<std::uint8_t>& parts, const Plane& cut) {
  std::vector<Orifice> orifices;
  for (const Part cavity : {Part::lv_cavity, Part::rv_cavity})
    for (const Opening& disc : discs_of(parts.grid, contacts_below(parts, cavity, cut)))
      orifices.push_back({cavity, is_whole(disc, cut) && lies_in_plate(parts, cavity, disc), disc});
  return orifices;
}

/// Just beyond an outflow valve, no wider than its orifice.
bool goes_on_to(const Opening& opening, const Vec3& p) {
  const Vec3 d = p - opening.center_mm;
  const double height = dot(d, opening.normal);
  return height <= priors::outflow_height_mm && norm(d - height * opening.normal) <= opening.radius_mm;
}

}  // namespace

std::optional<Opening> contact_disc(const LabelVolume& labels, Region ventricle, Region beyond) {
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
        points.push_back(image::voxel_center(g, g.offset(i, j, k)));
        sum += points.back();
      }
  if (points.size() < min_contacts || norm(across) < 1e-6) return std::nullopt;
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
        part = tag(beyond(image::voxel_center(parts.grid, v)) ? Part::other : Part::outside);
    }
  });
}

Volume<std::uint8_t> blood_beyond(const LabelVolume& labels, const Grid& grid,
                                  const std::map<std::string, Opening>& openings) {
  Volume<std::uint8_t> result(grid);
  for (const Valve& valve : valves) {
    const auto known = openings.find(valve.name);
    if (!valve.outflow || known == openings.end()) continue;
    const Opening& opening = known->second;
    const Part cavity = valve.ventricle == Region::lv_blood ? Part::lv_cavity : Part::rv_cavity;
    parallel::parallel_for(0, grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t v = begin; v < end; ++v) {
        const Vec3 p = image::voxel_center(grid, v), d = p - opening.center_mm;
        const double height = dot(d, opening.normal);
        if (std::abs(height) > priors::outflow_height_mm || norm(d - height * opening.normal) > opening.radius_mm)
          continue;
        if (nearest_label(labels, p) == tag(valve.beyond)) result.voxels[static_cast<std::size_t>(v)] = tag(cavity);
      }
    });
  }
  return result;
}

Volume<std::uint8_t> open_orifices(Volume<std::uint8_t>& parts, const Plane& cut) {
  Volume<std::uint8_t> beyond(parts.grid);
  const auto orifices = orifices_below(parts, cut);
  parallel::parallel_for(0, parts.grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
      if (!is(parts.voxels[v], Part::outside)) continue;
      const Vec3 p = image::voxel_center(parts.grid, static_cast<std::int64_t>(v));
      for (const auto& [cavity, inlet, opening] : orifices) {
        if (!lies_beyond(opening, inlet, p)) continue;
        parts.voxels[v] = tag(Part::other);
        if (!inlet && goes_on_to(opening, p)) beyond.voxels[v] = tag(cavity);
      }
    }
  });
  return beyond;
}

}  // namespace heartgen::ventricles
