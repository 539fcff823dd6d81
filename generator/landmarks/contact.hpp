// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the surface in which two regions of a label map touch.
#pragma once
#include <array>
#include <vector>

#include "generator/chest/working_image.hpp"

namespace heartgen::landmarks {

struct ContactSurface {
  std::vector<Vec3> points;  ///< centres of the common voxel faces
  Vec3 area_mm2;             ///< sum of the faces' area vectors, from the first region to the second
};

/// Faces between voxels with first(label) and voxels with second(label), on a grid of equal spacings.
template <class T, class First, class Second>
ContactSurface contact_surface(const Volume<T>& labels, First&& first, Second&& second) {
  ContactSurface surface;
  const Grid& grid = labels.grid;
  const double step = grid.spacing_mm.x;
  const std::array<std::int64_t, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Index3 here{i, j, k};
        const T a = labels.voxels[v];
        if (a == 0) continue;
        for (int axis = 0; axis < 3; ++axis) {
          const auto n = static_cast<std::size_t>(axis);
          if (here[n] + 1 >= grid.size[n]) continue;
          const T b = labels.voxels[v + static_cast<std::size_t>(stride[n])];
          const bool forward = first(a) && second(b), backward = first(b) && second(a);
          if (!forward && !backward) continue;
          Vec3 point = chest::position_mm(grid, i, j, k);
          point[axis] += 0.5 * step;
          surface.points.push_back(point);
          surface.area_mm2[axis] += (forward ? 1 : -1) * step * step;
        }
      }
  return surface;
}

}  // namespace heartgen::landmarks
