// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/atlas/voxel_atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

#include "generator/adapters/itk_io.hpp"
#include "generator/atlas/point_axes.hpp"
#include "model/axis_tensor.hpp"
#include "model/error.hpp"

namespace heartgen::atlas {
namespace {

namespace fs = std::filesystem;

constexpr const char* expected =
    "give one image with 3 (vector), 6 or 9 (tensor) components per voxel, or fiber_x, fiber_y and fiber_z; and the "
    "muscle, if fibres lie outside of it, as an image with \"mask\" in its name";
constexpr std::array<const char*, 3> component_names = {"fiber_x", "fiber_y", "fiber_z"};

bool is_image_file(const fs::path& path) {
  constexpr std::array endings{".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd"};
  const std::string name = path.filename().string();
  return std::any_of(endings.begin(), endings.end(), [&](const char* ending) { return name.ends_with(ending); });
}

/// What a voxel's components say.
AxisTensor tensor_of(const adapters::ComponentImage& image, std::size_t voxel) {
  const auto value = [&](std::size_t c) { return static_cast<double>(image.components[c].voxels[voxel]); };
  const auto matrix = [&](std::size_t xx, std::size_t xy, std::size_t xz, std::size_t yy, std::size_t yz,
                          std::size_t zz) {
    const Mat3 t{{Vec3{value(xx), value(xy), value(xz)}, Vec3{value(xy), value(yy), value(yz)},
                  Vec3{value(xz), value(yz), value(zz)}}};
    const Mat3 r = image.frame * t * transposed(image.frame);
    return AxisTensor{{r[0].x, r[1].y, r[2].z, r[0].y, r[0].z, r[1].z}};
  };
  switch (image.components.size()) {
    case 3:
      return axis_tensor(normalized(image.frame * Vec3{value(0), value(1), value(2)}));
    case 6:
      return matrix(0, 1, 2, 3, 4, 5);
    case 7:
      return value(0) > 0 ? matrix(1, 2, 3, 4, 5, 6) : AxisTensor{};
    default:
      return matrix(0, 1, 2, 4, 5, 8);
  }
}

Volume<Vec3> axes_of(const adapters::ComponentImage& image, const std::string& path) {
  const auto count = image.components.size();
  if (count != 3 && count != 6 && count != 7 && count != 9)
    throw UserError(fmt::format("has {} components per voxel, which is neither a vector nor a tensor", count), path,
                    expected);
  Volume<Vec3> axis(image.components.front().grid);
  for (std::size_t v = 0; v < axis.voxels.size(); ++v) axis.voxels[v] = leading_axis(tensor_of(image, v));
  return axis;
}

/// The files of an atlas in a folder.
struct Files {
  std::array<std::string, 3> component;
  std::string fiber, mask;
};

Files files_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_image_file(entry.path())) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  Files files;
  std::vector<std::string> others;
  for (const auto& path : paths) {
    const std::string name = path.filename().string();
    const auto component = std::find_if(component_names.begin(), component_names.end(),
                                        [&](const char* start) { return name.starts_with(start); });
    if (component != component_names.end())
      files.component[static_cast<std::size_t>(component - component_names.begin())] = path.string();
    else if (name.find("mask") != std::string::npos)
      files.mask = path.string();
    else
      others.push_back(path.string());
  }
  if (std::none_of(files.component.begin(), files.component.end(), [](const auto& f) { return f.empty(); }))
    return files;
  if (others.size() != 1)
    throw UserError(fmt::format("holds {} images that could be the fibres", others.size()), folder.string(), expected);
  files.fiber = others.front();
  return files;
}

adapters::ComponentImage joined(const std::array<std::string, 3>& paths) {
  adapters::ComponentImage image;
  for (const auto& path : paths) {
    image.components.push_back(adapters::read_image(path));
    if (image.components.back().grid.size != image.components.front().grid.size)
      throw UserError("has not as many voxels as fiber_x", path, "give all three on one grid");
  }
  return image;
}

Mask muscle_of(const std::string& mask_path, const Volume<Vec3>& axis) {
  Mask muscle(axis.grid);
  if (mask_path.empty()) {
    for (std::size_t v = 0; v < axis.voxels.size(); ++v) muscle.voxels[v] = norm(axis.voxels[v]) > 0;
    return muscle;
  }
  const auto mask = adapters::read_image(mask_path);
  if (mask.grid.size != axis.grid.size)
    throw UserError("has not as many voxels as the fibres", mask_path, "give both on one grid");
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) muscle.voxels[v] = mask.voxels[v] > 0;
  return muscle;
}

/// Voxels per side of a block.
std::array<std::int64_t, 3> block_of(const Grid& grid) {
  constexpr double min_cell_mm = 0.75;
  std::array<std::int64_t, 3> block{};
  for (int axis = 0; axis < 3; ++axis)
    block[static_cast<std::size_t>(axis)] =
        std::max<std::int64_t>(1, static_cast<std::int64_t>(min_cell_mm / grid.spacing_mm[axis]));
  return block;
}

