// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/options.hpp"

#include <utility>
#include <vector>

#include "generator/labels/presets.hpp"

namespace heartgen::app {

std::string preset_names() {
  std::string names;
  for (const auto& preset : labels::label_presets()) names += (names.empty() ? "" : ", ") + std::string(preset.name);
  return names;
}

void add_commands(Program& p) {
  add_bundle_options(p);
  add_tool_options(p);
  group_by_road(p);
}

void group_by_road(Program& p) {
  const std::pair<const char*, std::vector<const char*>> roads[]{
      {"You have a scan, or labels of it", {"build", "landmarks", "place"}},
      {"You have a bundle", {"get", "info", "verify", "validate", "report", "export", "transfer", "pack", "unpack"}},
      {"You have a label map or a mesh", {"mesh", "improve", "slice"}},
      {"You have an image", {"filter", "contours", "segment", "inpaint"}},
      {"You have nothing yet", {"phantom", "selftest"}}};
  for (const auto& [road, commands] : roads)
    for (const auto* command : commands) p.line.app.get_subcommand(command)->group(road);
}

}  // namespace heartgen::app
