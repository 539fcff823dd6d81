// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/registered_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "generator/atlas/atlas_image.hpp"
#include "generator/fibers/push_forward.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/resample.hpp"
#include "generator/image/subvoxel_distance.hpp"
#include "generator/parallel/tasks.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::fibers {
namespace {

using ventricles::Part;
using ventricles::WallPoint;

// The ventricles' fields are blended this far on either side of their junction: a wall's own axes hold up to the other,
// no farther than labels tell where that is.
constexpr double blend_mm = 0.15;

/// The left ventricle's angles go around the long axis, the right one's around the middle of its own cavity.
Both<Vec3> angle_centers(const ventricles::Ventricles& ventricles) {
  const auto& parts = ventricles.parts;
  Vec3 sum;
  double count = 0;
  for (std::size_t v = 0; v < parts.voxels.size(); ++v) {
    if (!is(parts.voxels[v], Part::rv_cavity)) continue;
    const Vec3 p = image::voxel_center(parts.grid, static_cast<std::int64_t>(v));
    if (depth_below_base_mm(ventricles.frame, p) < 0) continue;
    sum += p;
    ++count;
  }
  return {ventricles.frame.base_point_mm, count > 0 ? sum / count : ventricles.frame.base_point_mm};
}

struct WallSamples {
  AngleSamples by_place, by_coordinates;
  std::vector<double> depth, thickness_mm;
};

WallSamples wall_samples(const ventricles::AtlasImage& image, Part wall, const Vec3& center_mm,
                         const std::string& atlas_name) {
  WallSamples samples;
  const Grid& g = image.fiber.grid;
  const auto coordinates = wall_coordinates(image.ventricles, wall);
  for (std::size_t v = 0; v < image.fiber.voxels.size(); ++v) {
    const Vec3 f = image.fiber.voxels[v];
    if (!is(image.ventricles.parts.voxels[v], wall) || !coordinates.known.voxels[v] || norm(f) < 0.5) continue;
    if (!image.mixed.voxels.empty() && image.mixed.voxels[v]) continue;
    const Vec3 position = image::voxel_center(g, static_cast<std::int64_t>(v));
    const auto at = ventricles::wall_point(coordinates, image.ventricles.frame, position);
    if (!at) continue;
    const AxisTensor tensor = axis_tensor({dot(f, at->circumferential), dot(f, at->longitudinal), dot(f, at->normal)});
    samples.depth.push_back(at->depth);
    samples.thickness_mm.push_back(at->thickness_mm);
    samples.by_place.feature.push_back(place_feature(position, at->depth, at->bend, at->normal));
    samples.by_place.tensor.push_back(tensor);
    samples.by_coordinates.feature.push_back(
        coordinate_feature(image.ventricles.frame, center_mm, position, at->depth, at->bend, at->normal));
    samples.by_coordinates.tensor.push_back(tensor);
  }
  if (samples.depth.empty())
    throw UserError("the atlas has no fibres in one of the ventricles", atlas_name,
                    "a fibre atlas is a mesh of both ventricles with one vector per point or per cell");
  return samples;
}

double helix_of(const AxisTensor& local) {
  const Vec3 axis = leading_axis(local);
  return math::atan2(axis.x < 0 ? -axis.y : axis.y, std::abs(axis.x)) * 180 / math::acos(-1.0);
}

/// A heart's fibres climb from a right-handed helix inside to a left-handed one outside; a mirrored atlas's do not.
void check_handedness(const WallSamples& lv, const std::string& name) {
  constexpr double clearly_deg = 15;
  AxisTensor inside, outside;
  for (std::size_t n = 0; n < lv.depth.size(); ++n) {
    if (lv.depth[n] < 0.3) inside += lv.by_place.tensor[n];
    if (lv.depth[n] > 0.7) outside += lv.by_place.tensor[n];
  }
  const double inner = helix_of(inside), outer = helix_of(outside);
  if (inner < outer - clearly_deg)
    throw UserError(fmt::format("the fibres of the atlas turn the wrong way: helix angle {:.0f} deg inside, {:.0f} deg "
                                "outside; it is mirrored",
                                inner, outer),
                    name, "change the sign of one coordinate of its points and of its vectors");
}

/// Features of a few thousand voxels all over one of the patient's walls.
std::vector<WallFeature> places_of_wall(const RegisteredPair& hearts, const ventricles::WallCoordinates& wall) {
  constexpr std::size_t step = 37;  // of the wall's voxels
  std::vector<WallFeature> places;
  std::size_t passed = 0;
  for (std::size_t v = 0; v < wall.known.voxels.size(); ++v) {
    if (wall.known.voxels[v] != 1 || passed++ % step != 0) continue;
    const Vec3 position = image::voxel_center(wall.known.grid, static_cast<std::int64_t>(v));
    places.push_back(place_feature(atlas_position(hearts.registration, position), wall.depth.voxels[v],
                                   wall.bend.voxels[v], hearts.registration.rotation * wall.normal.voxels[v]));
  }
  return places;
}

/// Where two hearts are shaped so differently that bends or normals at corresponding places differ by more than they
/// count in, they count in units of most of that: a heart that is smaller or smoother than the atlas bends nowhere as
/// that does, and would be looked up at the few places where it does. The right wall folds, at its groove and around
/// its valves, where some mm to the side it faces elsewhere; the left one is round, and a normal within its 10 mm is a
/// mean over some mm: it tells of the place nothing that is not known.
ShapeShares shape_shares(const RegisteredPair& hearts, bool left) {
  const auto places = places_of_wall(hearts, left ? hearts.patient_walls.lv : hearts.patient_walls.rv);
  if (places.empty()) return {0, 0};
  auto shares = shares_of(shape_difference(left ? hearts.by_place.lv : hearts.by_place.rv, places));
  if (left) shares.facing = 0;
  return shares;
}

void weigh_shapes(RegisteredPair& hearts) {
  hearts.shape_shares = {shape_shares(hearts, true), shape_shares(hearts, false)};
  for (auto* samples : {&hearts.by_place, &hearts.by_coordinates}) {
    weigh_shape(hearts.shape_shares.lv, samples->lv);
    weigh_shape(hearts.shape_shares.rv, samples->rv);
  }
}

/// What both hearts' walls are, and where the one lies in the other: side by side, for much of it is not threaded.
void align(const LabelVolume& labels, const Landmarks& landmarks, const std::string& atlas_name,
           const FiberSettings& settings, RegisteredPair& hearts) {
  refuse_mirrored_patient(labels, landmarks, hearts.patient.frame);
  const auto centers = angle_centers(hearts.atlas.ventricles);
  Both<WallSamples> samples;
  parallel::run_tasks(std::vector<std::function<void()>>{
      // the longest ones first
      [&] { hearts.registration = atlas::register_atlas(hearts.patient, hearts.atlas.ventricles, settings); },
      [&] { hearts.patient_walls.lv = wall_coordinates(hearts.patient, Part::lv_wall); },
      [&] { hearts.patient_walls.rv = wall_coordinates(hearts.patient, Part::rv_wall); },
      [&] { samples.lv = wall_samples(hearts.atlas, Part::lv_wall, centers.lv, atlas_name); },
      [&] { samples.rv = wall_samples(hearts.atlas, Part::rv_wall, centers.rv, atlas_name); },
      [&] { hearts.left_of_junction_mm = left_of_junction(hearts.patient); }});
  auto& [lv, rv] = samples;
  check_handedness(lv, atlas_name);
  hearts.atlas_depth = {std::move(lv.depth), std::move(rv.depth)};
  hearts.atlas_thickness_mm = {std::move(lv.thickness_mm), std::move(rv.thickness_mm)};
  hearts.by_place = {std::move(lv.by_place), std::move(rv.by_place)};
  hearts.by_coordinates = {std::move(lv.by_coordinates), std::move(rv.by_coordinates)};
  hearts.patient_centers_mm = angle_centers(hearts.patient);
  weigh_shapes(hearts);
}

double left_of_junction_at(const RegisteredPair& hearts, const Vec3& point_mm) {
  const Volume<float>& left_mm = hearts.left_of_junction_mm;
  return sample_linear(left_mm, index_from_lps(left_mm.grid, point_mm));
}

/// Share of the left ventricle in the field: 1 in its wall, 0 in the right one's, smooth between, so that each wall
/// keeps its own directions up to near the other.
double left_share(double left_mm) {
  const double share = std::clamp(0.5 + 0.5 * left_mm / blend_mm, 0.0, 1.0);
  return share * share * (3 - 2 * share);
}

/// Fits at the points where one wall has a share, whose dyads, by that share, are added to `axes`.
template <class FeatureAt>
WallFits add_carried(const AngleSamples& samples, const PointWalls& walls, bool left, const FeatureAt& feature_at,
                     std::vector<AxisTensor>& axes) {
  const auto share_of = [&](std::size_t n) { return left ? walls.left_share[n] : 1 - walls.left_share[n]; };
  WallFits carried{std::vector<std::int32_t>(axes.size(), -1), {}};
  std::vector<WallFeature> features;
  for (std::size_t n = 0; n < axes.size(); ++n) {
    if (!walls.known[n] || share_of(n) <= 0) continue;
    carried.of_point[n] = static_cast<std::int32_t>(features.size());
    features.push_back(feature_at(n));
  }
  carried.fits = fit_local_angles(samples, features);
  parallel::parallel_for(0, static_cast<std::int64_t>(axes.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      if (carried.of_point[n] < 0) continue;
      const auto& fit = carried.fits[static_cast<std::size_t>(carried.of_point[n])];
      axes[n] += share_of(n) * in_patient_frame(fit.tensor, left ? walls.lv[n] : walls.rv[n]);
    }
  });
  return carried;
}

}  // namespace

