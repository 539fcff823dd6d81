// The fibre atlas: a tetrahedral mesh of the two ventricles with one fibre direction per point (thesis, chapter 9).
// Only the axis of a direction means anything; its sign and length are ignored everywhere.
#pragma once
#include <string>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heart::atlas {

struct FiberAtlas {
  std::vector<Vec3> points_mm;   ///< the file's own frame, any orientation, scaled to mm
  std::vector<Cell> cells;       ///< positively oriented
  std::vector<Vec3> fiber;       ///< per point, unit length; zero where the file has none
  std::vector<Vec3> cell_fiber;  ///< per cell, of an atlas made of voxels, which know no more; else empty
  std::string name;              ///< file name without folder, or what the maker called it
  std::string array;             ///< which array of the file the fibres are: "point array \"f0\""; or empty
  double unit_in_mm = 1;         ///< one unit of the file: 1, 10, 1000 or 0.001 mm
};

/// Atlas from tetrahedra with one vector per point, or per cell (`vectors` as long as `cells`): then each point gets
/// what the cells around it lead to (point_axes.hpp). The unit is worked out from the size of the heart. Inverted cells
/// are turned round.
/// Throws UserError: no cells, indices out of range, NaN, vectors all zero, a size that is no heart's in any unit.
FiberAtlas make_fiber_atlas(std::string name, std::vector<Vec3> points, std::vector<Cell> cells,
                            const std::vector<Vec3>& vectors);

/// Reads .exnode and .exelem files (exnode.hpp), images (voxel_atlas.hpp), or a .vtk (legacy), .vtu or .msh file with
/// tetrahedra and at least one array of vectors or of tensors, whose leading axes are the fibres. `array` names it, on
/// points or on cells; empty: the one with a known name of fibres (axis_name), points before cells and vectors before
/// tensors; without a known name the only one, unless it is called normals or sheets. Throws UserError, naming file and
/// remedy; where it cannot choose it lists the arrays.
FiberAtlas read_fiber_atlas(const std::string& path, const std::string& array = {});

}  // namespace heart::atlas
