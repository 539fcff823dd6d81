#include "generator/mesh/level_set_at.hpp"

#include <algorithm>
#include <array>

namespace heart::mesh {
namespace {

/// The cube of a volume in which a position lies, beyond the border the one on it, and the place in the cube.
struct Cube {
  const float* first;
  std::array<std::int64_t, 3> step;
  Vec3 fraction;
};

Cube cube_at(const LevelSet& volume, const Vec3& position) {
  const auto& size = volume.grid.size;
  std::array<std::int64_t, 3> base;
  Cube cube{nullptr, {1, size[0], size[0] * size[1]}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double index = position[axis] / volume.grid.spacing_mm[axis];
    const double inside = std::clamp(index, 0.0, static_cast<double>(size[a] - 1));
    base[a] = std::min(static_cast<std::int64_t>(inside), std::max<std::int64_t>(size[a] - 2, 0));
    if (size[a] < 2) cube.step[a] = 0;
    cube.fraction[axis] = inside - static_cast<double>(base[a]);
  }
  cube.first = &volume(base[0], base[1], base[2]);
  return cube;
}

/// A row of a cube: the value at the place in it, and the rise along it.
struct Row {
  double value = 0, rise = 0;
};

Row row_of(const Cube& cube, std::size_t row) {
  const float* q = cube.first + static_cast<std::int64_t>(row & 1U) * cube.step[1] +
                   static_cast<std::int64_t>(row >> 1U) * cube.step[2];
  const double rise = static_cast<double>(q[cube.step[0]]) - static_cast<double>(q[0]);
  return {static_cast<double>(q[0]) + cube.fraction.x * rise, rise};
}

}  // namespace

Sample sample(const LevelSet& volume, const Vec3& position) {
  const auto cube = cube_at(volume, position);
  const Vec3& f = cube.fraction;
  const std::array rows{row_of(cube, 0), row_of(cube, 1), row_of(cube, 2), row_of(cube, 3)};
  const double over_low = rows[1].value - rows[0].value, over_high = rows[3].value - rows[2].value;
  const double low = rows[0].value + f.y * over_low, high = rows[2].value + f.y * over_high;
  const double rise_low = rows[0].rise + f.y * (rows[1].rise - rows[0].rise);
  const double rise_high = rows[2].rise + f.y * (rows[3].rise - rows[2].rise);
  const auto& spacing = volume.grid.spacing_mm;
  return {low + f.z * (high - low),
          {(rise_low + f.z * (rise_high - rise_low)) / spacing.x, (over_low + f.z * (over_high - over_low)) / spacing.y,
           (high - low) / spacing.z}};
}

double value_at(const LevelSet& volume, const Vec3& position) {
  const auto cube = cube_at(volume, position);
  const auto across = [&](std::size_t row) {
    const double value = row_of(cube, row).value;
    return value + cube.fraction.y * (row_of(cube, row + 1).value - value);
  };
  const double low = across(0);
  return low + cube.fraction.z * (across(2) - low);
}

}  // namespace heart::mesh
