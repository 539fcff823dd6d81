// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/chambers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "generator/anatomy/blood_pool.hpp"
#include "generator/anatomy/hounsfield.hpp"
#include "generator/anatomy/seeds.hpp"
#include "generator/anatomy/vessel_ends.hpp"
#include "generator/image/box_around.hpp"
#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/flood.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/morphology.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/priors.hpp"
#include "model/tissue.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double seed_tolerance_mm = 6;    // a seed on a papillary muscle or a streak still means the cavity around it
constexpr double valve_margin_mm = 3;      // discs are widened: an orifice drawn too small must not leak at its rim
constexpr double vessel_seed_mm = 12;      // an artery without a seed starts this far beyond its valve
constexpr double thin_branch_mm = 2.5;     // radius; coronaries and small veins are no part of the model
constexpr double mixing_closing_mm = 6;    // unmixed contrast leaves dark clouds in the atria up to twice this wide
constexpr double mixing_fraction = 0.15;   // of the contrast: brighter than muscle at least by this
constexpr double atrium_core_share = 0.6;  // of the inscribed radius: what is narrower is a vein or an appendage

constexpr std::array<Region, 4> chamber_regions = {Region::lv_blood, Region::la_blood, Region::rv_blood,
                                                   Region::ra_blood};

struct Artery {
  Region region;
  const char* valve;
};
constexpr std::array<Artery, 2> arteries = {{{Region::aorta, "aortic"}, {Region::pulmonary_artery, "pulmonary"}}};

/// A first guess of the muscle's grey value: the brightest class of the tree that is clearly darker than blood. How
/// many splits it takes to part muscle and blood depends on the image; the classes' grey values do not. Beside blood of
/// low contrast, as in late scans, muscle is more than half as bright.
double soft_tissue_hu(const pde::SegmentationTree& tree, double blood_hu) {
  constexpr double enhanced_hu = 150, min_difference_hu = 40;
  const double brightest = std::max(blood_hu / 2, std::min(blood_hu - min_difference_hu, enhanced_hu));
  double soft = 0;
  for (const auto& step : tree)
    for (const double grey : {step.c_below, step.c_above})
      if (grey < brightest) soft = std::max(soft, grey);
  return soft;
}

/// Centre of the four chambers. Throws UserError for a seed that is missing or outside the image.
Vec3 heart_center(const CtVolume& ct, const Landmarks& landmarks) {
  Vec3 center;
  for (const Region region : chamber_regions) {
    const std::string name = region_name(tag(region));
    const auto seed = landmarks.seeds_mm.find(name);
    if (seed == landmarks.seeds_mm.end())
      throw UserError(fmt::format("the seed {} is missing", name), "landmarks",
                      "give a point inside each of lv_blood, rv_blood, la_blood and ra_blood");
    seed_voxel(ct.grid, name, seed->second);
    center += 0.25 * seed->second;
  }
  return center;
}

/// Half the side of the box that the heart is searched in. It must hold large hearts too, whose apex lies far from the
/// chambers' centre, and the front of the right ventricle nearly as far.
double search_radius_mm(const Vec3& center, const Landmarks& landmarks, const ChamberSettings& settings) {
  constexpr double of_apex = 0.9, max_mm = 130;
  const double apex_mm = landmarks.lv_apex_mm ? norm(*landmarks.lv_apex_mm - center) : 0;
  return std::max(settings.heart_radius_mm, std::min(of_apex * apex_mm, max_mm));
}

std::vector<image::Marker> markers_of(const CtVolume& ct, const Mask& blood, const Landmarks& landmarks) {
  std::vector<image::Marker> markers;
  const auto add = [&](Region region, const Vec3& at) {
    const std::string name = region_name(tag(region));
    markers.push_back(
        {tag(region), seed_in_mask(ct, blood, name, at, seed_tolerance_mm, "contrast-filled blood of the heart")});
  };
  for (const Region region : chamber_regions) add(region, landmarks.seeds_mm.at(region_name(tag(region))));
  for (const auto& [region, valve_name] : arteries) {
    const auto seed = landmarks.seeds_mm.find(region_name(tag(region)));
    const auto valve = landmarks.valves.find(valve_name);
    if (seed != landmarks.seeds_mm.end())
      add(region, seed->second);
    else if (valve != landmarks.valves.end())
      add(region, valve->second.center_mm + vessel_seed_mm * normalized(valve->second.normal));
  }
  return markers;
}

void replace_region(LabelVolume& labels, Region region, const Mask& by) {
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    if (labels.voxels[v] == tag(region)) labels.voxels[v] = 0;
    if (by.voxels[v]) labels.voxels[v] = tag(region);
  }
}