struct Voxels {
  Mask muscle;
  Volume<Vec3> axis;
};

/// Blocks of which half is muscle, with the leading axis of their voxels'.
Voxels in_blocks(const Mask& muscle, const Volume<Vec3>& axis) {
  const auto block = block_of(muscle.grid);
  Grid grid = muscle.grid;
  for (int a = 0; a < 3; ++a) {
    const auto n = static_cast<std::size_t>(a);
    grid.size[n] = (muscle.grid.size[n] + block[n] - 1) / block[n];
    grid.spacing_mm[a] *= static_cast<double>(block[n]);
  }
  const auto middle = [&](std::size_t n) { return 0.5 * static_cast<double>(block[n] - 1); };
  grid.origin_mm = lps_from_index(muscle.grid, {middle(0), middle(1), middle(2)});
  Voxels result{Mask(grid), Volume<Vec3>(grid)};
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        AxisTensor sum;
        std::int64_t inside = 0;
        for (std::int64_t c = 0; c < block[2]; ++c)
          for (std::int64_t b = 0; b < block[1]; ++b)
            for (std::int64_t a = 0; a < block[0]; ++a) {
              const auto x = i * block[0] + a, y = j * block[1] + b, z = k * block[2] + c;
              if (!muscle.grid.contains(x, y, z) || !muscle(x, y, z)) continue;
              ++inside;
              sum += axis_tensor(axis(x, y, z));
            }
        result.muscle(i, j, k) = 2 * inside >= block[0] * block[1] * block[2];
        if (trace(sum) > 0) result.axis(i, j, k) = leading_axis(sum);
      }
  return result;
}

/// Splits voxels into cells; corners are numbered as they are met.
class CubeMesh {
 public:
  explicit CubeMesh(const Grid& grid) : grid_(grid) {
    corner_ids_.assign(static_cast<std::size_t>((grid.size[0] + 1) * (grid.size[1] + 1) * (grid.size[2] + 1)), -1);
  }

  void add(std::int64_t i, std::int64_t j, std::int64_t k, const Vec3& axis) {
    constexpr int paths[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};  // around the diagonal from 0 to 7
    std::array<std::int32_t, 8> corner{};
    for (int c = 0; c < 8; ++c) corner[static_cast<std::size_t>(c)] = id(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2));
    for (const auto& path : paths) {
      cells.push_back(
          {corner[0], corner[static_cast<std::size_t>(path[0])], corner[static_cast<std::size_t>(path[1])], corner[7]});
      axes.push_back(axis);
    }
  }

  std::vector<Vec3> points_mm, axes;  ///< axes per cell
  std::vector<Cell> cells;

 private:
  std::int32_t id(std::int64_t i, std::int64_t j, std::int64_t k) {
    auto& id = corner_ids_[static_cast<std::size_t>((k * (grid_.size[1] + 1) + j) * (grid_.size[0] + 1) + i)];
    if (id < 0) {
      id = static_cast<std::int32_t>(points_mm.size());
      const auto at = [](std::int64_t n) { return static_cast<double>(n) - 0.5; };
      points_mm.push_back(lps_from_index(grid_, {at(i), at(j), at(k)}));
    }
    return id;
  }

  Grid grid_;
  std::vector<std::int32_t> corner_ids_;
};

}  // namespace

bool is_image_path(const std::string& path) { return fs::is_directory(path) || is_image_file(path); }

FiberAtlas atlas_of_voxels(std::string name, const Mask& muscle, const Volume<Vec3>& axis) {
  const Voxels voxels = in_blocks(muscle, axis);
  CubeMesh mesh(voxels.muscle.grid);
  const auto& size = voxels.muscle.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i)
        if (voxels.muscle(i, j, k)) mesh.add(i, j, k, voxels.axis(i, j, k));
  const auto at_points = mean_point_axes(mesh.points_mm.size(), mesh.cells, mesh.axes);
  auto atlas = make_fiber_atlas(std::move(name), std::move(mesh.points_mm), std::move(mesh.cells), at_points);
  atlas.cell_fiber = std::move(mesh.axes);
  return atlas;
}

FiberAtlas read_voxel_atlas(const std::string& path) {
  const Files files = fs::is_directory(path) ? files_in(path) : Files{{}, path, {}};
  const auto axis =
      axes_of(files.fiber.empty() ? joined(files.component) : adapters::read_components(files.fiber), path);
  const fs::path plain = fs::path(path).has_filename() ? fs::path(path) : fs::path(path).parent_path();
  return atlas_of_voxels(plain.filename().string(), muscle_of(files.mask, axis), axis);
}

}  // namespace heartgen::atlas
