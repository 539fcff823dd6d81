// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/hounsfield.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "model/error.hpp"
#include "model/tissue.hpp"

namespace heartgen::anatomy {

Volume<float> as_float(const CtVolume& ct) {
  Volume<float> image(ct.grid);
  std::copy(ct.voxels.begin(), ct.voxels.end(), image.voxels.begin());
  return image;
}

void require_hounsfield(const CtVolume& ct, const std::string& where) {
  constexpr double min_share = 1e-3;
  const auto dark =
      std::count_if(ct.voxels.begin(), ct.voxels.end(), [](std::int16_t hu) { return hu < tissue::fat_max_hu; });
  if (static_cast<double>(dark) >= min_share * static_cast<double>(ct.voxels.size())) return;
  if (ct.voxels.empty()) return;
  const auto [least, most] = std::minmax_element(ct.voxels.begin(), ct.voxels.end());
  const bool is_soft = *most <= tissue::bare_soft_tissue_max_hu;  // it may well be in Hounsfield units,
  const bool like_labels = is_soft && *least == 0;                // but not with a background of 0
  if (is_soft && !like_labels) return;
  throw UserError(fmt::format("grey values from {} to {} are no Hounsfield units: neither fat nor air is darker than 0",
                              *least, *most),
                  where,
                  like_labels
                      ? "is this a label map? Give the CT itself"
                      : "apply the scan's rescale slope and intercept (often: subtract 1024), or export it again");
}

}  // namespace heartgen::anatomy
