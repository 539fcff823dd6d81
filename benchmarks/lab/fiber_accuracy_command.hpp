// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen-lab fiber-accuracy`: an atlas's fibres carried to phantoms whose fibres are known, from their exact
/// labels.
#pragma once
#include <string>
#include <vector>

#include "model/recipe.hpp"

namespace heartgen::lab {

struct FiberAccuracyCommand {
  /// Phantoms: variants ("3"), "thick" and "dilated" (left wall 14 and 7 mm), "cut" (labels end 12 mm below the mitral
  /// valve), "tilted" (they end in a plane tilted by 15 degrees) and "uneven" (surfaces moved by 0.4 mm at random).
  std::vector<std::string> cases{"1", "2", "3", "4", "thick", "dilated", "cut", "tilted", "uneven"};
  std::string atlas = "phantom";  ///< "phantom" (variant 0 as an image), "stand-in", or a file
  std::vector<std::string> methods{"local_angles", "coordinates", "jacobian"};
  /// The phantom's helix angles: "uniform" (the same everywhere) and "regional" (changing around and along the heart).
  std::vector<std::string> fields{"uniform"};
  /// Frames and units that the atlas's file could be in: "plain", "turned" (40 degrees), "scaled" (0.8), "axes" (in
  /// another order), "metres", "all" of these, and "mirrored" (which is refused). Only for atlases that are meshes.
  std::vector<std::string> atlas_frames{"plain"};
  /// Of the patients' labels: one number, or one per axis. As a build has them at the thesis's size.
  std::vector<double> spacing_mm{0.5, 0.5, 1.2};
  /// Spacing to which labels are resampled, as a build does; 0: the labels' finest, on a grid of their own.
  double depth_grid_mm = FiberSettings{}.depth_grid_mm;
  double mesh_edge_mm = 0;  ///< mesh the exact labels' walls with this edge and compare on nodes and cells too; 0: no
  bool json = false;
};

/// One line per field, frame, phantom and method: mean and 95th percentile of the angle between carried and known axes
/// over all voxels (nodes, cells) of each wall where the phantom has fibres, share covered, seconds. A node of both
/// walls counts as the right one's; at the surface between them the phantom has the fibres of one or the other by
/// rounding, so "own nodes" are those in cells of no other region. Throws UserError for unknown names and for a
/// mirrored atlas. Not collective.
int fiber_accuracy_command(const FiberAccuracyCommand& command);

}  // namespace heartgen::lab
