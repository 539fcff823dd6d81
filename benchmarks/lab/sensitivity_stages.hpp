// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The stages that read numbers about patients, on a phantom whose truth is known: each from what is made before it.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "benchmarks/lab/fiber_cases.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/pde/hierarchy.hpp"

namespace heartgen::lab {

/// What the stages are tried on.
struct Specimen {
  phantom::Phantom phantom;  ///< with its carotid, and landmarks that are given
  FiberCase fibers;          ///< of another variant than the atlas, which is variant 0
};

/// The phantom `variant` on the grid of `settings`, and the next one's exact labels for the fibres.
Specimen make_specimen(phantom::PhantomSettings settings, int variant);

/// What one run of the stages made.
struct Made {
  pde::SegmentationTree tree;
  LabelVolume chambers, walls;
  /// "chambers.dice.lv_blood", "walls.mm.la_wall" (mean surface distance), "body.ml.liver", "fibers.deg.left" (mean
  /// angle to the known fibres) and the like. A stage writes those of its own name alone.
  std::map<std::string, double> figures;
};

struct SensitivityStage {
  const char* name;
  std::vector<std::string> needs;  ///< stages before it whose results it reads
  void (*make)(const Specimen&, Made&);
};

/// split, chambers, walls, body (with the trachea), carotid and fibers, in the order in which they run. Serial per rank
/// (threads inside); each throws UserError where a build would.
const std::vector<SensitivityStage>& sensitivity_stages();

}  // namespace heartgen::lab
