// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/ventricles/ventricles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>

#include "generator/image/isotropic_distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/resample.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/ventricles/base_extrapolation.hpp"
#include "generator/ventricles/openings.hpp"
#include "generator/ventricles/trabeculae.hpp"
#include "model/axis_tensor.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"
#include "model/priors.hpp"
#include "model/quantile.hpp"

namespace heartgen::ventricles {
namespace {

constexpr std::array<std::array<int, 3>, 6> faces{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
constexpr double grid_margin_mm = 6;  // as far as the clipped distances of the pose reach
constexpr double coarsest_spacing_mm =
    2;  // for trabeculae: in coarser labels an opening would only follow the voxels' steps

template <class Keep>
std::vector<Vec3> centers_where(const Volume<std::uint8_t>& parts, Keep&& keep) {
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < parts.voxels.size(); ++v) {
    if (parts.voxels[v] == tag(Part::outside)) continue;
    const Vec3 p = image::voxel_center(parts.grid, static_cast<std::int64_t>(v));
    if (keep(parts.voxels[v], p)) points.push_back(p);
  }
  return points;
}

Vec3 mean_of(const std::vector<Vec3>& points) {
  Vec3 sum;
  for (const Vec3& p : points) sum += p;
  return points.empty() ? sum : sum / static_cast<double>(points.size());
}

/// Direction of the straight line through the centroids of slices across `axis` that are clear of the base.
Vec3 centroid_line(const std::vector<Vec3>& lv, const Vec3& base_point, const Vec3& base_normal, const Vec3& axis,
                   double voxel_volume_mm3) {
  constexpr double slice_mm = 3, margin_mm = 1, used_share = 0.8;
  std::vector<double> at_base;
  double deepest = 0;
  for (const Vec3& p : lv) {
    const double t = dot(p - base_point, axis);
    deepest = std::max(deepest, t);
    if (std::abs(dot(p - base_point, base_normal)) < 2.5) at_base.push_back(t);
  }
  const double from = (at_base.empty() ? 0 : quantile(at_base, 0.98)) + margin_mm;
  const auto slices = static_cast<std::size_t>(std::max(0.0, used_share * (deepest - from) / slice_mm));
  std::vector<Vec3> sum(slices);
  std::vector<double> count(slices);
  for (const Vec3& p : lv) {
    const double s = (dot(p - base_point, axis) - from) / slice_mm;
    if (s < 0 || s >= static_cast<double>(slices)) continue;
    sum[static_cast<std::size_t>(s)] += p;
    count[static_cast<std::size_t>(s)] += 1;
  }
  std::vector<Vec3> centroids;
  for (std::size_t s = 0; s < slices; ++s)
    if (count[s] * voxel_volume_mm3 > priors::lv_section_min_mm2 * slice_mm) centroids.push_back(sum[s] / count[s]);
  if (centroids.size() < 3) return axis;
  const Vec3 middle = mean_of(centroids);
  AxisTensor spread;
  for (const Vec3& c : centroids) spread += axis_tensor(c - middle);
  const Vec3 line = leading_axis(spread);
  return dot(line, base_normal) < 0 ? -line : line;
}

std::uint8_t part_of_region(std::uint8_t region) {
  switch (static_cast<Region>(region)) {
    case Region::lv_myocardium:
      return tag(Part::lv_wall);
    case Region::rv_myocardium:
      return tag(Part::rv_wall);
    case Region::lv_blood:
      return tag(Part::lv_cavity);
    case Region::rv_blood:
      return tag(Part::rv_cavity);
    case Region::la_wall:
    case Region::ra_wall:
    case Region::la_blood:
    case Region::ra_blood:
    case Region::aorta:
    case Region::pulmonary_artery:
      return tag(Part::other);
    default:
      return tag(Part::outside);
  }
}

bool is_ventricular(std::uint8_t region) {
  return region == tag(Region::lv_myocardium) || region == tag(Region::rv_myocardium) ||
         region == tag(Region::papillary) || region == tag(Region::lv_blood) || region == tag(Region::rv_blood);
}

void check_regions(const LabelVolume& labels) {
  std::array<std::int64_t, 256> count{};
  for (const auto v : labels.voxels) ++count[v];
  for (const Region region : {Region::lv_myocardium, Region::rv_myocardium, Region::lv_blood, Region::rv_blood})
    if (count[tag(region)] == 0)
      throw UserError(fmt::format("the label map has no voxel of {}, which fibres need", region_name(tag(region))),
                      "fibers", "check the segmentation or the label map");
}

/// Papillary muscles become the blood that they stand in: the one reached first, face by face, through the muscle.
LabelVolume papillary_as_blood(LabelVolume labels) {
  const Grid& g = labels.grid;
  std::vector<Index3> front, next;
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i)
        if (labels(i, j, k) == tag(Region::lv_blood) || labels(i, j, k) == tag(Region::rv_blood))
          front.push_back({i, j, k});
  for (; !front.empty(); front.swap(next)) {
    next.clear();
    for (const auto& [i, j, k] : front)
      for (const auto& s : faces) {
        const Index3 at{i + s[0], j + s[1], k + s[2]};
        if (!g.contains(at[0], at[1], at[2]) || labels(at[0], at[1], at[2]) != tag(Region::papillary)) continue;
        labels(at[0], at[1], at[2]) = labels(i, j, k);
        next.push_back(at);
      }
  }
  return labels;
}

Volume<std::uint8_t> parts_of_labels(const LabelVolume& labels) {
  Volume<std::uint8_t> parts(labels.grid);
  parallel::parallel_for(0, parts.grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v)
      parts.voxels[v] = part_of_region(labels.voxels[v]);
  });
  return parts;
}

