// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/check_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <map>
#include <optional>

#include "exporters/bundle.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/anatomy/seeds.hpp"
#include "generator/atlas/atlas.hpp"
#include "generator/fibers/map_fibers.hpp"
#include "generator/labels/given_labels.hpp"
#include "generator/labels/names_file.hpp"
#include "generator/labels/presets.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/painting/region_masks.hpp"
#include "generator/pde/diffusion.hpp"
#include "generator/pde/hierarchy.hpp"
#include "generator/pipeline/image_stages.hpp"
#include "generator/pipeline/resolutions.hpp"
#include "generator/pipeline/torso_stage.hpp"
#include "generator/ventricles/ventricles.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"
#include "model/labels.hpp"
#include "model/priors.hpp"
#include "model/text.hpp"
#include "validation/uses.hpp"

namespace heartgen::pipeline {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> mesh_names = {"myocardium", "chambers", "torso", "trachea", "carotid"};

void check_meshes(const Recipe& recipe) {
  for (const auto& mesh : recipe.mesh.meshes)
    if (std::find(mesh_names.begin(), mesh_names.end(), mesh) == mesh_names.end())
      throw UserError(fmt::format("unknown mesh \"{}\"", mesh), "mesh.meshes",
                      fmt::format("known meshes: {}", fmt::join(mesh_names, ", ")));
  if (!wants(recipe, "myocardium"))
    throw UserError("\"myocardium\" is missing: every bundle has it", "mesh.meshes", "add it to the list");
  check_edges(recipe.mesh);
  mesh::check_settings(recipe.mesh);
  check_resolutions(recipe.mesh);
}

/// The tree of splits, and that chambers and body find their sides in it. A tree from a file has names of its own.
void check_segmentation(const Recipe& recipe) {
  pde::check_settings(recipe.denoise);
  pde::check_steps(recipe.segmentation);
  if (!recipe.input.labels.empty() || !recipe.replace.labels.empty() || !recipe.replace.segment.empty()) return;
  for (const auto& [key, name] : {std::pair{"chambers.blood", &recipe.chambers.blood},
                                  {"chambers.tissue", &recipe.chambers.tissue},
                                  {"chambers.soft", &recipe.chambers.soft}})
    pde::check_side(recipe.segmentation, *name, key);
}

void check_bounds(const ValidationSettings& bounds) {
  constexpr double regular_deg = 70.53;  // every cell has an angle at most as wide, and one at least as wide
  if (!(bounds.minimum_dihedral_deg >= 0 && bounds.minimum_dihedral_deg <= regular_deg))
    throw UserError(fmt::format("{:g} degrees", bounds.minimum_dihedral_deg), "validation.minimum_dihedral_deg",
                    fmt::format("give one between 0 and {}, the regular cell's", regular_deg));
  const bool is_wide = bounds.maximum_dihedral_deg >= regular_deg && bounds.maximum_dihedral_deg <= 180;
  if (bounds.maximum_dihedral_deg != 0 && !is_wide)
    throw UserError(
        fmt::format("{:g} degrees", bounds.maximum_dihedral_deg), "validation.maximum_dihedral_deg",
        fmt::format("give one between {}, the regular cell's, and 180, or 0 for the mesher's", regular_deg));
  const auto known = validation::use_names();
  for (const auto& use : bounds.uses)
    if (std::find(known.begin(), known.end(), use) == known.end())
      throw UserError(
          fmt::format("unknown use \"{}\"", use), "validation.uses",
          fmt::format("did you mean \"{}\"? All of them: {}", nearest_name(use, known), fmt::join(known, ", ")));
}

/// Other texts would be left out of the citation and the metadata without a word.
void check_date(const std::string& date) {
  int year = 0, month = 0, day = 0;
  char end = 0;
  const bool shaped = date.size() == 10 && date[4] == '-' && date[7] == '-' &&
                      std::sscanf(date.c_str(), "%4d-%2d-%2d%c", &year, &month, &day, &end) == 3;
  const std::chrono::year_month_day calendar{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                             std::chrono::day(static_cast<unsigned>(day))};
  if (!date.empty() && !(shaped && calendar.ok()))
    throw UserError(fmt::format("\"{}\" is no date", date), "date_published", "write YYYY-MM-DD, or leave it out");
}

void check_files_exist(const Recipe& recipe) {
  const auto require = [](const char* section) {
    return [section](const char* key, const std::string& path, const char*) {
      if (!path.empty() && !fs::is_directory(path))
        require_input_file(path, fmt::format("check {}.{}", section, key).c_str());
    };
  };
  InputSettings::describe_files(require("input"), recipe.input);
  ReplaceSettings::describe(require("replace"), recipe.replace);
}

void check_carotid(const Recipe& recipe) {
  if (recipe.input.carotid.empty() || !wants(recipe, "carotid")) return;
  if (recipe.replace.landmarks.empty()) carotid_seed(recipe);
  const Grid grid = adapters::read_ct(recipe.input.carotid).grid;
  const auto seed = recipe.landmarks.seeds_mm.find("carotid");
  if (seed != recipe.landmarks.seeds_mm.end()) anatomy::seed_voxel(grid, seed->first, seed->second);
}

/// Files of late stages, which are small: they are read here for their errors alone.
void check_late_files(const Recipe& recipe) {
  check_carotid(recipe);
  if (!recipe.input.atlas.empty()) atlas::read_fiber_atlas(recipe.input.atlas, recipe.input.atlas_array);
  if (!recipe.input.size_field.empty()) adapters::read_image(recipe.input.size_field);
  if (!recipe.input.label_names.empty()) labels::read_label_names(recipe.input.label_names);
  painting::read_regions(recipe.regions);
  if (!recipe.torso.landmarks.empty()) read_landmarks(recipe.torso.landmarks);
  if (!recipe.torso.labels.empty()) read_region_labels(recipe.torso.labels);
}

}  // namespace

