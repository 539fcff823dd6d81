// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/stage_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "generator/adapters/itk_io.hpp"
#include "generator/labels/given_labels.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"
#include "model/text.hpp"

namespace heartgen::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* record_file = "stages.json";

fs::path image_path(const fs::path& folder, const std::string& stage) { return folder / (stage + ".nii.gz"); }

/// Headers hold spacing and direction as 32-bit floats: a grid that agrees with the CT's but for that is the CT's.
void settle_grid(Grid& grid, const Grid& ct, const std::string& path) {
  if (!labels::same_place(grid, ct))
    throw UserError("does not lie on the CT's grid", path, "save it with the size, spacing and origin that it had");
  grid = ct;
}

Json read_json(const std::string& path) {
  require_input_file(path);
  std::ifstream file(path, std::ios::binary);
  Json json = Json::parse(file, nullptr, false);
  if (!json.is_object()) throw UserError("is not valid JSON", path, "correct the file");
  return json;
}

/// Calls `read` and turns what it throws about a missing or wrong member into a message about the file.
template <class Read>
auto with_members(const std::string& path, Read read) {
  try {
    return read();
  } catch (const Json::exception& error) {
    throw UserError(fmt::format("lacks a member or has a wrong one: {}", error.what()), path,
                    "start from the file that --keep-stages wrote");
  }
}

Json json_of(const pde::SegmentationTree& tree, const LeafImage& leaves, const std::string& image) {
  Json json{{"image", image}, {"steps", Json::array()}, {"leaves", Json::array()}};
  for (const auto& side : tree)
    json["steps"].push_back(
        {{"name", side.name}, {"c_below", side.c_below}, {"c_above", side.c_above}, {"iterations", side.iterations}});
  for (std::size_t n = 0; n < leaves.sides.size(); ++n)
    json["leaves"].push_back({{"value", n + 1}, {"sides", leaves.sides[n]}});
  return json;
}

/// 0 not in the step's domain, 1 below, 2 above, step after step.
using Signature = std::vector<int>;

Signature signature_at(const pde::SegmentationTree& tree, std::size_t voxel) {
  Signature signature;
  for (const auto& side : tree) signature.push_back(side.above.voxels[voxel] ? 2 : side.below.voxels[voxel] ? 1 : 0);
  return signature;
}

std::vector<std::string> sides_of(const pde::SegmentationTree& tree, const Signature& signature) {
  std::vector<std::string> sides;
  for (std::size_t step = 0; step < tree.size(); ++step)
    if (signature[step]) sides.push_back(tree[step].name + (signature[step] == 2 ? ".above" : ".below"));
  return sides;
}

/// Sets the voxels of one leaf in the masks of all its sides.
void add_leaf(pde::SegmentationTree& tree, const LabelVolume& leaves, int value, const std::vector<std::string>& sides,
              const std::string& path) {
  for (const auto& name : sides) {
    const auto step = std::find_if(tree.begin(), tree.end(), [&](const auto& s) {
      return name == s.name + ".above" || name == s.name + ".below";
    });
    if (step == tree.end())
      throw UserError(fmt::format("leaf {} lies in \"{}\", which is no step's side", value, name), path,
                      "correct the file");
    Mask& mask = name.ends_with(".above") ? step->above : step->below;
    for (std::size_t v = 0; v < leaves.voxels.size(); ++v)
      if (leaves.voxels[v] == value) mask.voxels[v] = 1;
  }
}

}  // namespace

LeafImage leaf_image(const pde::SegmentationTree& tree) {
  LeafImage image;
  if (tree.empty()) return image;
  image.leaf = LabelVolume(tree.front().above.grid);
  std::map<Signature, std::uint8_t> leaves;
  const auto for_each_voxel = [&](auto visit) {
    Signature last;
    std::uint8_t* slot = nullptr;
    for (std::size_t v = 0; v < image.leaf.voxels.size(); ++v) {
      const Signature signature = signature_at(tree, v);
      if (!slot || signature != last) slot = &leaves[last = signature];
      visit(v, *slot);
    }
  };
  for_each_voxel([](std::size_t, std::uint8_t&) {});
  for (auto& [signature, number] : leaves) {
    auto sides = sides_of(tree, signature);
    if (sides.empty()) continue;
    if (image.sides.size() == 255)
      throw UserError("the tree has more than 255 leaves", "segmentation", "use fewer steps");
    image.sides.push_back(std::move(sides));
    number = static_cast<std::uint8_t>(image.sides.size());
  }
  for_each_voxel([&](std::size_t v, std::uint8_t number) { image.leaf.voxels[v] = number; });
  return image;
}

