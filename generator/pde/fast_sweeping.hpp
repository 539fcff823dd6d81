// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Signed distance of a level set to sub-voxel accuracy: the equation |∇φ| = 1 that the reinitialisation of thesis 8.3
/// has as its steady state, solved directly by fast sweeping (Zhao 2005) with second-order upwind differences (Sethian
/// 1999).
///
/// Voxels beside the zero level get their distance from a quadratic model of the function there: the closest zero of
/// the Taylor polynomial with central differences, third-order accurate where the function is smooth; where it is not
/// (a mask of ±1), from the steepest one-sided slope, as in redistance.hpp. They are kept. The others follow by sweeps
/// in the eight directions along the axes (four in 2D), first with first-order, then with second-order differences.
///
/// Largest errors, measured by the tests on balls, ellipses and planes whose radius of curvature is at least eight
/// voxels: 0.01 voxels beside the zero level, 0.04 outside, 0.1 inside down to three voxels from the centre of
/// curvature (where distances have a kink and the error is up to half a voxel); 0.01 for planes where the closest point
/// lies well in the image. Beside the zero level and outside they fall at least with the square of the voxel.
#pragma once
#include <limits>

#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

/// Bound of distances that are wanted however far.
constexpr float any_distance_mm = std::numeric_limits<float>::max();

/// In place: mm, negative inside (where the function is negative), any spacing, 2D and 3D. One ghost slice at least.
/// Without a zero level the function stays as it is. Ranks follow each other through blocks of rows, threads through
/// the rows of a diagonal: each row finds what one thread would find, so the bits are the same for any number of them.
/// Distances beyond `within_mm` become ±within_mm, and take hardly any time: waves run outwards, so those below are the
/// same without them.
/// @collective
void fast_sweeping(parallel::Slab<float>& level_set, const parallel::Comm& comm, float within_mm = any_distance_mm);

/// The same for a whole function. Not collective.
Volume<float> fast_sweeping(const Volume<float>& level_set, float within_mm = any_distance_mm);

}  // namespace heartgen::pde
