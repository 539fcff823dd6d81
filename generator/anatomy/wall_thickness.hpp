// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How thick a wall is from place to place, where blood hardly differs from muscle (see faint_blood.hpp).
///
/// A surface that lies this or that deep behind another is a curve of one number a place, so many grey values can speak
/// for one number: at every place the evidence of the voxels beyond a thickness is summed for every thickness,
/// neighbours count by a Gaussian of their distance along the surface, and the mean of what is then likely is taken (a
/// posterior mean, with a Gaussian prior around the mean thickness). It errs less than the most likely contour of a
/// whole region.
#pragma once
#include "generator/anatomy/faint_blood.hpp"

namespace heartgen::anatomy {

/// Neighbours on the wall that speak together: standard deviations of a Gaussian.
struct WallNeighbours {
  double across_mm = 6;
  double along_mm = 0;  ///< more of them in this direction; 0: none
  Vec3 along{};         ///< unit vector along the grid's axes
};

/// Thickness (mm) at the place of every voxel within 10 mm of the mean wall's end, the mean elsewhere. `distance_mm` is
/// from where the wall begins, `speaks` the voxels that are wall or blood and no mixture, on a grid of equal spacings.
Volume<float> local_thickness(const Volume<float>& hu, const Volume<float>& distance_mm, double mean_mm,
                              const Mask& speaks, const FaintContrast& contrast, const WallNeighbours& neighbours);

/// How far (mm) the middle of a wall of known thickness between two pools lies beyond the zero of `distance_mm`, which
/// is negative in the one pool and positive in the other, at the place of every voxel within 10 mm of it; 0 elsewhere.
Volume<float> local_middle(const Volume<float>& hu, const Volume<float>& distance_mm, double wall_mm,
                           const Mask& speaks, const FaintContrast& contrast, const WallNeighbours& neighbours);

/// prior_cavity with the local thickness of free wall and septum around `mean`. `long_axis` (unit vector along the
/// grid's axes) is the ventricles': the trabeculae of the free wall run along it.
Volume<float> measured_cavity(const Volume<float>& hu, const WallDistances& walls, const Mask& thin_walled,
                              const Mask& compartment, const WallThickness& mean, const FaintContrast& contrast,
                              const Vec3& long_axis);

}  // namespace heartgen::anatomy
