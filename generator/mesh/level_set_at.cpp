// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/level_set_at.hpp"

#include <algorithm>
#include <array>

#include "generator/parallel/threads.hpp"

namespace heartgen::mesh {
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

namespace {

double value_in(const Cube& cube) {
  const auto across = [&](std::size_t row) {
    const double value = row_of(cube, row).value;
    return value + cube.fraction.y * (row_of(cube, row + 1).value - value);
  };
  const double low = across(0);
  return low + cube.fraction.z * (across(2) - low);
}

// Of the signs at a cube's corners; at a border that has no next voxel, some of another one's may be among them.
struct CornerSigns {
  bool is_any_negative, is_any_other;
};

CornerSigns corner_signs(const Signs& signs, const std::array<std::size_t, 4>& rows) {
  unsigned any = 0, all = 3;
  for (const auto row : rows) {
    const unsigned two = (signs.bits[row / 8] | signs.bits[row / 8 + 1] << 8U) >> row % 8 & 3U;
    any |= two;
    all &= two;
  }
  return {any != 0, all != 3};
}

}  // namespace

double value_at(const LevelSet& volume, const Vec3& position) { return value_in(cube_at(volume, position)); }

Signs signs_of(const LevelSet& volume) {
  const auto count = static_cast<std::int64_t>(volume.voxels.size());
  Signs signs;
  signs.bits.assign(static_cast<std::size_t>(count / 8 + 2), 0);  // one to read beyond the last voxel
  parallel::parallel_for(0, count / 8 + 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto byte = begin; byte < end; ++byte)
      for (auto v = 8 * byte; v < std::min(8 * byte + 8, count); ++v)
        if (volume.voxels[static_cast<std::size_t>(v)] < 0)
          signs.bits[static_cast<std::size_t>(byte)] |= static_cast<std::uint8_t>(1U << (v % 8));
  });
  return signs;
}

bool is_negative_at(const LevelSet& volume, const Signs& signs, const Vec3& position) {
  const auto cube = cube_at(volume, position);
  const auto first = static_cast<std::size_t>(cube.first - volume.voxels.data());
  const auto y = static_cast<std::size_t>(cube.step[1]), z = static_cast<std::size_t>(cube.step[2]);
  const auto corners = corner_signs(signs, {first, first + y, first + z, first + y + z});
  if (!corners.is_any_negative) return false;
  return !corners.is_any_other || value_in(cube) < 0;
}

}  // namespace heartgen::mesh