PartShares part_shares(const std::map<std::uint8_t, Volume<float>>& of_parts, const Grid& grid) {
  const auto sum_of = [&](std::initializer_list<Part> parts) {
    Volume<float> sum(grid);
    for (const Part part : parts)
      if (const auto share = of_parts.find(tag(part)); share != of_parts.end())
        for (std::size_t v = 0; v < sum.voxels.size(); ++v) sum.voxels[v] += share->second.voxels[v];
    return sum;
  };
  return {sum_of({Part::lv_cavity}), sum_of({Part::rv_cavity}), sum_of({Part::lv_wall, Part::lv_cavity}),
          sum_of({Part::lv_wall, Part::lv_cavity, Part::rv_wall, Part::rv_cavity})};
}

/// Where the left ventricle's blood is open: it touches what is neither blood of its own nor wall.
std::vector<Vec3> open_places(const LabelVolume& labels) {
  const Grid& g = labels.grid;
  const auto is_open_to = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return g.contains(i, j, k) && labels(i, j, k) != tag(Region::lv_blood) &&
           !is_myocardium(static_cast<Region>(labels(i, j, k)));
  };
  std::vector<Vec3> places;
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i)
        if (labels(i, j, k) == tag(Region::lv_blood) && std::any_of(faces.begin(), faces.end(), [&](const auto& s) {
              return is_open_to(i + s[0], j + s[1], k + s[2]);
            }))
          places.push_back(image::voxel_center(g, g.offset(i, j, k)));
  return places;
}

/// Direction of the left ventricle's largest extent, from its open side (base) to the apex. (Where most of the wall is
/// does not tell: a thick septum and the outflow tract can outweigh the apex.)
Vec3 rough_axis(const LabelVolume& labels) {
  std::vector<Vec3> blood;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    if (labels.voxels[v] == tag(Region::lv_blood))
      blood.push_back(image::voxel_center(labels.grid, static_cast<std::int64_t>(v)));
  const Vec3 middle = mean_of(blood);
  AxisTensor spread;
  for (const Vec3& p : blood) spread += axis_tensor(p - middle);
  const Vec3 axis = leading_axis(spread);
  const auto open = open_places(labels);
  return !open.empty() && dot(axis, mean_of(open) - middle) > 0 ? -axis : axis;
}

Vec3 patient_base_point(const LabelVolume& labels, const Landmarks& landmarks, const Vec3& axis) {
  if (const auto mitral = landmarks.valves.find("mitral"); mitral != landmarks.valves.end())
    return mitral->second.center_mm;
  if (const auto contact = contact_disc(labels, Region::lv_blood, Region::la_blood)) return contact->center_mm;
  std::vector<double> along;
  std::vector<Vec3> blood;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    if (labels.voxels[v] == tag(Region::lv_blood)) {
      blood.push_back(image::voxel_center(labels.grid, static_cast<std::int64_t>(v)));
      along.push_back(dot(blood.back(), axis));
    }
  const Vec3 middle = mean_of(blood);
  return middle + (quantile(along, 0.03) - dot(middle, axis)) * axis;
}

