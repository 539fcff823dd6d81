// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/sensitivity_stages.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "benchmarks/lab/fiber_errors.hpp"
#include "benchmarks/lab/label_scores.hpp"
#include "datasets/phantom/companions.hpp"
#include "generator/anatomy/body.hpp"
#include "generator/anatomy/chambers.hpp"
#include "generator/anatomy/epicardium.hpp"
#include "generator/anatomy/fuse_labels.hpp"
#include "generator/anatomy/hounsfield.hpp"
#include "generator/anatomy/trachea.hpp"
#include "generator/anatomy/vessel.hpp"
#include "generator/anatomy/vessel_snakes.hpp"
#include "generator/pde/diffusion.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"

namespace heartgen::lab {
namespace {

using enum Region;

void note_scores(const std::string& stage, const std::vector<Score>& scores, Made& made) {
  for (const Score& score : scores) {
    made.figures[fmt::format("{}.dice.{}", stage, score.name)] = score.dice;
    made.figures[fmt::format("{}.ml.{}", stage, score.name)] = score.volume_ml;
    if (std::isfinite(score.mean_mm)) made.figures[fmt::format("{}.mm.{}", stage, score.name)] = score.mean_mm;
  }
}

void make_split(const Specimen& on, Made& made) {
  anatomy::require_hounsfield(on.phantom.ct, "phantom");
  const auto self = parallel::self();
  const auto smooth = pde::perona_malik(anatomy::as_float(on.phantom.ct), DenoiseSettings{}, self);
  made.tree = pde::segment(smooth, default_segmentation(), self);
}

void make_chambers(const Specimen& on, Made& made) {
  constexpr std::array regions = {lv_blood, rv_blood, la_blood, ra_blood, aorta, pulmonary_artery, papillary};
  made.chambers = anatomy::split_chambers(on.phantom.ct, made.tree, on.phantom.landmarks, ChamberSettings{});
  note_scores("chambers", scores_of(made.chambers, on.phantom.labels, regions), made);
}

void make_walls(const Specimen& on, Made& made) {
  constexpr std::array regions = {lv_myocardium, rv_myocardium, la_wall, ra_wall};
  made.walls = anatomy::epicardium(on.phantom.ct, made.chambers, EpicardiumSettings{}, parallel::self()).walls;
  note_scores("walls", scores_of(made.walls, on.phantom.labels, regions), made);
}

void make_body(const Specimen& on, Made& made) {
  constexpr std::array regions = {torso, lung, bone, liver, trachea};
  const auto body =
      anatomy::segment_body(on.phantom.ct, made.tree, made.chambers, on.phantom.landmarks, ChamberSettings{});
  const Mask airways = anatomy::segment_trachea(on.phantom.ct, made.tree, on.phantom.landmarks);
  const LabelVolume all = anatomy::fuse_labels(made.chambers, made.walls, anatomy::label_surroundings(body, airways));
  note_scores("body", scores_of(all, on.phantom.labels, regions), made);
}

void make_carotid(const Specimen& on, Made& made) {
  constexpr std::array regions = {carotid};
  const auto& p = on.phantom;
  const auto note = [&](const char* way, const Mask& lumen) {
    auto scores = scores_of(labelled(lumen, carotid), p.carotid_labels, regions);
    for (Score& score : scores) score.name = way;
    note_scores("carotid", scores, made);
  };
  note("edge_step", anatomy::segment_vessel(p.carotid, p.carotid_seed_mm));
  note("snakes", anatomy::segment_vessel_by_snakes(p.carotid, p.carotid_seed_mm));
}

/// On a coarse grid: what a number does shows there as well.
void make_fibers(const Specimen& on, Made& made) {
  FiberSettings settings;
  settings.grid_mm = 3;
  settings.depth_grid_mm = 1.5;
  settings.demons_iterations = {15, 8, 4};
  const auto atlas = phantom_atlas(settings.depth_grid_mm, HelixField::uniform);
  const auto hearts = fibers::register_pair(on.fibers.labels, on.fibers.landmarks, atlas, "phantom", settings);
  const auto known = known_at_voxels(on.fibers, HelixField::uniform);
  const auto walls = fibers::point_walls(hearts, known.points_mm, std::vector<std::uint8_t>(known.points_mm.size(), 1));
  const auto carried = fibers::carried_axes(hearts, walls, known.points_mm,
                                            fibers::atlas_positions(hearts, known.points_mm), settings.method);
  for (const bool left : {true, false})
    made.figures[fmt::format("fibers.deg.{}", left ? "left" : "right")] = errors_of(known, carried.axes, left).mean_deg;
}

}  // namespace

Specimen make_specimen(phantom::PhantomSettings settings, int variant) {
  constexpr double label_spacing_mm = 1.5;
  settings.variant = variant;
  settings.companions = settings.fibers = false;
  Specimen on{phantom::make_phantom(settings),
              make_fiber_case(std::to_string(variant + 1), {label_spacing_mm, label_spacing_mm, label_spacing_mm})};
  phantom::add_carotid(on.phantom, variant, settings.noise_hu);
  return on;
}

const std::vector<SensitivityStage>& sensitivity_stages() {
  static const std::vector<SensitivityStage> stages = {
      {"split", {}, make_split},           {"chambers", {"split"}, make_chambers},
      {"walls", {"chambers"}, make_walls}, {"body", {"split", "chambers", "walls"}, make_body},
      {"carotid", {}, make_carotid},       {"fibers", {}, make_fibers}};
  return stages;
}

}  // namespace heartgen::lab
