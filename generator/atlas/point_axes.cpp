#include "generator/atlas/point_axes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/atlas/axis_tensor.hpp"
#include "generator/parallel/threads.hpp"
#include "model/sort_unique.hpp"

namespace heart::atlas {
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
  void add(std::int32_t point, std::vector<std::int32_t>& cells) const {
    const auto p = static_cast<std::size_t>(point);
    cells.insert(cells.end(), pool.begin() + first[p], pool.begin() + first[p + 1]);
  }
};

/// A value and three slopes: weighted sums for the fit of all components at once.
template <class Value>
struct LinearFit {
  std::array<std::array<double, 4>, 4> matrix{};
  std::array<Value, 4> right{};

  void add(const Vec3& offset, double weight, const Value& value) {
    const std::array<double, 4> row{1, offset.x, offset.y, offset.z};
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) matrix[i][j] += weight * row[i] * row[j];
      right[i] += (weight * row[i]) * value;
    }
  }
  bool is_empty() const { return !(matrix[0][0] > 0); }
  /// The value at offset 0. Slopes in directions in which there are hardly any cells are kept flat.
  Value value() {
    constexpr double flatness = 1e-3;  // of the mean square of the offsets
    const double spread = matrix[1][1] + matrix[2][2] + matrix[3][3];
    for (std::size_t i = 1; i < 4; ++i) matrix[i][i] += flatness * spread;
    for (std::size_t i = 3; i > 0; --i)  // from below, so that the value is left
      for (std::size_t row = 0; row < i; ++row) {
        const double factor = matrix[row][i] / matrix[i][i];
        for (std::size_t j = 0; j < 4; ++j) matrix[row][j] -= factor * matrix[i][j];
        right[row] += -factor * right[i];
      }
    return (1 / matrix[0][0]) * right[0];
  }
};

struct Neighbour {
  Vec3 offset, axis;
  double weight;
};

/// Dyads of axes that turn by a constant angle per mm are no linear function of place: good for a first guess.
Vec3 guess(const std::vector<Neighbour>& neighbours) {
  LinearFit<AxisTensor> fit;
  for (const auto& n : neighbours) fit.add(n.offset, n.weight, axis_tensor(n.axis));
  return fit.is_empty() ? Vec3{} : leading_axis(fit.value());
}

/// Angles from a guess to the axes around, as vectors across it, are linear where axes turn evenly; those of axes far
/// from it count for less.
Vec3 refined(const Vec3& start, const std::vector<Neighbour>& neighbours) {
  LinearFit<Vec3> fit;
  for (const auto& n : neighbours) {
    const double cosine = std::abs(dot(n.axis, start));
    const Vec3 across = (dot(n.axis, start) < 0 ? -n.axis : n.axis) - cosine * start;
    const double sine = norm(across);
    fit.add(n.offset, n.weight * cosine * cosine, std::atan2(sine, cosine) * normalized(across));
  }
  if (fit.is_empty()) return start;
  const Vec3 turn = fit.value();
  return with_unique_sign(normalized(std::cos(norm(turn)) * start + std::sin(norm(turn)) * normalized(turn)));
}

/// Cells two steps around a point that have an axis, with the weights of a Gaussian as wide as one step.
std::vector<Neighbour> neighbours_of(std::int32_t point, const Stars& stars, const std::vector<Cell>& cells,
                                     const std::vector<Vec3>& middles, const std::vector<Vec3>& axes, const Vec3& at) {
  std::vector<std::int32_t> own, near;
  stars.add(point, own);
  double reach2 = 0;
  for (const auto c : own) {
    const Vec3 offset = middles[static_cast<std::size_t>(c)] - at;
    reach2 = std::max(reach2, dot(offset, offset));
    for (const auto other : cells[static_cast<std::size_t>(c)]) stars.add(other, near);
  }
  sort_unique(near);
  std::vector<Neighbour> neighbours;
  for (const auto c : near) {
    const auto cell = static_cast<std::size_t>(c);
    const Vec3 offset = middles[cell] - at;
    if (axes[cell] != Vec3{}) neighbours.push_back({offset, axes[cell], std::exp(-dot(offset, offset) / (2 * reach2))});
  }
  return neighbours;
}

}  // namespace

std::vector<Vec3> point_axes(const std::vector<Vec3>& points, const std::vector<Cell>& cells,
                             const std::vector<Vec3>& cell_axes) {
  const Stars stars(points.size(), cells);
  std::vector<Vec3> middles(cells.size()), unit(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (const auto p : cells[c]) middles[c] += 0.25 * points[static_cast<std::size_t>(p)];
    unit[c] = normalized(cell_axes[c]);
  }
  std::vector<Vec3> axes(points.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(points.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto p = static_cast<std::size_t>(begin); p < static_cast<std::size_t>(end); ++p) {
      const auto around = neighbours_of(static_cast<std::int32_t>(p), stars, cells, middles, unit, points[p]);
      const Vec3 first = guess(around);
      axes[p] = first == Vec3{} ? first : refined(first, around);
    }
  });
  return axes;
}

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

}  // namespace heart::atlas
