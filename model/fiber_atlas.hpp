// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The fibre atlas as data: a tetrahedral mesh of the two ventricles with one fibre direction per point (thesis,
/// chapter 9). Only the axis of a direction means anything; its sign and length are ignored everywhere.
#pragma once
#include <string>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen {

struct FiberAtlas {
  std::vector<Vec3> points_mm;   ///< the file's own frame, any orientation, scaled to mm
  std::vector<Cell> cells;       ///< positively oriented
  std::vector<Vec3> fiber;       ///< per point, unit length; zero where the file has none
  std::vector<Vec3> cell_fiber;  ///< per cell, of an atlas made of voxels, which know no more; else empty
  std::string name;              ///< file name without folder, or what the maker called it
  std::string array;             ///< which array of the file the fibres are: "point array \"f0\""; or empty
  double unit_in_mm = 1;         ///< one unit of the file: 1, 10, 1000 or 0.001 mm
};

}  // namespace heartgen
