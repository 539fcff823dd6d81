// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/torso_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "generator/adapters/itk_io.hpp"
#include "generator/pipeline/image_stages.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"

namespace heartgen::pipeline {
namespace {

constexpr const char* section = "recipe, [torso]";

/// Stands for the torso's files.
std::string hash_of_torso(const Build& b) {
  return b.hash("torso.ct") + b.hash("torso.labels") + b.hash("torso.landmarks");
}

/// A map's 3 rows of 4 numbers, and the map of such numbers.
std::vector<double> numbers_of(const AffineMap& map) {
  std::vector<double> numbers;
  for (int row = 0; row < 3; ++row)
    numbers.insert(numbers.end(), {map.matrix[row].x, map.matrix[row].y, map.matrix[row].z, map.offset_mm[row]});
  return numbers;
}

AffineMap map_of(const std::vector<double>& numbers) {
  AffineMap map;
  for (int row = 0; row < 3; ++row) {
    const auto at = 4 * static_cast<std::size_t>(row);
    map.matrix[row] = {numbers[at], numbers[at + 1], numbers[at + 2]};
    map.offset_mm[row] = numbers[at + 3];
  }
  return map;
}

/// A rigid map's is 1 to the last bit: a grid's spacing stays what it is.
double scale_of(const AffineMap& map) {
  constexpr double rounding = 1e-9;
  const double scale = math::cbrt(determinant(map.matrix));
  return std::abs(scale - 1) < rounding ? 1 : scale;
}

/// The matrix of a pose is a rotation times one scale.
bool is_similarity(const AffineMap& map) {
  constexpr double tolerance = 1e-6;
  const double scale = math::cbrt(determinant(map.matrix));
  if (!(scale > 0.2 && scale < 5)) return false;
  const Mat3 square = map.matrix * transposed(map.matrix);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!(std::abs(square[i][j] / (scale * scale) - (i == j ? 1 : 0)) < tolerance)) return false;
  return std::isfinite(norm(map.offset_mm));
}

/// The other patient's CT goes through the same image stages; their progress is not shown, their results are not kept.
/// @collective
Noted<Person> segmented(const Build& b) try {
  Build own;
  own.recipe = b.recipe;
  own.recipe.input = {};
  own.recipe.input.ct = b.recipe.torso.ct;
  own.recipe.replace = {};
  own.recipe.landmarks = b.recipe.torso.landmarks.empty() ? Landmarks{} : read_landmarks(b.recipe.torso.landmarks);
  own.run.comm = b.run.comm;
  own.run.cache_folder = b.run.cache_folder;
  own.run.program_hash = b.run.program_hash;
  own.hashes["ct"] = hash_of_torso(b);
  run_stages(joined({input_stages(), landmark_stages(), label_stages()}), own);
  Noted<Person> person{{std::move(own.heart.value), own.recipe.landmarks, own.padding, own.run.used_keys}};
  for (const auto& [code, level, text] : own.run.notes)
    person.notes.push_back({"torso." + code, level, "The torso's CT: " + text});
  return person;
} catch (const UserError& error) {
  throw UserError(error.problem, "[torso] of the recipe, " + error.where, error.remedy);
}

Person read_person(const TorsoSettings& settings) {
  Person person;
  person.labels = adapters::read_labels(settings.labels);
  if (!settings.landmarks.empty()) person.landmarks = read_landmarks(settings.landmarks);
  return person;
}

labels::TorsoPose given_pose(const TorsoSettings& settings) {
  labels::TorsoPose pose;
  pose.torso_from_heart = map_of(settings.torso_from_heart);
  pose.scale = scale_of(pose.torso_from_heart);
  return pose;
}

TorsoAround place(const LabelVolume& heart, const Recipe& recipe, const Person& person) {
  TorsoAround around;
  if (recipe.torso.torso_from_heart.empty()) {
    const auto marks = labels::common_marks(heart, recipe.landmarks, person.labels, person.landmarks);
    around.pose = labels::fit_torso(marks, recipe.torso.with_scale);
    for (const auto& mark : marks) around.marks.push_back(mark.name);
  } else {
    around.pose = given_pose(recipe.torso);
  }
  auto placed = labels::place_heart(heart, person.labels, around.pose);
  around.labels = std::move(placed.labels);
  around.outside_share = placed.outside_share;
  around.bone_share = placed.bone_share;
  const auto& to_torso = around.pose.torso_from_heart;
  const bool in_torso = recipe.torso.frame == "torso";
  if (in_torso) around.labels.grid = moved(around.labels.grid, to_torso);
  around.torso_padding = person.padding;
  around.torso_grid = in_torso ? person.labels.grid : moved(person.labels.grid, inverse(to_torso));
  return around;
}

std::string remark_of(const TorsoAround& around, const TorsoSettings& settings) {
  const std::string how = around.marks.empty() ? std::string("its pose was given")
                                               : fmt::format("{} marks of both agree to {:.1f} mm (root mean square)",
                                                             around.marks.size(), around.pose.rms_mm);
  return fmt::format("The body around the heart is another patient's ({}); {}, its scale is {:.3f}.",
                     std::filesystem::path(settings.ct + settings.labels).filename().string(), how, around.pose.scale);
}

/// The other patient's map and the pose depend on them.
Sources sources_of_torso(const Build& b) {
  std::string sections;
  for (const char* name : {"denoise", "segmentation", "chambers", "epicardium", "landmarks", "torso"})
    sections += recipe_section(b.recipe, name);
  return {b.heart.key, hash_of_torso(b), sections};
}

Noted<TorsoAround> place_in_torso(const Build& b) {
  const auto& labels = b.recipe.torso.labels;
  return {place(*b.heart, b.recipe, labels.empty() ? b.other : read_person(b.recipe.torso))};
}

/// The pose is left in the recipe. Where the bundle has the torso's frame, the grids of the heart's images go there:
/// whatever is made from them is there, too.
Notes adopt_pose(Build& b) {
  Notes notes{{"torso.other_patient", WarningLevel::note, remark_of(*b.around, b.recipe.torso)}};
  const auto& pose = b.around->pose.torso_from_heart;
  b.recipe.torso.torso_from_heart = numbers_of(pose);
  b.recipe.torso.landmarks.clear();  // the pose is what they gave
  if (b.recipe.torso.frame == "torso") {
    b.heart.value.grid = moved(b.heart->grid, pose);
    b.ct.value.grid = moved(b.ct->grid, pose);
  }
  b.run.used_keys.insert(b.run.used_keys.end(), b.other.used_keys.begin(), b.other.used_keys.end());
  b.other = {};
  return notes;
}

}  // namespace

