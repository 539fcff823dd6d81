// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Warnings and verdicts on uses as JSON, the same in metrics.json and in the manifest. nlohmann::json finds these
/// functions by their arguments.
#pragma once
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/certificate.hpp"

namespace heartgen {

/// Throws std::invalid_argument for a word that is none of `names`.
template <class Enum, std::size_t N>
Enum enum_from(const std::string& word, const std::array<std::string_view, N>& names) {
  const auto at = std::find(names.begin(), names.end(), word);
  if (at == names.end()) throw std::invalid_argument("unknown word \"" + word + "\"");
  return static_cast<Enum>(at - names.begin());
}

template <class Enum, std::size_t N>
std::string_view name_of(Enum value, const std::array<std::string_view, N>& names) {
  return names.at(static_cast<std::size_t>(value));
}

template <class Json>
void to_json(Json& json, const Warning& warning) {
  json = {{"code", warning.code}, {"level", name_of(warning.level, warning_level_names)}, {"text", warning.text}};
}

template <class Json>
void from_json(const Json& json, Warning& warning) {
  json.at("code").get_to(warning.code);
  warning.level = enum_from<WarningLevel>(json.at("level").template get<std::string>(), warning_level_names);
  json.at("text").get_to(warning.text);
}

template <class Json>
void to_json(Json& json, const UseVerdict& use) {
  json = {{"use", use.use},
          {"fitness", name_of(use.fitness, fitness_names)},
          {"asked", use.is_asked},
          {"reasons", use.reasons},
          {"remedy", use.remedy}};
}

template <class Json>
void from_json(const Json& json, UseVerdict& use) {
  json.at("use").get_to(use.use);
  use.fitness = enum_from<Fitness>(json.at("fitness").template get<std::string>(), fitness_names);
  json.at("asked").get_to(use.is_asked);
  json.at("reasons").get_to(use.reasons);
  json.at("remedy").get_to(use.remedy);
}

}  // namespace heartgen