/// Total least squares.
Plane plane_through(const std::vector<Vec3>& points) {
  const Vec3 middle = mean_of(points);
  AxisTensor spread;
  for (const Vec3& p : points) spread += axis_tensor(p - middle);
  // Least spread is along the normal: the leading axis of what the spread lacks.
  const double all = trace(spread);
  AxisTensor lack = -1.0 * spread;
  for (std::size_t c = 0; c < 3; ++c) lack.c[c] += all;
  return {middle, leading_axis(lack)};
}

/// The plane in which ventricles without atria are cut: there, and only there, their blood meets what is no part of the
/// heart. Empty where that is no plane across the axis.
std::optional<Plane> cut_plane(const Volume<std::uint8_t>& parts, const Vec3& axis) {
  constexpr std::size_t min_voxels = 100;
  constexpr int rounds = 8;
  constexpr double used_share = 0.6;  // the rest may lie in a valve's orifice below the cut
  constexpr double tolerance_mm = 1.5, min_cosine = 0.8;
  const Grid& g = parts.grid;
  const auto outside = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return g.contains(i, j, k) && is(parts(i, j, k), Part::outside);
  };
  std::vector<Vec3> points;
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        if (!is(parts(i, j, k), Part::lv_cavity) && !is(parts(i, j, k), Part::rv_cavity)) continue;
        if (std::any_of(faces.begin(), faces.end(), [&](auto s) { return outside(i + s[0], j + s[1], k + s[2]); }))
          points.push_back(image::voxel_center(g, g.offset(i, j, k)));
      }
  if (points.size() < min_voxels) return std::nullopt;
  const auto height = [](const Plane& plane, const Vec3& p) { return dot(p - plane.point_mm, plane.normal); };
  Plane plane = plane_through(points);
  for (int round = 0; round < rounds; ++round) {
    std::stable_sort(points.begin(), points.end(), [&](const Vec3& p, const Vec3& q) {
      return std::abs(height(plane, p)) < std::abs(height(plane, q));
    });
    plane =
        plane_through({points.begin(),
                       points.begin() + static_cast<std::ptrdiff_t>(used_share * static_cast<double>(points.size()))});
  }
  const auto flat = std::count_if(points.begin(), points.end(),
                                  [&](const Vec3& p) { return std::abs(height(plane, p)) < tolerance_mm; });
  if (static_cast<double>(flat) < used_share * static_cast<double>(points.size()) ||
      std::abs(dot(plane.normal, axis)) < min_cosine)
    return std::nullopt;
  if (dot(plane.normal, axis) < 0) plane.normal = -plane.normal;
  return plane;
}

bool has_atria(const LabelVolume& labels) {
  return std::any_of(labels.voxels.begin(), labels.voxels.end(),
                     [](auto v) { return v == tag(Region::la_blood) || v == tag(Region::ra_blood); });
}

}  // namespace

HeartFrame heart_frame(const Volume<std::uint8_t>& parts, const Vec3& base_point_mm, const Vec3& base_normal) {
  const auto below = [&](const Vec3& p) { return dot(p - base_point_mm, base_normal) >= 0; };
  const auto lv = centers_where(parts, [&](std::uint8_t v, const Vec3& p) {
    return (is(v, Part::lv_wall) || is(v, Part::lv_cavity)) && below(p);
  });
  const auto rv = centers_where(parts, [&](std::uint8_t v, const Vec3& p) {
    return (is(v, Part::rv_wall) || is(v, Part::rv_cavity)) && below(p);
  });
  if (lv.empty() || rv.empty())
    throw UserError("a ventricle lies wholly above the base plane", "fibers",
                    "check the mitral valve plane and the orientation of the image");
  HeartFrame frame;
  frame.base_normal = base_normal;
  Vec3 axis = base_normal;
  for (int round = 0; round < 6; ++round) {
    const Vec3 line = centroid_line(lv, base_point_mm, base_normal, axis, parts.grid.voxel_volume_mm3());
    axis = round == 0 ? line : normalized(axis + line);
  }
  frame.long_axis = axis;
  const Vec3 middle = mean_of(lv);
  frame.base_point_mm = middle + (dot(base_point_mm - middle, base_normal) / dot(axis, base_normal)) * axis;
  const Vec3 to_rv = mean_of(rv) - frame.base_point_mm;
  frame.rv_side = normalized(to_rv - dot(to_rv, axis) * axis);
  for (const Vec3& p : lv) frame.length_mm = std::max(frame.length_mm, dot(p - frame.base_point_mm, axis));
  return frame;
}

