// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "generator/image/distance.hpp"
#include "generator/labels/contacts.hpp"
#include "generator/labels/swapped_labels.hpp"
#include "model/crop.hpp"
#include "model/error.hpp"
#include "model/priors.hpp"
#include "model/tissue.hpp"

namespace heartgen::labels {
namespace {

std::array<double, 256> volumes_ml(const LabelVolume& labels) {
  std::array<double, 256> ml{};
  for (const auto label : labels.voxels) ml[label] += labels.grid.voxel_volume_mm3() / 1000;
  return ml;
}

/// Two cavities of one heart, and how many times the other's volume one can have.
struct Companions {
  Region one, other;
  const Number* most;
};

constexpr std::array companions = {Companions{Region::lv_blood, Region::rv_blood, &priors::lv_to_rv_volume_max},
                                   Companions{Region::la_blood, Region::lv_blood, &priors::la_to_lv_volume_max},
                                   Companions{Region::ra_blood, Region::rv_blood, &priors::ra_to_rv_volume_max}};

/// The first pair that no heart has; null where there is none.
const Companions* mismatch_in(const std::array<double, 256>& ml) {
  for (const auto& pair : companions) {
    const double one = ml[tag(pair.one)], other = ml[tag(pair.other)];
    if (one > 0 && other > 0 && std::max(one, other) > *pair.most * std::min(one, other)) return &pair;
  }
  return nullptr;
}

bool is_exchanged(const LabelVolume& labels) {
  try {
    refuse_exchanged_regions(labels, "");
  } catch (const UserError&) {
    return true;
  }
  return false;
}

std::set<std::int32_t> values_in(const adapters::LabelImage& image) {
  std::set<std::int32_t> values;
  for (const auto& layer : image.layers) values.merge(labels::values_in(layer));
  return values;
}

LabelVolume read_with(const adapters::LabelImage& image, const LabelPreset& preset) {
  LabelVolume labels(image.layers.front().grid);
  for (const auto& layer : image.layers)
    std::transform(layer.voxels.begin(), layer.voxels.end(), labels.voxels.begin(), labels.voxels.begin(),
                   [&](std::int32_t value, std::uint8_t before) {
                     return value == 0 ? before : tag(preset.values.at(value).region);
                   });
  return labels;
}

std::string listed(const std::set<std::int32_t>& values) {
  constexpr std::size_t most = 9;
  if (values.size() <= most) return fmt::format("{}", fmt::join(values, ", "));
  return fmt::format("{} to {}", *values.begin(), *values.rbegin());
}

double median_of(std::vector<std::int16_t>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<std::int16_t> grey_of(const LabelVolume& labels, const CtVolume& ct, Region region) {
  std::vector<std::int16_t> values;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    if (labels.voxels[v] == tag(region)) values.push_back(ct.voxels[v]);
  return values;
}

constexpr const char* same_patient =
    "are both of the same patient, and in the same frame? RAS taken for LPS turns x and y round";

/// Where the blood is enhanced, hardly any of the wall is as bright.
void refuse_bright_wall(const LabelVolume& labels, const CtVolume& ct, const std::string& path) {
  constexpr double most = 0.3;
  auto blood = grey_of(labels, ct, Region::lv_blood), wall = grey_of(labels, ct, Region::lv_myocardium);
  if (blood.empty() || wall.empty()) return;
  const double blood_hu = median_of(blood);
  std::sort(wall.begin(), wall.end());
  const double low_hu = wall[wall.size() / 4];
  if (blood_hu - low_hu < tissue::blood_enhanced_hu) return;
  const auto limit = static_cast<std::int16_t>(0.5 * (blood_hu + low_hu));
  const auto bright = static_cast<double>(wall.end() - std::upper_bound(wall.begin(), wall.end(), limit));
  const double share = bright / static_cast<double>(wall.size());
  if (share > most)
    throw UserError(fmt::format("{:.0f} % of lv_myocardium is as bright as blood in the CT", 100 * share), path,
                    same_patient);
}

}  // namespace

std::set<std::int32_t> values_in(const Volume<std::int32_t>& layer) {
  std::set<std::int32_t> values;
  std::int32_t last = 0;
  for (const auto value : layer.voxels)
    if (value != last && value != 0) values.insert(last = value);
  return values;
}

bool looks_like_heart(const LabelVolume& labels) {
  constexpr double min_share = 0.4;  // of the blood's surface; valves and papillary muscle take the rest
  using enum Region;
  const auto contacts = contacts_in(labels);
  const double all = contacts.all(lv_blood), wall = contacts.of(lv_blood, lv_myocardium);
  return all > 0 && wall + contacts.of(lv_blood, papillary) > min_share * all && wall > 0 &&
         mismatch_in(volumes_ml(labels)) == nullptr && !is_exchanged(labels);
}

std::vector<std::string> fitting_presets(const adapters::LabelImage& image) {
  const auto values = values_in(image);
  std::vector<std::string> fitting;
  for (const auto& preset : label_presets()) {
    const bool knows_all =
        std::all_of(values.begin(), values.end(), [&](std::int32_t value) { return preset.values.contains(value); });
    if (knows_all && looks_like_heart(read_with(image, preset))) fitting.emplace_back(preset.name);
  }
  return fitting;
}

std::string fitting_preset(const adapters::LabelImage& image) {
  const auto fitting = fitting_presets(image);
  return fitting.empty() ? "" : fitting.front();
}

void refuse_another_task(const adapters::LabelImage& image, const LabelVolume& labels, const LabelPreset& preset,
                         const std::string& path) {
  if (looks_like_heart(labels)) return;
  const std::string other = fitting_preset(image);
  if (other.empty()) return;
  throw UserError(
      fmt::format("holds no heart with the preset \"{}\", but one with the preset \"{}\" (its values are {})",
                  preset.name, other, listed(values_in(image))),
      path, "name the values in [labels.regions]");
}

void refuse_no_heart(const LabelVolume& labels, const std::string& path) {
  const auto ml = volumes_ml(labels);
  if (const auto* pair = mismatch_in(ml); pair != nullptr && ml[tag(Region::lv_myocardium)] > 0) {
    const bool first_is_small = ml[tag(pair->one)] < ml[tag(pair->other)];
    const auto small = tag(first_is_small ? pair->one : pair->other);
    const auto large = tag(first_is_small ? pair->other : pair->one);
    throw UserError(fmt::format("{} holds {:.2g} ml beside {} of {:.3g} ml: no heart has such chambers",
                                region_name(small), ml[small], region_name(large), ml[large]),
                    path, "check labels.preset and [labels.regions]: the numbers may be another task's");
  }
  refuse_exchanged_regions(labels, path);
}

void refuse_labels_beside_heart(const LabelVolume& labels, const CtVolume& ct, const std::string& path) {
  constexpr double most = 0.1;  // of true labels, a hundredth: partial volumes at the lungs
  std::int64_t heart = 0, in_air = 0;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    const auto region = static_cast<Region>(labels.voxels[v]);
    if (!is_myocardium(region) && !is_blood(region)) continue;
    ++heart;
    in_air += ct.voxels[v] < tissue::heart_label_air_max_hu;
  }
  const double share = heart == 0 ? 0 : static_cast<double>(in_air) / static_cast<double>(heart);
  if (share > most)
    throw UserError(fmt::format("{:.0f} % of the labels' heart lies in air or lung of the CT", 100 * share), path,
                    same_patient);
  refuse_bright_wall(labels, ct, path);
}

void refuse_organs_in_heart(const LabelVolume& given, const LabelVolume& chambers, const std::string& path) {
  constexpr double most = 0.04;  // of the zone: true organs reach no heart
  const Box box = bounding_box(chambers, 4, [](std::uint8_t label) { return is_blood(static_cast<Region>(label)); });
  if (box.empty()) return;
  const LabelVolume found = crop(chambers, box), organs = crop(given, box);
  Mask left(found.grid);
  std::transform(found.voxels.begin(), found.voxels.end(), left.voxels.begin(),
                 [](std::uint8_t label) { return static_cast<std::uint8_t>(label == tag(Region::lv_blood)); });
  const auto distance = image::distance_to(left);
  double zone = 0;
  std::array<double, 256> inside{};
  for (std::size_t v = 0; v < found.voxels.size(); ++v) {
    if (!is_blood(static_cast<Region>(found.voxels[v])) && distance.voxels[v] > priors::lv_surroundings_mm) continue;
    ++zone;
    ++inside[organs.voxels[v]];
  }
  for (const Region organ : {Region::liver, Region::bone, Region::lung, Region::trachea})
    if (inside[tag(organ)] > most * zone)
      throw UserError(
          fmt::format("{:.0f} % of the given {} lies in the heart that was found in the CT",
                      100 * inside[tag(organ)] /
                          static_cast<double>(std::count(given.voxels.begin(), given.voxels.end(), tag(organ))),
                      region_name(tag(organ))),
          path, "check labels.preset and [labels.regions]: the numbers may be another task's");
}

}  // namespace heartgen::labels
