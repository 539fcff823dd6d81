// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Results of image stages as files that a person can look at, correct, and give back: images as .nii.gz, landmarks and
/// the tree of splits as .json. Beside them stages.json keeps what each was made from, so that a file that comes back
/// unchanged is known as the stage's own result.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "generator/landmarks/landmarks.hpp"
#include "generator/pde/hierarchy.hpp"
#include "model/volume.hpp"

namespace heartgen::pipeline {

/// What stages read and write beside the cache.
struct StageFiles {
  std::map<std::string, std::string> replaced_by{};  ///< stage to the file that takes the place of its result
  std::filesystem::path keep_folder{};               ///< where results are written; empty: nowhere
  std::string origin{};                              ///< hash of all that the image stages depend on
  Grid grid{};                                       ///< of the CT: replaced images must lie on it
  std::vector<std::string> changed{};                ///< "STAGE HASH" of the files that really changed a result
};

template <class T>
constexpr bool has_stage_file =
    std::is_same_v<T, Volume<float>> || std::is_same_v<T, LabelVolume> ||
    std::is_same_v<T, landmarks::FoundLandmarks> || std::is_same_v<T, pde::SegmentationTree>;

/// A label map with the tags of a bundle. Throws UserError as adapters::read_labels, and for unknown tags.
LabelVolume read_region_labels(const std::string& path);

/// Reads a stage's result. Throws UserError: missing or damaged file, another grid than the CT's, unknown labels.
void read_stage_file(const std::string& path, const Grid& grid, Volume<float>& value);
void read_stage_file(const std::string& path, const Grid& grid, LabelVolume& value);
void read_stage_file(const std::string& path, const Grid& grid, landmarks::FoundLandmarks& value);
void read_stage_file(const std::string& path, const Grid& grid, pde::SegmentationTree& value);

/// Writes FOLDER/STAGE.nii.gz or .json.
void write_stage_file(const std::filesystem::path& folder, const std::string& stage, const Volume<float>& value);
void write_stage_file(const std::filesystem::path& folder, const std::string& stage, const LabelVolume& value);
void write_stage_file(const std::filesystem::path& folder, const std::string& stage,
                      const landmarks::FoundLandmarks& value);
void write_stage_file(const std::filesystem::path& folder, const std::string& stage,
                      const pde::SegmentationTree& value);

/// One entry of stages.json.
struct StageRecord {
  std::string origin;    ///< of the run that wrote the file
  std::string key;       ///< of the stage in that run
  std::string contents;  ///< hash of the result
};
/// All empty where there is none.
StageRecord read_stage_record(const std::filesystem::path& folder, const std::string& stage);
void write_stage_record(const std::filesystem::path& folder, const std::string& stage, const StageRecord& record);

/// The tree as one image: voxels get the number (from 1) of the leaf they lie in, a leaf being what the splits leave
/// undivided; 0 lies in no domain. Leaves are numbered in the order of their sides' names along the steps.
struct LeafImage {
  LabelVolume leaf;
  std::vector<std::vector<std::string>> sides;  ///< of leaf N at [N - 1]: "body.above", "soft.below"
};
/// Throws UserError for more than 255 leaves.
LeafImage leaf_image(const pde::SegmentationTree& tree);

}  // namespace heartgen::pipeline