void refuse_mirrored_patient(const LabelVolume& labels, const Landmarks& landmarks,
                             const ventricles::HeartFrame& frame) {
  constexpr double clearly = -0.3;
  const auto handedness = heart_handedness(labels, landmarks, frame);
  if (handedness && *handedness < clearly)
    throw UserError(
        "the heart is mirrored: from its apex, with the left ventricle behind, the pulmonary valve lies on "
        "the wrong side of the tricuspid valve",
        "fibers",
        "check the orientation in the image's header, or how the image was converted; a heart "
        "that truly is mirrored (situs inversus) needs an atlas of its own");
}

Volume<float> left_of_junction(const ventricles::Ventricles& ventricles) {
  const auto& shares = ventricles.shares;
  Volume<float> left = shares.left, right = shares.both;
  for (std::size_t v = 0; v < left.voxels.size(); ++v) {
    right.voxels[v] -= left.voxels[v] + shares.rv_cavity.voxels[v];
    left.voxels[v] -= shares.lv_cavity.voxels[v];
  }
  const auto to = [&](Part wall, const Volume<float>& share) {
    return image::signed_distance(image::mask_where(ventricles.parts, [wall](auto v) { return is(v, wall); }), share);
  };
  Volume<float> result = to(Part::rv_wall, right);
  const auto to_left = to(Part::lv_wall, left);
  for (std::size_t v = 0; v < result.voxels.size(); ++v)
    result.voxels[v] = 0.5F * (result.voxels[v] - to_left.voxels[v]);
  return result;
}

