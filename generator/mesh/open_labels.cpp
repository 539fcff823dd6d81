// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/open_labels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "generator/image/distance.hpp"
#include "generator/parallel/threads.hpp"
#include "model/crop.hpp"
#include "model/mathematics.hpp"

namespace heartgen::mesh {
namespace {

/// How far (mm) voxels around a label are from where a ball's centre can be inside it.
struct Reach {
  Box box;
  Volume<float> to_center;

  float at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const auto &b = box.begin, &e = box.end;
    const bool is_in = i >= b[0] && i < e[0] && j >= b[1] && j < e[1] && k >= b[2] && k < e[2];
    return is_in ? to_center(i - b[0], j - b[1], k - b[2]) : std::numeric_limits<float>::max();
  }
};

double half_voxel_of(const Grid& grid) { return 0.5 * math::cbrt(grid.voxel_volume_mm3()); }

Reach reach_of(const LabelVolume& labels, std::uint8_t tag, double radius_mm) {
  const auto& spacing = labels.grid.spacing_mm;
  const double finest = std::min({spacing.x, spacing.y, spacing.z});
  const auto margin = static_cast<std::int64_t>(std::ceil(3 * radius_mm / finest)) + 2;
  Reach reach{bounding_box(labels, margin, [&](std::uint8_t label) { return label == tag; }), {}};
  if (reach.box.empty()) return reach;  // the label is nowhere left
  const auto near = crop(labels, reach.box);
  Mask mask(near.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) mask.voxels[v] = near.voxels[v] != tag;
  const auto depth = image::distance_to(mask);
  const auto least = static_cast<float>(radius_mm + half_voxel_of(near.grid));  // the surface is half a voxel nearer
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) mask.voxels[v] = depth.voxels[v] > least;
  reach.to_center = image::distance_to(mask);
  return reach;
}

}  // namespace

void open_labels(LabelVolume& labels, std::span<const std::uint8_t> tags, double radius_mm) {
  std::vector<Reach> reaches;
  reaches.reserve(tags.size());
  for (const auto tag : tags) reaches.push_back(reach_of(labels, tag, radius_mm));
  const auto reached = static_cast<float>(radius_mm + half_voxel_of(labels.grid));
  const auto farthest = reached + static_cast<float>(2 * radius_mm);
  const auto label_at = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    std::uint8_t best = labels(i, j, k);
    float least = farthest;
    for (std::size_t t = 0; t < tags.size(); ++t) {
      const float way = reaches[t].at(i, j, k);
      if (tags[t] == labels(i, j, k) && way <= reached) return tags[t];
      if (way >= least) continue;
      least = way;
      best = tags[t];
    }
    return best;
  };
  const auto& size = labels.grid.size;
  parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j)
        for (std::int64_t i = 0; i < size[0]; ++i)
          if (labels(i, j, k) != 0) labels(i, j, k) = label_at(i, j, k);  // nothing asks for a changed one
  });
}

}  // namespace heartgen::mesh
