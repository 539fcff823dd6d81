// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/image_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "generator/adapters/itk_io.hpp"
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
#include "generator/pipeline/check_inputs.hpp"
#include "generator/pipeline/landmarks_picture.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/text.hpp"

namespace heartgen::pipeline {
namespace {

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

bool makes_parts(const Build& b) {
  if (b.from_file("labels")) return false;
  return b.missing.any() || b.from_file("chambers") || b.from_file("epicardium") || b.from_file("body");
}

bool makes_chambers(const Build& b) {
  return makes_parts(b) && (b.missing.chambers || b.missing.vessels) && !b.from_file("chambers");
}

bool makes_body(const Build& b) { return makes_parts(b) && b.missing.body && !b.from_file("body"); }

bool needs_tree(const Build& b) { return makes_chambers(b) || makes_body(b); }

bool needs_smooth(const Build& b) { return needs_tree(b) && !b.from_file("segment"); }

bool needs_landmarks(const Build& b) {
  return (b.missing.chambers || b.missing.vessels) && !chambers_are_marked(b.recipe.landmarks);
}

Noted<CtVolume> read_ct(const Build& b) {
  return {b.has_ct() ? adapters::read_ct(b.recipe.input.ct, b.recipe.input.phase) : CtVolume{}};
}

/// Without a CT they keep their own grid.
Noted<LabelVolume> read_given(const Build& b) {
  const auto& file = b.recipe.input.labels;
  auto given = labels::read_given_labels(b.recipe.input, b.recipe.labels, b.has_ct() ? &b.ct->grid : nullptr);
  labels::refuse_no_heart(given.labels, file);
  Noted<LabelVolume> noted{std::move(given.labels), std::move(given.warnings)};
  const auto islands = labels::drop_islands(noted.value);
  noted.notes.insert(noted.notes.end(), islands.begin(), islands.end());
  return noted;
}

/// What only a CT could add is missing no more where there is none.
void find_what_is_missing(Build& b) {
  const auto& file = b.recipe.input.labels;
  b.missing = labels::missing_groups(*b.given, b.recipe.labels);
  if (b.has_ct()) labels::refuse_labels_beside_heart(*b.given, *b.ct, file);
  if (!b.has_ct()) refuse_what_needs_a_ct(*b.given, b.missing, file);
  b.missing.body &= b.has_ct();
  b.missing.vessels &= b.has_ct();
}

void settle_grid(Build& b) {
  if (!b.has_ct()) b.ct.value.grid = b.given->grid;
  b.run.files.grid = b.ct->grid;
  check_seeds_inside(b.ct->grid, b.recipe.landmarks);
}

/// What was not measured where cut lungs open into it.
Notes close_unmeasured(Build& b) {
  b.padding = anatomy::find_padding(*b.ct);
  anatomy::close_padding(b.ct.value, b.padding);
  if (!b.padding.is_there()) return {};
  return {{"ct.padding", WarningLevel::note,
           fmt::format("The CT holds {} HU where nothing was measured: the body ends there, with a surface that is "
                       "called fov_cut.",
                       b.padding.value_hu)}};
}

/// The given labels without the groups whose stage is replaced by a file.
void keep_given(Build& b) {
  LabelVolume& rest = b.kept = *b.given;
  for (const auto& [stage, group] : {std::pair{"chambers", labels::Group::chambers},
                                     {"epicardium", labels::Group::walls},
                                     {"body", labels::Group::body}})
    if (b.from_file(stage))
      for (auto& label : rest.voxels)
        if (label != 0 && labels::group_of(static_cast<Region>(label)) == group) label = 0;
}

/// The walls around the chambers, those that are given as they are. @collective
Noted<LabelVolume> make_walls(const Build& b) {
  const Recipe& recipe = b.recipe;
  LabelVolume own(b.ct->grid);
  if (b.run.agreed(b.missing.walls)) {
    if (!b.has_ct() && b.has_labels())
      return {
          parallel::run_on_root(b.run.comm, [&] { return labels::min_walls(*b.chambers, b.kept, recipe.epicardium); })};
    const LabelVolume near =
        b.kept.voxels.empty() ? *b.chambers : labels::near_heart(*b.chambers, recipe.chambers.vessel_length_mm);
    own = anatomy::epicardium(*b.ct, near, recipe.epicardium, b.run.comm, labels::only(b.kept, labels::Group::walls))
              .walls;
  }
  own = labels::with_given(std::move(own), b.kept, labels::Group::walls);
  anatomy::clear_padding(own, b.padding);
  return {std::move(own)};
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
void refuse_doubtful_landmarks(const Build& b, const Landmarks& all, double confidence) {
  const bool complete = chambers_are_marked(all);
  const bool is_needed = b.missing.chambers;  // for vessels alone nobody is asked
  if (complete &&
      ((is_needed && b.options.accept_doubtful) || landmarks::trust_in(confidence) != landmarks::Trust::doubtful))
    return;
  const std::string problem =
      complete ? fmt::format("what was found can hardly be a heart (confidence {:.2f}, at least {:g} is needed)",
                             confidence, landmarks::min_confidence)
               : "not every chamber was found";
  throw UserError(fmt::format("{}: {}", problem, fmt::join(b.found->warnings, "; ")), "landmarks",
                  (is_needed ? show_landmarks(*b.ct, picture_beside(b.options)) : "") + by_hand +
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

Notes no_vessels(const UserError& error) {
  return {{"labels.no_vessels", WarningLevel::warning,
           fmt::format("The great vessels that the given labels lack were not found in the CT: {}.", error.problem)}};
}

/// Whoever gives the chambers can do without the vessels.
Noted<landmarks::FoundLandmarks> find_landmarks(const Build& b) try {
  return {landmarks::find_landmarks(*b.ct)};
} catch (const UserError& error) {
  if (b.missing.chambers) throw;
  return {{}, no_vessels(error)};
}

/// The recipe's landmarks, completed by those that were found. What the recipe gives wins.
Notes complete_landmarks(Build& b) {
  Landmarks all = b.recipe.landmarks;
  all.seeds_mm.insert(b.found->landmarks.seeds_mm.begin(), b.found->landmarks.seeds_mm.end());
  all.valves.insert(b.found->landmarks.valves.begin(), b.found->landmarks.valves.end());
  if (!all.lv_apex_mm) all.lv_apex_mm = b.found->landmarks.lv_apex_mm;
  const double confidence = landmarks::confidence_beside(*b.found, b.recipe.landmarks);
  const bool corrected = b.from_file("landmarks");
  if (!corrected) refuse_doubtful_landmarks(b, all, confidence);
  b.recipe.landmarks = std::move(all);
  Notes notes{corrected ? Warning{"landmarks.by_hand", WarningLevel::note,
                                  "Seeds and valves come from a file that replaces what was found; nothing judged "
                                  "them."}
                        : confidence_warning(confidence)};
  for (const auto& sentence : b.found->warnings)
    notes.push_back({"landmarks.anatomy", WarningLevel::warning, "Automatic landmarks: " + sentence});
  return notes;
}

Notes adopt_landmarks(Build& b) {
  if (b.missing.chambers) {
    auto notes = complete_landmarks(b);
    if (takes_chambers_from_ct(b)) refuse_cut_ventricles(b.found->ventricles_cut_cm2);
    return notes;
  }
  const bool is_told = b.found->landmarks.seeds_mm.empty();  // by the stage
  try {
    if (!is_told) return complete_landmarks(b);
    b.missing.vessels = false;
    return {};
  } catch (const UserError& error) {
    b.missing.vessels = false;
    return no_vessels(error);
  }
}

/// The given chambers with what they lack, without gaps and pockets.
LabelVolume complete_chambers(LabelVolume own, const Build& b) {
  const LabelVolume& given = b.kept;
  if (given.voxels.empty()) return own;
  labels::refuse_organs_in_heart(given, own, b.recipe.input.labels);
  own = labels::with_given(std::move(own), given, labels::Group::chambers);
  own = labels::with_closed_gaps(std::move(own), given, b.has_ct() ? &*b.ct : nullptr);
  const double crumb_mm3 = labels::crumb_mm3(b.recipe.mesh.heart_edge_mm);
  own = labels::with_filled_pockets(std::move(own), given, 5 * crumb_mm3);  // what we make, meshes must resolve
  labels::absorb_crumbs(own, crumb_mm3);
  return own;
}

/// @collective
Noted<Volume<float>> denoise(const Build& b) {
  return {pde::perona_malik(anatomy::as_float(*b.ct), b.recipe.denoise, b.run.comm)};
}

/// @collective
Noted<pde::SegmentationTree> segment(const Build& b) {
  return {pde::segment(*b.smooth, b.recipe.segmentation, b.run.comm)};
}

Noted<LabelVolume> make_chambers(const Build& b) {
  LabelVolume own(b.ct->grid);
  if (makes_chambers(b)) own = anatomy::split_chambers(*b.ct, *b.tree, b.recipe.landmarks, b.recipe.chambers);
  anatomy::clear_padding(own, b.padding);
  return {complete_chambers(std::move(own), b)};
}

Noted<LabelVolume> make_body(const Build& b) {
  const Landmarks& landmarks = b.recipe.landmarks;
  LabelVolume own(b.ct->grid);
  if (makes_body(b))
    own = anatomy::label_surroundings(anatomy::segment_body(*b.ct, *b.tree, *b.chambers, landmarks, b.recipe.chambers),
                                      anatomy::segment_trachea(*b.ct, *b.tree, landmarks));
  anatomy::clear_padding(own, b.padding);
  return {labels::with_given(std::move(own), b.kept, labels::Group::body)};
}

Noted<LabelVolume> make_labels(const Build& b) {
  if (!makes_parts(b)) return {*b.given};
  return {labels::with_all_given(anatomy::fuse_labels(*b.chambers, *b.walls, *b.body), b.kept)};
}

/// On which chambers and body depend.
Sources sources_of_parts(const Build& b) {
  return {b.tree.key, b.given.key, recipe_section(b.recipe, "landmarks"), recipe_section(b.recipe, "chambers")};
}

Sources with(Sources keys, const std::string& key) {
  keys.push_back(key);
  return keys;
}

Sources sources_of_ct(const Build& b) { return {b.hash("ct"), fmt::to_string(b.recipe.input.phase)}; }
Sources sources_of_given(const Build& b) {
  return {b.ct.key, b.hash("labels") + b.hash("label_names"), recipe_section(b.recipe, "labels")};
}
Sources sources_of_landmarks(const Build& b) { return {b.ct.key}; }
Sources sources_of_smooth(const Build& b) { return {b.ct.key, recipe_section(b.recipe, "denoise")}; }
Sources sources_of_tree(const Build& b) { return {b.smooth.key, recipe_section(b.recipe, "segmentation")}; }
/// Given labels' crumbs depend on the edges.
Sources sources_of_chambers(const Build& b) {
  return with(sources_of_parts(b), b.has_labels() ? fmt::to_string(b.recipe.mesh.heart_edge_mm) : "");
}
Sources sources_of_walls(const Build& b) {
  return {b.ct.key, b.chambers.key, b.given.key, recipe_section(b.recipe, "epicardium")};
}
Sources sources_of_body(const Build& b) { return with(sources_of_parts(b), b.chambers.key); }
Sources sources_of_labels(const Build& b) {
  if (!makes_parts(b)) return {b.given.key};
  return {b.chambers.key, b.walls.key, b.body.key, b.given.key};
}

constexpr Needed has_labels = [](const Build& b) { return b.has_labels(); };
constexpr Needed has_no_labels = [](const Build& b) { return !b.has_labels(); };

}  // namespace

bool chambers_are_marked(const Landmarks& landmarks) {
  for (const char* chamber : {"lv_blood", "rv_blood", "la_blood", "ra_blood"})
    if (!landmarks.seeds_mm.contains(chamber)) return false;
  return true;
}

bool takes_chambers_from_ct(const Build& b) {
  return b.missing.chambers && !b.from_file("chambers") && !b.from_file("labels");
}

std::filesystem::path picture_beside(const BuildOptions& options) {
  if (options.output.empty()) return {};
  return options.output.string() + ".landmarks.png";
}

Notes label_notes(const LabelVolume& given, const LabelVolume& heart, bool has_ct) {
  Notes notes;
  if (!given.voxels.empty()) {
    notes.push_back(completion_warning(given, heart, has_ct));
    if (auto grown = grown_regions(given, heart); !grown.empty())
      notes.push_back(
          {"labels.grown", WarningLevel::note,
           fmt::format("Gaps and pockets beside the given regions were closed: {}.", fmt::join(grown, ", "))});
  }
  const auto valves = labels::closed_valves(heart);
  notes.insert(notes.end(), valves.begin(), valves.end());
  return notes;
}

Stages input_stages() {
  return {stage("read", 1, always, &Build::ct, sources_of_ct, read_ct),
          stage("given", 3, has_labels, &Build::given, sources_of_given, read_given),
          step(has_labels, find_what_is_missing), step(always, settle_grid), step(has_no_labels, close_unmeasured)};
}

Stages landmark_stages() {
  return {stage("landmarks", 8, needs_landmarks, &Build::found, sources_of_landmarks, find_landmarks),
          step(needs_landmarks, adopt_landmarks)};
}

Stages label_stages() {
  return {step(needs_tree, [](Build& b) { anatomy::require_hounsfield(*b.ct); }),
          step(makes_parts, keep_given),
          stage("denoise", 2, needs_smooth, &Build::smooth, sources_of_smooth, denoise, On::all_ranks),
          stage("segment", 8, needs_tree, &Build::tree, sources_of_tree, segment, On::all_ranks),
          stage("chambers", 8, makes_parts, &Build::chambers, sources_of_chambers, make_chambers),
          stage("epicardium", 10, makes_parts, &Build::walls, sources_of_walls, make_walls, On::all_ranks),
          stage("body", 5, makes_parts, &Build::body, sources_of_body, make_body),
          stage("labels", 3, always, &Build::heart, sources_of_labels, make_labels)};
}

}  // namespace heartgen::pipeline
