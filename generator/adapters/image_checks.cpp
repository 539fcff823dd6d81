// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/image_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/error.hpp"
#include "model/memory.hpp"

namespace heartgen::adapters {
namespace {

constexpr double largest_anisotropy = 10, min_mm = 1e-6, max_mm = 1e5, same_direction = 1e-3;
constexpr double max_voxels = 2048.0 * 2048 * 2048;

void check_counts(const Index3& size, const std::string& path) {
  double voxels = 1;
  for (const auto length : size) {
    if (length <= 0) throw UserError("is empty: a size below 1 voxel", path, "is it complete and undamaged?");
    voxels *= static_cast<double>(length);
  }
  if (voxels > max_voxels)
    throw UserError(fmt::format("has {} x {} x {} voxels, more than 2048 x 2048 x 2048", size[0], size[1], size[2]),
                    path, "crop or resample the volume");
}

void check_spacing(const Vec3& s, const std::string& path) {
  const double least = std::min({s.x, s.y, s.z}), most = std::max({s.x, s.y, s.z});
  if (!(s.x > 0 && s.y > 0 && s.z > 0))
    throw UserError("has a voxel spacing that is not positive", path, "repair the header");
  if (!(least >= min_mm && most <= max_mm))
    throw UserError(fmt::format("voxels of {:.6g} x {:.6g} x {:.6g} mm cannot be", s.x, s.y, s.z), path,
                    "repair the header");
  if (most > largest_anisotropy * least)
    throw UserError(fmt::format("voxels of {:.6g} x {:.6g} x {:.6g} mm are more anisotropic than {}:1", s.x, s.y, s.z,
                                largest_anisotropy),
                    path, "resample the volume or use a thinner reconstruction");
}

void check_origin(const Vec3& origin, const std::string& path) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(origin[axis]) <= max_mm))
      throw UserError(fmt::format("an origin at {:.6g}, {:.6g}, {:.6g} mm cannot be", origin.x, origin.y, origin.z),
                      path, "repair the header");
}

void check_direction(const Mat3& direction, const std::string& path) {
  const Mat3 product = transposed(direction) * direction;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      if (!(std::abs(product[row][column] - (row == column ? 1 : 0)) < same_direction))
        throw UserError("has a sheared or missing orientation matrix", path, "resample it to a regular grid");
}

}  // namespace

void check_grid(const Grid& grid, const std::string& path) {
  check_counts(grid.size, path);
  check_spacing(grid.spacing_mm, path);
  check_origin(grid.origin_mm, path);
  check_direction(grid.direction, path);
}

void check_size(const Index3& size, const std::string& path, bool allow_2d) {
  check_counts(size, path);
  if (size[2] == 1 && !allow_2d) throw UserError("is a single slice, not a volume", path, "give the whole series");
  constexpr double bytes_per_voxel = 40;  // that a build holds at its peak
  const double voxels = static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]);
  const double needed = voxels * bytes_per_voxel, there = memory_bytes();
  if (there > 0 && needed > there)
    throw UserError(
        fmt::format("needs about {} of memory, and there are {}", text_of_bytes(needed), text_of_bytes(there)), path,
        "crop or resample the volume, or give it more memory");
}

void check_phase(int phase, int phases, const std::string& path) {
  const std::string choice = phases > 1 ? fmt::format("choose one with --phase 1 to {}", phases) : "leave --phase out";
  const std::string volumes = phases > 1 ? fmt::format("{} volumes, as of several phases", phases) : "one volume";
  if (phase == 0 && phases > 1) throw UserError("holds " + volumes, path, choice);
  if (phase < 0 || phase > phases)
    throw UserError(fmt::format("holds {}, and no phase {}", volumes, phase), path, choice);
}

void check_claim(double claimed_bytes, double file_bytes, bool is_compressed, const std::string& path) {
  constexpr double largest_compression = 1032;
  if (claimed_bytes > file_bytes * (is_compressed ? largest_compression : 1))
    throw UserError(
        fmt::format("is truncated or damaged: its header claims {:.0f} bytes of voxels, the file has {:.0f}",
                    claimed_bytes, file_bytes),
        path, "copy or download it again");
}

}  // namespace heartgen::adapters
