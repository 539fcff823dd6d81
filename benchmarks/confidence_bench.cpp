// SPDX-License-Identifier: GPL-3.0-or-later
// How well the confidence of automatic landmarks parts right from wrong: phantoms of many patients, grids, noises and
// poses, scans spoiled on purpose, and the public scans in the folder HEARTGEN_DATA where that is set.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>

#include "benchmarks/benchmarks.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/anatomy/padding.hpp"
#include "generator/landmarks/judge.hpp"
#include "generator/landmarks/search.hpp"
#include "generator/parallel/threads.hpp"
#include "model/crop.hpp"
#include "model/error.hpp"

namespace heartgen::benchmarks {
namespace {

constexpr std::array chambers = {Region::lv_blood, Region::rv_blood, Region::la_blood, Region::ra_blood};
constexpr double valve_mm = 15;  // farther from its place a valve parts the wrong things
constexpr double min_dice = 0.6;

/// Where things are in an image. Of a spoiled one nothing is right, whatever is found.
struct Truth {
  std::optional<phantom::HeartModel> model;
  std::map<std::string, Vec3> seeds_mm;  ///< without a model: a point of each chamber
  std::map<std::string, Vec3> valves_mm;
};

struct Case {
  std::string name;
  CtVolume ct;
  Truth truth;
};

struct Score {
  bool is_right = true;
  std::string wrong;  ///< what is, in words