RegisteredPair register_pair(const LabelVolume& labels, const Landmarks& landmarks, ventricles::AtlasImage atlas,
                             const std::string& atlas_name, const FiberSettings& settings) {
  RegisteredPair hearts;
  hearts.atlas = std::move(atlas);
  hearts.patient = ventricles::ventricles_of_labels(labels, landmarks, settings.depth_grid_mm);
  align(labels, landmarks, atlas_name, settings, hearts);
  return hearts;
}

RegisteredPair register_pair(const LabelVolume& labels, const Landmarks& landmarks, const FiberAtlas& atlas,
                             const FiberSettings& settings) {
  RegisteredPair hearts;
  parallel::run_tasks(std::vector<std::function<void()>>{
      [&] { hearts.atlas = atlas::image_of_atlas(atlas, settings.depth_grid_mm); },
      [&] { hearts.patient = ventricles::ventricles_of_labels(labels, landmarks, settings.depth_grid_mm); }});
  align(labels, landmarks, atlas.name, settings, hearts);
  return hearts;
}

PointWalls point_walls(const RegisteredPair& hearts, const std::vector<Vec3>& points_mm,
                       const std::vector<std::uint8_t>& wanted) {
  const std::size_t count = points_mm.size();
  PointWalls walls{std::vector<double>(count), std::vector<std::uint8_t>(count), std::vector<WallPoint>(count),
                   std::vector<WallPoint>(count), std::vector<double>(count, std::numeric_limits<double>::infinity())};
  parallel::parallel_for(0, static_cast<std::int64_t>(count), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      if (!wanted[n]) continue;
      const double left_mm = left_of_junction_at(hearts, points_mm[n]);
      walls.left_share[n] = left_share(left_mm);
      const auto lv = wall_point(hearts.patient_walls.lv, hearts.patient.frame, points_mm[n]);
      const auto rv = wall_point(hearts.patient_walls.rv, hearts.patient.frame, points_mm[n]);
      if (!lv && !rv) continue;
      walls.known[n] = 1;
      if (lv && rv) walls.from_junction_mm[n] = std::abs(left_mm);
      if (!lv) walls.left_share[n] = 0;
      if (!rv) walls.left_share[n] = 1;
      if (lv) walls.lv[n] = *lv;
      if (rv) walls.rv[n] = *rv;
    }
  });
  return walls;
}

