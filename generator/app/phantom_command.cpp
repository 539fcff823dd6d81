// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <heartgen/phantom.hpp>
#include <nlohmann/json.hpp>

#include "generator/adapters/image_checks.hpp"
#include "generator/app/commands.hpp"

namespace heartgen::app {

namespace fs = std::filesystem;

int phantom_command(const PhantomCommand& command) {
  adapters::check_size(command.size, "--size", true);
  phantom::PhantomSettings settings;
  settings.size = command.size;
  settings.spacing_mm = command.spacing_mm;
  settings.variant = command.variant;
  settings.noise_hu = command.noise_hu;
  settings.overrides = command.heart;
  const fs::path folder = command.folder, recipe = folder / "recipe.toml";
  write_phantom(folder, settings);
  if (command.json)
    fmt::print("{}\n", nlohmann::ordered_json{{"folder", folder.string()}, {"recipe", recipe.string()}}.dump(1));
  else
    fmt::print("{}\nbuild it with: heartgen build {} --output {}\n", folder.string(), recipe.string(),
               (folder.parent_path() / "bundle").string());
  return 0;
}

}  // namespace heartgen::app