/// Voxels of the artery that touch its ventricle: where it begins.
Mask contact(const Mask& artery, const Mask& ventricle) {
  const auto& spacing = artery.grid.spacing_mm;
  return image::intersect(artery, image::dilate(ventricle, 1.01 * std::max({spacing.x, spacing.y, spacing.z})));
}

void cut_vessels(LabelVolume& labels, const ChamberSettings& settings) {
  for (const auto& [region, valve] : arteries) {
    const Mask artery = image::mask_of(labels, region);
    const Region ventricle = region == Region::aorta ? Region::lv_blood : Region::rv_blood;
    const Mask start = contact(artery, image::mask_of(labels, ventricle));
    if (image::count(start) == 0) continue;
    if (settings.vessel_length_mm == 0) continue;  // the whole vessel
    const Mask root = cut_artery(artery, start, settings.vessel_length_mm);
    replace_region(labels, region, drop_thin_branches(root, thin_branch_mm));
  }
  for (const Region atrium : {Region::la_blood, Region::ra_blood}) {
    Mask body = image::mask_of(labels, atrium);
    if (atrium == Region::ra_blood) body = cut_venae_cavae(body, atrium_core_share, settings.cava_stump_radii);
    body = cut_veins(body, atrium_core_share, settings.vein_stump_mm);
    replace_region(labels, atrium, drop_thin_branches(body, thin_branch_mm));
  }
}

/// Muscles that the cavity was found with go.
void take_out_muscles(LabelVolume& labels, const Mask& muscles) {
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    if (muscles.voxels[v] && labels.voxels[v] == tag(Region::rv_blood)) labels.voxels[v] = 0;
}

/// Clouds of unmixed blood in the atria: gaps of their blood that are darker, yet brighter than muscle, and holes.
void fill_mixing_clouds(LabelVolume& labels, const BloodPool& pool) {
  const double least = pool.muscle_hu + mixing_fraction * (pool.blood_hu - pool.muscle_hu);
  for (const Region atrium : {Region::la_blood, Region::ra_blood}) {
    const Mask mask = image::mask_of(labels, atrium);
    Mask filled = image::close(mask, mixing_closing_mm);
    for (std::size_t v = 0; v < filled.voxels.size(); ++v)
      filled.voxels[v] = mask.voxels[v] || (filled.voxels[v] && static_cast<double>(pool.smooth.voxels[v]) > least);
    filled = image::fill_holes(filled);
    for (std::size_t v = 0; v < filled.voxels.size(); ++v)
      if (filled.voxels[v] && labels.voxels[v] == 0) labels.voxels[v] = tag(atrium);
  }
}

/// Where muscle is wall, however narrow the notch of the cavity that it lies in: what a right ventricle's wall has at
/// least (and a voxel) around fat and air, and the plate of the valves around atria and arteries.
Mask never_papillary(const LabelVolume& labels, const CtVolume& ct, double muscle_hu) {
  constexpr double min_wall_mm = 2, streak_ml = 5, smoothing_mm = 0.8;
  const Volume<float> smooth = image::gaussian(as_float(ct), smoothing_mm);
  Mask fat(labels.grid), others(labels.grid);
  for (std::size_t v = 0; v < fat.voxels.size(); ++v) {
    fat.voxels[v] = 2 * static_cast<double>(smooth.voxels[v]) < tissue::fat_hu + muscle_hu;
    const auto label = labels.voxels[v];
    others.voxels[v] = label != 0 && label != tag(Region::lv_blood) && label != tag(Region::rv_blood);
  }
  const Vec3& spacing = labels.grid.spacing_mm;
  const double voxel_mm = 1.01 * std::max({spacing.x, spacing.y, spacing.z});
  const auto streak = static_cast<std::int64_t>(streak_ml * 1000 / labels.grid.voxel_volume_mm3());
  fat = image::drop_small_components(fat, streak);  // streaks in the blood are dark too
  return image::unite(image::dilate(fat, std::max(min_wall_mm, voxel_mm)),
                      image::dilate(others, std::max<double>(priors::valve_plate_mm, voxel_mm)));
}

