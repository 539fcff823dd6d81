// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Label maps of any spacing and direction on isotropic grids along LPS axes.
#pragma once
#include <functional>
#include <map>

#include "model/volume.hpp"

namespace heartgen::image {

/// LPS position of voxel number v.
Vec3 voxel_center(const Grid& grid, std::int64_t v);

/// Identity direction, `spacing_mm` along each axis, around all voxels whose label is `wanted`, plus a margin.
Grid isotropic_grid_around(const LabelVolume& labels, const std::function<bool(std::uint8_t)>& wanted,
                           double spacing_mm, double margin_mm);

/// How much of the surroundings of each voxel centre of `grid` every label that is near has, 0 to 1, by linear
/// interpolation of shares that are smoothed over .7 voxels of the labels, along axes on which these are not clearly
/// coarser than the grid; 0 outside. Without smoothing the steps of the labels would beat with the grid: waves of half
/// a voxel that are many voxels long, which no later smoothing takes away. Not collective.
std::map<std::uint8_t, Volume<float>> shares_on(const LabelVolume& labels, const Grid& grid);

/// The first label with the largest share at each voxel of `grid`; 0 where all are 0.
LabelVolume largest_share(const std::map<std::uint8_t, Volume<float>>& shares, const Grid& grid);

}  // namespace heartgen::image
