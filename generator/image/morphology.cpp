// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/morphology.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "generator/image/box_around.hpp"
#include "generator/image/distance.hpp"
#include "generator/parallel/threads.hpp"
#include "model/contract.hpp"

namespace heartgen::image {
namespace {

constexpr std::uint8_t far = 255;       // voxels along a row
constexpr std::int64_t max_rows = 250;  // of a ball, beyond which a distance transform is quicker
constexpr double rounding_mm = 1e-4;    // distances are floats: a ball reaches the voxels exactly at its radius

Mask inverse(const Mask& mask) {
  Mask result(mask.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) result.voxels[v] = mask.voxels[v] == 0;
  return result;
}

template <class Rule>
Mask combine(const Mask& a, const Mask& b, Rule rule) {
  HEARTGEN_EXPECTS(a.grid == b.grid);
  Mask result(a.grid);
  for (std::size_t v = 0; v < a.voxels.size(); ++v) result.voxels[v] = rule(a.voxels[v] != 0, b.voxels[v] != 0);
  return result;
}

Mask dilate_by_distance(const Mask& mask, double radius_mm) {
  const auto distance = distance_to(mask, static_cast<float>(radius_mm) + 1.0F);
  Mask result(mask.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v)
    result.voxels[v] = static_cast<double>(distance.voxels[v]) <= radius_mm + rounding_mm;
  return result;
}

/// Voxels that a ball reaches along each axis.
Index3 ball_reach(const Grid& grid, double radius_mm) {
  Index3 reach{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    reach[axis] = static_cast<std::int64_t>((radius_mm + rounding_mm) / grid.spacing_mm[static_cast<int>(axis)]);
  return reach;
}

/// One row of a ball, relative to its centre.
struct BallRow {
  std::int64_t j, k;
  std::uint8_t half_width;  // voxels
};

std::vector<BallRow> rows_of_ball(const Grid& grid, double radius_mm) {
  const Index3 reach = ball_reach(grid, radius_mm);
  std::vector<BallRow> rows;
  for (std::int64_t k = -reach[2]; k <= reach[2]; ++k)
    for (std::int64_t j = -reach[1]; j <= reach[1]; ++j) {
      const double y = static_cast<double>(j) * grid.spacing_mm.y, z = static_cast<double>(k) * grid.spacing_mm.z;
      const double left = (radius_mm + rounding_mm) * (radius_mm + rounding_mm) - y * y - z * z;
      if (left >= 0) rows.push_back({j, k, static_cast<std::uint8_t>(std::sqrt(left) / grid.spacing_mm.x)});
    }
  return rows;
}

struct Span {
  std::int64_t begin = 0, end = 0;  // of the set voxels of a row
};

/// Voxels from each voxel of a row to the nearest set one, at most `far`. Returns where the row is set.
Span distance_in_row(const std::uint8_t* set, std::uint8_t* distance, std::int64_t n) {
  Span span;
  std::uint8_t now = far;
  for (std::int64_t i = 0; i < n; ++i) {
    if (set[i]) span = {span.end > 0 ? span.begin : i, i + 1};
    now = set[i] ? std::uint8_t{0} : static_cast<std::uint8_t>(std::min<int>(now + 1, far));
    distance[i] = now;
  }
  for (std::int64_t i = span.end; i-- > 0;) {
    now = set[i] ? std::uint8_t{0} : static_cast<std::uint8_t>(std::min<int>(now + 1, far));
    distance[i] = std::min(distance[i], now);
  }
  return span;
}

/// Row by row of the ball: a voxel is reached by a row when the nearest set voxel along it is not farther than the
/// ball is wide there. Quicker than a distance transform while the ball has few rows.
Mask dilate_by_rows(const Mask& mask, double radius_mm) {
  const std::int64_t nx = mask.grid.size[0], ny = mask.grid.size[1], nz = mask.grid.size[2];
  Mask distance(mask.grid), result(mask.grid);
  std::vector<Span> spans(static_cast<std::size_t>(ny * nz));
  parallel::parallel_for(0, ny * nz, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t r = begin; r < end; ++r)
      spans[static_cast<std::size_t>(r)] =
          distance_in_row(mask.voxels.data() + r * nx, distance.voxels.data() + r * nx, nx);
  });
  const auto rows = rows_of_ball(mask.grid, radius_mm);
  parallel::parallel_for(0, ny * nz, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t r = begin; r < end; ++r)
      for (const BallRow& row : rows) {
        const std::int64_t j = r % ny + row.j, k = r / ny + row.k;
        if (j < 0 || j >= ny || k < 0 || k >= nz) continue;
        const Span& span = spans[static_cast<std::size_t>(k * ny + j)];
        if (span.end == 0) continue;
        const std::uint8_t* near = distance.voxels.data() + (k * ny + j) * nx;
        std::uint8_t* out = result.voxels.data() + r * nx;
        const std::int64_t last = std::min(span.end + row.half_width, nx);
        for (std::int64_t i = std::max<std::int64_t>(span.begin - row.half_width, 0); i < last; ++i)
          out[i] = static_cast<std::uint8_t>(out[i] | (near[i] <= row.half_width));
      }
  });
  return result;
}

Mask dilate_whole(const Mask& mask, double radius_mm) {
  const Index3 reach = ball_reach(mask.grid, radius_mm);
  return reach[0] < far && (2 * reach[1] + 1) * (2 * reach[2] + 1) <= max_rows ? dilate_by_rows(mask, radius_mm)
                                                                               : dilate_by_distance(mask, radius_mm);
}

Box box_of(const Mask& mask, const Index3& margin) {
  Box box = bounding_box(mask, 0, [](std::uint8_t on) { return on != 0; });
  if (box.empty()) return box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.begin[axis] = std::max<std::int64_t>(box.begin[axis] - margin[axis], 0);
    box.end[axis] = std::min(box.end[axis] + margin[axis], mask.grid.size[axis]);
  }
  return box;
}

}  // namespace

Mask dilate(const Mask& mask, double radius_mm) {
  HEARTGEN_EXPECTS(radius_mm >= 0);
  const Box box = box_of(mask, ball_reach(mask.grid, radius_mm));  // beyond it nothing is reached
  return box.empty() ? Mask(mask.grid) : pasted(mask.grid, dilate_whole(crop(mask, box), radius_mm), box);
}

Mask erode(const Mask& mask, double radius_mm) {
  HEARTGEN_EXPECTS(radius_mm >= 0);
  const Box box = box_of(mask, {1, 1, 1});  // an unset voxel farther out has one in the margin that is nearer
  if (box.empty()) return Mask(mask.grid);
  return pasted(mask.grid, inverse(dilate_whole(inverse(crop(mask, box)), radius_mm)), box);
}

Mask open(const Mask& mask, double radius_mm) { return dilate(erode(mask, radius_mm), radius_mm); }
Mask close(const Mask& mask, double radius_mm) { return erode(dilate(mask, radius_mm), radius_mm); }

Mask intersect(const Mask& a, const Mask& b) {
  return combine(a, b, [](bool x, bool y) { return x && y; });
}
Mask unite(const Mask& a, const Mask& b) {
  return combine(a, b, [](bool x, bool y) { return x || y; });
}
Mask subtract(const Mask& a, const Mask& b) {
  return combine(a, b, [](bool x, bool y) { return x && !y; });
}
std::int64_t count(const Mask& mask) {
  return static_cast<std::int64_t>(mask.voxels.size()) -
         std::count(mask.voxels.begin(), mask.voxels.end(), std::uint8_t{0});
}

}  // namespace heartgen::image
