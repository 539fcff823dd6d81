// Values between the voxels of a level set.
#pragma once
#include "model/volume.hpp"

namespace heart::mesh {

/// A trilinear value and its gradient (per mm along the axes).
struct Sample {
  double value = 0;
  Vec3 gradient;
};

/// At a position in mm along the axes of the grid, voxel (0, 0, 0) at the origin; beyond the border, the border's.
Sample sample(const LevelSet& volume, const Vec3& position);

/// The same value; most of the time nobody asks for more.
double value_at(const LevelSet& volume, const Vec3& position);

}  // namespace heart::mesh