/// Muscle inside a ventricle's cavity: what a closing of its blood adds, without the free wall, fat, air, thin seams
/// and what is nearer to an atrium or artery. The right ventricle is closed half as far: its inflow and outflow are
/// parted by muscle that is wall.
void add_papillary(LabelVolume& labels, const CtVolume& ct, const BloodPool& pool, const ChamberSettings& settings) {
  constexpr double seam_mm = 1.5, regrown_mm = 2;
  const Mask wall = never_papillary(labels, ct, pool.muscle_hu);
  for (const Region ventricle : {Region::lv_blood, Region::rv_blood}) {
    const double radius_mm = settings.papillary_closing_mm * (ventricle == Region::lv_blood ? 1 : 0.5);
    const Mask closed = image::close(image::mask_of(labels, ventricle), radius_mm);
    Mask gap(labels.grid);
    for (std::size_t v = 0; v < gap.voxels.size(); ++v)
      gap.voxels[v] =
          closed.voxels[v] && labels.voxels[v] == 0 && !wall.voxels[v] && ct.voxels[v] > pool.muscle_hu - 100;
    const auto minimum =
        static_cast<std::int64_t>(settings.minimum_component_ml * 1000 / labels.grid.voxel_volume_mm3());
    Mask muscle = image::drop_small_components(image::open(gap, seam_mm), minimum);
    if (image::count(muscle) == 0) continue;
    muscle = image::intersect(image::dilate(muscle, regrown_mm), gap);  // the muscles' ends, thinner than a seam
    muscle = image::drop_small_components(muscle, minimum);             // not what only lies near them
    for (std::size_t v = 0; v < muscle.voxels.size(); ++v)
      if (muscle.voxels[v]) labels.voxels[v] = tag(Region::papillary);
  }
}

void close_trabeculae(LabelVolume& labels, double radius_mm) {
  for (const Region ventricle : {Region::lv_blood, Region::rv_blood}) {
    const Mask closed = image::close(image::mask_of(labels, ventricle), radius_mm);
    for (std::size_t v = 0; v < closed.voxels.size(); ++v)
      if (closed.voxels[v] && labels.voxels[v] == 0) labels.voxels[v] = tag(ventricle);
  }
}

/// Keeps the largest piece of every region: what the flood reached through single voxels goes.
void drop_islands(LabelVolume& labels) {
  for (const Region region : chamber_regions)
    replace_region(labels, region, image::largest_component(image::mask_of(labels, region)));
}

bool joined_by_valve(std::uint8_t a, std::uint8_t b) {
  constexpr std::array<std::array<Region, 2>, 4> valves = {{{Region::lv_blood, Region::la_blood},
                                                            {Region::lv_blood, Region::aorta},
                                                            {Region::rv_blood, Region::ra_blood},
                                                            {Region::rv_blood, Region::pulmonary_artery}}};
  return std::any_of(valves.begin(), valves.end(), [&](const auto& valve) {
    return (a == tag(valve[0]) && b == tag(valve[1])) || (a == tag(valve[1]) && b == tag(valve[0]));
  });
}

/// Blood of pools that no valve joins never touches: where a thin wall was lost in partial volumes, both sides give
/// way to it.
void part_pools(LabelVolume& labels) {
  const LabelVolume before = labels;
  const auto& size = labels.grid.size;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::int64_t k = 0; k < size[2] - (axis == 2); ++k)
      for (std::int64_t j = 0; j < size[1] - (axis == 1); ++j)
        for (std::int64_t i = 0; i < size[0] - (axis == 0); ++i) {
          const Index3 to{i + (axis == 0), j + (axis == 1), k + (axis == 2)};
          const std::uint8_t a = before(i, j, k);
          const std::uint8_t b = before(to[0], to[1], to[2]);
          if (a == 0 || b == 0 || a == b || joined_by_valve(a, b)) continue;
          labels(i, j, k) = 0;
          labels(to[0], to[1], to[2]) = 0;
        }
}

}  // namespace

LabelVolume split_chambers(const CtVolume& ct, const pde::SegmentationTree& tree, const Landmarks& landmarks,
                           const ChamberSettings& settings) {
  const Vec3 center = heart_center(ct, landmarks);
  const Box box = image::box_around(ct.grid, center, search_radius_mm(center, landmarks, settings));
  const CtVolume heart = crop(ct, box);
  const double soft_hu = soft_tissue_hu(tree, pde::grey_value(tree, settings.blood));
  const BloodPool pool = find_blood(heart, landmarks, soft_hu);

  Mask wall(heart.grid);
  for (std::size_t v = 0; v < wall.voxels.size(); ++v) wall.voxels[v] = pool.blood.voxels[v] == 0;
  LabelVolume labels =
      image::flood_from_markers(pool.blood, image::distance_to(wall), markers_of(heart, pool.blood, landmarks),
                                image::valve_barrier(heart.grid, landmarks, valve_margin_mm));
  fill_mixing_clouds(labels, pool);
  cut_vessels(labels, settings);
  take_out_muscles(labels, pool.muscles);
  part_pools(labels);
  drop_islands(labels);
  if (settings.close_trabeculae_mm > 0)
    close_trabeculae(labels, settings.close_trabeculae_mm);
  else
    add_papillary(labels, heart, pool, settings);
  return image::pasted(ct.grid, labels, box);
}

}  // namespace heartgen::anatomy