std::vector<Vec3> atlas_positions(const RegisteredPair& hearts, const std::vector<Vec3>& points_mm) {
  std::vector<Vec3> result(points_mm.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(result.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      result[n] = atlas_position(hearts.registration, points_mm[n]);
  });
  return result;
}

WallFeature feature_in_atlas(const RegisteredPair& hearts, bool left, const Vec3& atlas_mm, const WallPoint& at) {
  return weighed(place_feature(atlas_mm, at.depth, at.bend, hearts.registration.rotation * at.normal),
                 left ? hearts.shape_shares.lv : hearts.shape_shares.rv);
}

WallFeature feature_of(const RegisteredPair& hearts, bool left, const std::string& method, const Vec3& point_mm,
                       const Vec3& atlas_mm, const WallPoint& at) {
  if (method != "coordinates") return feature_in_atlas(hearts, left, atlas_mm, at);
  const Vec3& center = left ? hearts.patient_centers_mm.lv : hearts.patient_centers_mm.rv;
  return weighed(coordinate_feature(hearts.patient.frame, center, point_mm, at.depth, at.bend, at.normal),
                 left ? hearts.shape_shares.lv : hearts.shape_shares.rv);
}

FittedAxes carried_axes(const RegisteredPair& hearts, const PointWalls& walls, const std::vector<Vec3>& points_mm,
                        const std::vector<Vec3>& atlas_mm, const std::string& method) {
  if (method == "jacobian") return {push_forward(hearts.atlas, hearts.registration, points_mm), {}};
  FittedAxes carried{std::vector<AxisTensor>(points_mm.size()), {}};
  const auto& samples = method == "coordinates" ? hearts.by_coordinates : hearts.by_place;
  const auto features = [&](bool left) {
    return [&, left](std::size_t n) {
      return feature_of(hearts, left, method, points_mm[n], atlas_mm[n], left ? walls.lv[n] : walls.rv[n]);
    };
  };
  carried.fits.lv = add_carried(samples.lv, walls, true, features(true), carried.axes);
  carried.fits.rv = add_carried(samples.rv, walls, false, features(false), carried.axes);
  return carried;
}

}  // namespace heartgen::fibers