void check_torso(const TorsoSettings& s) {
  if (!s.is_given()) {
    if (!s.landmarks.empty() || !s.torso_from_heart.empty() || s.frame != "heart")
      throw UserError("there is no torso", section, "name another patient's ct or labels, or leave the section out");
    return;
  }
  if (!s.ct.empty() && !s.labels.empty())
    throw UserError("both ct and labels are given", section, "name one: labels are taken as they are");
  TorsoSettings::describe_files(
      [](const char* key, const std::string& file, const char*) {
        if (!file.empty() && !std::filesystem::is_directory(file))
          require_input_file(file, fmt::format("check torso.{}", key).c_str());
      },
      s);
  if (s.frame != "heart" && s.frame != "torso")
    throw UserError(fmt::format("unknown frame \"{}\"", s.frame), section, "use \"heart\" or \"torso\"");
  if (s.torso_from_heart.empty()) return;
  if (s.torso_from_heart.size() != 12)
    throw UserError(fmt::format("torso_from_heart has {} numbers", s.torso_from_heart.size()), section,
                    "give 3 rows of 4 numbers, or leave it out to have it fitted");
  if (!is_similarity(map_of(s.torso_from_heart)))
    throw UserError("torso_from_heart is not a rotation, a shift and one scale between 0.2 and 5", section,
                    "correct it, or leave it out to have it fitted");
}

Stages torso_stages() {
  constexpr Needed has_torso = [](const Build& b) { return b.has_torso(); };
  constexpr Needed has_torso_ct = [](const Build& b) { return !b.recipe.torso.ct.empty(); };
  return {last_stage("torso_ct", 30, has_torso_ct, &Build::other, segmented, On::all_ranks),
          stage("torso", 3, has_torso, &Build::around, sources_of_torso, place_in_torso), step(has_torso, adopt_pose)};
}

Landmarks landmarks_in_bundle(const Recipe& recipe) {
  if (recipe.torso.frame != "torso") return recipe.landmarks;
  return moved(recipe.landmarks, map_of(recipe.torso.torso_from_heart));
}

Grid grid_in_bundle(const Recipe& recipe, const Grid& of_heart) {
  if (recipe.torso.frame != "torso") return of_heart;
  return moved(of_heart, map_of(recipe.torso.torso_from_heart));
}

Grid moved(const Grid& grid, const AffineMap& map) {
  const double scale = scale_of(map);
  Grid result = grid;
  result.origin_mm = map(grid.origin_mm);
  result.spacing_mm = scale * grid.spacing_mm;
  result.direction = map.matrix * grid.direction;
  for (auto& row : result.direction.rows) row = row / scale;
  return result;
}

Landmarks moved(const Landmarks& landmarks, const AffineMap& map) {
  const double scale = scale_of(map);
  Landmarks result = landmarks;
  for (auto& [name, point] : result.seeds_mm) point = map(point);
  for (auto& [name, valve] : result.valves)
    valve = {map(valve.center_mm), normalized(map.matrix * valve.normal), scale * valve.radius_mm};
  if (result.lv_apex_mm) result.lv_apex_mm = map(*result.lv_apex_mm);
  return result;
}

Report torso_rows(const TorsoAround& around) {
  Report rows;
  const auto add = [&](const std::string& metric, double value, const char* unit) {
    rows.push_back({"pose", "torso", metric, value, unit, {}, {}});
  };
  add("scale", around.pose.scale, "");
  if (!around.marks.empty()) add("marks_rms", around.pose.rms_mm, "mm");
  for (std::size_t m = 0; m < around.marks.size(); ++m)
    add("mark_distance_" + around.marks[m], around.pose.residual_mm[m], "mm");
  add("heart_outside_body", around.outside_share, "");
  add("heart_in_bone", around.bone_share, "");
  return rows;
}

}  // namespace heartgen::pipeline
