// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fits an affine map by nonlinear least squares (Ceres, one thread, deterministic). Not collective.
#pragma once
#include <vector>

#include "model/affine_map.hpp"
#include "model/volume.hpp"

namespace heartgen::adapters {

enum class PoseFreedom { rigid, similarity, affine };  ///< 6, 7 or 12 parameters

struct PoseFit {
  AffineMap map;
  double rms = 0;  ///< of the residuals, in the unit of the images
  int iterations = 0;
};

/// The map near `start` that makes each target image at map(point) equal the given value:
/// minimises the sum over points p and channels c of (targets[c](map(p)) - values[c][p])^2, trilinear in the targets.
/// The targets share one grid. `center_mm` is where the parameters' rotation and scale act (near the points' centre).
PoseFit fit_pose(const AffineMap& start, const Vec3& center_mm, const std::vector<Vec3>& points_mm,
                 const std::vector<const Volume<float>*>& targets, const std::vector<std::vector<float>>& values,
                 PoseFreedom freedom);

/// The map that brings each point of `from_mm` nearest to its partner in `to_mm` (sum of squares); the start is the
/// shift of their middles. `rms` is in mm. At least three points that are not on one line; no mirroring.
PoseFit fit_points(const std::vector<Vec3>& from_mm, const std::vector<Vec3>& to_mm, PoseFreedom freedom);

}  // namespace heartgen::adapters
