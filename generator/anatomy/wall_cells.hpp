// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the heart's part of the image, and which chamber's wall a voxel can belong to.
#pragma once
#include "model/crop.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// The box around the heart and what the cuts of its walls share. Empty off the root.
struct HeartBand {
  Box box;
  LabelVolume chambers;  ///< blood, vessels and papillary muscles
  LabelVolume known;     ///< walls that are given; 0 elsewhere
  LabelVolume owner;     ///< the chamber (lv_blood ...) whose wall may stand here; 0: an artery's own wall
  LabelVolume atrium;    ///< the nearer of la_blood and ra_blood
  Volume<float> tissue;  ///< clipped between fat and muscle, slightly smoothed: the endocardial edge vanishes
  Mask other_blood;      ///< bright vessels without a label
  Mask beyond;           ///< more fat or air than muscle: outside the heart but for the least wall
};

/// Cuts out the box around `chambers_all` and `known_walls_all` (no voxels: none) and measures its grey values.
/// Throws UserError for chambers without a voxel. Root only.
HeartBand prepare_heart(const CtVolume& ct_all, const LabelVolume& chambers_all, const LabelVolume& known_walls_all,
                        const EpicardiumSettings& settings);

/// The chamber's blood and, for a ventricle, the papillary muscles in it.
Mask cavity(const HeartBand& heart, Region region);

}  // namespace heartgen::anatomy
