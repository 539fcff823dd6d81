// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/judge.hpp"

#include <algorithm>
#include <span>

namespace heartgen::landmarks {
namespace {

using Names = std::span<const char* const>;

constexpr const char* left_pools[] = {"lv_blood", "la_blood", "aorta"};
constexpr const char* right_pools[] = {"rv_blood", "ra_blood", "pulmonary_artery"};
constexpr const char* left_valves[] = {"mitral", "aortic"};
constexpr const char* right_valves[] = {"tricuspid", "pulmonary"};

bool holds_all(const auto& map, Names names) {
  return std::all_of(names.begin(), names.end(), [&](const char* name) { return map.contains(name); });
}

auto count_supplied(const auto& found, const auto& given, Names names) {
  return std::count_if(names.begin(), names.end(),
                       [&](const char* name) { return !found.contains(name) && given.contains(name); });
}

}  // namespace

double confidence_beside(const FoundLandmarks& found, const Landmarks& given) {
  const auto& own = found.landmarks;
  auto supplied =
      count_supplied(own.seeds_mm, given.seeds_mm, left_pools) + count_supplied(own.valves, given.valves, left_valves);
  double confidence = found.confidence;
  if (own.seeds_mm.contains("rv_blood"))
    supplied += count_supplied(own.seeds_mm, given.seeds_mm, right_pools) +
                count_supplied(own.valves, given.valves, right_valves);
  else if (holds_all(given.seeds_mm, right_pools) && holds_all(given.valves, right_valves))
    confidence /= missing_half_keeps;
  for (; supplied > 0; --supplied) confidence /= missing_keeps;
  return std::min(confidence, 1.0);
}

Trust trust_in(double confidence) {
  if (confidence < min_confidence) return Trust::doubtful;
  return confidence < min_sound_confidence ? Trust::uncertain : Trust::sound;
}

}  // namespace heartgen::landmarks
