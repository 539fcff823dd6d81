// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fibres for a patient's myocardium from an atlas (thesis, chapter 9): pose, registration, carrying, inpainting, rule
/// for what the atlas does not have (papillary muscles, atria), and orthonormal frames on nodes and cells.
/// Serial per rank (threads inside); the same bits for any number of threads. Not collective.
#pragma once
#include <string>
#include <vector>

#include "generator/atlas/atlas.hpp"
#include "generator/fibers/atlas_figures.hpp"
#include "model/certificate.hpp"
#include "model/landmarks.hpp"
#include "model/part_clock.hpp"
#include "model/recipe.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::fibers {

struct FiberResult {
  FiberField node;                         ///< per node of the mesh, unit and mutually orthogonal to 1e-12
  FiberField cell;                         ///< per cell
  std::vector<std::uint8_t> source;        ///< FiberSource per node; never `none` on myocardium
  std::vector<float> atlas_distance_mm;    ///< per node: to the nearest warped atlas sample; -1 where not ventricular
  std::vector<float> wall_depth;           ///< per node: 0 at the endocardium, 1 at the epicardium; -1 where unknown
  std::vector<float> rule_difference_deg;  ///< per cell: from the carried axis to the rule's; -1 where there is none
  AtlasFigures figures;                    ///< the atlas's own fibres beside those carried from it
  double min_jacobian = 0;                 ///< smallest Jacobian of the warp on its grid; > 0: it folds nowhere
  double affine_rms_mm = 0;                ///< misfit of the clipped distance maps after the affine step
  double atlas_overlap = 0;                ///< Dice of the ventricular walls after the warp
  double second_mean_deg = 0;        ///< mean angle between the chosen method's axes and the second best's, and its
  double second_p95_deg = 0;         ///< 95th percentile, over the ventricles' nodes where both have an axis
  std::string atlas_array;           ///< of the atlas: which array of its file the fibres are; may be empty
  std::vector<Warning> warnings;     ///< what a reader of the certificate should look at
  std::vector<PartTime> part_times;  ///< in the order of the work; for logs only, never cached
};

/// Throws UserError for a method that does not exist and for grids out of range; map_fibers checks the same.
void check_settings(const FiberSettings& settings);

/// `patient_labels`: tags of labels.hpp with at least lv_myocardium, rv_myocardium, lv_blood and rv_blood.
/// `myocardium`: nodes in the same frame; cells outside the ventricles get rule-based fibres.
/// Throws UserError where a ventricle is missing in the labels, the atlas cannot be aligned or is mirrored, and for
/// settings out of range. Not for the method "rule".
FiberResult map_fibers(const TetMesh& myocardium, const LabelVolume& patient_labels, const Landmarks& landmarks,
                       const FiberAtlas& atlas, const FiberSettings& settings);

/// By the rules of `settings.rule` everywhere: no atlas is aligned, and what tells of one stays empty. Throws UserError
/// where a ventricle is missing in the labels, for a mirrored heart, and for settings out of range.
FiberResult rule_fibers(const TetMesh& myocardium, const LabelVolume& patient_labels, const Landmarks& landmarks,
                        const FiberSettings& settings);

}  // namespace heartgen::fibers
