#include "generator/segment/epicardium.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "generator/segment/box_around.hpp"
#include "generator/segment/distance.hpp"
#include "generator/segment/minimal_cut.hpp"
#include "generator/segment/morphology.hpp"
#include "generator/segment/wall_band.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heart::segment {
namespace {

constexpr int air_hu = -400;              // darker is lung, even with partial volumes
constexpr double vessel_radius_mm = 2.5;  // unlabelled blood thicker than this is a vein or artery, not a coronary

/// The heart's part of the image and what the cuts share. Empty off the root.
struct HeartBand {
  Box box;
  LabelVolume chambers;  // papillary muscles included
  LabelVolume cell;      // region tag of the nearest blood; papillary muscles belong to their ventricle
  Volume<float> tissue;  // clipped at the muscle's grey value
  Mask other_blood;      // bright vessels without a label
  Mask air;
};

template <class Rule>
Mask mask_where(const Grid& grid, Rule rule) {
  Mask mask(grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) mask.voxels[v] = rule(v);
  return mask;
}

bool is(std::uint8_t value, Region region) { return value == tag(region); }

double median_of(std::vector<std::int16_t> values, double otherwise) {
  if (values.empty()) return otherwise;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double blood_hu(const CtVolume& ct, const LabelVolume& chambers) {
  std::vector<std::int16_t> values;
  for (std::size_t v = 0; v < ct.voxels.size(); ++v)
    if (is(chambers.voxels[v], Region::lv_blood)) values.push_back(ct.voxels[v]);
  return median_of(std::move(values), 0);
}

/// Median of the soft tissue 2 to 6 mm outside the left ventricle's cavity.
double measured_muscle_hu(const CtVolume& ct, const LabelVolume& chambers, double blood) {
  const Mask cavity = mask_where(ct.grid, [&](std::size_t v) { return is(chambers.voxels[v], Region::lv_blood); });
  const auto distance = distance_to(cavity);
  std::vector<std::int16_t> values;
  for (std::size_t v = 0; v < ct.voxels.size(); ++v) {
    const bool shell = distance.voxels[v] > 2 && distance.voxels[v] < 6 && chambers.voxels[v] == 0;
    if (shell && ct.voxels[v] > 0 && ct.voxels[v] < blood / 2) values.push_back(ct.voxels[v]);
  }
  return median_of(std::move(values), blood / 4);
}

HeartBand prepare(const CtVolume& ct_all, const LabelVolume& chambers_all, const EpicardiumSettings& settings) {
  const auto& spacing = ct_all.grid.spacing_mm;
  const double least = std::min({spacing.x, spacing.y, spacing.z});
  const auto margin = static_cast<std::int64_t>((settings.ventricle_band_mm + 4) / least);
  HeartBand heart;
  heart.box = bounding_box(chambers_all, margin, [](std::uint8_t label) { return label != 0; });
  if (heart.box.empty()) throw UserError("the chambers are empty", "epicardium", "check the seeds");
  const CtVolume ct = crop(ct_all, heart.box);
  heart.chambers = crop(chambers_all, heart.box);
  LabelVolume blood = heart.chambers;
  std::replace(blood.voxels.begin(), blood.voxels.end(), tag(Region::papillary), std::uint8_t{0});
  heart.cell = nearest_label(blood, 1e9);
  const double bright = blood_hu(ct, heart.chambers);
  const double muscle = settings.muscle_hu > 0 ? settings.muscle_hu : measured_muscle_hu(ct, heart.chambers, bright);
  heart.tissue = clipped_tissue(ct, muscle);
  heart.other_blood = open(mask_where(ct.grid,
                                      [&](std::size_t v) {
                                        return blood.voxels[v] == 0 && ct.voxels[v] > muscle + 0.6 * (bright - muscle);
                                      }),
                           vessel_radius_mm);
  heart.air = mask_where(ct.grid, [&](std::size_t v) { return ct.voxels[v] < air_hu; });
  return heart;
}

struct Cut {
  Mask inside;  // on the root
  double duality_gap = 0;
  int iterations = 0;
};

/// @collective; `band` is read on the root.
Cut cut_band(const HeartBand& heart, const BandInput& band, const EpicardiumSettings& settings,
             const parallel::Comm& comm) {
  const Mask state = parallel::run_on_root(comm, [&] { return band_state(band); });
  const Volume<float> weight =
      parallel::run_on_root(comm, [&] { return band_weight(heart.tissue, band, state, settings.edge_hu_per_mm); });
  const auto cut = minimal_cut(weight, state,
                               {.max_iterations = settings.max_iterations, .duality_gap = settings.duality_gap}, comm);
  Cut result{{}, cut.duality_gap, cut.iterations};
  if (!comm.is_root()) return result;
  result.inside = inside_of_cut(cut.u, band);
  if (band.thick_wall) result.inside = grown_to_half_height(result.inside, band, heart.tissue);
  return result;
}

/// Voxels that no wall of these chambers may take: blood of others, and the surroundings of other blood.
Mask forbidden_to(const HeartBand& heart, Region a, Region b) {
  return mask_where(heart.cell.grid, [&](std::size_t v) {
    const bool own_cell = is(heart.cell.voxels[v], a) || is(heart.cell.voxels[v], b);
    return !own_cell || heart.other_blood.voxels[v] != 0;
  });
}

/// Cavity with its papillary muscles.
Mask cavity(const HeartBand& heart, Region region) {
  return mask_where(heart.cell.grid,
                    [&](std::size_t v) { return heart.chambers.voxels[v] != 0 && is(heart.cell.voxels[v], region); });
}

/// The band of the left ventricle. The septum is free up to the right ventricle's blood.
BandInput lv_band(const HeartBand& heart, const EpicardiumSettings& settings) {
  const Mask lv = cavity(heart, Region::lv_blood);
  const Mask rv = cavity(heart, Region::rv_blood);
  BandInput band{lv,
                 unite(forbidden_to(heart, Region::lv_blood, Region::rv_blood), rv),
                 heart.air,
                 distance_to(lv),
                 settings.ventricle_band_mm,
                 true};
  add_least_wall(band, lv, settings.minimum_lv_wall_mm);
  return band;
}

/// The band of the right ventricle around both ventricles; the left one is inside with its wall.
BandInput rv_band(const HeartBand& heart, const Mask& left, const EpicardiumSettings& settings) {
  const Mask rv = cavity(heart, Region::rv_blood);
  BandInput band{unite(left, rv),     forbidden_to(heart, Region::lv_blood, Region::rv_blood),
                 heart.air,           distance_to(rv),
                 settings.rv_band_mm, true};
  add_least_wall(band, rv, settings.minimum_rv_wall_mm);
  return band;
}

BandInput atrial_band(const HeartBand& heart, const Mask& ventricles, const EpicardiumSettings& settings) {
  const Mask atria = unite(cavity(heart, Region::la_blood), cavity(heart, Region::ra_blood));
  BandInput band{atria, unite(forbidden_to(heart, Region::la_blood, Region::ra_blood), ventricles), heart.air,
                 distance_to(atria), settings.atrium_band_mm};
  add_least_wall(band, atria, settings.minimum_atrial_wall_mm);
  return band;
}

LabelVolume label_walls(const HeartBand& heart, const Mask& left, const Mask& ventricles, const Mask& atria) {
  LabelVolume walls(heart.cell.grid);
  for (std::size_t v = 0; v < walls.voxels.size(); ++v) {
    if (heart.chambers.voxels[v] != 0) continue;
    if (left.voxels[v])
      walls.voxels[v] = tag(Region::lv_myocardium);
    else if (ventricles.voxels[v])
      walls.voxels[v] = tag(Region::rv_myocardium);
    else if (atria.voxels[v])
      walls.voxels[v] = tag(is(heart.cell.voxels[v], Region::la_blood) ? Region::la_wall : Region::ra_wall);
  }
  return walls;
}

}  // namespace

WallResult epicardium(const CtVolume& ct_on_root, const LabelVolume& chambers_on_root, const SegmentationTree&,
                      const Landmarks&, const EpicardiumSettings& settings, const parallel::Comm& comm) {
  const auto on_root = [&](auto work) { return parallel::run_on_root(comm, work); };
  const HeartBand heart = on_root([&] { return prepare(ct_on_root, chambers_on_root, settings); });
  const Cut left = cut_band(heart, on_root([&] { return lv_band(heart, settings); }), settings, comm);
  const Cut both = cut_band(heart, on_root([&] { return rv_band(heart, left.inside, settings); }), settings, comm);
  const Cut atria = cut_band(heart, on_root([&] { return atrial_band(heart, both.inside, settings); }), settings, comm);
  WallResult result;
  result.ventricle_duality_gap = std::max(left.duality_gap, both.duality_gap);
  result.ventricle_iterations = left.iterations + both.iterations;
  result.atrium_duality_gap = atria.duality_gap;
  result.atrium_iterations = atria.iterations;
  if (comm.is_root())
    result.walls = pasted(ct_on_root.grid, label_walls(heart, left.inside, both.inside, atria.inside), heart.box);
  return result;
}

}  // namespace heart::segment
