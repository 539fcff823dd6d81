// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the band around a cavity in which the outer surface of its wall is cut (thesis 7.2).
#pragma once
#include "generator/pde/continuous_min_cut.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// What the band is built from, all on one grid.
struct BandInput {
  Mask inner;                 ///< surely inside: the cavity and what is known of its wall
  Mask forbidden;             ///< surely outside: other blood, other walls. The wall may end there at next to no cost
  Mask beyond;                ///< fat and air: outside, too, but for the least wall
  Mask reach;                 ///< the band: nothing elsewhere belongs to the wall
  Mask thick;                 ///< where no surface is preferred for being close to the cavity, see band_weight
  Volume<float> distance_mm;  ///< to the cavity
};

/// Central differences (per mm, along the grid's axes), one-sided at the border.
Vec3 gradient(const Volume<float>& image, const Index3& at);

/// Adds to `band.inner` the least wall: voxels within `min_mm` of the cavity and, where slices are thicker than that,
/// the voxels that touch it, unless they are forbidden.
void add_min_wall(BandInput& band, const Mask& cavity, double min_mm);

/// cut_inner, cut_outer or cut_free for every voxel.
Mask band_state(const BandInput& band);

/// The weight h of the cut: low where the image falls outwards (muscle to weaker tissue), and next to nothing between a
/// free voxel and a forbidden one, fat or air: there the wall ends at half height between muscle and fat, voxel by
/// voxel. In a thick wall h is divided by the area of the distance's level sets, so that the cut is not drawn to the
/// small surface next to the cavity; in a thin one that pull is welcome. `tissue` is the image clipped between fat and
/// muscle.
Volume<float> band_weight(const Volume<float>& tissue, const BandInput& band, const Mask& state, double edge_hu_per_mm);

/// The inside of the cut `u` without holes, islands and what is too thin to be the heart's, such as the rims of
/// coronary arteries.
Mask inside_of_cut(const Volume<float>& u, const BandInput& band);

}  // namespace heartgen::anatomy
