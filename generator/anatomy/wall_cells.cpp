// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/wall_cells.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "generator/image/distance.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/morphology.hpp"
#include "model/error.hpp"
#include "model/priors.hpp"
#include "model/quantile.hpp"
#include "model/tissue.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double smoothing_mm = 0.8;       // of the tissue
constexpr double vessel_smoothing_mm = 1;  // against noise, for vessels

constexpr std::array<Region, 4> chamber_regions = {Region::lv_blood, Region::rv_blood, Region::la_blood,
                                                   Region::ra_blood};

bool is(std::uint8_t value, Region region) { return value == tag(region); }

template <class Keep>
double median_where(const CtVolume& ct, double otherwise, Keep keep) {
  std::vector<std::int16_t> values;
  for (std::size_t v = 0; v < ct.voxels.size(); ++v)
    if (keep(v)) values.push_back(ct.voxels[v]);
  return values.empty() ? otherwise : upper_median(values);
}

/// Median of the soft tissue 2 to 6 mm outside the left ventricle's cavity.
double measured_muscle_hu(const CtVolume& ct, const LabelVolume& chambers, double blood_hu) {
  const auto distance = image::distance_to(
      image::mask_where(ct.grid, [&](std::size_t v) { return is(chambers.voxels[v], Region::lv_blood); }));
  return median_where(ct, blood_hu / 4, [&](std::size_t v) {
    const bool shell = distance.voxels[v] > priors::lv_muscle_from_mm && distance.voxels[v] < priors::lv_muscle_to_mm &&
                       chambers.voxels[v] == 0;
    return shell && ct.voxels[v] > 0 && ct.voxels[v] < blood_hu / 2;
  });
}

double measured_fat_hu(const CtVolume& ct) {
  return median_where(ct, tissue::fat_hu, [&](std::size_t v) {
    return ct.voxels[v] > tissue::fat_min_hu && ct.voxels[v] < tissue::fat_max_hu;
  });
}

Volume<float> clipped(const CtVolume& ct, double low_hu, double high_hu) {
  Volume<float> image(ct.grid);
  for (std::size_t v = 0; v < ct.voxels.size(); ++v)
    image.voxels[v] = static_cast<float>(std::clamp(static_cast<double>(ct.voxels[v]), low_hu, high_hu));
  return image;
}

bool joined_by_valve(std::uint8_t chamber, std::uint8_t artery) {
  return (is(chamber, Region::lv_blood) && is(artery, Region::aorta)) ||
         (is(chamber, Region::rv_blood) && is(artery, Region::pulmonary_artery));
}

/// Nearest of two regions, with the distance.
image::NearestLabel nearest_of(const LabelVolume& chambers, Region a, Region b) {
  LabelVolume part(chambers.grid);
  for (std::size_t v = 0; v < part.voxels.size(); ++v)
    if (is(chambers.voxels[v], a) || is(chambers.voxels[v], b)) part.voxels[v] = chambers.voxels[v];
  return image::nearest_label_and_distance(part);
}

/// Fills in heart.owner and heart.atrium.
void find_owners(HeartBand& heart) {
  const LabelVolume& chambers = heart.chambers;
  const image::NearestLabel ventricle = nearest_of(chambers, Region::lv_blood, Region::rv_blood);
  image::NearestLabel atrium = nearest_of(chambers, Region::la_blood, Region::ra_blood);
  const image::NearestLabel artery = nearest_of(chambers, Region::aorta, Region::pulmonary_artery);
  heart.owner = LabelVolume(chambers.grid);
  const double touching_mm = 1.01 * norm(chambers.grid.spacing_mm);  // centres of voxels that share a corner
  for (std::size_t v = 0; v < heart.owner.voxels.size(); ++v) {
    const double to_ventricle = static_cast<double>(ventricle.distance_mm.voxels[v]);
    const double to_atrium = static_cast<double>(atrium.distance_mm.voxels[v]);
    const double to_artery = static_cast<double>(artery.distance_mm.voxels[v]);
    const bool of_atrium = to_atrium + priors::valve_plate_mm < to_ventricle;
    const auto chamber = (of_atrium ? atrium : ventricle).label.voxels[v];
    const double lead = joined_by_valve(chamber, artery.label.voxels[v]) ? 0 : priors::artery_lead_mm;
    const double to_chamber = of_atrium ? to_atrium : to_ventricle;
    const bool of_artery =
        to_artery <= priors::artery_wall_mm && to_artery + lead < to_chamber && to_chamber > touching_mm;
    heart.owner.voxels[v] = of_artery ? std::uint8_t{0} : chamber;
  }
  heart.atrium = std::move(atrium.label);
}

