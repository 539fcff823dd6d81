// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Neighbours among points in space: nanoflann's tree over a plain vector. Private to atlas and fibers.
#pragma once
#include <nanoflann.hpp>
#include <vector>

#include "model/vec.hpp"

namespace heartgen::adapters {

struct PointCloud {
  std::vector<Vec3> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t n, std::size_t axis) const { return points[n][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using PointTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointCloud>, PointCloud, 3, std::size_t>;

/// `const PointTree tree(3, cloud, tree_leaves);` refers to the cloud, which must outlive it.
inline const nanoflann::KDTreeSingleIndexAdaptorParams tree_leaves(16);

}  // namespace heartgen::adapters
