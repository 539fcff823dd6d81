// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/inpaint_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "generator/adapters/itk_io.hpp"
#include "generator/fibers/inpaint_grid.hpp"
#include "generator/labels/given_labels.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heartgen::app {
namespace {

namespace fs = std::filesystem;

constexpr std::array file_names{"fiber_x.nrrd", "fiber_y.nrrd", "fiber_z.nrrd"};

struct Input {
  Volume<Vec3> fiber;
  Mask wall;
};

std::string path_in(const std::string& folder, std::size_t axis) {
  return (fs::path(folder) / file_names[axis]).string();
}

Volume<Vec3> read_fibers(const InpaintCommand& command, const Grid& grid) {
  Volume<Vec3> fiber(grid);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto path = path_in(command.input, axis);
    const auto component = adapters::read_image(path);
    if (!labels::same_place(component.grid, grid))
      throw UserError("does not lie on the label map's grid", path, "give both with one size, spacing and origin");
    for (std::size_t v = 0; v < fiber.voxels.size(); ++v) fiber.voxels[v][static_cast<int>(axis)] = component.voxels[v];
  }
  for (Vec3& f : fiber.voxels) f = normalized(f);
  return fiber;
}

Input read_input(const InpaintCommand& command) {
  if (command.iterations < 0 || command.iterations > 100000)
    throw UserError("the number of iterations is out of range", "--iterations", "give 0 to 100000");
  std::vector<std::uint8_t> wanted;
  for (const auto& name : command.regions) {
    const auto region = region_from_name(name);
    if (!region) throw UserError("unknown region \"" + name + "\"", "--regions", "`heartgen info` lists the names");
    wanted.push_back(static_cast<std::uint8_t>(tag(*region)));
  }
  const auto labels = adapters::read_labels(command.labels);
  Input input{read_fibers(command, labels.grid), Mask(labels.grid)};
  std::int64_t known = 0;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    input.wall.voxels[v] = std::find(wanted.begin(), wanted.end(), labels.voxels[v]) != wanted.end();
    known += input.wall.voxels[v] && norm(input.fiber.voxels[v]) > 0.5;
  }
  if (known == 0) throw UserError("no voxel of the regions has a fibre", command.input, "is it the same heart?");
  return input;
}

struct Counts {
  std::int64_t filled = 0, unreached = 0;
};

Counts counts_of(const Input& before, const Volume<Vec3>& after) {
  Counts counts;
  for (std::size_t v = 0; v < after.voxels.size(); ++v) {
    if (!before.wall.voxels[v] || norm(before.fiber.voxels[v]) > 0.5) continue;
    ++(norm(after.voxels[v]) > 0.5 ? counts.filled : counts.unreached);
  }
  return counts;
}

void write(const InpaintCommand& command, const Volume<Vec3>& fiber) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Volume<float> component(fiber.grid);
    for (std::size_t v = 0; v < component.voxels.size(); ++v)
      component.voxels[v] = static_cast<float>(fiber.voxels[v][static_cast<int>(axis)]);
    adapters::write_volume(path_in(command.output, axis), component);
  }
}

}  // namespace

int inpaint_command(const InpaintCommand& command, const parallel::Comm& comm) {
  const auto input = parallel::run_on_root(comm, [&] {
    for (std::size_t axis = 0; axis < 3; ++axis) adapters::check_image_output(path_in(command.output, axis));
    return read_input(command);
  });
  const auto filled = fibers::inpaint_axes(input.fiber, input.wall, command.iterations, comm);
  parallel::run_on_root(comm, [&] {
    write(command, filled);
    const auto [count, unreached] = counts_of(input, filled);
    if (command.json)
      fmt::print("{}\n", nlohmann::ordered_json{{"filled", count}, {"unreached", unreached}}.dump(1));
    else
      fmt::print("{} voxels filled, {} that no known one can be reached from\n", count, unreached);
  });
  return 0;
}

}  // namespace heartgen::app