Mask find_other_blood(const CtVolume& ct, const HeartBand& heart, double muscle_hu) {
  std::array<double, 256> min_hu{};
  for (const Region region : chamber_regions) {
    const double blood =
        median_where(ct, muscle_hu, [&](std::size_t v) { return is(heart.chambers.voxels[v], region); });
    min_hu[tag(region)] = muscle_hu + std::max<double>(tissue::other_vessel_contrast_share * (blood - muscle_hu),
                                                       tissue::other_vessel_contrast_min_hu);
  }
  min_hu[0] = min_hu[tag(Region::lv_blood)];
  Volume<float> smooth(ct.grid);
  std::copy(ct.voxels.begin(), ct.voxels.end(), smooth.voxels.begin());
  smooth = image::gaussian(smooth, vessel_smoothing_mm);
  const Mask bright = image::mask_where(ct.grid, [&](std::size_t v) {
    return heart.chambers.voxels[v] == 0 && static_cast<double>(smooth.voxels[v]) > min_hu[heart.owner.voxels[v]];
  });
  return image::open(bright, priors::other_vessel_radius_mm);
}

/// The box of all chambers and known walls with room for the widest band.
Box heart_box(const LabelVolume& chambers, const LabelVolume& walls, const EpicardiumSettings& settings) {
  const auto& spacing = chambers.grid.spacing_mm;
  const double reach_mm = settings.ventricle_band_mm + 4;
  Box box = bounding_box(chambers, 0, [](std::uint8_t label) { return label != 0; });
  if (box.empty()) throw UserError("the chambers are empty", "epicardium", "check the seeds");
  const Box known =
      walls.voxels.empty() ? Box{} : bounding_box(walls, 0, [](std::uint8_t label) { return label != 0; });
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!known.empty()) {
      box.begin[axis] = std::min(box.begin[axis], known.begin[axis]);
      box.end[axis] = std::max(box.end[axis], known.end[axis]);
    }
    const auto margin = static_cast<std::int64_t>(reach_mm / spacing[static_cast<int>(axis)]);
    box.begin[axis] = std::max<std::int64_t>(box.begin[axis] - margin, 0);
    box.end[axis] = std::min(box.end[axis] + margin, chambers.grid.size[axis]);
  }
  return box;
}

}  // namespace

HeartBand prepare_heart(const CtVolume& ct_all, const LabelVolume& chambers_all, const LabelVolume& known_walls_all,
                        const EpicardiumSettings& settings) {
  HeartBand heart;
  heart.box = heart_box(chambers_all, known_walls_all, settings);
  const CtVolume ct = crop(ct_all, heart.box);
  heart.chambers = crop(chambers_all, heart.box);
  heart.known = known_walls_all.voxels.empty() ? LabelVolume(ct.grid) : crop(known_walls_all, heart.box);
  find_owners(heart);
  const double blood =
      median_where(ct, 0, [&](std::size_t v) { return is(heart.chambers.voxels[v], Region::lv_blood); });
  const double muscle = settings.muscle_hu > 0 ? settings.muscle_hu : measured_muscle_hu(ct, heart.chambers, blood);
  const double fat = std::min(measured_fat_hu(ct), muscle - 1);
  heart.tissue = image::gaussian(clipped(ct, fat, muscle), smoothing_mm);
  heart.other_blood = find_other_blood(ct, heart, muscle);
  heart.beyond = image::mask_where(
      ct.grid, [&](std::size_t v) { return 2 * static_cast<double>(heart.tissue.voxels[v]) < fat + muscle; });
  return heart;
}

Mask cavity(const HeartBand& heart, Region region) {
  return image::mask_where(heart.owner.grid, [&](std::size_t v) {
    const auto label = heart.chambers.voxels[v];
    return is(label, region) || (is(label, Region::papillary) && is(heart.owner.voxels[v], region));
  });
}

}  // namespace heartgen::anatomy
