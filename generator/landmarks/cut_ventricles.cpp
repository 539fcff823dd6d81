// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/cut_ventricles.hpp"

#include "generator/chest/working_image.hpp"
#include "generator/image/distance.hpp"
#include "model/labels.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double thinnest_left_wall_mm = 4;  // of dilated hearts; its tip may be thinner

Volume<float> distance_to_pool(const LabelVolume& chambers, Region pool) {
  return image::distance_to(
      chest::mask_where(chambers.grid, [&](const Vec3&, std::size_t v) { return chambers.voxels[v] == tag(pool); }));
}

}  // namespace

double ventricles_cut_cm2(const LabelVolume& chambers) {
  const auto left = distance_to_pool(chambers, Region::lv_blood), right = distance_to_pool(chambers, Region::rv_blood);
  const auto& size = chambers.grid.size;
  const double face_cm2 = chambers.grid.spacing_mm.x * chambers.grid.spacing_mm.y / 100;
  double cut_cm2 = 0;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        const int faces = (i == 0) + (j == 0) + (k == 0) + (i + 1 == size[0]) + (j + 1 == size[1]) + (k + 1 == size[2]);
        if (faces == 0) continue;
        const bool in_ventricle = static_cast<double>(left.voxels[v]) < thinnest_left_wall_mm || right.voxels[v] <= 0;
        cut_cm2 += in_ventricle ? faces * face_cm2 : 0;
      }
  return cut_cm2;
}

}  // namespace heartgen::landmarks