Volume<std::uint8_t> cut_at(const Ventricles& ventricles, const std::vector<Plane>& planes) {
  Volume<std::uint8_t> parts = ventricles.parts;
  const auto is_above = [&](const Vec3& p) {
    return std::any_of(planes.begin(), planes.end(), [&](const Plane& plane) { return depth_below_mm(plane, p) < 0; });
  };
  parallel::parallel_for(0, parts.grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t v = begin; v < end; ++v) {
      auto& part = parts.voxels[static_cast<std::size_t>(v)];
      if (is(part, Part::outside)) continue;
      if (is(part, Part::other) || is_above(image::voxel_center(parts.grid, v))) part = tag(Part::outside);
    }
  });
  return parts;
}

Volume<std::uint8_t> cut_at_base(const Ventricles& ventricles) {
  std::vector<Plane> planes{base_plane(ventricles)};
  if (ventricles.cut) planes.push_back(*ventricles.cut);
  return cut_at(ventricles, planes);
}

Ventricles ventricles_of_labels(const LabelVolume& labels, const Landmarks& landmarks, double spacing_mm) {
  check_regions(labels);
  const Grid grid = image::isotropic_grid_around(labels, is_ventricular, spacing_mm, grid_margin_mm);
  const bool atria = has_atria(labels);
  const Vec3& voxel = labels.grid.spacing_mm;
  Ventricles result;
  result.label_spacing_mm = math::cbrt(voxel.x * voxel.y * voxel.z);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 step;
    step[axis] = voxel[axis];
    result.label_steps_mm[static_cast<std::size_t>(axis)] = lps_from_axes(labels.grid, step);
  }
  const auto shares = image::shares_on(parts_of_labels(papillary_as_blood(labels)), grid);
  result.parts = image::largest_share(shares, grid);
  result.shares = part_shares(shares, grid);
  if (atria) {
    const auto openings = openings_of(labels, landmarks);
    close_base(result.parts, openings);
    result.beyond = blood_beyond(labels, grid, openings);
  }
  Vec3 normal = rough_axis(labels);
  const Vec3 base = patient_base_point(labels, landmarks, normal);
  // The atlas is cut across its long axis; so is the patient, hence the plane follows the axis found under it.
  for (int round = 0; round < 2; ++round) {
    result.frame = heart_frame(result.parts, base, normal);
    normal = result.frame.long_axis;
  }
  result.frame = heart_frame(result.parts, base, normal);
  if (!atria) {
    result.cut = cut_plane(result.parts, normal).value_or(Plane{result.frame.base_point_mm, result.frame.base_normal});
    result.beyond = open_orifices(result.parts, *result.cut);
    extrapolate_above_base(result.parts, *result.cut, result.frame.long_axis);
  }
  if (std::max({voxel.x, voxel.y, voxel.z}) > coarsest_spacing_mm) return result;
  result.trabeculae = image::mask_where(result.parts, is_wall);
  for (const Part wall : {Part::lv_wall, Part::rv_wall}) give_trabeculae_to_cavity(result.parts, wall);
  for (std::size_t v = 0; v < result.parts.voxels.size(); ++v)
    if (is_wall(result.parts.voxels[v])) result.trabeculae.voxels[v] = 0;
  return result;
}

std::optional<double> heart_handedness(const LabelVolume& labels, const Landmarks& landmarks, const HeartFrame& frame) {
  const auto openings = openings_of(labels, landmarks);
  const auto inflow = openings.find("tricuspid"), outflow = openings.find("pulmonary");
  if (inflow == openings.end() || outflow == openings.end()) return std::nullopt;
  const Vec3 across = cross(frame.rv_side, frame.long_axis);
  return dot(across, normalized(outflow->second.center_mm - inflow->second.center_mm));
}

AtlasImage image_of_labels(const LabelVolume& labels, const std::function<Vec3(const Vec3& lps_mm)>& fiber_at,
                           const Landmarks& landmarks, double spacing_mm) {
  AtlasImage image;
  image.ventricles = ventricles_of_labels(labels, landmarks, spacing_mm);
  const auto& parts = image.ventricles.parts;
  image.fiber = Volume<Vec3>(parts.grid);
  parallel::parallel_for(0, parts.grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t v = begin; v < end; ++v) {
      const auto at = static_cast<std::size_t>(v);
      if (is_wall(parts.voxels[at])) image.fiber.voxels[at] = normalized(fiber_at(image::voxel_center(parts.grid, v)));
    }
  });
  return image;
}

}  // namespace heartgen::ventricles
