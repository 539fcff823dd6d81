// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/given_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "generator/adapters/itk_io.hpp"
#include "generator/labels/islands.hpp"
#include "generator/labels/judge.hpp"
#include "generator/labels/names_file.hpp"
#include "generator/labels/presets.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace heartgen::labels {
namespace {

namespace fs = std::filesystem;
using ValueNames = std::map<std::int32_t, std::string>;

constexpr const char* remedy = "map it in [labels.regions], or name it in labels.ignore";

/// What a value or a name means: the user's word, then the preset's.
struct Dictionary {
  const LabelPreset* preset = nullptr;
  std::map<std::string, Region> user;  // plain name or number as text
  std::set<std::string> ignored;       // the same
  bool ignore_unknown = false;
};

Dictionary dictionary_of(const LabelSettings& settings) {
  Dictionary dictionary;
  dictionary.preset = &label_preset(settings.preset);
  for (const auto& [name, values] : settings.regions)
    for (const auto& key : values.keys) {
      const auto [at, fresh] = dictionary.user.emplace(plain_name(key), *region_from_name(name));
      if (!fresh && at->second != *region_from_name(name))
        throw UserError(fmt::format("\"{}\" stands for two regions", key), "labels.regions." + name,
                        "keep it in one of them");
    }
  for (const auto& key : settings.ignore.keys) {
    dictionary.ignore_unknown |= key == "*";
    dictionary.ignored.insert(plain_name(key));
  }
  return dictionary;
}

const Region* user_word(const Dictionary& dictionary, const std::string& plain) {
  static constexpr Region nothing = Region::none;
  const auto mapped = dictionary.user.find(plain);
  if (mapped != dictionary.user.end()) return &mapped->second;
  return dictionary.ignored.contains(plain) ? &nothing : nullptr;
}

/// What names and values mean, and those that nobody knows.
struct Meanings {
  const Dictionary& dictionary;
  std::vector<std::string> unknown_names{};
  std::vector<std::int32_t> unknown_values{};

