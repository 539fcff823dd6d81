// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Axes of cells, which hold at their middles, taken to the points of the mesh.
#pragma once
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::atlas {

/// Unit axis per point from one per cell (any length, zero where there is none), such that the mean of a cell's four
/// points, which is the axis at its middle, is the given one: the mean of the cells around a point on a wall is the
/// axis half a cell deep. From those means on, points are turned again and again by what their cells still lack. Zero
/// where no cell around has an axis. Threads; the same bits for any number of them.
std::vector<Vec3> point_axes(const std::vector<Vec3>& points, const std::vector<Cell>& cells,
                             const std::vector<Vec3>& cell_axes);

/// The plain means of the cells around each point: enough where the cells' own axes are used beside them.
std::vector<Vec3> mean_point_axes(std::size_t points, const std::vector<Cell>& cells,
                                  const std::vector<Vec3>& cell_axes);

}  // namespace heartgen::atlas
