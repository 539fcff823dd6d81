#include "generator/segment/vessel_ends.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "generator/segment/box_around.hpp"
#include "generator/segment/components.hpp"
#include "generator/segment/distance.hpp"
#include "generator/segment/flood.hpp"
#include "generator/segment/morphology.hpp"

namespace heart::segment {
namespace {

constexpr double shell_mm = 4;  // thickness of the slices of a vessel whose centroids give its axis
constexpr double lever_mm = 8;  // distance between them

Vec3 position(const Grid& grid, std::size_t v) {
  const auto offset = static_cast<std::int64_t>(v);
  const auto row = offset / grid.size[0], slice = row / grid.size[1];
  return lps_from_index(grid, {static_cast<double>(offset % grid.size[0]), static_cast<double>(row % grid.size[1]),
                               static_cast<double>(slice)});
}

Mask shell(const Volume<float>& way_mm, double from_mm, double to_mm) {
  Mask result(way_mm.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v) {
    const auto way = static_cast<double>(way_mm.voxels[v]);
    result.voxels[v] = way >= from_mm && way < to_mm;
  }
  return result;
}

/// Centroids of the pieces of a mask with at least `minimum` voxels.
std::vector<Vec3> centroids(const Mask& mask, std::int64_t minimum) {
  const Components pieces = connected_components(mask);
  std::vector<Vec3> sum(pieces.voxel_count.size());
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (const auto label = pieces.label.voxels[v]; label > 0)
      sum[static_cast<std::size_t>(label)] += position(mask.grid, v);
  std::vector<Vec3> result;
  for (std::size_t n = 1; n < sum.size(); ++n)
    if (pieces.voxel_count[n] >= minimum) result.push_back(sum[n] / static_cast<double>(pieces.voxel_count[n]));
  return result;
}

const Vec3& nearest(const std::vector<Vec3>& points, const Vec3& to) {
  return *std::min_element(points.begin(), points.end(),
                           [&](const Vec3& a, const Vec3& b) { return norm(a - to) < norm(b - to); });
}

/// The opening of a chamber by a share of its inscribed radius, the piece that holds the deepest point.
Mask wide_part(const Mask& whole, double core_share) {
  const Box box = bounding_box(whole, 1, [](std::uint8_t on) { return on != 0; });
  if (box.empty()) return whole;
  const Mask chamber = crop(whole, box);
  Mask outside(chamber.grid);
  for (std::size_t v = 0; v < outside.voxels.size(); ++v) outside.voxels[v] = chamber.voxels[v] == 0;
  const auto depth = distance_to(outside, 1e3F);
  const auto deepest = std::max_element(depth.voxels.begin(), depth.voxels.end());
  const double radius = core_share * static_cast<double>(*deepest);
  const auto at = deepest - depth.voxels.begin();
  const Index3 seed{at % chamber.grid.size[0], at / chamber.grid.size[0] % chamber.grid.size[1],
                    at / (chamber.grid.size[0] * chamber.grid.size[1])};
  return pasted(whole.grid, component_of(intersect(open(chamber, radius), chamber), seed), box);
}

/// A plane perpendicular to a vessel, and the direction in which it leaves.
struct End {
  Vec3 at, axis;
};

/// The largest piece at heights within 2 mm of `z_mm`.
Mask section(const Mask& region, double z_mm) {
  Mask result = region;
  for (std::size_t v = 0; v < result.voxels.size(); ++v)
    if (std::abs(position(region.grid, v).z - z_mm) > shell_mm / 2) result.voxels[v] = 0;
  return largest_component(result);
}

/// Where a vena cava that leaves upwards (`way` 1) or downwards (-1) crosses the height `z_mm`. Flat where it cannot be
/// followed far enough, or widens or turns away beyond: other tissue that was taken for blood.
End cava_end(const Mask& atrium, double z_mm, double way) {
  constexpr double most_wider = 1.5, least_along = 0.7;
  const End flat{{0, 0, z_mm}, {0, 0, way}};
  const Mask here = section(atrium, z_mm), beyond = section(atrium, z_mm + way * lever_mm);
  const auto first = centroids(here, 1), second = centroids(beyond, 1);
  const auto area = static_cast<double>(count(here));
  if (first.empty() || second.empty() || static_cast<double>(count(beyond)) > most_wider * area) return flat;
  const Vec3 axis = normalized(second.front() - first.front());
  return way * axis.z > least_along ? End{first.front(), axis} : flat;
}

}  // namespace

Mask cut_artery(const Mask& artery, const Mask& start, double length_mm) {
  const auto way = geodesic_distance(artery, start, length_mm + lever_mm);
  const auto minimum = static_cast<std::int64_t>(50 / artery.grid.voxel_volume_mm3());
  const auto ends = centroids(shell(way, length_mm - shell_mm / 2, length_mm + shell_mm / 2), minimum);
  const auto before =
      centroids(shell(way, length_mm - shell_mm / 2 - lever_mm, length_mm + shell_mm / 2 - lever_mm), 1);
  Mask result(artery.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v) {
    const auto length = static_cast<double>(way.voxels[v]);
    if (length > length_mm + lever_mm) continue;
    if (ends.empty() || before.empty() || length < length_mm - lever_mm) {
      result.voxels[v] = length <= length_mm;
      continue;
    }
    const Vec3 at = position(artery.grid, v);
    const Vec3& end = nearest(ends, at);
    const Vec3 axis = normalized(end - nearest(before, end));
    result.voxels[v] = dot(at - end, axis) <= 0;
  }
  return largest_component(result);
}

Mask cut_veins(const Mask& chamber, double core_share, double stump_mm) {
  const auto way = geodesic_distance(chamber, wide_part(chamber, core_share), stump_mm);
  Mask result(chamber.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v)
    result.voxels[v] = static_cast<double>(way.voxels[v]) <= stump_mm;
  return result;
}

Mask cut_venae_cavae(const Mask& atrium, double core_share, double above_mm, double below_mm) {
  const Mask core = wide_part(atrium, core_share);
  double lowest_mm = std::numeric_limits<double>::infinity(), highest_mm = -lowest_mm;
  for (std::size_t v = 0; v < core.voxels.size(); ++v) {
    if (!core.voxels[v]) continue;
    const double z = position(core.grid, v).z;
    lowest_mm = std::min(lowest_mm, z);
    highest_mm = std::max(highest_mm, z);
  }
  if (lowest_mm > highest_mm) return atrium;
  const End inferior = cava_end(atrium, lowest_mm - below_mm, -1),
            superior = cava_end(atrium, highest_mm + above_mm, 1);
  Mask result = atrium;
  for (std::size_t v = 0; v < result.voxels.size(); ++v) {
    const Vec3 at = position(core.grid, v);
    const bool below = at.z < lowest_mm && dot(at - inferior.at, inferior.axis) > 0;
    const bool above = at.z > highest_mm && dot(at - superior.at, superior.axis) > 0;
    if (below || above) result.voxels[v] = 0;
  }
  return largest_component(result);
}

Mask drop_thin_branches(const Mask& region, double radius_mm) {
  constexpr double rim_mm = 1;
  const Mask wide = dilate(erode(region, radius_mm), radius_mm + rim_mm);
  return largest_component(intersect(wide, region));
}

}  // namespace heart::segment
