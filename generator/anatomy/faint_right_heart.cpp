// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/faint_right_heart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "generator/anatomy/chest_wall.hpp"
#include "generator/anatomy/faint_blood.hpp"
#include "generator/anatomy/muscle_bundles.hpp"
#include "generator/anatomy/right_partition.hpp"
#include "generator/anatomy/seeds.hpp"
#include "generator/anatomy/wall_thickness.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/flood.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/morphology.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double working_spacing_mm = 1;  // walls of 2 mm are two voxels; finer would not see more through the noise
constexpr double antialias_per_mm = 0.7;
constexpr double smoothing_mm = 1;        // for what is brighter than muscle beyond doubt
constexpr double seed_tolerance_mm = 12;  // to the cavity that usual walls leave
constexpr double elsewhere_mm = 9;        // deeper tissue at the border of the image is no vessel, but liver or chest
constexpr double clear_nats = 1;  // per mm³: from there on the image tells thin walls better than usual ones do
constexpr double everywhere_mm = 1e6;
constexpr std::uint8_t elsewhere = 255;

constexpr std::array<Region, 3> right_regions = {Region::rv_blood, Region::ra_blood, Region::pulmonary_artery};

/// What the work is done on.
struct Scene {
  Volume<float> hu, smooth;
  Mask lv, other_left;
  double fine_mm = 0;  ///< finest spacing of the original image
};

Grid working_grid(const Grid& ct) {
  Grid grid = ct;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    grid.spacing_mm[axis] = working_spacing_mm;
    grid.size[a] =
        static_cast<std::int64_t>(static_cast<double>(ct.size[a] - 1) * ct.spacing_mm[axis] / working_spacing_mm) + 1;
  }
  return grid;
}

/// `source` at the voxels of a grid along the same axes from the same corner.
template <class T>
Volume<float> resampled(const Volume<T>& source, const Grid& grid) {
  Volume<float> result(grid);
  const Vec3 step{grid.spacing_mm.x / source.grid.spacing_mm.x, grid.spacing_mm.y / source.grid.spacing_mm.y,
                  grid.spacing_mm.z / source.grid.spacing_mm.z};
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i)
          result(i, j, k) = static_cast<float>(sample_linear(
              source,
              {static_cast<double>(i) * step.x, static_cast<double>(j) * step.y, static_cast<double>(k) * step.z}));
  });
  return result;
}

Volume<float> depth_of(const Mask& mask) {
  return image::distance_to(image::mask_where(mask.grid, [&](std::size_t v) { return mask.voxels[v] == 0; }));
}

/// The left heart's blood, divided at the valves.
void find_left_heart(const Landmarks& landmarks, const CtVolume& seen, double threshold_hu, Scene& scene) {
  const Mask bright = image::mask_where(
      scene.hu.grid, [&](std::size_t v) { return static_cast<double>(scene.smooth.voxels[v]) > threshold_hu; });
  std::vector<image::Marker> markers;
  for (const Region region : {Region::lv_blood, Region::la_blood, Region::aorta}) {
    const auto seed = landmarks.seeds_mm.find(region_name(tag(region)));
    if (seed == landmarks.seeds_mm.end()) continue;
    markers.push_back(
        {tag(region), seed_in_mask(seen, bright, seed->first, seed->second, seed_tolerance_mm, "bright blood")});
  }
  const LabelVolume labels = image::flood_from_markers(
      bright, depth_of(bright), markers, image::valve_barrier(bright.grid, landmarks, working_spacing_mm));
  scene.lv = image::mask_where(bright.grid, [&](std::size_t v) { return labels.voxels[v] == tag(Region::lv_blood); });
  scene.other_left =
      image::mask_where(bright.grid, [&](std::size_t v) { return bright.voxels[v] && !scene.lv.voxels[v]; });
}

