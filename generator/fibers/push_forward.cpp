// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/push_forward.hpp"

#include "generator/parallel/threads.hpp"
#include "model/mesh_queries/corners.hpp"

namespace heartgen::fibers {
namespace {

/// Trilinear mean of the dyads of the voxels that have one; zero where they hold less than half of the weight.
AxisTensor atlas_tensor(const Volume<Vec3>& fiber, const Vec3& atlas_mm) {
  AxisTensor sum;
  double total = 0;
  const Vec3 index = index_from_lps(fiber.grid, atlas_mm);
  mesh_queries::for_corners(index, [&](double weight, std::int64_t i, std::int64_t j, std::int64_t k) {
    if (weight == 0 || !fiber.grid.contains(i, j, k)) return;
    const Vec3 f = fiber(i, j, k);
    if (norm(f) < 0.5) return;
    sum += weight * axis_tensor(f);
    total += weight;
  });
  return total >= 0.5 ? sum : AxisTensor{};
}

}  // namespace

std::vector<AxisTensor> push_forward(const ventricles::AtlasImage& image, const atlas::Registration& registration,
                                     const std::vector<Vec3>& patient_mm) {
  std::vector<AxisTensor> result(patient_mm.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(result.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto p = static_cast<std::size_t>(begin); p < static_cast<std::size_t>(end); ++p) {
      const Vec3 axis = leading_axis(atlas_tensor(image.fiber, atlas::atlas_position(registration, patient_mm[p])));
      if (norm(axis) == 0) continue;
      // The registration maps patient to atlas, so its derivative's inverse takes atlas vectors to the patient.
      const Mat3 m = atlas::atlas_jacobian(registration, patient_mm[p]);
      const Vec3 pushed =
          normalized(dot(axis, {1, 0, 0}) * cross(m[1], m[2]) + dot(axis, {0, 1, 0}) * cross(m[2], m[0]) +
                     dot(axis, {0, 0, 1}) * cross(m[0], m[1]));
      result[p] = axis_tensor(pushed);
    }
  });
  return result;
}

}  // namespace heartgen::fibers
