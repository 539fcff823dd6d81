// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/image_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "generator/anatomy/body.hpp"
#include "generator/anatomy/chambers.hpp"
#include "generator/anatomy/epicardium.hpp"
#include "generator/anatomy/fuse_labels.hpp"
#include "generator/anatomy/hounsfield.hpp"
#include "generator/anatomy/trachea.hpp"
#include "generator/labels/gaps.hpp"
#include "generator/labels/islands.hpp"
#include "generator/labels/judge.hpp"
#include "generator/landmarks/judge.hpp"
#include "generator/landmarks/search.hpp"
#include "generator/pde/diffusion.hpp"
#include "generator/pde/hierarchy.hpp"
#include "generator/pipeline/landmarks_picture.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/text.hpp"

namespace heartgen::pipeline {
namespace {

std::vector<std::string> with(std::vector<std::string> keys, const std::string& key) {
  keys.push_back(key);
  return keys;
}

/// The regions that the whole map has and the given labels lack.
std::vector<std::string> added_regions(const LabelVolume& given, const LabelVolume& heart) {
  std::vector<std::string> names;
  for (const auto& row : region_table())
    if (const auto region = static_cast<Region>(row.tag); labels::holds(heart, region) && !labels::holds(given, region))
      names.emplace_back(row.name);
  return names;
}

/// Given regions of the heart that have grown, with by how much.
std::vector<std::string> grown_regions(const LabelVolume& given, const LabelVolume& heart) {
  std::array<double, 256> more_ml{};
  for (std::size_t v = 0; v < heart.voxels.size(); ++v)
    if (heart.voxels[v] != given.voxels[v]) more_ml[heart.voxels[v]] += heart.grid.voxel_volume_mm3() / 1000;
  std::vector<std::string> grown;
  for (const auto& row : region_table()) {
    const auto region = static_cast<Region>(row.tag);
    const bool is_heart = is_blood(region) || is_myocardium(region);
    if (is_heart && more_ml[tag(region)] > 0 && labels::holds(given, region))
      grown.push_back(fmt::format("{} by {:.2g} ml", row.name, more_ml[tag(region)]));
  }
  return grown;
}

Warning completion_warning(const LabelVolume& given, const LabelVolume& heart, bool has_ct) {
  const auto added = added_regions(given, heart);
  if (added.empty())
    return {"labels.completed", WarningLevel::note, "Everything else was left as the given labels have it."};
  if (has_ct)
    return {"labels.completed", WarningLevel::note,
            fmt::format("What the given labels lack was made from the CT: {}.", fmt::join(added, ", "))};
  return {"labels.no_ct", WarningLevel::warning,
          fmt::format("Without a CT, walls that the given labels lack ({}) got the least thickness of the recipe, and "
                      "nothing was added around the heart.",
                      fmt::join(added, ", "))};
}

/// Chambers and the left ventricle's wall cannot be guessed.
void refuse_what_needs_a_ct(const LabelVolume& given, const labels::MissingGroups& missing, const std::string& path) {
  constexpr const char* remedy = "give the CT too, or labels that hold it";
  if (missing.chambers) throw UserError("lacks a chamber of the heart", path, remedy);
  if (missing.walls && !labels::holds(given, Region::lv_myocardium))
    throw UserError("lacks lv_myocardium", path, remedy);
}

/// The given labels without the groups whose stage is replaced by a file. Root only.
LabelVolume labels_not_from_files(const Run& run, const labels::GivenLabels& given) {
  LabelVolume rest = given.labels;
  for (const auto& [stage, group] : {std::pair{"chambers", labels::Group::chambers},
                                     {"epicardium", labels::Group::walls},
                                     {"body", labels::Group::body}})
    if (run.files.replaced_by.contains(stage))
      for (auto& label : rest.voxels)
        if (label != 0 && labels::group_of(static_cast<Region>(label)) == group) label = 0;
  return rest;
}

/// The walls around the chambers, those that are given as they are. @collective
LabelVolume make_walls(Run& run, const CtVolume& ct, const LabelVolume& chambers, const LabelVolume& given,
                       bool missing, const Recipe& recipe) {
  if (missing && recipe.input.ct.empty() && !recipe.input.labels.empty())
    return parallel::run_on_root(run.comm, [&] { return labels::min_walls(chambers, given, recipe.epicardium); });
  LabelVolume own(ct.grid);
  if (missing) {
    const LabelVolume near =
        given.voxels.empty() ? chambers : labels::near_heart(chambers, recipe.chambers.vessel_length_mm);
    own = anatomy::epicardium(ct, near, recipe.epicardium, run.comm, labels::only(given, labels::Group::walls)).walls;
  }
  return labels::with_given(std::move(own), given, labels::Group::walls);
}

constexpr const char* by_hand =
    "check the image's orientation and field of view; give the seeds lv_blood, rv_blood, la_blood, ra_blood, aorta and "
    "pulmonary_artery and the valve planes by hand (--landmarks)";

/// Writes the picture of what was found, if there is a place for it; returns the sentence that names it.
std::string show_landmarks(const CtVolume& ct, const std::filesystem::path& path) {
  if (path.empty()) return "";
  const auto png = landmarks_picture(ct, landmarks::search(ct));
  write_text(path, std::string(png.begin(), png.end()));
  return fmt::format("look at {}, which shows what was found; ", path.string());
}

/// What the search says of itself tells more than that a seed is missing, and than a model of something else.
void refuse_doubtful_landmarks(const Landmarks& all, const landmarks::FoundLandmarks& found, double confidence,
                               const CtVolume& ct, const Doubt& doubt) {
  const bool complete = chambers_are_marked(all);
  if (complete && (doubt.is_accepted || landmarks::trust_in(confidence) != landmarks::Trust::doubtful)) return;
  const std::string problem =
      complete ? fmt::format("what was found can hardly be a heart (confidence {:.2f}, at least {:g} is needed)",
                             confidence, landmarks::min_confidence)
               : "not every chamber was found";
  throw UserError(fmt::format("{}: {}", problem, fmt::join(found.warnings, "; ")), "landmarks",
                  show_landmarks(ct, doubt.picture) + by_hand +
                      (complete ? ", or go on with --accept-doubtful, which marks the model" : ""));
}

Warning confidence_warning(double confidence) {
  const std::string text =
      fmt::format("Seeds and valves were found automatically, with a confidence of {:.2f}", confidence);
  switch (landmarks::trust_in(confidence)) {
    case landmarks::Trust::doubtful:
      return {"landmarks.doubtful", WarningLevel::doubt,
              text + ": what was found can hardly be a heart, and the build went on because that was accepted."};
    case landmarks::Trust::uncertain:
      return {"landmarks.uncertain", WarningLevel::warning,
              text + fmt::format(", less than the {:g} of a sure one: check them before you rely on the model.",
                                 landmarks::min_sound_confidence)};
    default:
      return {"landmarks.automatic", WarningLevel::note, text + "."};
  }
}

/// The given chambers with what they lack, without gaps and pockets. Root only.
LabelVolume complete_chambers(LabelVolume own, const LabelVolume& given, const CtVolume& ct, const Recipe& recipe) {
  if (given.voxels.empty()) return own;
  labels::refuse_organs_in_heart(given, own, recipe.input.labels);
  own = labels::with_given(std::move(own), given, labels::Group::chambers);
  own = labels::with_closed_gaps(std::move(own), given, recipe.input.ct.empty() ? nullptr : &ct);
  const double crumb_mm3 = labels::crumb_mm3(recipe.mesh.heart_edge_mm);
  own = labels::with_filled_pockets(std::move(own), given, 5 * crumb_mm3);  // what we make, meshes must resolve
  labels::absorb_crumbs(own, crumb_mm3);
  return own;
}

}  // namespace

anatomy::Padding close_unmeasured(Run& run, Staged<CtVolume>& ct, const Recipe& recipe,
                                  std::vector<Warning>& warnings) {
  anatomy::Padding padding;
  if (!recipe.input.labels.empty()) return padding;
  parallel::run_on_root(run.comm, [&] {
    padding = anatomy::find_padding(*ct);
    anatomy::close_padding(ct.value, padding);
    if (padding.is_there())
      warnings.push_back({"ct.padding", WarningLevel::note,
                          fmt::format("The CT holds {} HU where nothing was measured: the body ends there, with a "
                                      "surface that is called fov_cut.",
                                      padding.value_hu)});
  });
  return padding;
}

bool chambers_are_marked(const Landmarks& landmarks) {
  for (const char* chamber : {"lv_blood", "rv_blood", "la_blood", "ra_blood"})
    if (!landmarks.seeds_mm.contains(chamber)) return false;
  return true;
}

CompletedLandmarks complete_landmarks(Run& run, const Staged<CtVolume>& ct, const Landmarks& given,
                                      std::vector<Warning>& warnings, const Doubt& doubt) {
  if (chambers_are_marked(given)) return {given};
  const auto found = run.root_stage("landmarks", {ct.key}, [&] { return landmarks::find_landmarks(*ct); });
  Landmarks all = given;
  all.seeds_mm.insert(found->landmarks.seeds_mm.begin(), found->landmarks.seeds_mm.end());
  all.valves.insert(found->landmarks.valves.begin(), found->landmarks.valves.end());
  if (!all.lv_apex_mm) all.lv_apex_mm = found->landmarks.lv_apex_mm;
  const bool corrected = run.files.replaced_by.contains("landmarks");
  const double confidence = landmarks::confidence_beside(*found, given);
  if (!corrected)
    parallel::run_on_root(run.comm, [&] { refuse_doubtful_landmarks(all, *found, confidence, *ct, doubt); });
  warnings.push_back(corrected ? Warning{"landmarks.by_hand", WarningLevel::note,
                                         "Seeds and valves come from a file that replaces what was found; nothing "
                                         "judged them."}
                               : confidence_warning(confidence));
  for (const auto& sentence : found->warnings)
    warnings.push_back({"landmarks.anatomy", WarningLevel::warning, "Automatic landmarks: " + sentence});
  std::string text = write_landmarks(all);  // what the root found, for every rank
  parallel::broadcast(run.comm, text);
  return {parse_landmarks(text, "automatic landmarks"), found->ventricles_cut_cm2};
}

bool find_vessels(Run& run, const Staged<CtVolume>& ct, Landmarks& landmarks, std::vector<Warning>& warnings) {
  try {
    landmarks = complete_landmarks(run, ct, landmarks, warnings, {}).landmarks;
    return true;
  } catch (const UserError& error) {
    warnings.push_back(
        {"labels.no_vessels", WarningLevel::warning,
         fmt::format("The great vessels that the given labels lack were not found in the CT: {}.", error.problem)});
    return false;
  }
}

std::vector<Warning> label_warnings(const LabelVolume& given, const LabelVolume& heart, bool has_ct) {
  std::vector<Warning> warnings;
  if (!given.voxels.empty()) {
    warnings.push_back(completion_warning(given, heart, has_ct));
    if (auto grown = grown_regions(given, heart); !grown.empty())
      warnings.push_back(
          {"labels.grown", WarningLevel::note,
           fmt::format("Gaps and pockets beside the given regions were closed: {}.", fmt::join(grown, ", "))});
  }
  const auto valves = labels::closed_valves(heart);
  warnings.insert(warnings.end(), valves.begin(), valves.end());
  return warnings;
}

KnownLabels read_known_labels(Run& run, const Staged<CtVolume>& ct, const Recipe& recipe, const std::string& hash,
                              std::vector<Warning>& warnings) {
  KnownLabels known;
  if (recipe.input.labels.empty()) return known;
  const bool has_ct = !recipe.input.ct.empty();
  known.given = run.root_stage("given", {ct.key, hash, recipe_section(recipe, "labels")}, [&] {
    auto given = labels::read_given_labels(recipe.input, recipe.labels, has_ct ? &ct->grid : nullptr);
    labels::refuse_no_heart(given.labels, recipe.input.labels);
    const auto islands = labels::drop_islands(given.labels);
    given.warnings.insert(given.warnings.end(), islands.begin(), islands.end());
    return given;
  });
  known.missing = parallel::run_on_root(run.comm, [&] {
    auto missing = labels::missing_groups(known.given->labels, recipe.labels);
    if (has_ct) labels::refuse_labels_beside_heart(known.given->labels, *ct, recipe.input.labels);
    if (!has_ct) refuse_what_needs_a_ct(known.given->labels, missing, recipe.input.labels);
    warnings.insert(warnings.end(), known.given->warnings.begin(), known.given->warnings.end());
    missing.body &= has_ct;
    missing.vessels &= has_ct;
    return missing;
  });
  parallel::broadcast(run.comm, known.missing);
  return known;
}

Staged<LabelVolume> label_ct(Run& run, const Staged<CtVolume>& ct, const Recipe& recipe, const KnownLabels& known,
                             const anatomy::Padding& padding) {
  const auto from_file = [&](const char* stage) { return run.files.replaced_by.contains(stage); };
  const bool whole_map = from_file("labels") || !(known.missing.any() || from_file("chambers") ||
                                                  from_file("epicardium") || from_file("body"));
  if (whole_map) return run.root_stage("labels", {known.given.key}, [&] { return known.given->labels; });

  const bool make_chambers = (known.missing.chambers || known.missing.vessels) && !from_file("chambers");
  const bool make_body = known.missing.body && !from_file("body");
  if (make_chambers || make_body) parallel::run_on_root(run.comm, [&] { anatomy::require_hounsfield(*ct); });
  const LabelVolume given = labels_not_from_files(run, *known.given);
  Staged<Volume<float>> smooth;
  Staged<pde::SegmentationTree> tree;
  if ((make_chambers || make_body) && !from_file("segment"))
    smooth = run.stage("denoise", {ct.key, recipe_section(recipe, "denoise")},
                       [&] { return pde::perona_malik(anatomy::as_float(*ct), recipe.denoise, run.comm); });
  if (make_chambers || make_body)
    tree = run.stage("segment", {smooth.key, recipe_section(recipe, "segmentation")},
                     [&] { return pde::segment(*smooth, recipe.segmentation, run.comm); });
  const std::vector<std::string> sources = {tree.key, known.given.key, recipe_section(recipe, "landmarks"),
                                            recipe_section(recipe, "chambers")};
  const bool has_labels = !recipe.input.labels.empty();  // their crumbs depend on the edges
  const std::string edge = has_labels ? fmt::to_string(recipe.mesh.heart_edge_mm) : "";
  const auto chambers = run.root_stage("chambers", with(sources, edge), [&] {
    LabelVolume own(ct->grid);
    if (make_chambers) own = anatomy::split_chambers(*ct, *tree, recipe.landmarks, recipe.chambers);
    anatomy::clear_padding(own, padding);
    return complete_chambers(std::move(own), given, *ct, recipe);
  });
  const auto walls =
      run.stage("epicardium", {ct.key, chambers.key, known.given.key, recipe_section(recipe, "epicardium")}, [&] {
        auto own = make_walls(run, *ct, *chambers, given, known.missing.walls, recipe);
        anatomy::clear_padding(own, padding);
        return own;
      });
  const auto body = run.root_stage("body", with(sources, chambers.key), [&] {
    LabelVolume own(ct->grid);
    if (make_body)
      own = anatomy::label_surroundings(anatomy::segment_body(*ct, *tree, *chambers, recipe.landmarks, recipe.chambers),
                                        anatomy::segment_trachea(*ct, *tree, recipe.landmarks));
    anatomy::clear_padding(own, padding);
    return labels::with_given(std::move(own), given, labels::Group::body);
  });
  return run.root_stage("labels", {chambers.key, walls.key, body.key, known.given.key},
                        [&] { return labels::with_all_given(anatomy::fuse_labels(*chambers, *walls, *body), given); });
}

}  // namespace heartgen::pipeline