  void fail(const std::string& what) {
    is_right = false;
    wrong += (wrong.empty() ? "" : ", ") + what;
  }
};

std::map<std::string, double> dice_of(const LabelVolume& found, const phantom::HeartModel& model) {
  std::array<std::array<double, 3>, 256> counts{};  // found, true, both
  const auto& size = found.grid.size;
  for (std::int64_t k = 0; k < size[2]; k += 2)
    for (std::int64_t j = 0; j < size[1]; j += 2)
      for (std::int64_t i = 0; i < size[0]; i += 2) {
        const Vec3 at =
            lps_from_index(found.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const auto mine = found(i, j, k), known = tag(phantom::region_at(model, at));
        ++counts[mine][0];
        ++counts[known][1];
        if (mine == known) ++counts[mine][2];
      }
  std::map<std::string, double> dice;
  for (const Region region : chambers) {
    const auto& [mine, known, both] = counts[tag(region)];
    dice[region_name(tag(region))] = mine + known > 0 ? 2 * both / (mine + known) : 0;
  }
  return dice;
}

void score_chambers(const landmarks::SearchResult& result, const Truth& truth, Score& score) {
  constexpr double same_pool_mm = 30;
  const auto& seeds = result.found.landmarks.seeds_mm;
  const auto dice = truth.model ? dice_of(result.chambers, *truth.model) : std::map<std::string, double>{};
  for (const Region region : chambers) {
    const std::string name = region_name(tag(region));
    const auto seed = seeds.find(name);
    if (seed == seeds.end())
      score.fail("no " + name);
    else if (truth.model && phantom::region_at(*truth.model, seed->second) != region)
      score.fail(name + " elsewhere");
    else if (!truth.model && norm(seed->second - truth.seeds_mm.at(name)) > same_pool_mm)
      score.fail(name + " elsewhere");
    else if (truth.model && dice.at(name) < min_dice)
      score.fail(fmt::format("{} Dice {:.2f}", name, dice.at(name)));
  }
}

Score score_of(const landmarks::SearchResult& result, const Truth& truth) {
  Score score;
  if (truth.valves_mm.empty()) {
    score.fail("spoiled");
    return score;
  }
  score_chambers(result, truth, score);
  for (const auto& [name, place] : truth.valves_mm) {
    const auto& valves = result.found.landmarks.valves;
    const auto at = valves.find(name);
    if (at == valves.end())
      score.fail("no " + name + " valve");
    else if (const double off = norm(at->second.center_mm - place); off > valve_mm)
      score.fail(fmt::format("{} valve {:.0f} mm off", name, off));
  }
  return score;
}

std::string volumes_of(const landmarks::FoundLandmarks& found) {
  std::string text;
  for (const Region region : chambers) {
    const auto at = found.volumes_ml.find(region_name(tag(region)));
    text += fmt::format("{}{:.0f}", text.empty() ? "" : "/", at == found.volumes_ml.end() ? 0 : at->second);
  }
  return text + " ml";
}

Row row_of(const Case& example) {
  const auto row = [&](double confidence, const std::string& note) {
    return Row{"confidence", example.name, confidence, "1", note};
  };
  try {
    const auto result = landmarks::search(example.ct);
    const Score score = score_of(result, example.truth);
    const auto& warnings = result.found.warnings;
    return row(
        result.found.confidence,
        fmt::format("{} | {} | {} | {} | {}", score.is_right ? "right" : "WRONG",
                    landmarks::trust_names.at(static_cast<std::size_t>(landmarks::trust_in(result.found.confidence))),
                    score.wrong, volumes_of(result.found), fmt::join(warnings, "; ")));
  } catch (const UserError& error) {
    return row(
        0, fmt::format("{} | refused | | | {}", example.truth.valves_mm.empty() ? "WRONG" : "no heart", error.problem));
  }
}

using Cases = std::vector<std::function<Case()>>;

struct Patient {
  int variant = 0;
  double noise_hu = 22;
  phantom::HeartOverrides heart{};
  bool fine = false;
};

Case phantom_case(const std::string& name, const Patient& patient) {
  phantom::PhantomSettings settings;
  settings.size = patient.fine ? Index3{160, 160, 110} : Index3{128, 128, 90};
  settings.spacing_mm = patient.fine ? Vec3{2.2, 2.2, 2.8} : Vec3{2.8, 2.8, 3.4};
  settings.variant = patient.variant;
  settings.noise_hu = patient.noise_hu;
  settings.overrides = patient.heart;
  settings.companions = settings.fibers = false;
  auto phantom = phantom::make_phantom(settings);
  Truth truth{phantom.model, {}, {}};
  for (const auto& [name_of, valve] : phantom.landmarks.valves) truth.valves_mm[name_of] = valve.center_mm;
  return {fmt::format("variant {} {}", patient.variant, name), std::move(phantom.ct), std::move(truth)};
}

void add_patients(Cases& cases) {
  for (const bool fine : {false, true})
    for (int variant = 0; variant < 30; variant += fine ? 5 : 1)
      cases.push_back([=] { return phantom_case(fine ? "2.2 mm" : "2.8 mm", {variant, 22, {}, fine}); });
  for (const double noise : {10.0, 40.0})
    for (int variant = 0; variant < 30; variant += 3)
      cases.push_back([=] { return phantom_case(fmt::format("noise {:g}", noise), {variant, noise}); });
}

void add_shapes(Cases& cases) {
  const std::vector<phantom::HeartOverrides> shapes = {{{}, {}, {}, Vec3{25, 0, 0}},
                                                       {{}, {}, {}, Vec3{-25, 0, 0}},
                                                       {{}, {}, {}, Vec3{0, 25, 0}},
                                                       {{}, {}, {}, Vec3{0, -25, 0}},
                                                       {{}, {}, {}, Vec3{0, 0, 25}},
                                                       {{}, {}, {}, Vec3{0, 0, -25}},
                                                       {{}, {}, {}, Vec3{20, 20, 20}},
                                                       {{}, {}, {}, Vec3{-20, -20, -20}},
                                                       {6, {}, {}, {}},
                                                       {16, {}, {}, {}},
                                                       {{}, 7.5, {}, {}},
                                                       {{}, {}, 0.8, {}},
                                                       {{}, {}, 1.25, {}}};
  for (const int variant : {0, 7})
    for (std::size_t s = 0; s < shapes.size(); ++s)
      cases.push_back([=] { return phantom_case(fmt::format("shape {}", s), {variant, 22, shapes[s]}); });
}

void mirror(CtVolume& ct, std::size_t axis) {
  const CtVolume before = ct;
  const auto& size = ct.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) {
        Index3 from{i, j, k};
        from[axis] = size[axis] - 1 - from[axis];
        ct(i, j, k) = before(from[0], from[1], from[2]);
      }
}

/// The contrast agent thinned to a share: what is brighter than enhanced muscle, but no undiluted agent and no bone.
void thin_contrast(CtVolume& ct, double share) {
  constexpr int muscle_hu = 110, bone_hu = 600;
  for (auto& hu : ct.voxels)
    if (hu > muscle_hu && hu < bone_hu) hu = static_cast<std::int16_t>(muscle_hu + share * (hu - muscle_hu));
}

/// As without contrast: the phantom's blood as dark as unenhanced blood, its muscle too; bone stays.
void take_contrast(CtVolume& ct, const phantom::HeartModel& model) {
  constexpr std::int16_t plain_hu = 45;
  const auto& size = ct.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) {
        const auto region = phantom::region_at(
            model, lps_from_index(ct.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
        if (is_blood(region) || is_myocardium(region))
          ct(i, j, k) = static_cast<std::int16_t>(plain_hu + (ct(i, j, k) % 17));
      }
}

/// Without the share of the slices (axis 2) or rows on one side.
void cut(CtVolume& ct, std::size_t axis, double from, double to) {
  Box box{{0, 0, 0}, ct.grid.size};
  const auto size = static_cast<double>(ct.grid.size[axis]);
  box.begin[axis] = static_cast<std::int64_t>(from * size);
  box.end[axis] = static_cast<std::int64_t>(to * size);
  ct = crop(ct, box);
}

struct Spoiling {
  const char* name;
  std::function<void(Case&)> spoil;
};

std::vector<Spoiling> spoilings() {
  const auto flipped = [](std::vector<std::size_t> axes) {
    return [axes = std::move(axes)](Case& c) {
      for (const auto axis : axes) mirror(c.ct, axis);
      c.truth = {};
    };
  };
  const auto cut_out = [](std::size_t axis, double from, double to) {
    return [=](Case& c) {
      cut(c.ct, axis, from, to);
      c.truth = {};
    };
  };
  return {{"mirrored", flipped({0})},
          {"front to back", flipped({1})},
          {"upside down", flipped({2})},
          {"turned in its plane", flipped({0, 1})},
          {"turned head to feet", flipped({1, 2})},
          {"cut through the ventricles from below", cut_out(2, 0.5, 1)},
          {"cut through the ventricles from above", cut_out(2, 0, 0.5)},
          {"cut through the ventricles from the front", cut_out(1, 0.45, 1)},
          {"cut through the left ventricle", cut_out(0, 0, 0.58)}};
}

void add_spoiled(Cases& cases) {
  for (int variant = 0; variant < 4; ++variant) {
    for (const auto& spoiling : spoilings())
      cases.push_back([=] {
        Case spoiled = phantom_case(spoiling.name, {variant});
        spoiling.spoil(spoiled);
        return spoiled;
      });
    cases.push_back([=] {
      Case plain = phantom_case("without contrast", {variant});
      take_contrast(plain.ct, *plain.truth.model);
      plain.truth = {};
      return plain;
    });
    for (const double share : {0.5, 0.25, 0.1})
      cases.push_back([=] {
        Case thin = phantom_case(fmt::format("contrast times {:g}", share), {variant});
        thin_contrast(thin.ct, share);
        return thin;
      });
  }
}

/// Points of the public scans, set by eye inside the pools and the valves.
const std::map<std::string, Truth>& public_scans() {
  static const std::map<std::string, Truth> scans = {{"cardiac-cta-1.5mm/ct.nii.gz",
                                                      {{},
                                                       {{"lv_blood", {48, -186, 636}},
                                                        {"la_blood", {0.3, -146.2, 664.7}},
                                                        {"rv_blood", {30, -214, 645}},
                                                        {"ra_blood", {-16.2, -188.2, 639.2}}},
                                                       {{"mitral", {23.9, -167.7, 646.2}},
                                                        {"aortic", {15.6, -184.4, 660.5}},
                                                        {"tricuspid", {-0.5, -207.9, 640.2}},
                                                        {"pulmonary", {35.2, -193.7, 687.4}}}}},
                                                     {"chest-ct-lidc-0001/ct.nii.gz",
                                                      {{},
                                                       {{"lv_blood", {63, -12, -184}},
                                                        {"la_blood", {20, 15.8, -172}},
                                                        {"rv_blood", {40, -41.2, -194}},
                                                        {"ra_blood", {-1, -29.2, -181}}},
                                                       {{"mitral", {42.6, 3.5, -180.7}},
                                                        {"aortic", {34.7, -15.1, -173.6}},
                                                        {"tricuspid", {20, -31, -198}},
                                                        {"pulmonary", {41, -38.5, -154}}}}},
                                                     {"chest-dicom-small", {}}};
  return scans;
}

Case scan_case(const std::filesystem::path& folder, const std::string& file) {
  Case scan{file, adapters::read_ct((folder / file).string()), public_scans().at(file)};
  anatomy::close_padding(scan.ct, anatomy::find_padding(scan.ct));
  return scan;
}

void add_scans(Cases& cases) {
  const char* data = std::getenv("HEARTGEN_DATA");
  if (data == nullptr) return;
  const std::filesystem::path folder = data;
  for (const auto& [file, truth] : public_scans()) {
    if (!std::filesystem::exists(folder / file)) continue;
    cases.push_back([=] { return scan_case(folder, file); });
    for (const auto& spoiling : spoilings())
      cases.push_back([=] {
        Case spoiled = scan_case(folder, file);
        spoiling.spoil(spoiled);
        spoiled.name += fmt::format(" {}", spoiling.name);
        return spoiled;
      });
    for (const double share : {0.7, 0.5, 0.25, 0.1, 0.0})
      cases.push_back([=] {
        Case thin = scan_case(folder, file);
        thin_contrast(thin.ct, share);
        if (share == 0) thin.truth = {};
        thin.name += fmt::format(" contrast times {:g}", share);
        return thin;
      });
  }
}

}  // namespace

Table bench_confidence(const Settings& settings, const parallel::Comm& comm) {
  if (!comm.is_root()) return {};
  parallel::set_thread_count(settings.threads);
  Cases cases;
  add_scans(cases);
  add_spoiled(cases);
  add_shapes(cases);
  add_patients(cases);
  Table table;
  for (const auto& make : cases) {
    table.push_back(row_of(make()));
    const Row& row = table.back();
    if (std::getenv("HEARTGEN_TRACE")) fmt::print(stderr, "{}\t{:.3f}\t{}\n", row.what, row.value, row.note);
  }
  return table;
}

}  // namespace heartgen::benchmarks
