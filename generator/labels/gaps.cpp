// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/gaps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/labels/contacts.hpp"
#include "model/crop.hpp"
#include "model/priors.hpp"
#include "model/tissue.hpp"

namespace heartgen::labels {
namespace {

constexpr double gap_voxels = 2;

double coarsest_mm(const Grid& grid) { return std::max({grid.spacing_mm.x, grid.spacing_mm.y, grid.spacing_mm.z}); }

/// What a valve's surroundings are made of.
struct Scene {
  LabelVolume chambers, given;
  CtVolume ct;  ///< without voxels: none, or one that does not tell blood from muscle
  double muscle_hu = 0;
};

std::optional<double> median_hu(const CtVolume& ct, const auto& accept) {
  std::vector<double> values;
  for (std::size_t v = 0; v < ct.voxels.size(); ++v)
    if (accept(v)) values.push_back(ct.voxels[v]);
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of the given wall, else of what lies around the left ventricle's blood.
std::optional<double> muscle_of(const Scene& scene) {
  const auto given =
      median_hu(scene.ct, [&](std::size_t v) { return scene.given.voxels[v] == tag(Region::lv_myocardium); });
  if (given) return given;
  const auto distance = image::distance_to(image::mask_of(scene.chambers, Region::lv_blood));
  return median_hu(scene.ct, [&](std::size_t v) {
    return scene.chambers.voxels[v] == 0 && distance.voxels[v] > priors::given_muscle_from_mm &&
           distance.voxels[v] < priors::given_muscle_to_mm;
  });
}

/// The grey value midway between a pair's blood and muscle; none where the CT does not tell them apart.
std::optional<double> min_blood_hu(const Scene& scene, const ValvePair& pair) {
  if (scene.ct.voxels.empty()) return std::nullopt;
  const auto blood = median_hu(scene.ct, [&](std::size_t v) {
    return scene.chambers.voxels[v] == tag(pair.from) || scene.chambers.voxels[v] == tag(pair.to);
  });
  if (!blood || *blood - scene.muscle_hu < tissue::valve_contrast_min_hu) return std::nullopt;
  return 0.5 * (*blood + scene.muscle_hu);
}

/// Only pieces that touch both regions.
Mask bridges_of(const Mask& between, const LabelVolume& chambers, const ValvePair& pair) {
  const auto parts = image::connected_components(between);
  std::vector<std::array<bool, 2>> touches(parts.voxel_count.size(), {false, false});
  const auto& size = between.grid.size;
  const auto look = [&](std::size_t v, std::size_t other) {
    auto& piece = touches[static_cast<std::size_t>(parts.label.voxels[v])];
    piece[0] |= chambers.voxels[other] == tag(pair.from);
    piece[1] |= chambers.voxels[other] == tag(pair.to);
  };
  const std::array<std::size_t, 3> step{1, static_cast<std::size_t>(size[0]),
                                        static_cast<std::size_t>(size[0] * size[1])};
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        const std::array<bool, 3> has_next{i + 1 < size[0], j + 1 < size[1], k + 1 < size[2]};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if (!has_next[axis]) continue;
          look(v, v + step[axis]);
          look(v + step[axis], v);
        }
      }
  Mask result(between.grid);
  for (std::size_t n = 0; n < result.voxels.size(); ++n) {
    const auto piece = static_cast<std::size_t>(parts.label.voxels[n]);
    result.voxels[n] = piece > 0 && touches[piece][0] && touches[piece][1];
  }
  return result;
}

/// Of every voxel, the sum of its distances to both regions.
Volume<float> width_between(const Volume<float>& from, const Volume<float>& to) {
  Volume<float> width(from.grid);
  std::transform(from.voxels.begin(), from.voxels.end(), to.voxels.begin(), width.voxels.begin(), std::plus<>());
  return width;
}

/// How far apart a pair may be at a voxel for that to be a gap; none where the valve is open, or the pair is far apart.
std::optional<double> max_width_mm(const Scene& scene, const Volume<float>& width, bool is_seen) {
  const double voxel_mm = coarsest_mm(scene.chambers.grid), gap_mm = (gap_voxels + 1) * voxel_mm;
  const auto narrowest = static_cast<double>(*std::min_element(width.voxels.begin(), width.voxels.end()));
  const double max_mm =
      is_seen ? std::max<double>(priors::valve_gap_max_mm, gap_mm) : std::min(gap_mm, narrowest + voxel_mm);
  return narrowest <= max_mm ? std::optional(max_mm) : std::nullopt;
}

void close_gap(Scene& scene, const ValvePair& pair) {
  if (contacts_in(scene.chambers).of(pair.from, pair.to) >= pair.open_mm2) return;
  const auto from = image::distance_to(image::mask_of(scene.chambers, pair.from));
  const auto to = image::distance_to(image::mask_of(scene.chambers, pair.to));
  const auto width = width_between(from, to);
  const auto blood_hu = min_blood_hu(scene, pair);
  const auto max_mm = max_width_mm(scene, width, blood_hu.has_value());
  if (!max_mm) return;
  Mask between(scene.chambers.grid);
  for (std::size_t v = 0; v < between.voxels.size(); ++v) {
    const auto given = scene.given.voxels[v];
    const bool is_free = scene.chambers.voxels[v] == 0 && (given == 0 || given == tag(Region::torso));
    const bool is_blood_there = !blood_hu || scene.ct.voxels[v] >= *blood_hu;
    between.voxels[v] = is_free && is_blood_there && static_cast<double>(width.voxels[v]) <= *max_mm;
  }
  const Mask bridges = bridges_of(between, scene.chambers, pair);
  for (std::size_t v = 0; v < bridges.voxels.size(); ++v)
    if (bridges.voxels[v]) scene.chambers.voxels[v] = tag(from.voxels[v] <= to.voxels[v] ? pair.from : pair.to);
}

bool occurs(const LabelVolume& labels, Region region) {
  return std::find(labels.voxels.begin(), labels.voxels.end(), tag(region)) != labels.voxels.end();
}

}  // namespace

