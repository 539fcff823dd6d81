// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/heart_frame.hpp"

#include "model/labels.hpp"

namespace heartgen::validation {
namespace {

Vec3 cell_center(const TetMesh& mesh, std::size_t c) {
  Vec3 sum;
  for (const auto n : mesh.cells[c]) sum += mesh.nodes_mm[static_cast<std::size_t>(n)];
  return 0.25 * sum;
}

struct Mean {
  Vec3 value;
  double volume_mm3 = 0;
};

/// Volume-weighted centre of a region, or of all cells (Region::none).
Mean region_center(const TetMesh& mesh, Region region) {
  Mean mean;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (region != Region::none && mesh.region[c] != tag(region)) continue;
    const double v = cell_volume_mm3(mesh, mesh.cells[c]);
    mean.value += v * cell_center(mesh, c);
    mean.volume_mm3 += v;
  }
  if (mean.volume_mm3 > 0) mean.value = mean.value / mean.volume_mm3;
  return mean;
}

Vec3 principal_axis(const TetMesh& mesh, const Vec3& center) {
  Mat3 covariance{{Vec3{}, Vec3{}, Vec3{}}};
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (mesh.region[c] != tag(Region::lv_myocardium)) continue;
    const Vec3 d = cell_center(mesh, c) - center;
    const double v = cell_volume_mm3(mesh, mesh.cells[c]);
    for (int row = 0; row < 3; ++row) covariance[row] += (v * d[row]) * d;
  }
  Vec3 axis = normalized(Vec3{-0.5, 0.45, 0.74});
  constexpr int power_iterations = 200;
  for (int step = 0; step < power_iterations; ++step) axis = normalized(covariance * axis);
  const Vec3 base_in_body{-0.6, 0.5, 0.6};
  return dot(axis, base_in_body) < 0 ? -axis : axis;
}

}  // namespace

HeartFrame heart_frame(const TetMesh& mesh) {
  HeartFrame frame;
  const Mean left = region_center(mesh, Region::lv_myocardium), right = region_center(mesh, Region::rv_myocardium);
  if (left.volume_mm3 <= 0) {
    frame.center_mm = region_center(mesh, Region::none).value;
    return frame;
  }
  frame.center_mm = left.value;
  frame.axis = principal_axis(mesh, left.value);
  Vec3 across = right.volume_mm3 > 0 ? right.value - left.value : Vec3{-1, 0, 0};
  across = across - dot(across, frame.axis) * frame.axis;
  if (norm(across) < 1e-6) across = cross(frame.axis, Vec3{0, 1, 0});
  frame.to_right = normalized(across);
  return frame;
}

}  // namespace heartgen::validation
