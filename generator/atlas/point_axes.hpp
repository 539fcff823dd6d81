// Axes of cells, which hold at their middles, taken to the points of the mesh.
#pragma once
#include <vector>

#include "model/tet_mesh.hpp"

namespace heart::atlas {

/// Unit axis per point from one per cell (any length, zero where there is none). Around each point the angles of the
/// cells two steps away are fitted by a function that is linear in place, weighted by distance: the middles of the
/// cells at a wall all lie on one side of it, and their mean is the axis half a cell deep. Zero where no cell near has
/// an axis. Threads; the same bits for any number of them.
std::vector<Vec3> point_axes(const std::vector<Vec3>& points, const std::vector<Cell>& cells,
                             const std::vector<Vec3>& cell_axes);

/// The plain means of the cells around each point: enough where the cells' own axes are used beside them.
std::vector<Vec3> mean_point_axes(std::size_t points, const std::vector<Cell>& cells,
                                  const std::vector<Vec3>& cell_axes);

}  // namespace heart::atlas
