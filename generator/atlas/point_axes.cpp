// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/atlas/point_axes.hpp"

#include <algorithm>
#include <cmath>

#include "generator/parallel/threads.hpp"
#include "model/axis_tensor.hpp"
#include "model/mathematics.hpp"

namespace heartgen::atlas {
namespace {

/// The cells of every point, one list after the other.
struct Stars {
  std::vector<std::int32_t> first, pool;

  Stars(std::size_t points, const std::vector<Cell>& cells) : first(points + 1, 0), pool(4 * cells.size()) {
    for (const auto& cell : cells)
      for (const auto p : cell) ++first[static_cast<std::size_t>(p) + 1];
    for (std::size_t p = 0; p < points; ++p) first[p + 1] += first[p];
    auto next = first;
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (const auto p : cells[c])
        pool[static_cast<std::size_t>(next[static_cast<std::size_t>(p)]++)] = static_cast<std::int32_t>(c);
  }
};

template <class At>
void for_each(std::size_t count, const At& at) {
  parallel::parallel_for(0, static_cast<std::int64_t>(count), [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) at(i);
  });
}

/// What an axis is turned about, and by how much, to become the other: the same whatever the signs of both.
Vec3 turn_between(const Vec3& from, const Vec3& to) {
  const Vec3 about = cross(from, to);
  const double cosine = dot(from, to);
  return math::atan2(norm(about), std::abs(cosine)) * normalized(cosine < 0 ? -about : about);
}

/// A vector turned about `turn` by its length.
Vec3 turned(const Vec3& v, const Vec3& turn) {
  const double angle = norm(turn);
  const Vec3 about = normalized(turn);
  return math::cos(angle) * v + math::sin(angle) * cross(about, v) + ((1 - math::cos(angle)) * dot(about, v)) * about;
}

}  // namespace

std::vector<Vec3> mean_point_axes(std::size_t points, const std::vector<Cell>& cells,
                                  const std::vector<Vec3>& cell_axes) {
  std::vector<AxisTensor> sum(points);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const auto p : cells[c]) sum[static_cast<std::size_t>(p)] += axis_tensor(normalized(cell_axes[c]));
  std::vector<Vec3> axes(points);
  for (std::size_t p = 0; p < points; ++p)
    if (trace(sum[p]) > 0) axes[p] = leading_axis(sum[p]);
  return axes;
}

std::vector<Vec3> point_axes(const std::vector<Vec3>& points, const std::vector<Cell>& cells,
                             const std::vector<Vec3>& cell_axes) {
  constexpr int sweeps =
      16;  // an error of the means falls to a twentieth; more would follow the noise of measured axes
  const Stars stars(points.size(), cells);
  auto axes = mean_point_axes(points.size(), cells, cell_axes);
  std::vector<Vec3> missing(cells.size());
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for_each(cells.size(), [&](std::size_t c) {
      AxisTensor sum;
      for (const auto p : cells[c]) sum += axis_tensor(axes[static_cast<std::size_t>(p)]);
      const Vec3 given = normalized(cell_axes[c]);
      missing[c] = given == Vec3{} ? Vec3{} : turn_between(leading_axis(sum), given);
    });
    for_each(points.size(), [&](std::size_t p) {
      Vec3 turn;
      const auto begin = stars.first[p], end = stars.first[p + 1];
      for (auto i = begin; i < end; ++i)
        turn += missing[static_cast<std::size_t>(stars.pool[static_cast<std::size_t>(i)])];
      if (end > begin) axes[p] = normalized(turned(axes[p], turn / static_cast<double>(end - begin)));
    });
  }
  return axes;
}

}  // namespace heartgen::atlas
