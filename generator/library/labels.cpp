// SPDX-License-Identifier: GPL-3.0-or-later
#include <heartgen/labels.hpp>
#include <utility>

#include "generator/labels/given_labels.hpp"
#include "generator/labels/presets.hpp"
#include "model/recipe.hpp"

namespace heartgen {

LabelMap read_label_map(const std::string& path, const std::string& preset, const std::string& names) {
  InputSettings input;
  input.labels = path;
  input.label_names = names;
  LabelSettings settings;
  settings.preset = preset;
  auto given = labels::read_given_labels(input, settings, nullptr);
  return {std::move(given.labels), std::move(given.warnings)};
}

std::vector<std::string> label_preset_names() {
  std::vector<std::string> names;
  for (const auto& preset : labels::label_presets()) names.emplace_back(preset.name);
  return names;
}

}  // namespace heartgen
