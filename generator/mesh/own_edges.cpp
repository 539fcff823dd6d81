// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/own_edges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/error.hpp"

namespace heartgen::mesh {
namespace {

constexpr float min_edge_mm = 0.1F;

void refuse_impossible_lengths(const Volume<float>& image_mm) {
  for (const float edge : image_mm.voxels)
    if (!(edge >= 0) || (edge > 0 && edge < min_edge_mm))
      throw UserError(fmt::format("holds the edge length {} mm", edge), "size field of the mesh",
                      fmt::format("give lengths of at least {} mm, and 0 where nothing is wished", min_edge_mm));
}

float nearest(const Volume<float>& image_mm, const Vec3& lps_mm) {
  const Vec3 index = index_from_lps(image_mm.grid, lps_mm);
  Index3 at;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    at[a] = static_cast<std::int64_t>(std::floor(index[axis] + 0.5));
    if (at[a] < 0 || at[a] >= image_mm.grid.size[a]) return 0;
  }
  return image_mm(at[0], at[1], at[2]);
}

}  // namespace

std::vector<float> own_edges_on(const Volume<float>& image_mm, const Grid& grid) {
  refuse_impossible_lengths(image_mm);
  std::vector<float> edges;
  edges.reserve(static_cast<std::size_t>(grid.voxel_count()));
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i)
        edges.push_back(nearest(
            image_mm, lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})));
  if (std::none_of(edges.begin(), edges.end(), [](float edge) { return edge > 0; }))
    throw UserError("no voxel of the label map gets an edge length from it", "size field of the mesh",
                    "check that both images lie in the same frame (LPS mm), or leave it out");
  return edges;
}

}  // namespace heartgen::mesh