Scene make_scene(const CtVolume& ct, const Landmarks& landmarks, double left_threshold_hu) {
  const double finest = std::min({ct.grid.spacing_mm.x, ct.grid.spacing_mm.y, ct.grid.spacing_mm.z});
  Scene scene;
  scene.hu = resampled(ct, ct.grid);
  const double sigma = antialias_per_mm * (working_spacing_mm - finest);
  if (sigma > 0) scene.hu = image::gaussian(scene.hu, sigma);
  scene.hu = resampled(scene.hu, working_grid(ct.grid));
  scene.smooth = image::gaussian(scene.hu, smoothing_mm);
  CtVolume seen(scene.hu.grid);
  std::transform(scene.hu.voxels.begin(), scene.hu.voxels.end(), seen.voxels.begin(),
                 [](float hu) { return static_cast<std::int16_t>(std::lround(hu)); });
  find_left_heart(landmarks, seen, left_threshold_hu, scene);
  return scene;
}

/// Tissue at the border of the image that is too deep for a vessel.
void add_elsewhere(const Mask& cavity, const Volume<float>& depth, std::vector<image::Marker>& markers) {
  const auto& size = cavity.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j) {
      const bool all = k == 0 || j == 0 || k + 1 == size[2] || j + 1 == size[1];
      for (std::int64_t i = 0; i < size[0]; i += all ? 1 : std::max<std::int64_t>(size[0] - 1, 1))
        if (static_cast<double>(depth(i, j, k)) > elsewhere_mm) markers.push_back({elsewhere, {i, j, k}});
    }
}

/// A right heart that lies against the chest wall without fat between them must not run out into it.
void add_chest_wall(const Mask& cavity, const Volume<float>& smooth, std::vector<image::Marker>& markers) {
  const Mask wall = image::intersect(cavity, beyond_the_lungs(lungs_of(smooth)));
  const auto& size = wall.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i)
        if (wall(i, j, k)) markers.push_back({elsewhere, {i, j, k}});
}

/// The cavities of the right heart as far as usual walls tell, each with its tag.
LabelVolume usual_right_heart(const Volume<float>& space, const Scene& scene, const Landmarks& landmarks) {
  const Mask cavity = image::mask_where(space.grid, [&](std::size_t v) { return space.voxels[v] > 0; });
  const Volume<float> depth = depth_of(cavity);
  CtVolume seen(space.grid);
  for (std::size_t v = 0; v < seen.voxels.size(); ++v)
    seen.voxels[v] = static_cast<std::int16_t>(std::lround(scene.smooth.voxels[v]));
  std::vector<image::Marker> markers;
  for (const Region region : right_regions) {
    const auto seed = landmarks.seeds_mm.find(region_name(tag(region)));
    if (seed == landmarks.seeds_mm.end()) continue;
    markers.push_back({tag(region), seed_in_mask(seen, cavity, seed->first, seed->second, seed_tolerance_mm,
                                                 "soft tissue that may be the right heart's blood")});
  }
  add_elsewhere(cavity, depth, markers);
  add_chest_wall(cavity, scene.smooth, markers);
  LabelVolume labels = image::flood_from_markers(cavity, depth, markers,
                                                 image::valve_barrier(space.grid, landmarks, working_spacing_mm));
  std::replace(labels.voxels.begin(), labels.voxels.end(), elsewhere, std::uint8_t{0});
  return labels;
}

/// From apex to base, along the grid's axes.
Vec3 long_axis(const Grid& grid, const Landmarks& landmarks) {
  const auto mitral = landmarks.valves.find("mitral");
  const Vec3 tip = landmarks.lv_apex_mm.value_or(landmarks.seeds_mm.at("lv_blood"));
  const Vec3 base = mitral != landmarks.valves.end() ? mitral->second.center_mm : landmarks.seeds_mm.at("la_blood");
  return normalized(index_from_lps(grid, base) - index_from_lps(grid, tip));
}

