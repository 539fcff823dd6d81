// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Euclidean distance maps of masks and Gaussian smoothing, on grids with isotropic spacing.
#pragma once
#include "model/volume.hpp"

namespace heartgen::image {

/// Distance in mm from each voxel centre to the nearest centre of a voxel with mask != 0 (Felzenszwalb and
/// Huttenlocher 2012, exact). Large (1e9) everywhere for an empty mask.
Volume<float> distance_to(const Mask& mask);

/// Separable Gaussian, truncated at 4 sigma, border values continued.
Volume<float> smoothed(const Volume<float>& volume, double sigma_voxels);
/// The same with a sigma per axis.
Volume<float> smoothed(const Volume<float>& volume, const Vec3& sigma_voxels);

/// Signed distance in mm, negative in the mask, zero half-way between voxel centres; the steps of the voxels are
/// smoothed by `sigma_voxels` without shrinking curved surfaces.
LevelSet signed_distance(const Mask& mask, double sigma_voxels);

/// A level set smoothed by a Gaussian in the same way, without shrinking curved surfaces.
LevelSet smoothed_level_set(const LevelSet& surface, double sigma_voxels);

/// Central differences (one-sided at the border) in mm, along x, y, z of the grid's own axes.
Vec3 gradient_at(const Volume<float>& volume, std::int64_t i, std::int64_t j, std::int64_t k);

}  // namespace heartgen::image