void read_stage_file(const std::string& path, const Grid& grid, Volume<float>& value) {
  value = adapters::read_image(path);
  settle_grid(value.grid, grid, path);
}

LabelVolume read_region_labels(const std::string& path) {
  LabelVolume labels = adapters::read_labels(path);
  const auto largest = *std::max_element(labels.voxels.begin(), labels.voxels.end());
  if (largest > tag(Region::torso))
    throw UserError(fmt::format("holds the label {}, the largest known one is {}", largest, tag(Region::torso)), path,
                    "use the tags of a bundle's manifest");
  return labels;
}

void read_stage_file(const std::string& path, const Grid& grid, LabelVolume& value) {
  value = read_region_labels(path);
  settle_grid(value.grid, grid, path);
}

void read_stage_file(const std::string& path, const Grid&, landmarks::FoundLandmarks& value) {
  value.landmarks = read_landmarks(path);
  const Json json = read_json(path);
  with_members(path, [&] {
    value.confidence = json.value("confidence", 1.0);
    value.warnings = json.value("warnings", std::vector<std::string>{});
    value.volumes_ml = json.value("volumes_ml", std::map<std::string, double>{});
    const auto axis = json.value("long_axis", std::vector<double>{0, 0, 0});
    value.long_axis = {axis.at(0), axis.at(1), axis.at(2)};
  });
}

void read_stage_file(const std::string& path, const Grid& grid, pde::SegmentationTree& value) {
  const Json json = read_json(path);
  with_members(path, [&] {
    LabelVolume leaves;
    const std::string image = (fs::path(path).parent_path() / json.at("image").get<std::string>()).string();
    leaves = adapters::read_labels(image);
    settle_grid(leaves.grid, grid, image);
    for (const auto& step : json.at("steps"))
      value.push_back({step.at("name"), Mask(leaves.grid), Mask(leaves.grid), step.at("c_below"), step.at("c_above"),
                       step.value("iterations", 0)});
    for (const auto& leaf : json.at("leaves")) add_leaf(value, leaves, leaf.at("value"), leaf.at("sides"), path);
  });
}

void write_stage_file(const fs::path& folder, const std::string& stage, const Volume<float>& value) {
  fs::create_directories(folder);
  adapters::write_volume(image_path(folder, stage).string(), value);
}

void write_stage_file(const fs::path& folder, const std::string& stage, const LabelVolume& value) {
  fs::create_directories(folder);
  adapters::write_volume(image_path(folder, stage).string(), value);
}

void write_stage_file(const fs::path& folder, const std::string& stage, const landmarks::FoundLandmarks& value) {
  Json json = Json::parse(write_landmarks(value.landmarks));
  json["confidence"] = value.confidence;
  json["warnings"] = value.warnings;
  json["volumes_ml"] = value.volumes_ml;
  json["long_axis"] = {value.long_axis.x, value.long_axis.y, value.long_axis.z};
  write_text(folder / (stage + ".json"), json.dump(1) + "\n");
}

void write_stage_file(const fs::path& folder, const std::string& stage, const pde::SegmentationTree& value) {
  const LeafImage leaves = leaf_image(value);
  write_stage_file(folder, stage, leaves.leaf);
  write_text(folder / (stage + ".json"),
             json_of(value, leaves, image_path("", stage).filename().string()).dump(1) + "\n");
}

StageRecord read_stage_record(const fs::path& folder, const std::string& stage) {
  std::ifstream file(folder / record_file, std::ios::binary);
  const Json json = Json::parse(file, nullptr, false);
  if (!json.is_object() || !json.contains(stage)) return {};
  const Json& entry = json[stage];
  return {entry.value("origin", ""), entry.value("key", ""), entry.value("contents", "")};
}

void write_stage_record(const fs::path& folder, const std::string& stage, const StageRecord& record) {
  Json json = Json::object();
  if (std::ifstream file(folder / record_file, std::ios::binary); file) {
    json = Json::parse(file, nullptr, false);
    if (!json.is_object()) json = Json::object();
  }
  json[stage] = {{"origin", record.origin}, {"key", record.key}, {"contents", record.contents}};
  write_text(folder / record_file, json.dump(1) + "\n");
}

}  // namespace heartgen::pipeline
