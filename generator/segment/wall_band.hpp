// Private to this folder: the band around a cavity in which the outer surface of its wall is cut (thesis 7.2).
#pragma once
#include "generator/segment/minimal_cut.hpp"
#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heart::segment {

/// What the band is built from, all on one grid.
struct BandInput {
  Mask inner;                 ///< surely inside: the cavity and what is known of its wall
  Mask forbidden;             ///< surely outside: other blood, other walls. The wall may end there at no cost
  Mask air;                   ///< surely outside, but an edge of the image like any other
  Volume<float> distance_mm;  ///< to the cavity
  double band_mm = 0;         ///< nothing farther from the cavity belongs to its wall
  bool thick_wall = false;    ///< no preference for surfaces close to the cavity, see band_weight
};

/// Adds to `band.inner` the least wall: voxels within `least_mm` of the cavity and, where slices are thicker than that,
/// the voxels that touch it, unless they are forbidden.
void add_least_wall(BandInput& band, const Mask& cavity, double least_mm);

/// cut_inner, cut_outer or cut_free for every voxel.
Mask band_state(const BandInput& band);

/// The weight h of the cut: low where the image falls outwards (muscle to fat or air) and next to forbidden voxels. For
/// a thick wall it is divided by the area of the distance's level sets, so that the cut is not drawn to the small
/// surface next to the cavity; for a thin one that pull is welcome. `tissue` is the image clipped at the muscle's grey
/// value.
Volume<float> band_weight(const Volume<float>& tissue, const BandInput& band, const Mask& state, double edge_hu_per_mm);

/// The inside of the cut `u` without islands and holes, grown to the forbidden voxels where only a seam of one voxel
/// parts them: next to them the cut is free to run on either side of a voxel.
Mask inside_of_cut(const Volume<float>& u, const BandInput& band);

/// `inside` with the voxels on its surface that are more muscle than what lies beyond them: brighter than half-way
/// between muscle and the next voxel outwards, where there is an edge at all. The cut of a wall of two or three voxels
/// settles on the steepest face, which partial volumes draw inwards by up to a voxel.
Mask grown_to_half_height(const Mask& inside, const BandInput& band, const Volume<float>& tissue);

/// The image between fat and muscle, slightly smoothed: the endocardial edge vanishes, the epicardial one stays.
Volume<float> clipped_tissue(const CtVolume& ct, double muscle_hu);

}  // namespace heart::segment