  Region of_name(const std::string& name) {
    if (const Region* region = user_word(dictionary, plain_name(name))) return *region;
    if (const auto region = region_of_name(*dictionary.preset, name)) return *region;
    if (!dictionary.ignore_unknown) unknown_names.push_back(name);
    return Region::none;
  }
  /// Names that the file or the user gives go before the preset's; the user may map or ignore all of them.
  Region of_value(std::int32_t value, const ValueNames& names) {
    if (const Region* region = user_word(dictionary, std::to_string(value))) return *region;
    if (const auto name = names.find(value); name != names.end()) return of_name(name->second);
    const auto known = dictionary.preset->values.find(value);
    if (known != dictionary.preset->values.end()) return of_name(known->second.name);
    if (!dictionary.ignore_unknown) unknown_values.push_back(value);
    return Region::none;
  }
};

/// For the first few names, the nearest that are known.
std::string suggestions(const Dictionary& dictionary, const std::vector<std::string>& unknown) {
  constexpr std::size_t max_suggested = 3;
  std::vector<std::string> names, nearest;
  for (const auto& [candidate, region] : dictionary.preset->names) names.push_back(candidate);
  for (const auto& [candidate, region] : dictionary.user) names.push_back(candidate);
  for (const auto& name : unknown)
    if (auto known = nearest_name(plain_name(name), names); !known.empty() && nearest.size() < max_suggested)
      nearest.push_back(fmt::format("\"{}\"", known));
  return nearest.empty() ? remedy : fmt::format("did you mean {}? else {}", fmt::join(nearest, ", "), remedy);
}

/// All of them at once.
void refuse_unknown(const Meanings& meanings, const std::string& where) {
  const auto& [dictionary, names, values] = meanings;
  const std::string preset = dictionary.preset->name == automatic_preset
                                 ? std::string("no preset knows")
                                 : fmt::format("the preset \"{}\" does not know", dictionary.preset->name);
  if (!names.empty()) {
    const bool is_one = names.size() == 1;
    throw UserError(
        fmt::format("holds the structure{} \"{}\", which {}", is_one ? "" : "s", fmt::join(names, "\", \""), preset),
        where, suggestions(dictionary, names));
  }
  if (!values.empty())
    throw UserError(
        fmt::format("holds the value{} {}, which {}", values.size() == 1 ? "" : "s", fmt::join(values, ", "), preset),
        where, remedy);
}

/// Structures that overlap: the higher rank stays.
int rank(Region region) {
  constexpr std::array<Region, 18> order = {Region::none,
                                            Region::torso,
                                            Region::lung,
                                            Region::liver,
                                            Region::bone,
                                            Region::trachea,
                                            Region::carotid,
                                            Region::ra_wall,
                                            Region::la_wall,
                                            Region::rv_myocardium,
                                            Region::lv_myocardium,
                                            Region::aorta,
                                            Region::pulmonary_artery,
                                            Region::ra_blood,
                                            Region::la_blood,
                                            Region::rv_blood,
                                            Region::lv_blood,
                                            Region::papillary};
  return static_cast<int>(std::find(order.begin(), order.end(), region) - order.begin());
}

void paint(LabelVolume& labels, std::size_t voxel, Region region) {
  if (rank(region) > rank(static_cast<Region>(labels.voxels[voxel]))) labels.voxels[voxel] = tag(region);
}

/// Paints every value of a layer by what `meaning` says of it; asked once for each value that occurs.
template <class Meaning>
void paint_layer(LabelVolume& labels, const Volume<std::int32_t>& layer, Meaning meaning) {
  std::map<std::int32_t, Region> regions;
  std::int32_t last = 0;
  Region region = Region::none;
  for (std::size_t v = 0; v < layer.voxels.size(); ++v) {
    const std::int32_t value = layer.voxels[v];
    if (value == 0) continue;
    if (value != last) {
      last = value;
      const auto known = regions.find(value);
      region = known != regions.end() ? known->second : regions[value] = meaning(value);
    }
    if (region != Region::none) paint(labels, v, region);
  }
}

/// Names that a layer's values have: the user's, then the file's.
ValueNames names_in_layer(const adapters::LabelImage& image, std::size_t layer, const ValueNames& given) {
  ValueNames names = given;
  for (const auto& segment : image.segments)
    if (segment.layer == layer) names.emplace(segment.value, segment.name);
  return names;
}

LabelVolume paint_layers(const adapters::LabelImage& image, const std::string& path, const Dictionary& dictionary,
                         const ValueNames& names) {
  LabelVolume labels(image.layers.front().grid);
  Meanings meanings{dictionary};
  for (std::size_t layer = 0; layer < image.layers.size(); ++layer) {
    const auto names_here = names_in_layer(image, layer, names);
    paint_layer(labels, image.layers[layer], [&](std::int32_t value) { return meanings.of_value(value, names_here); });
  }
  refuse_unknown(meanings, path);
  return labels;
}

/// Of the values that occur; empty where one has none.
std::vector<std::string> names_in(const adapters::LabelImage& image, const ValueNames& given) {
  std::set<std::string> names;
  for (std::size_t layer = 0; layer < image.layers.size(); ++layer) {
    const auto names_here = names_in_layer(image, layer, given);
    for (const auto value : values_in(image.layers[layer])) {
      const auto name = names_here.find(value);
      if (name == names_here.end()) return {};
      names.insert(name->second);
    }
  }
  return {names.begin(), names.end()};
}

/// A preset that is recognised, and by what.
struct Recognised {
  const LabelPreset* preset = nullptr;
  const char* by = "";
};

/// Names tell; where a value has none, the values and where they lie do. Our own numbers where nothing else fits: they
/// may be a part of a heart.
Recognised recognise(const adapters::LabelImage& image, const ValueNames& names, const std::string& path) {
  if (const auto* preset = preset_for_names(names_in(image, names))) return {preset, "its names"};
  const auto fitting = fitting_presets(image);
  if (fitting.size() > 1)
    throw UserError(fmt::format("makes a heart with each of the presets {}", fmt::join(fitting, ", ")), path,
                    "choose one of them with --preset");
  if (!fitting.empty()) return {&label_preset(fitting.front()), "its values and where they lie"};
  return {&label_preset("heartgen"), "its values"};
}

/// Whatever is wrong with numbers that nobody has named: another preset may make a heart of them.
LabelVolume labels_of_unnamed(const adapters::LabelImage& image, const std::string& path,
                              const Dictionary& dictionary) {
  try {
    LabelVolume labels = paint_layers(image, path, dictionary, {});
    refuse_another_task(image, labels, *dictionary.preset, path);
    return labels;
  } catch (const UserError& error) {
    const std::string other = fitting_preset(image);
    if (other.empty() || other == dictionary.preset->name) throw;
    throw UserError(error.problem, error.where, fmt::format("use --preset {}, or {}", other, error.remedy));
  }
}

Warning preset_note(const Recognised& recognised) {
  return {"labels.preset", WarningLevel::note,
          fmt::format("The given labels are read with the preset \"{}\", recognised by {}.", recognised.preset->name,
                      recognised.by)};
}

GivenLabels labels_of_image(const std::string& path, Dictionary dictionary, const ValueNames& names) {
  const adapters::LabelImage image = adapters::read_label_image(path);
  GivenLabels given;
  if (dictionary.preset->name == automatic_preset) {
    const auto recognised = recognise(image, names, path);
    dictionary.preset = recognised.preset;
    given.warnings.push_back(preset_note(recognised));
  }
  const bool is_named = !names.empty() || !image.segments.empty();
  given.labels = is_named || !dictionary.user.empty() || !dictionary.ignored.empty()
                     ? paint_layers(image, path, dictionary, names)
                     : labels_of_unnamed(image, path, dictionary);
  return given;
}

/// "heart_atrium_left" of "heart_atrium_left.nii.gz"; empty for a file that is no image.
std::string structure_of_file(const fs::path& file) {
  const std::string name = file.filename().string();
  for (const char* ending : {".nii.gz", ".nii", ".seg.nrrd", ".nrrd", ".mha", ".mhd"})
    if (name.ends_with(ending)) return name.substr(0, name.size() - std::string_view(ending).size());
  return "";
}

std::vector<fs::path> masks_in(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && !structure_of_file(entry.path()).empty()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw UserError("holds no image", folder, "give a folder with one mask per structure");
  return files;
}

/// Of structures that the user has not named himself.
Recognised recognise(const std::vector<fs::path>& files, const Dictionary& dictionary) {
  std::vector<std::string> names;
  for (const auto& file : files)
    if (!user_word(dictionary, plain_name(structure_of_file(file)))) names.push_back(structure_of_file(file));
  const auto* preset = preset_for_names(names);
  return {preset != nullptr ? preset : dictionary.preset, "the names of its files"};
}

GivenLabels labels_of_folder(const std::string& folder, Dictionary dictionary) {
  const auto files = masks_in(folder);
  GivenLabels given;
  if (dictionary.preset->name == automatic_preset) {
    const auto recognised = recognise(files, dictionary);
    dictionary.preset = recognised.preset;
    if (recognised.preset->name != automatic_preset) given.warnings.push_back(preset_note(recognised));
  }
  Meanings meanings{dictionary};
  std::vector<std::pair<fs::path, Region>> masks;
  for (const auto& file : files)
    if (const Region region = meanings.of_name(structure_of_file(file)); region != Region::none)
      masks.emplace_back(file, region);
  refuse_unknown(meanings, folder);
  LabelVolume& labels = given.labels;
  for (const auto& [file, region] : masks) {
    const auto image = adapters::read_label_image(file.string());
    if (labels.voxels.empty()) labels = LabelVolume(image.layers.front().grid);
    if (!same_place(labels.grid, image.layers.front().grid))
      throw UserError("lies on another grid than the masks before it", file.string(), "resample it to their grid");
    for (const auto& layer : image.layers) paint_layer(labels, layer, [&](std::int32_t) { return region; });
  }
  if (labels.voxels.empty())
    throw UserError(fmt::format("none of its {} structures is a region", files.size()), folder,
                    "map their names in [labels.regions]");
  return given;
}

std::array<bool, 256> values_of(const LabelVolume& labels) {
  std::array<bool, 256> found{};
  for (const auto label : labels.voxels) found[label] = true;
  return found;
}

void check_mapped_regions(const LabelVolume& labels, const LabelSettings& settings, const std::string& path) {
  const auto found = values_of(labels);
  for (const auto& [name, values] : settings.regions)
    if (!found[tag(*region_from_name(name))])
      throw UserError(fmt::format("has no voxel of {}: {} does not occur", name, fmt::join(values.keys, " or ")), path,
                      fmt::format("correct labels.regions.{}, or leave it out", name));
}

LabelVolume resampled(const LabelVolume& labels, const Grid& grid) {
  LabelVolume result(grid);
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t first, std::int64_t end) {
    for (std::int64_t k = first; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          const Vec3 at = index_from_lps(
              labels.grid,
              lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
          const auto a = std::lround(at.x), b = std::lround(at.y), c = std::lround(at.z);
          if (labels.grid.contains(a, b, c)) result(i, j, k) = labels(a, b, c);
        }
  });
  return result;
}

