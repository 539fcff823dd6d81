// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/pipeline.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "generator/pipeline/bundle_stage.hpp"
#include "generator/pipeline/check_inputs.hpp"
#include "generator/pipeline/image_stages.hpp"
#include "generator/pipeline/input_files.hpp"
#include "generator/pipeline/mesh_stages.hpp"
#include "generator/pipeline/print_certificate.hpp"
#include "generator/pipeline/torso_stage.hpp"
#include "generator/pipeline/user_regions.hpp"
#include "model/error.hpp"
#include "model/memory.hpp"
#include "model/own_file.hpp"

namespace heartgen::pipeline {
namespace {

namespace fs = std::filesystem;

void hash_inputs(Build& b) {
  const auto add = [&](const std::string& role, const std::string& path) {
    if (path.empty()) return;
    b.inputs.push_back(hash_input(role, path));
    b.hashes[role] = b.inputs.back().sha256;
  };
  InputSettings::describe_files([&](const char* key, const std::string& path, const char*) { add(key, path); },
                                b.recipe.input);
  TorsoSettings::describe_files(
      [&](const char* key, const std::string& path, const char*) { add(std::string("torso.") + key, path); },
      b.recipe.torso);
  for (const auto& region : b.recipe.regions) add("regions", region.file);
}

/// What the image stages depend on, for recognising their files.
std::string origin_of(const Build& b) {
  std::string text = b.run.program_hash + fmt::format("{}\n", b.recipe.input.phase);
  for (const char* input : {"ct", "labels", "label_names"}) text += b.hash(input) + "\n";
  for (const char* section : {"labels", "landmarks", "denoise", "segmentation", "chambers", "epicardium"})
    text += recipe_section(b.recipe, section);
  return exporters::sha256_of_text(text);
}

StageFiles stage_files(const Recipe& recipe, const BuildOptions& options) {
  StageFiles files;
  files.keep_folder = options.keep_stages;
  ReplaceSettings::describe(
      [&](const char* stage, const std::string& file, const char*) {
        if (!file.empty()) files.replaced_by[stage] = file;
      },
      recipe.replace);
  return files;
}

/// Regions that meshing and fibres cannot do without.
void refuse_empty_regions(const Build& b) {
  if (!b.has_labels()) return;
  for (const Region region : needed_regions())
    if (!labels::holds(*b.heart, region))
      throw UserError(fmt::format("no voxel is {}, and every heart needs it", region_name(tag(region))),
                      b.recipe.input.labels,
                      "map it in [labels.regions], or let labels.complete have it made from the CT");
}

/// Leaves in the recipe the files that changed a result, and says so.
Notes settle_replacements(Build& b) {
  Notes notes;
  const auto changed = [&](const std::string& stage) {
    return std::any_of(b.run.files.changed.begin(), b.run.files.changed.end(),
                       [&](const auto& entry) { return entry.substr(0, entry.find(' ')) == stage; });
  };
  ReplaceSettings::describe(
      [&](const char* stage, std::string& file, const char*) {
        if (!file.empty() && changed(stage)) {
          b.inputs.push_back(hash_input(stage, file));
          notes.push_back({"stage.replaced", WarningLevel::note,
                           fmt::format("The result of the stage \"{}\" was replaced by the file {}.", stage,
                                       fs::path(file).filename().string())});
        } else {
          file.clear();
        }
      },
      b.recipe.replace);
  return notes;
}

/// What can be refused before the first stage is; the output's place is taken.
void begin(Build& b) {
  const fs::path& cache_folder = b.options.cache_folder;
  b.new_cache = NewCache(cache_folder);
  check_inputs(b.recipe);
  b.place = exporters::reserve_place(b.options.output, existing_output(b.options));
  if (!b.place.remark.empty() && b.options.tells_warnings) fmt::print(stderr, "heartgen: {}\n", b.place.remark);
  clear_unfinished_entries(cache_folder);
  hash_inputs(b);
  b.run.program_hash = exporters::sha256_of_file(own_file());
  b.run.files.origin = origin_of(b);
}

/// From here on nothing is refused, and what fails for want of room goes on where it stopped.
void refuse_no_heart(Build& b) {
  anatomy::reopen_padding(b.ct.value, b.padding);
  refuse_empty_regions(b);
  check_memory(*b.heart, b.recipe.mesh, memory_bytes());
  if (takes_chambers_from_ct(b)) refuse_cut_ventricles(*b.heart, b.padding);
  refuse_mirrored_heart(*b.heart, b.recipe.landmarks);
  b.regions = regions_on_walls(b.recipe, *b.heart);
  b.recipe.regions = painting::with_names(b.recipe.regions, b.regions);
  b.new_cache.keep();
}

Notes remark_on_labels(Build& b) { return label_notes(*b.given, *b.heart, b.has_ct()); }

/// Not before: a refusal is one message.
void print_notes(Build& b) {
  if (b.options.tells_warnings) print_warnings(b.run.notes);
}

void clean_cache(Build& b) { forget_other_entries(b.options.cache_folder, b.run.used_keys); }

Stages build_stages() {
  return joined({{step(always, begin)},
                 input_stages(),
                 landmark_stages(),
                 label_stages(),
                 {step(always, refuse_no_heart), step(always, remark_on_labels), step(always, print_notes),
                  step(always, settle_replacements)},
                 torso_stages(),
                 mesh_stages(),
                 bundle_stages(),
                 {step(always, clean_cache)}});
}

}  // namespace

BuildResult build(const Recipe& recipe, const BuildOptions& options, const parallel::Comm& comm) {
  Build b;
  b.recipe = recipe;
  b.options = options;
  b.run.comm = comm;
  b.run.cache_folder = options.cache_folder;
  b.run.progress = make_progress({}, options.progress && comm.is_root());
  if (comm.is_root()) b.run.progress.on_stage = options.on_stage;
  b.run.files = stage_files(recipe, options);
  run_stages(build_stages(), b);
  return {b.written.content_id, b.written.certificate, time_log(b.run) + b.written.fibers_from};
}

}  // namespace heartgen::pipeline
