// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A build as it grows: what was asked for, and what each stage has left for those after it.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "exporters/bundle.hpp"
#include "exporters/reserved_place.hpp"
#include "generator/anatomy/padding.hpp"
#include "generator/fibers/map_fibers.hpp"
#include "generator/labels/given_labels.hpp"
#include "generator/labels/place_heart.hpp"
#include "generator/landmarks/landmarks.hpp"
#include "generator/painting/region_masks.hpp"
#include "generator/pde/hierarchy.hpp"
#include "generator/pipeline/resolutions.hpp"
#include "generator/pipeline/run.hpp"
#include "generator/pipeline/stage_event.hpp"
#include "model/certificate.hpp"
#include "model/recipe.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::pipeline {

struct BuildOptions {
  std::filesystem::path output;        ///< folder of the bundle
  std::filesystem::path cache_folder;  ///< stage results; empty: no cache
  std::filesystem::path keep_stages;   ///< where the image stages' results are written as files; empty: nowhere
  bool replace = false;                ///< replace an existing bundle
  bool progress = true;                ///< lines on standard error
  bool tells_warnings = true;          ///< on standard error, as they come up; they are in the certificate too
  bool accept_doubtful = false;        ///< go on with automatic landmarks that can hardly be a heart's
  /// Called on the root; what it throws ends the build of a single process.
  std::function<void(const StageEvent&)> on_stage{};
};

/// A cache that this run has made goes where its input is refused: nobody will ask for it again.
class NewCache {
 public:
  NewCache() = default;
  explicit NewCache(const std::filesystem::path& folder);
  ~NewCache();
  NewCache(NewCache&& other) noexcept;
  NewCache& operator=(NewCache&& other) noexcept;
  void keep() { folder_.clear(); }

 private:
  std::filesystem::path folder_{};
};

using Meshes = std::map<std::string, TetMesh>;

/// Another patient, whose torso goes around the heart.
struct Person {
  LabelVolume labels;
  Landmarks landmarks;
  anatomy::Padding padding{};            ///< of the CT that the labels were made from
  std::vector<std::string> used_keys{};  ///< of the cache
};

/// The heart's label map in another patient's torso. Grids, like the heart's, are in the frame that the recipe asks
/// for.
struct TorsoAround {
  LabelVolume labels;                ///< heart and torso
  Grid torso_grid;                   ///< of the other patient's image: where its field of view ends
  anatomy::Padding torso_padding{};  ///< of that image, likewise
  labels::TorsoPose pose;
  std::vector<std::string> marks;  ///< names of what the pose was fitted to; empty: the recipe gave it
  double outside_share = 0, bone_share = 0;
};
inline auto members(TorsoAround& t) {
  return std::tie(t.labels, t.torso_grid, t.torso_padding, t.pose, t.marks, t.outside_share, t.bone_share);
}

/// What the last stage leaves.
struct Written {
  std::string content_id;
  Certificate certificate;
  std::string fibers_from;  ///< a sentence
};

/// What stages leave is valid on the root only.
struct Build {
  Recipe recipe;  ///< as given, then with what stages find: landmarks, the torso's pose
  BuildOptions options{};
  Run run{};
  std::map<std::string, std::string> hashes{};  ///< of the input files, by what they are used as
  std::vector<exporters::BundleInput> inputs{};
  exporters::ReservedPlace place{};
  NewCache new_cache{};

  Staged<CtVolume> ct{};        ///< without a CT: the given labels' grid, no voxels
  anatomy::Padding padding{};   ///< of the CT; no stage labels it, but a file that replaces a stage may
  Staged<LabelVolume> given{};  ///< on the CT's grid; no voxels: nothing is given
  LabelVolume kept{};           ///< what of it no file replaces
  labels::MissingGroups missing{true, false, true, true};  ///< what the image stages must add to it
  Staged<landmarks::FoundLandmarks> found{};
  Staged<Volume<float>> smooth{};
  Staged<pde::SegmentationTree> tree{};
  Staged<LabelVolume> chambers{}, walls{}, body{};
  Staged<LabelVolume> heart{};  ///< all of them as one map
  Person other{};
  std::vector<painting::RegionMask> regions{};  ///< the user's, on the heart's walls
  Staged<TorsoAround> around{};
  Staged<Meshes> meshes{};
  Staged<fibers::FiberResult> fibers{};
  Staged<Resolutions> further{};
  Written written{};

  bool from_file(const std::string& stage) const { return run.files.replaced_by.contains(stage); }
  bool has_ct() const { return !recipe.input.ct.empty(); }
  bool has_labels() const { return !recipe.input.labels.empty(); }
  bool has_torso() const { return recipe.torso.is_given(); }
  std::string hash(const std::string& input) const {
    const auto at = hashes.find(input);
    return at == hashes.end() ? "none" : at->second;
  }
  /// The map that is meshed, and its key.
  const LabelVolume& labels() const { return has_torso() ? around->labels : *heart; }
  const std::string& labels_key() const { return has_torso() ? around.key : heart.key; }
};

}  // namespace heartgen::pipeline
