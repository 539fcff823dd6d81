// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/atlas/pose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/image/isotropic_distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/resample.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::atlas {
namespace {

constexpr double clip_mm = 6;
constexpr double sample_spacing_mm = 4;
constexpr double rms_tolerance_mm = 5;

/// Columns long axis, RV side, and the third of a right-handed frame.
Mat3 columns_of(const ventricles::HeartFrame& frame) {
  return transposed(Mat3{{frame.long_axis, frame.rv_side, cross(frame.long_axis, frame.rv_side)}});
}

double hull_volume_mm3(const Volume<std::uint8_t>& cut) {
  const auto outside = std::count(cut.voxels.begin(), cut.voxels.end(), ventricles::tag(ventricles::Part::outside));
  return static_cast<double>(static_cast<std::ptrdiff_t>(cut.voxels.size()) - outside) * cut.grid.voxel_volume_mm3();
}

Vec3 middle_of(const ventricles::HeartFrame& frame) {
  return frame.base_point_mm + 0.4 * frame.length_mm * frame.long_axis;
}

std::vector<Volume<float>> clipped_distances(const Volume<std::uint8_t>& cut) {
  const auto channel = [&](auto inside) {
    auto distance = image::signed_distance(image::mask_where(cut, inside), 1);
    for (float& d : distance.voxels) d = std::clamp(d, static_cast<float>(-clip_mm), static_cast<float>(clip_mm));
    return distance;
  };
  return {channel([](std::uint8_t v) {
            return ventricles::is(v, ventricles::Part::lv_wall) || ventricles::is(v, ventricles::Part::lv_cavity);
          }),
          channel([](std::uint8_t v) { return ventricles::is(v, ventricles::Part::lv_cavity); }),
          channel([](std::uint8_t v) { return ventricles::is(v, ventricles::Part::rv_cavity); }),
          channel([](std::uint8_t v) { return !ventricles::is(v, ventricles::Part::outside); })};
}

/// What the map makes of a plane.
ventricles::Plane mapped(const AffineMap& map, const ventricles::Plane& plane) {
  const Vec3 helper = std::abs(plane.normal.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 first = normalized(cross(helper, plane.normal)), second = cross(plane.normal, first);
  return {map(plane.point_mm), normalized(cross(map.matrix * first, map.matrix * second))};
}

/// Where a patient's ventricles end: at their base, or, where that is cut off, at the cut and where the atlas ends.
std::vector<ventricles::Plane> ends_of(const ventricles::Ventricles& patient, const ventricles::Ventricles& atlas,
                                       const AffineMap& atlas_from_patient) {
  if (!patient.cut) return {ventricles::base_plane(patient)};
  return {*patient.cut, mapped(inverse(atlas_from_patient), ventricles::base_plane(atlas))};
}

/// A coarse lattice of points in the patient's heart and up to 4 mm around it; only those that no cut reaches.
std::vector<Vec3> sample_points(const Volume<float>& hull, const std::vector<ventricles::Plane>& cuts) {
  const auto& g = hull.grid;
  const auto step = std::max<std::int64_t>(1, std::llround(sample_spacing_mm / g.spacing_mm.x));
  std::vector<Vec3> points;
  for (std::int64_t k = 0; k < g.size[2]; k += step)
    for (std::int64_t j = 0; j < g.size[1]; j += step)
      for (std::int64_t i = 0; i < g.size[0]; i += step) {
        const Vec3 p = image::voxel_center(g, g.offset(i, j, k));
        const auto clear = [&](const ventricles::Plane& cut) { return ventricles::depth_below_mm(cut, p) > clip_mm; };
        if (hull(i, j, k) < 4 && std::all_of(cuts.begin(), cuts.end(), clear)) points.push_back(p);
      }
  return points;
}

/// Distance maps of both hearts as they are cut, the patient's at a lattice of points.
struct Maps {
  std::vector<Vec3> points_mm;
  std::vector<std::vector<float>> patient;
  std::vector<Volume<float>> atlas;
};

/// `cuts` of the patient: no point is so near that they change its distances.
Maps maps_of(const CommonParts& parts, const std::vector<ventricles::Plane>& cuts) {
  Maps maps;
  maps.atlas = clipped_distances(parts.atlas);
  const auto patient = clipped_distances(parts.patient);
  maps.points_mm = sample_points(patient.back(), cuts);
  for (const auto& map : patient) {
    auto& channel = maps.patient.emplace_back();
    for (const Vec3& p : maps.points_mm)
      channel.push_back(static_cast<float>(sample_linear(map, index_from_lps(map.grid, p))));
  }
  return maps;
}

adapters::PoseFit fit(const Maps& maps, const AffineMap& start, const Vec3& center, adapters::PoseFreedom freedom) {
  std::vector<const Volume<float>*> targets;
  for (const auto& map : maps.atlas) targets.push_back(&map);
  return adapters::fit_pose(start, center, maps.points_mm, targets, maps.patient, freedom);
}

/// Without its base a heart does not say how long it is, other than by how wide it is. Where the atlas ends in it is
/// known from a first fit on; the end that its own frame has says nothing.
adapters::PoseFit fit_cut_pose(const ventricles::Ventricles& patient, const ventricles::Ventricles& atlas,
                               const AffineMap& start) {
  const Vec3 center = middle_of(patient.frame);
  const auto similarity = adapters::PoseFreedom::similarity;
  const CommonParts parts{ventricles::cut_at_base(patient), ventricles::cut_at_base(atlas)};
  const auto first = fit(maps_of(parts, {*patient.cut}), start, center, similarity);
  if (!(determinant(first.map.matrix) > 0)) return first;
  const auto maps = maps_of(common_parts(patient, atlas, first.map), ends_of(patient, atlas, first.map));
  return fit(maps, first.map, center, similarity);
}

}  // namespace

AffineMap pose_from_frames(const ventricles::Ventricles& patient, const ventricles::Ventricles& atlas) {
  const double scale =
      math::cbrt(hull_volume_mm3(ventricles::cut_at_base(atlas)) / hull_volume_mm3(ventricles::cut_at_base(patient)));
  AffineMap map;
  map.matrix = columns_of(atlas.frame) * transposed(columns_of(patient.frame));
  for (auto& row : map.matrix.rows) row *= scale;
  map.offset_mm = middle_of(atlas.frame) - map.matrix * middle_of(patient.frame);
  return map;
}

CommonParts common_parts(const ventricles::Ventricles& patient, const ventricles::Ventricles& atlas,
                         const AffineMap& atlas_from_patient) {
  std::vector<ventricles::Plane> atlas_ends{ventricles::base_plane(atlas)};
  if (patient.cut) atlas_ends.push_back(mapped(atlas_from_patient, *patient.cut));
  return {ventricles::cut_at(patient, ends_of(patient, atlas, atlas_from_patient)),
          ventricles::cut_at(atlas, atlas_ends)};
}

Pose fit_atlas_pose(const ventricles::Ventricles& patient, const ventricles::Ventricles& atlas) {
  const AffineMap start = pose_from_frames(patient, atlas);
  const Vec3 center = middle_of(patient.frame);
  const auto whole = [&] {
    const Maps maps = maps_of({ventricles::cut_at_base(patient), ventricles::cut_at_base(atlas)}, {});
    const auto similar = fit(maps, start, center, adapters::PoseFreedom::similarity);
    return fit(maps, similar.map, center, adapters::PoseFreedom::affine);
  };
  const auto found = patient.cut ? fit_cut_pose(patient, atlas, start) : whole();
  if (!(found.rms <= rms_tolerance_mm) || determinant(found.map.matrix) <= 0)
    throw UserError(fmt::format("the atlas does not fit the patient's ventricles (misfit {:.1f} mm)", found.rms),
                    "fibers", "check the segmentation of the ventricles, and that the atlas is a mesh of both");
  return {found.map, found.rms};
}

}  // namespace heartgen::atlas
