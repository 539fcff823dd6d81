// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fibres on meshes of the myocardium: of an atlas, by rules, from another mesh. Axes are unit vectors whose sign means
/// nothing. Not collective; everything throws UserError.
#pragma once
#include <string>
#include <vector>

#include "generator/atlas/atlas.hpp"
#include "generator/fibers/transfer.hpp"
#include "model/certificate.hpp"
#include "model/error.hpp"
#include "model/fiber_atlas.hpp"
#include "model/landmarks.hpp"
#include "model/recipe.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen {

using atlas::make_fiber_atlas;
using atlas::read_fiber_atlas;
using fibers::transfer_fibers;
using fibers::TransferredFibers;

/// The built-in stand-in: a synthetic heart with published helix angles.
FiberAtlas standin_atlas();

struct MappedFibers {
  TetMesh mesh;              ///< as given, with node_fibers, cell_fibers, fiber_source and rule_difference_deg
  double atlas_overlap = 0;  ///< Dice of the ventricular walls after the registration
  double min_jacobian = 0;   ///< of the warp: above 0 it folds nowhere
  std::vector<Warning> warnings;
};

/// `myocardium` holds cells of the walls (only_regions of a mesh of the label map will do), in the frame of `labels`,
/// which has at least both ventricles' blood and walls. Cells outside the ventricles get fibres by rule.
MappedFibers map_fibers(TetMesh myocardium, const LabelVolume& labels, const Landmarks& landmarks,
                        const FiberAtlas& atlas, const FiberSettings& settings = {});

}  // namespace heartgen