std::vector<ValvePair> valve_pairs() {
  using enum Region;
  return {{la_blood, lv_blood, "mitral_orifice", priors::mitral_open_mm2},
          {lv_blood, aorta, "aortic_orifice", priors::aortic_open_mm2},
          {ra_blood, rv_blood, "tricuspid_orifice", priors::tricuspid_open_mm2},
          {rv_blood, pulmonary_artery, "pulmonary_orifice", priors::pulmonary_open_mm2}};
}

LabelVolume with_closed_gaps(LabelVolume chambers, const LabelVolume& given, const CtVolume* ct) {
  constexpr std::int64_t margin = 8;  // voxels: what lies around the left ventricle tells muscle's grey value
  if (given.voxels.empty()) return chambers;
  const Box box =
      bounding_box(chambers, margin, [](std::uint8_t label) { return is_blood(static_cast<Region>(label)); });
  if (box.empty()) return chambers;
  Scene scene{crop(chambers, box), crop(given, box), {}, 0};
  if (ct != nullptr && !ct->voxels.empty()) {
    scene.ct = crop(*ct, box);
    const auto muscle = muscle_of(scene);
    if (muscle) scene.muscle_hu = *muscle;
    if (!muscle) scene.ct = {};
  }
  for (const auto& pair : valve_pairs()) {
    const bool is_given = occurs(scene.given, pair.from) || occurs(scene.given, pair.to);
    if (is_given && occurs(scene.chambers, pair.from) && occurs(scene.chambers, pair.to)) close_gap(scene, pair);
  }
  paste(scene.chambers, box, chambers);
  return chambers;
}

std::vector<Warning> closed_valves(const LabelVolume& heart) {
  constexpr double narrow = 0.5;  // of half an adult's annulus
  const auto contacts = contacts_in(heart);
  const auto is_there = [&](Region region) { return contacts.is_there[tag(region)]; };
  std::vector<Warning> warnings;
  for (const auto& pair : valve_pairs()) {
    const std::string from = region_name(tag(pair.from)), to = region_name(tag(pair.to));
    if (!is_there(pair.from)) continue;
    if (const double mm2 = contacts.of(pair.from, pair.to); mm2 == 0)
      warnings.push_back({"labels.no_outlet", WarningLevel::warning,
                          is_there(pair.to)
                              ? fmt::format("{} is missing: {} and {} do not touch.", pair.orifice, from, to)
                              : fmt::format("{} is missing: without {}, {} has no outlet.", pair.orifice, to, from)});
    else if (mm2 < narrow * pair.open_mm2)
      warnings.push_back({"labels.narrow_valve", WarningLevel::warning,
                          fmt::format("{} is narrow: {} and {} touch over {:.0f} mm2 of the label map only.",
                                      pair.orifice, from, to, mm2)});
  }
  return warnings;
}

}  // namespace heartgen::labels
