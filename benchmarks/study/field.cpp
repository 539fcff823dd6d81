// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/field.hpp"

#include <algorithm>

namespace heartgen::study {

Field::Field(int width_px, int height_px, double value)
    : width(width_px),
      height(height_px),
      values(static_cast<std::size_t>(width_px + 2) * static_cast<std::size_t>(height_px + 2), 0) {
  if (value == 0) return;
  for (int j = 0; j < height; ++j) std::fill_n(row(j), width, value);
}

PixelLabels::PixelLabels(int width_px, int height_px, std::uint8_t value)
    : width(width_px),
      height(height_px),
      values(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), value) {}

Domain whole_plane(int width, int height) { return part_of_plane(PixelLabels(width, height, 1)); }

Domain part_of_plane(const PixelLabels& labels) {
  Domain domain{Field(labels.width, labels.height), Field(labels.width, labels.height),
                Field(labels.width, labels.height)};
  for (int j = 0; j < labels.height; ++j)
    for (int i = 0; i < labels.width; ++i) domain.inside(i, j) = labels(i, j) != 0;
  for (int j = 0; j < labels.height; ++j)
    for (int i = 0; i < labels.width; ++i) {
      domain.open_x(i, j) = domain.inside(i, j) * domain.inside(i + 1, j);
      domain.open_y(i, j) = domain.inside(i, j) * domain.inside(i, j + 1);
    }
  return domain;
}

PixelLabels positive_side(const Field& phi, const Domain& domain) {
  PixelLabels side(phi.width, phi.height);
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i) side(i, j) = phi(i, j) >= 0 && domain.inside(i, j) != 0;
  return side;
}

std::int64_t differing_pixels(const PixelLabels& a, const PixelLabels& b, const Domain& domain) {
  std::int64_t differ = 0, all = 0;
  for (int j = 0; j < a.height; ++j)
    for (int i = 0; i < a.width; ++i) {
      if (domain.inside(i, j) == 0) continue;
      ++all;
      differ += (a(i, j) != 0) != (b(i, j) != 0);
    }
  return std::min(differ, all - differ);
}

}  // namespace heartgen::study
