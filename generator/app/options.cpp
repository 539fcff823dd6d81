#include "generator/app/options.hpp"

#include "generator/labels/presets.hpp"

namespace heartgen::app {

std::string preset_names() {
  std::string names;
  for (const auto& preset : labels::label_presets()) names += (names.empty() ? "" : ", ") + std::string(preset.name);
  return names;
}

}  // namespace heartgen::app