void check_edges(const MeshSettings& settings) {
  constexpr double longest_edge_mm = 1000;  // no edge of a patient's mesh
  const std::map<std::string, double> edges{{"heart_edge_mm", settings.heart_edge_mm},
                                            {"blood_edge_mm", settings.blood_edge_mm},
                                            {"torso_edge_mm", settings.torso_edge_mm},
                                            {"trachea_edge_mm", settings.trachea_edge_mm},
                                            {"carotid_edge_mm", settings.carotid_edge_mm}};
  for (const auto& [name, edge] : edges)
    if (!(edge > 0 && edge <= longest_edge_mm))
      throw UserError(fmt::format("an edge of {:g} mm", edge), "mesh." + name,
                      fmt::format("give a positive length of at most {:g} mm", longest_edge_mm));
}

bool wants(const Recipe& recipe, const std::string& mesh) {
  return std::find(recipe.mesh.meshes.begin(), recipe.mesh.meshes.end(), mesh) != recipe.mesh.meshes.end();
}

void check_inputs(const Recipe& recipe) {
  if (recipe.input.ct.empty() && recipe.input.labels.empty())
    throw UserError("no CT given", "input.ct", "name it in the recipe or with --ct; or give labels alone");
  exporters::require_safe_names(recipe.name, recipe.version);
  check_date(recipe.date_published);
  check_files_exist(recipe);
  check_torso(recipe.torso);
  labels::label_preset(recipe.labels.preset);
  labels::check_settings(recipe.labels);
  check_segmentation(recipe);
  check_meshes(recipe);
  fibers::check_settings(recipe.fibers);
  check_bounds(recipe.validation);
  if (recipe.epicardium.max_iterations < 1)
    throw UserError(fmt::format("{} iterations", recipe.epicardium.max_iterations), "epicardium.max_iterations",
                    "give one at least; 600 are usual");
  if (!recipe.replace.landmarks.empty() && chambers_are_marked(recipe.landmarks))
    throw UserError("all chambers have seeds already, so that none are looked for", "replace.landmarks",
                    "leave out this file, or the seeds");
  check_late_files(recipe);
}

void check_seeds_inside(const Grid& grid, const Landmarks& landmarks) {
  for (const auto& [name, p] : landmarks.seeds_mm)
    if (name != "carotid") anatomy::seed_voxel(grid, name, p);
}

void refuse_cut_ventricles(const LabelVolume& labels, const anatomy::Padding& padding) {
  constexpr double mm2_per_cm2 = 100;
  const auto& size = labels.grid.size;
  const Vec3& s = labels.grid.spacing_mm;
  const std::array<double, 3> face_mm2{s.y * s.z, s.x * s.z, s.x * s.y};
  double cut_mm2 = 0;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        const auto region = static_cast<Region>(labels.voxels[v]);
        if (region != Region::lv_myocardium && region != Region::rv_myocardium && region != Region::lv_blood &&
            region != Region::rv_blood && region != Region::papillary)
          continue;
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const std::int64_t way : {-1, 1}) {
            Index3 next{i, j, k};
            next[axis] += way;
            if (!labels.grid.contains(next[0], next[1], next[2]) || padding.covers(next)) cut_mm2 += face_mm2[axis];
          }
      }
  refuse_cut_ventricles(cut_mm2 / mm2_per_cm2);
}

void refuse_cut_ventricles(double cut_cm2) {
  if (cut_cm2 > priors::ventricles_cut_max_cm2)
    throw UserError(fmt::format("the field of view cuts the ventricles, over {:.0f} cm2", cut_cm2), "CT",
                    "use a scan that shows the whole heart, or give labels of it");
}

void refuse_mirrored_heart(const LabelVolume& labels, const Landmarks& landmarks) {
  constexpr double grid_mm = 2, clearly = -0.3;
  std::optional<double> handedness;
  try {
    const auto ventricles = ventricles::ventricles_of_labels(labels, landmarks, grid_mm);
    handedness = ventricles::heart_handedness(labels, landmarks, ventricles.frame);
  } catch (const UserError&) {
    return;  // walls too thin for this grid, for one
  }
  if (handedness && *handedness < clearly)
    throw UserError("the heart is mirrored: its pulmonary valve lies on the wrong side of its tricuspid valve",
                    "labels",
                    "check the orientation in the image's header, or how the image was converted; a heart that truly "
                    "is mirrored (situs inversus) needs an atlas of its own");
}

Vec3 carotid_seed(const Recipe& recipe) {
  const auto seed = recipe.landmarks.seeds_mm.find("carotid");
  if (seed == recipe.landmarks.seeds_mm.end())
    throw UserError("no seed for the carotid", "landmarks.seeds_mm", "give a point in its lumen as \"carotid\"");
  return seed->second;
}

}  // namespace heartgen::pipeline
