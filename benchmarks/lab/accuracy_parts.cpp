// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/accuracy_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "benchmarks/lab/label_scores.hpp"
#include "datasets/phantom/companions.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/anatomy/epicardium.hpp"
#include "generator/anatomy/trachea.hpp"
#include "generator/anatomy/vessel.hpp"
#include "generator/anatomy/vessel_snakes.hpp"
#include "generator/labels/given_labels.hpp"
#include "generator/pde/diffusion.hpp"
#include "generator/pde/hierarchy.hpp"
#include "model/error.hpp"

namespace heartgen::lab {
namespace {

using Json = nlohmann::json;

constexpr int refused = 3;

struct PartCase {
  int variant = 0;
  double noise_hu = 0;
  std::vector<Score> scores{};
  std::vector<std::pair<std::string, double>> shares{};  ///< of a volume, 0 to 1
  std::string refusal{};
};

/// Blood, papillary muscles, and the great vessels as far as a build follows them.
LabelVolume true_chambers(const LabelVolume& truth) {
  LabelVolume chambers = truth;
  for (auto& label : chambers.voxels) {
    const auto region = static_cast<Region>(label);
    if (!is_blood(region) && region != Region::papillary) label = 0;
  }
  return labels::near_heart(std::move(chambers), Recipe{}.chambers.vessel_length_mm);
}

/// How much of one region of the truth has another region's label.
double share_called(const LabelVolume& ours, const LabelVolume& truth, Region region, Region called) {
  std::int64_t all = 0, wrong = 0;
  for (std::size_t v = 0; v < truth.voxels.size(); ++v) {
    if (truth.voxels[v] != tag(region)) continue;
    ++all;
    wrong += ours.voxels[v] == tag(called);
  }
  return all > 0 ? static_cast<double>(wrong) / static_cast<double>(all) : 0;
}

/// @collective
void measure_walls(const phantom::Phantom& phantom, const parallel::Comm& comm, PartCase& result) {
  constexpr std::array walls = {Region::lv_myocardium, Region::rv_myocardium, Region::la_wall, Region::ra_wall};
  const LabelVolume chambers = parallel::run_on_root(comm, [&] { return true_chambers(phantom.labels); });
  const auto found = anatomy::epicardium(phantom.ct, chambers, {}, comm).walls;
  if (!comm.is_root()) return;
  result.scores = scores_of(found, phantom.labels, walls);
  result.shares = {
      {"rv wall called lv", share_called(found, phantom.labels, Region::rv_myocardium, Region::lv_myocardium)},
      {"lv wall called rv", share_called(found, phantom.labels, Region::lv_myocardium, Region::rv_myocardium)}};
}

/// The build's stages up to the first split, which parts air and tissue. @collective
void measure_trachea(const phantom::Phantom& phantom, const parallel::Comm& comm, PartCase& result) {
  constexpr std::array parts = {Region::trachea};
  Volume<float> image(phantom.ct.grid);
  std::copy(phantom.ct.voxels.begin(), phantom.ct.voxels.end(), image.voxels.begin());
  const auto smooth = pde::perona_malik(image, Recipe{}.denoise, comm);
  const auto tree = pde::segment(smooth, {default_segmentation().front()}, comm);
  if (!comm.is_root()) return;
  const Mask lumen = anatomy::segment_trachea(phantom.ct, tree, {});
  result.scores = scores_of(labelled(lumen, Region::trachea), phantom.labels, parts);
}

void measure_carotid(const phantom::PhantomSettings& settings, PartCase& result) {
  constexpr std::array parts = {Region::carotid};
  phantom::Phantom phantom;
  phantom::add_carotid(phantom, settings.variant, settings.noise_hu);
  const auto add = [&](const char* name, const Mask& lumen) {
    for (Score score : scores_of(labelled(lumen, Region::carotid), phantom.carotid_labels, parts)) {
      score.name = name;
      result.scores.push_back(score);
    }
  };
  add("edge step", anatomy::segment_vessel(phantom.carotid, phantom.carotid_seed_mm));
  add("snakes", anatomy::segment_vessel_by_snakes(phantom.carotid, phantom.carotid_seed_mm));
}

/// @collective
PartCase measure(const std::string& part, const phantom::PhantomSettings& settings, const parallel::Comm& comm) {
  PartCase result{.variant = settings.variant, .noise_hu = settings.noise_hu};
  try {
    if (part == "carotid") {
      parallel::run_on_root(comm, [&] { measure_carotid(settings, result); });
      return result;
    }
    phantom::Phantom phantom;
    parallel::run_on_root(comm, [&] { phantom = phantom::make_phantom(settings); });
    if (part == "walls")
      measure_walls(phantom, comm, result);
    else
      measure_trachea(phantom, comm, result);
  } catch (const UserError& error) {
    result.refusal = error.what();
  }
  return result;
}

void print_case(const PartCase& c) {
  fmt::print("variant {:>2}, noise {:>2g} HU", c.variant, c.noise_hu);
  for (const Score& score : c.scores)
    fmt::print(" | {}: dice {:.3f}, distance {:.3f} mm, at most {:.1f}", score.name, score.dice, score.mean_mm,
               score.max_mm);
  for (const auto& [name, share] : c.shares) fmt::print(" | {}: {:.2f} %", name, 100 * share);
  fmt::print("{}\n", c.refusal.empty() ? "" : " | refused: " + c.refusal);
  std::fflush(stdout);
}

void print_means(const std::vector<PartCase>& cases) {
  for (std::size_t n = 0; !cases.empty() && n < cases.front().scores.size(); ++n) {
    double dice = 0, distance = 0, least = 1;
    int count = 0;
    for (const PartCase& c : cases) {
      if (n >= c.scores.size()) continue;
      dice += c.scores[n].dice, distance += c.scores[n].mean_mm, ++count;
      least = std::min(least, c.scores[n].dice);
    }
    fmt::print("mean of {}: {}: dice {:.3f} (least {:.3f}), distance {:.3f} mm\n", count, cases.front().scores[n].name,
               dice / count, least, distance / count);
  }
}

Json as_json(const std::string& part, const PartCase& c) {
  Json row{{"part", part}, {"variant", c.variant}, {"noise_hu", c.noise_hu}, {"refusal", c.refusal}};
  for (const Score& score : c.scores)
    row["scores"][score.name] = {
        {"dice", score.dice}, {"surface_distance_mean", score.mean_mm}, {"surface_distance_max", score.max_mm}};
  for (const auto& [name, share] : c.shares) row["shares"][name] = share;
  return row;
}

}  // namespace

int accuracy_of_part(const AccuracyCommand& command, const std::vector<phantom::PhantomSettings>& phantoms,
                     const parallel::Comm& comm) {
  if (command.of != "walls" && command.of != "carotid" && command.of != "trachea")
    throw UserError(fmt::format("\"{}\" is no part that can be measured", command.of), "--of",
                    "choose chambers, walls, carotid or trachea");
  const bool table = comm.is_root() && !command.json;
  std::vector<PartCase> cases;
  for (const auto& settings : phantoms) {
    cases.push_back(measure(command.of, settings, comm));
    if (table) print_case(cases.back());
  }
  if (table) print_means(cases);
  if (comm.is_root() && command.json) {
    Json rows = Json::array();
    for (const PartCase& c : cases) rows.push_back(as_json(command.of, c));
    fmt::print("{}\n", rows.dump(1));
  }
  const bool all_good = std::all_of(cases.begin(), cases.end(), [](const PartCase& c) { return c.refusal.empty(); });
  return parallel::run_on_root(comm, [&] { return all_good ? 0 : refused; });
}

}  // namespace heartgen::lab
