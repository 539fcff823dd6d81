#include "generator/atlas/pose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/atlas/distance_map.hpp"
#include "generator/atlas/resample.hpp"
#include "model/error.hpp"

namespace heart::atlas {
namespace {

constexpr double clip_mm = 6;
constexpr double sample_spacing_mm = 4;
constexpr double hopeless_rms_mm = 5;

/// Columns long axis, RV side, and the third of a right-handed frame.
Mat3 columns_of(const HeartFrame& frame) {
  return transposed(Mat3{{frame.long_axis, frame.rv_side, cross(frame.long_axis, frame.rv_side)}});
}

double hull_volume_mm3(const Volume<std::uint8_t>& cut) {
  const auto outside = std::count(cut.voxels.begin(), cut.voxels.end(), tag(Part::outside));
  return static_cast<double>(static_cast<std::ptrdiff_t>(cut.voxels.size()) - outside) * cut.grid.voxel_volume_mm3();
}

Vec3 middle_of(const HeartFrame& frame) { return frame.base_point_mm + 0.4 * frame.length_mm * frame.long_axis; }

std::vector<Volume<float>> clipped_distances(const Volume<std::uint8_t>& cut) {
  const auto channel = [&](auto inside) {
    auto distance = signed_distance(mask_where(cut, inside), 1);
    for (float& d : distance.voxels) d = std::clamp(d, static_cast<float>(-clip_mm), static_cast<float>(clip_mm));
    return distance;
  };
  return {channel([](std::uint8_t v) { return is(v, Part::lv_wall) || is(v, Part::lv_cavity); }),
          channel([](std::uint8_t v) { return is(v, Part::lv_cavity); }),
          channel([](std::uint8_t v) { return is(v, Part::rv_cavity); }),
          channel([](std::uint8_t v) { return !is(v, Part::outside); })};
}

/// A coarse lattice of points in the patient's heart and up to 4 mm around it; only those that a cut does not reach.
std::vector<Vec3> sample_points(const Volume<float>& hull, const std::optional<Plane>& cut) {
  const auto& g = hull.grid;
  const auto step = std::max<std::int64_t>(1, std::llround(sample_spacing_mm / g.spacing_mm.x));
  std::vector<Vec3> points;
  for (std::int64_t k = 0; k < g.size[2]; k += step)
    for (std::int64_t j = 0; j < g.size[1]; j += step)
      for (std::int64_t i = 0; i < g.size[0]; i += step)
        if (hull(i, j, k) < 4) {
          const Vec3 p = voxel_center(g, g.offset(i, j, k));
          if (!cut || depth_below_mm(*cut, p) > clip_mm) points.push_back(p);
        }
  return points;
}

}  // namespace

AffineMap pose_from_frames(const Ventricles& patient, const Ventricles& atlas) {
  const double scale = std::cbrt(hull_volume_mm3(cut_at_base(atlas)) / hull_volume_mm3(cut_at_base(patient)));
  AffineMap map;
  map.matrix = columns_of(atlas.frame) * transposed(columns_of(patient.frame));
  for (auto& row : map.matrix.rows) row *= scale;
  map.offset_mm = middle_of(atlas.frame) - map.matrix * middle_of(patient.frame);
  return map;
}

Pose fit_atlas_pose(const Ventricles& patient, const Ventricles& atlas) {
  const auto patient_maps = clipped_distances(cut_at_base(patient));
  const auto atlas_maps = clipped_distances(cut_at_base(atlas));
  const auto points = sample_points(patient_maps.back(), patient.cut);
  std::vector<const Volume<float>*> targets;
  std::vector<std::vector<float>> values;
  for (std::size_t c = 0; c < patient_maps.size(); ++c) {
    targets.push_back(&atlas_maps[c]);
    auto& channel = values.emplace_back();
    for (const Vec3& p : points)
      channel.push_back(static_cast<float>(sample_linear(patient_maps[c], index_from_lps(patient_maps[c].grid, p))));
  }
  const AffineMap start = pose_from_frames(patient, atlas);
  const Vec3 center = middle_of(patient.frame);
  const auto similar = adapters::fit_pose(start, center, points, targets, values, adapters::PoseFreedom::similarity);
  // Without its base a heart does not say how long it is, other than by how wide it is.
  const auto fit =
      patient.cut ? similar
                  : adapters::fit_pose(similar.map, center, points, targets, values, adapters::PoseFreedom::affine);
  if (!(fit.rms <= hopeless_rms_mm) || determinant(fit.map.matrix) <= 0)
    throw UserError(fmt::format("the atlas does not fit the patient's ventricles (misfit {:.1f} mm)", fit.rms),
                    "fibers", "check the segmentation of the ventricles, and that the atlas is a mesh of both");
  return {fit.map, fit.rms};
}

}  // namespace heart::atlas
