// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Turns an anatomy into images: labels, CT-like grey values with partial volume, point spread and noise.
#pragma once
#include <array>

#include "datasets/phantom/body.hpp"
#include "model/volume.hpp"

namespace heartgen::phantom {

/// What every voxel centre consists of.
struct SampledVolume {
  LabelVolume regions;
  Volume<std::uint8_t> tissues;
};

SampledVolume sample_volume(const Anatomy& anatomy, const Grid& grid);

/// Adds a smooth random field (grain about 5 mm) to the voxels whose centre lies in a tissue with an amplitude.
void add_texture(Volume<float>& volume, const Volume<std::uint8_t>& tissues,
                 const std::array<float, tissue_count>& amplitude_of_tissue, std::uint64_t key);

/// Mean grey value per tissue, averaged over 2 x 2 x 2 points in voxels whose neighbours differ from them.
Volume<float> grey_volume(const Anatomy& anatomy, const SampledVolume& samples,
                          const std::array<float, tissue_count>& grey_of_tissue);

/// Gaussian blur with a standard deviation in mm, in place; the border value is continued.
void blur(Volume<float>& volume, double sigma_mm);

/// Adds noise of the given standard deviation with a short correlation (about one voxel) in the plane; a function of
/// `key` and the voxel only.
void add_noise(Volume<float>& volume, double sigma, std::uint64_t key);

/// Rounds and clamps to int16.
CtVolume rounded(const Volume<float>& volume, float lowest, float highest);

}  // namespace heartgen::phantom
