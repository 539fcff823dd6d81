// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Values between the voxels of a level set.
#pragma once
#include <cstdint>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::mesh {

/// A trilinear value and its gradient (per mm along the axes).
struct Sample {
  double value = 0;
  Vec3 gradient;
};

/// At a position in mm along the axes of the grid, voxel (0, 0, 0) at the origin; beyond the border, the border's.
Sample sample(const LevelSet& volume, const Vec3& position);

/// The same value; most of the time nobody asks for more.
double value_at(const LevelSet& volume, const Vec3& position);

/// Which voxels of a level set are negative, a bit for each (x fastest): a thirty-second of its memory, so that the
/// signs of a whole heart stay near the processor.
struct Signs {
  std::vector<std::uint8_t> bits;  ///< of voxel v: bit v % 8 of byte v / 8
};
Signs signs_of(const LevelSet& volume);

/// Whether value_at is negative. Where all corners of the cube around a position have one sign, that is known without
/// their values. `signs` are the volume's.
bool is_negative_at(const LevelSet& volume, const Signs& signs, const Vec3& position);

}  // namespace heartgen::mesh
