// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/epicardium.hpp"

#include <algorithm>
#include <utility>

#include "generator/anatomy/wall_band.hpp"
#include "generator/anatomy/wall_cells.hpp"
#include "generator/anatomy/wall_division.hpp"
#include "generator/image/box_around.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/morphology.hpp"
#include "generator/pde/continuous_min_cut.hpp"
#include "model/labels.hpp"

namespace heartgen::anatomy {
namespace {

struct Cut {
  Mask inside;  // on the root
  double duality_gap = 0;
  int iterations = 0;
};

bool is(std::uint8_t value, Region region) { return value == tag(region); }

/// @collective
bool on_every_rank(bool on_root, const parallel::Comm& comm) {
  return parallel::sum_int64(comm, comm.is_root() && on_root ? 1 : 0) != 0;
}

/// @collective; `band` is read on the root. A band without a free voxel, such as a cavity in fat with no muscle to be
/// seen, gives the least wall.
Cut cut_band(const HeartBand& heart, const BandInput& band, const EpicardiumSettings& settings,
             const parallel::Comm& comm) {
  const Mask state = parallel::run_on_root(comm, [&] { return band_state(band); });
  const bool is_free =
      on_every_rank(std::find(state.voxels.begin(), state.voxels.end(), pde::cut_free) != state.voxels.end(), comm);
  if (!is_free) return {band.inner, 0, 0};
  const Volume<float> weight =
      parallel::run_on_root(comm, [&] { return band_weight(heart.tissue, band, state, settings.edge_hu_per_mm); });
  const auto cut = pde::continuous_min_cut(
      weight, state, {.max_iterations = settings.max_iterations, .duality_gap = settings.duality_gap}, comm);
  Cut result{{}, cut.duality_gap, cut.iterations};
  if (comm.is_root()) result.inside = inside_of_cut(cut.u, band);
  return result;
}

Mask within(const Volume<float>& distance_mm, double limit_mm) {
  return image::mask_where(distance_mm.grid,
                           [&](std::size_t v) { return static_cast<double>(distance_mm.voxels[v]) <= limit_mm; });
}

/// Voxels that the ventricles' walls may not take: places of other walls, and blood without a label.
Mask forbidden_to_ventricles(const HeartBand& heart) {
  return image::mask_where(heart.owner.grid, [&](std::size_t v) {
    const bool own = is(heart.owner.voxels[v], Region::lv_blood) || is(heart.owner.voxels[v], Region::rv_blood);
    return !own || heart.other_blood.voxels[v] != 0;
  });
}

bool knows(const HeartBand& heart, Region wall) {
  return std::find(heart.known.voxels.begin(), heart.known.voxels.end(), tag(wall)) != heart.known.voxels.end();
}

/// Both ventricles' walls, or both atria's.
bool knows_both(const HeartBand& heart, Region a, Region b) { return knows(heart, a) && knows(heart, b); }

/// Known walls are inside; a left ventricle whose wall is known takes nothing more.
void add_known_walls(const HeartBand& heart, BandInput& band) {
  const bool left_is_known = knows(heart, Region::lv_myocardium);
  for (std::size_t v = 0; v < heart.known.voxels.size(); ++v) {
    const auto wall = heart.known.voxels[v];
    if (is(wall, Region::lv_myocardium) || is(wall, Region::rv_myocardium))
      band.inner.voxels[v] = 1;
    else if (left_is_known && is(heart.owner.voxels[v], Region::lv_blood) && heart.chambers.voxels[v] == 0)
      band.forbidden.voxels[v] = 1, band.inner.voxels[v] = 0;
  }
}

/// The band around both ventricles: the septum lies between them, and no edge in it can draw the cut.
BandInput ventricular_band(const HeartBand& heart, const EpicardiumSettings& settings) {
  const Mask lv = cavity(heart, Region::lv_blood);
  const Mask rv = cavity(heart, Region::rv_blood);
  BandInput band;
  band.forbidden = forbidden_to_ventricles(heart);
  band.beyond = heart.beyond;
  band.inner = image::unite(lv, rv);
  band.thick =
      image::mask_where(heart.owner.grid, [&](std::size_t v) { return is(heart.owner.voxels[v], Region::lv_blood); });
  band.distance_mm = image::distance_to(rv);
  add_min_wall(band, rv, settings.minimum_rv_wall_mm);
  const Mask near_rv = within(band.distance_mm, settings.rv_band_mm);
  const Volume<float> to_rv = std::move(band.distance_mm);
  band.distance_mm = image::distance_to(lv);
  add_min_wall(band, lv, settings.minimum_lv_wall_mm);
  band.reach = image::unite(near_rv, within(band.distance_mm, settings.ventricle_band_mm));
  for (std::size_t v = 0; v < to_rv.voxels.size(); ++v)
    band.distance_mm.voxels[v] = std::min(band.distance_mm.voxels[v], to_rv.voxels[v]);
  add_known_walls(heart, band);
  return band;
}

/// The band around both atria. They may use what the ventricles' walls have left, so that no blood at a valve is bare.
BandInput atrial_band(const HeartBand& heart, const Mask& ventricles, const EpicardiumSettings& settings) {
  const Mask atria = image::unite(cavity(heart, Region::la_blood), cavity(heart, Region::ra_blood));
  BandInput band;
  band.inner = atria;
  band.forbidden = image::mask_where(atria.grid, [&](std::size_t v) {
    return heart.owner.voxels[v] == 0 || heart.other_blood.voxels[v] != 0 || ventricles.voxels[v] != 0;
  });
  band.beyond = heart.beyond;
  band.distance_mm = image::distance_to(atria);
  band.reach = within(band.distance_mm, settings.atrium_band_mm);
  band.thick = Mask(atria.grid);
  add_min_wall(band, atria, settings.minimum_atrial_wall_mm);
  return band;
}

/// Walls that are known are kept, and the part of a region that is known gets nothing more.
LabelVolume label_walls(const HeartBand& heart, const Mask& left, const Mask& ventricles, const Mask& atria) {
  const bool left_is_known = knows(heart, Region::lv_myocardium);
  const bool right_is_known = knows(heart, Region::rv_myocardium);
  LabelVolume walls = heart.known;
  for (std::size_t v = 0; v < walls.voxels.size(); ++v) {
    if (heart.chambers.voxels[v] != 0) walls.voxels[v] = 0;
    if (heart.chambers.voxels[v] != 0 || walls.voxels[v] != 0) continue;
    if (ventricles.voxels[v]) {
      const bool to_left = left.voxels[v] && !left_is_known;
      if (to_left || !right_is_known) walls.voxels[v] = tag(to_left ? Region::lv_myocardium : Region::rv_myocardium);
    } else if (!atria.voxels.empty() && atria.voxels[v]) {
      walls.voxels[v] = tag(is(heart.atrium.voxels[v], Region::la_blood) ? Region::la_wall : Region::ra_wall);
    }
  }
  return walls;
}

/// Both ventricles with their known walls.
Mask known_ventricles(const HeartBand& heart) {
  return image::mask_where(heart.known.grid, [&](std::size_t v) {
    const auto wall = heart.known.voxels[v];
    return is(wall, Region::lv_myocardium) || is(wall, Region::rv_myocardium) ||
           is(heart.chambers.voxels[v], Region::lv_blood) || is(heart.chambers.voxels[v], Region::rv_blood) ||
           is(heart.chambers.voxels[v], Region::papillary);
  });
}

}  // namespace

WallResult epicardium(const CtVolume& ct_on_root, const LabelVolume& chambers_on_root,
                      const EpicardiumSettings& settings, const parallel::Comm& comm,
                      const LabelVolume& known_walls_on_root) {
  const auto on_root = [&](auto work) { return parallel::run_on_root(comm, work); };
  const HeartBand heart =
      on_root([&] { return prepare_heart(ct_on_root, chambers_on_root, known_walls_on_root, settings); });
  Cut both, atria;
  if (on_every_rank(knows_both(heart, Region::lv_myocardium, Region::rv_myocardium), comm))
    both.inside = on_root([&] { return known_ventricles(heart); });
  else
    both = cut_band(heart, on_root([&] { return ventricular_band(heart, settings); }), settings, comm);
  if (!on_every_rank(knows_both(heart, Region::la_wall, Region::ra_wall), comm))
    atria = cut_band(heart, on_root([&] { return atrial_band(heart, both.inside, settings); }), settings, comm);
  WallResult result;
  result.ventricle_duality_gap = both.duality_gap;
  result.ventricle_iterations = both.iterations;
  result.atrium_duality_gap = atria.duality_gap;
  result.atrium_iterations = atria.iterations;
  result.walls = on_root([&] {
    return image::pasted(ct_on_root.grid, label_walls(heart, left_part(heart, both.inside), both.inside, atria.inside),
                         heart.box);
  });
  return result;
}

}  // namespace heartgen::anatomy