bool any_label(const LabelVolume& labels) {
  return std::any_of(labels.voxels.begin(), labels.voxels.end(), [](std::uint8_t label) { return label != 0; });
}

void bring_to(const Grid& grid, const std::string& path, GivenLabels& given) {
  const Grid own = given.labels.grid;
  if (same_place(own, grid)) {
    given.labels.grid = grid;
    return;
  }
  given.labels = resampled(given.labels, grid);
  if (!any_label(given.labels))
    throw UserError("does not reach into the CT", path, "are both of the same patient and in the same frame?");
  given.warnings.push_back(
      {"labels.resampled", WarningLevel::note,
       fmt::format("The given labels were taken from a grid of {} x {} x {} voxels of {:g} x {:g} x {:g} mm to the "
                   "CT's, each voxel from the nearest.",
                   own.size[0], own.size[1], own.size[2], own.spacing_mm.x, own.spacing_mm.y, own.spacing_mm.z)});
}

std::string listed_regions(const LabelVolume& labels) {
  const auto found = values_of(labels);
  std::vector<std::string> names;
  for (const auto& row : region_table())
    if (found[static_cast<std::size_t>(row.tag)]) names.emplace_back(row.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

bool listed(const std::vector<std::string>& list, const char* word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

}  // namespace

GivenLabels read_given_labels(const InputSettings& input, const LabelSettings& settings, const Grid* grid) {
  const Dictionary dictionary = dictionary_of(settings);
  const ValueNames names = input.label_names.empty() ? ValueNames{} : read_label_names(input.label_names);
  GivenLabels given = fs::is_directory(input.labels) ? labels_of_folder(input.labels, dictionary)
                                                     : labels_of_image(input.labels, dictionary, names);
  check_mapped_regions(given.labels, settings, input.labels);
  if (!any_label(given.labels))
    throw UserError("holds no region at all", input.labels, "check labels.preset and [labels.regions]");
  if (grid) bring_to(*grid, input.labels, given);
  given.warnings.insert(given.warnings.begin(),
                        {"labels.given", WarningLevel::note,
                         fmt::format("Regions taken from the given labels: {}.", listed_regions(given.labels))});
  return given;
}

bool same_place(const Grid& a, const Grid& b) {
  constexpr double tolerance_mm = 1e-2;
  if (a.size != b.size) return false;
  const Vec3 last{static_cast<double>(a.size[0] - 1), static_cast<double>(a.size[1] - 1),
                  static_cast<double>(a.size[2] - 1)};
  for (const Vec3& corner : {Vec3{0, 0, 0}, Vec3{last.x, 0, 0}, Vec3{0, last.y, 0}, Vec3{0, 0, last.z}})
    if (norm(lps_from_index(a, corner) - lps_from_index(b, corner)) > tolerance_mm) return false;
  return true;
}

bool holds(const LabelVolume& labels, Region region) {
  return std::find(labels.voxels.begin(), labels.voxels.end(), tag(region)) != labels.voxels.end();
}

void check_settings(const LabelSettings& settings) {
  const std::vector<std::string> groups = {"chambers", "walls", "body"};
  for (const auto& name : settings.complete)
    if (std::find(groups.begin(), groups.end(), name) == groups.end())
      throw UserError(fmt::format("unknown group \"{}\"", name), "labels.complete",
                      fmt::format("known groups: {}", fmt::join(groups, ", ")));
}

MissingGroups missing_groups(const LabelVolume& given, const LabelSettings& settings) {
  const auto found = values_of(given);
  const auto lacks = [&](std::initializer_list<Region> regions) {
    return std::any_of(regions.begin(), regions.end(), [&](Region region) { return !found[tag(region)]; });
  };
  using enum Region;
  const bool lacks_chamber = lacks({lv_blood, rv_blood, la_blood, ra_blood});
  return {listed(settings.complete, "chambers") && lacks_chamber,
          listed(settings.complete, "chambers") && !lacks_chamber && lacks({aorta, pulmonary_artery}),
          listed(settings.complete, "walls") && lacks({lv_myocardium, rv_myocardium, la_wall, ra_wall}),
          listed(settings.complete, "body") && lacks({torso})};
}

Group group_of(Region region) {
  if (is_blood(region) || region == Region::papillary) return Group::chambers;
  return is_myocardium(region) ? Group::walls : Group::body;
}

}  // namespace heartgen::labels