/// The right ventricle's papillary muscles and bands.
void take_out_muscles(const Volume<float>& hu, const Mask& thin_walled, const FaintContrast& contrast,
                      const Landmarks& landmarks, Volume<float>& blood) {
  Volume<float> evidence(hu.grid);
  Mask ventricle(hu.grid);
  MuscleAnchors anchors;
  anchors.from_wall_mm = depth_of(image::mask_where(hu.grid, [&](std::size_t v) { return blood.voxels[v] > 0; }));
  if (const auto valve = landmarks.valves.find("tricuspid"); valve != landmarks.valves.end())
    anchors.orifice_mm = working_spacing_mm * index_from_lps(hu.grid, valve->second.center_mm);
  for (std::size_t v = 0; v < hu.voxels.size(); ++v) {
    ventricle.voxels[v] = thin_walled.voxels[v] == 0;
    if (ventricle.voxels[v] && blood.voxels[v] > 0)
      evidence.voxels[v] = static_cast<float>(-grey_evidence(hu.voxels[v], contrast));
  }
  carve_bundles(find_muscle_bundles(evidence, information(contrast), anchors), ventricle, blood);
}

}  // namespace

RightHeartBlood faint_right_heart(const CtVolume& ct, const Landmarks& landmarks, double muscle_hu, double left_hu) {
  const double left_threshold_hu = 0.5 * (muscle_hu + left_hu);
  const Scene scene = make_scene(ct, landmarks, left_threshold_hu);
  const Grid& grid = scene.hu.grid;
  const auto walls = measure_walls(scene.hu, scene.lv, scene.other_left, muscle_hu);
  const WallThickness usual = prior_thickness(walls);
  const auto parts = usual_right_heart(prior_cavity(walls, Mask(grid, 1), usual), scene, landmarks);
  const LabelVolume nearest = image::nearest_label(parts, everywhere_mm);
  const Mask thin = image::mask_where(grid, [&](std::size_t v) { return nearest.voxels[v] != tag(Region::rv_blood); });
  Volume<float> space = prior_cavity(walls, thin, usual);
  const Mask compartment = image::mask_where(grid, [&](std::size_t v) { return parts.voxels[v] != 0; });
  FaintContrast contrast = measure_faint_contrast(scene.hu, walls, space, compartment);
  const WallThickness thickness = measure_thickness(scene.hu, walls, thin, compartment, usual, contrast);
  space = prior_cavity(walls, thin, thickness);
  contrast = measure_faint_contrast(scene.hu, walls, space, compartment);
  space = measured_cavity(scene.hu, walls, thin, compartment, thickness, contrast, long_axis(grid, landmarks));
  if (const auto valve = landmarks.valves.find("tricuspid"); valve != landmarks.valves.end()) {
    const auto outside =
        outside_right_partition(scene.hu, walls, nearest, compartment, valve->second, contrast, thickness.free_mm);
    std::transform(space.voxels.begin(), space.voxels.end(), outside.voxels.begin(), space.voxels.begin(),
                   [](float a, float b) { return std::min(a, b); });
  }
  const Mask measured = image::mask_where(grid, [&](std::size_t v) { return thin.voxels[v] == 0; });
  Volume<float> blood = faint_blood(scene.hu, walls, space, compartment, contrast, measured_walls, measured);
  if (information(contrast) < clear_nats) blood = settle_thin_walls(std::move(blood), space, thin);
  RightHeartBlood found;
  const Volume<float> cavity = resampled(blood, ct.grid);
  found.blood = image::mask_where(ct.grid, [&](std::size_t v) {
    return cavity.voxels[v] > 0 && static_cast<double>(ct.voxels[v]) < 2 * left_threshold_hu;
  });
  take_out_muscles(scene.hu, thin, contrast, landmarks, blood);
  blood = resampled(blood, ct.grid);
  found.muscles =
      image::mask_where(ct.grid, [&](std::size_t v) { return found.blood.voxels[v] && blood.voxels[v] <= 0; });
  return found;
}

}  // namespace heartgen::anatomy
