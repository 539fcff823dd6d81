// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/painting/region_masks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "generator/adapters/itk_io.hpp"
#include "generator/painting/triangles.hpp"
#include "model/crop.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"
#include "model/labels.hpp"

namespace heartgen::painting {
namespace {

namespace fs = std::filesystem;

constexpr double surface_voxel_mm = 0.3;  // of closed surfaces: a fifth of the walls' usual edge

/// Letters, digits and '_' of a text that may be anything.
std::string as_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool is_plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    if (is_plain)
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  return name;
}

std::string name_of_file(const std::string& path) {
  std::string name = fs::path(path).filename().string();
  for (const char* ending : {".nii.gz", ".seg.nrrd"})
    if (name.ends_with(ending)) return as_name(name.substr(0, name.size() - std::string_view(ending).size()));
  return as_name(fs::path(name).stem().string());
}

/// Part of a layer with one value, in the box around it.
struct Found {
  std::int32_t value = 0;
  std::string own_name;  ///< in the file; may be empty
  Mask mask;
};

Mask mask_of_value(const Volume<std::int32_t>& layer, std::int32_t value) {
  const auto is_it = [value](std::int32_t voxel) { return voxel == value; };
  const auto part = crop(layer, bounding_box(layer, 0, is_it));
  Mask mask(part.grid);
  std::transform(part.voxels.begin(), part.voxels.end(), mask.voxels.begin(), is_it);
  return mask;
}

std::vector<Found> regions_of_image(const std::string& path) {
  const auto image = adapters::read_label_image(path);
  std::vector<Found> found;
  for (std::size_t l = 0; l < image.layers.size(); ++l) {
    std::set<std::int32_t> values;
    std::int32_t last = 0;
    for (const auto voxel : image.layers[l].voxels)
      if (voxel != last) values.insert(last = voxel);
    values.erase(0);
    if (values.size() > last_user_region - first_user_region + 1)
      throw UserError(fmt::format("holds {} values", values.size()), path,
                      "give a label image: one value for each of a few regions");
    for (const auto value : values) {
      Found region{value, "", mask_of_value(image.layers[l], value)};
      for (const auto& segment : image.segments)
        if (segment.layer == l && segment.value == value) region.own_name = as_name(segment.name);
      found.push_back(std::move(region));
    }
  }
  if (found.empty()) throw UserError("is empty: all its voxels are 0", path, "give an image with the region's voxels");
  return found;
}

std::vector<Found> regions_of_surface(const std::string& path) {
  Found region{1, "", inside_of(read_surface_file(path), surface_voxel_mm, path)};
  const auto box = bounding_box(region.mask, 0, [](std::uint8_t voxel) { return voxel != 0; });
  if (box.empty()) throw UserError("is empty: it has no room inside", path, "give a closed surface around the region");
  region.mask = crop(region.mask, box);
  return {std::move(region)};
}

std::vector<std::string> names_for(const RegionSettings& file, const std::vector<Found>& found) {
  std::vector<std::string> names;
  if (!file.names.empty() && file.names.size() != found.size()) {
    std::vector<std::int32_t> values;
    for (const auto& region : found) values.push_back(region.value);
    throw UserError(fmt::format("holds {} region{} (value{} {}), and {} name{} given", found.size(),
                                found.size() == 1 ? "" : "s", found.size() == 1 ? "" : "s", fmt::join(values, ", "),
                                file.names.size(), file.names.size() == 1 ? " is" : "s are"),
                    file.file, "name each, in the order of their values: FILE:NAME,NAME; or none");
  }
  for (std::size_t r = 0; r < found.size(); ++r) {
    if (!file.names.empty())
      names.push_back(file.names[r]);
    else if (!found[r].own_name.empty())
      names.push_back(found[r].own_name);
    else
      names.push_back(name_of_file(file.file) + (found.size() == 1 ? "" : fmt::format("_{}", found[r].value)));
  }
  return names;
}

void check_name(const std::string& name, const std::string& file, const std::vector<RegionMask>& before) {
  const char* remedy = "give another: FILE:NAME, or names in [[regions]] of the recipe";
  const auto refuse = [&](const std::string& why) {
    throw UserError(fmt::format("the name \"{}\" {}", name, why), file, remedy);
  };
  if (name.empty() || as_name(name) != name || name.ends_with('_')) refuse("is no word of letters, digits and \"_\"");
  if (region_from_name(name) || surface_from_name(name)) refuse("is one of heartgen's own");
  for (const auto& region : before)
    if (region.name == name) refuse("stands for two regions");
}

}  // namespace

RegionSettings region_argument(const std::string& text) {
  const auto colon = text.rfind(':');
  if (colon == std::string::npos || fs::exists(text)) return {text, {}};
  RegionSettings settings{text.substr(0, colon), {}};
  for (std::size_t begin = colon + 1; begin <= text.size();) {
    const auto end = std::min(text.find(',', begin), text.size());
    settings.names.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return settings;
}

std::vector<RegionMask> read_regions(const std::vector<RegionSettings>& files) {
  std::vector<RegionMask> regions;
  for (std::size_t entry = 0; entry < files.size(); ++entry) {
    const auto& file = files[entry];
    require_input_file(file.file, "check --regions, or regions.file in the recipe");
    auto found = is_surface_name(file.file) ? regions_of_surface(file.file) : regions_of_image(file.file);
    const auto names = names_for(file, found);
    for (std::size_t r = 0; r < found.size(); ++r) {
      check_name(names[r], file.file, regions);
      regions.push_back({names[r], file.file, entry, std::move(found[r].mask)});
    }
  }
  if (regions.size() > last_user_region - first_user_region + 1)
    throw UserError(fmt::format("{} regions are given", regions.size()), "--regions",
                    fmt::format("give {} at most", last_user_region - first_user_region + 1));
  return regions;
}

std::vector<RegionSettings> with_names(const std::vector<RegionSettings>& files,
                                       const std::vector<RegionMask>& regions) {
  std::vector<RegionSettings> named;
  for (const auto& file : files) named.push_back({file.file, {}});
  for (const auto& region : regions) named[region.entry].names.push_back(region.name);
  return named;
}

}  // namespace heartgen::painting
