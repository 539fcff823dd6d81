// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/contacts.hpp"

namespace heartgen::labels {

Contacts contacts_in(const LabelVolume& labels) {
  Contacts contacts;
  const auto& size = labels.grid.size;
  const Vec3& s = labels.grid.spacing_mm;
  const std::array<double, 3> area{s.y * s.z, s.x * s.z, s.x * s.y};
  const std::array<std::int64_t, 3> step{1, size[0], size[0] * size[1]};
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        contacts.is_there[labels.voxels[v]] = true;
        const std::array<bool, 3> has_next{i + 1 < size[0], j + 1 < size[1], k + 1 < size[2]};
        for (std::size_t axis = 0; axis < 3; ++axis)
          if (has_next[axis])
            contacts.add(labels.voxels[v], labels.voxels[v + static_cast<std::size_t>(step[axis])], area[axis]);
      }
  return contacts;
}

}  // namespace heartgen::labels
