// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The walls of the heart (thesis 7.2, 7.3): the epicardium of the ventricles, then of the atria, each as the minimal
/// cut in a band around the cavities.
#pragma once
#include "generator/parallel/comm.hpp"
#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

struct WallResult {
  LabelVolume walls;  ///< lv_myocardium, rv_myocardium, la_wall, ra_wall; 0 elsewhere. Root only, empty elsewhere
  double ventricle_duality_gap = 0;  ///< relative gap of the two cuts at the end
  double atrium_duality_gap = 0;
  int ventricle_iterations = 0;
  int atrium_iterations = 0;
};

/// @collective: the images are read on the root only. Blood and vessels of `chambers_on_root` are never overwritten;
/// valve orifices stay open. Walls that are known already (from another segmentation; a volume without voxels: none)
/// are kept as they are and not cut again: lv_myocardium, rv_myocardium, and la_wall with ra_wall, each where present.
/// Throws UserError for chambers without a voxel.
WallResult epicardium(const CtVolume& ct_on_root, const LabelVolume& chambers_on_root,
                      const EpicardiumSettings& settings, const parallel::Comm& comm,
                      const LabelVolume& known_walls_on_root = {});

}  // namespace heartgen::anatomy
