// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/accuracy_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "benchmarks/lab/accuracy_parts.hpp"
#include "benchmarks/study/study.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/adapters/image_checks.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/landmarks/landmarks.hpp"
#include "generator/pipeline/image_stages.hpp"
#include "model/crop.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"
#include "model/text.hpp"
#include "validation/contour_fit.hpp"

namespace heartgen::lab {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr int below_bounds = 3;
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

struct Bound {
  Region region;
  const char* heading;
  double min_dice;
};
/// What a phantom at 0.5 x 0.5 x 1.2 mm must reach, any variant, any noise up to 40 HU.
constexpr std::array<Bound, 6> bounds = {{{Region::lv_blood, "lv", 0.98},
                                          {Region::lv_myocardium, "lv wall", 0.95},
                                          {Region::rv_blood, "rv", 0.97},
                                          {Region::rv_myocardium, "rv wall", 0.80},
                                          {Region::la_blood, "la", 0.96},
                                          {Region::ra_blood, "ra", 0.96}}};
constexpr double max_distance_mm = 0.4;
constexpr std::array<const char*, 4> valve_names = {"mitral", "aortic", "tricuspid", "pulmonary"};

struct ValveError {
  double center_mm = nothing, normal_deg = nothing;
};

/// What one phantom gave.
struct Case {
  int variant = 0;
  double noise_hu = 0, right_minus_muscle_hu = 0;
  std::string refusal;                                       ///< the message, where a stage refused the image
  std::map<std::string, std::map<std::string, double>> fit;  ///< region, then metric
  std::map<std::string, ValveError> valves;
  double axis_deg = nothing, confidence = nothing, seconds = 0;
  std::vector<std::string> warnings;
};

int whole_number(std::string_view text) {
  int value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0)
    throw UserError(fmt::format("\"{}\" is no phantom", text), "--variants", "write numbers and ranges, such as 0-4,9");
  return value;
}

std::vector<int> variant_list(const std::string& text) {
  std::vector<int> variants;
  for (std::size_t at = 0; at <= text.size();) {
    const auto end = std::min(text.find(',', at), text.size());
    const std::string_view part(text.data() + at, end - at);
    const auto dash = part.find('-');
    const int first = whole_number(part.substr(0, dash));
    const int last = dash == std::string_view::npos ? first : whole_number(part.substr(dash + 1));
    if (last < first)
      throw UserError(fmt::format("\"{}\" is no range", part), "--variants", "write the smaller number first: 0-4");
    for (int variant = first; variant <= last; ++variant) variants.push_back(variant);
    at = end + 1;
  }
  return variants;
}

double angle_between_deg(const Vec3& a, const Vec3& b) {
  return math::acos(std::clamp(dot(normalized(a), normalized(b)), -1.0, 1.0)) * 180 / std::numbers::pi;
}

void compare_landmarks(const phantom::Phantom& phantom, const landmarks::FoundLandmarks& found, Case& result) {
  result.confidence = found.confidence;
  result.warnings = found.warnings;
  result.axis_deg = angle_between_deg(found.long_axis, -phantom::long_axis(phantom.model));
  for (const auto& [name, truth] : phantom.landmarks.valves) {
    const auto at = found.landmarks.valves.find(name);
    if (at != found.landmarks.valves.end())
      result.valves[name] = {norm(at->second.center_mm - truth.center_mm),
                             angle_between_deg(at->second.normal, truth.normal)};
  }
}

/// Only the heart's regions, and only the box that holds both maps' heart.
void compare_maps(const LabelVolume& labels, const LabelVolume& truth, Case& result) {
  const auto is_compared = [](std::uint8_t label) {
    return std::any_of(bounds.begin(), bounds.end(), [&](const Bound& b) { return label == tag(b.region); }) ||
           label == tag(Region::papillary) || label == tag(Region::la_wall) || label == tag(Region::ra_wall);
  };
  const auto ours = bounding_box(labels, 1, is_compared);
  auto box = bounding_box(truth, 1, is_compared);
  for (std::size_t a = 0; a < 3 && !ours.empty(); ++a) {
    box.begin[a] = std::min(box.begin[a], ours.begin[a]);
    box.end[a] = std::max(box.end[a], ours.end[a]);
  }
  LabelVolume mine = crop(labels, box), reference = crop(truth, box);
  for (auto* map : {&mine, &reference})
    for (auto& label : map->voxels)
      if (!is_compared(label)) label = 0;
  for (const auto& row : validation::compare_labels(mine, reference)) result.fit[row.scope][row.metric] = row.value;
}

fs::path case_folder(const std::string& keep, const phantom::PhantomSettings& settings) {
  return fs::path(keep) / fmt::format("variant-{}-noise-{:g}", settings.variant, settings.noise_hu);
}

void keep_images(const fs::path& folder, const phantom::Phantom& phantom, const LabelVolume& labels) {
  fs::create_directories(folder);
  adapters::write_volume((folder / "ct.nii.gz").string(), phantom.ct);
  adapters::write_volume((folder / "truth.nii.gz").string(), phantom.labels);
  adapters::write_volume((folder / "labels.nii.gz").string(), labels);
}

double total_seconds(const pipeline::Run& run) {
  double seconds = 0;
  for (const auto& time : run.times) seconds += time.seconds;
  return seconds;
}

/// The image stages of a build with an empty recipe. @collective
Case measure(const phantom::PhantomSettings& settings, const std::string& keep, const parallel::Comm& comm) {
  Case result;
  result.variant = settings.variant;
  result.noise_hu = settings.noise_hu;
  pipeline::Build build;
  build.run.comm = comm;
  build.recipe.segmentation = default_segmentation();
  phantom::Phantom phantom;
  parallel::run_on_root(comm, [&] { phantom = phantom::make_phantom(settings); });
  result.right_minus_muscle_hu =
      phantom::right_heart_contrast_hu(phantom::make_heart_model(settings.variant, settings.overrides));
  try {
    build.ct.value = phantom.ct;
    const auto found = build.run.stage(pipeline::On::root, "landmarks", {}, [&] {
      return pipeline::Noted<landmarks::FoundLandmarks>{landmarks::find_landmarks(phantom.ct)};
    });
    build.recipe.landmarks = found->landmarks;
    if (comm.is_root()) compare_landmarks(phantom, *found, result);
    run_stages(pipeline::label_stages(), build);
    if (comm.is_root()) compare_maps(*build.heart, phantom.labels, result);
    if (comm.is_root() && !keep.empty()) keep_images(case_folder(keep, settings), phantom, *build.heart);
  } catch (const UserError& error) {
    result.refusal = error.what();
  }
  result.seconds = total_seconds(build.run);
  return result;
}

double value_of(const Case& c, Region region, const std::string& metric) {
  const auto scope = c.fit.find(region_name(tag(region)));
  if (scope == c.fit.end()) return nothing;
  const auto at = scope->second.find(metric);
  return at == scope->second.end() ? nothing : at->second;
}

/// What the case misses, one entry per number; nothing where it is as good as it must be.
std::vector<std::string> misses(const Case& c) {
  if (!c.refusal.empty()) return {c.refusal};
  std::vector<std::string> result;
  for (const Bound& bound : bounds) {
    const double dice = value_of(c, bound.region, "dice");
    const double distance = value_of(c, bound.region, "surface_distance_mean");
    if (!(dice >= bound.min_dice))
      result.push_back(fmt::format("{} dice {:.3f} < {:.2f}", bound.heading, dice, bound.min_dice));
    if (!(distance <= max_distance_mm))
      result.push_back(fmt::format("{} distance {:.2f} > {:.1f} mm", bound.heading, distance, max_distance_mm));
  }
  return result;
}

void print_heading() {
  fmt::print("{:>7} {:>5} {:>6} |", "variant", "noise", "right");
  for (const Bound& bound : bounds) fmt::print(" {:>10}", bound.heading);
  fmt::print(" |");
  for (const char* valve : valve_names) fmt::print(" {:>9}", valve);
  fmt::print(" | {:>4} {:>5} {:>5}\n{:>7} {:>5} {:>6} |", "axis", "conf", "time", "", "HU", "HU");
  for (std::size_t n = 0; n < bounds.size(); ++n) fmt::print(" {:>10}", "dice   mm");
  fmt::print(" |");
  for (std::size_t n = 0; n < valve_names.size(); ++n) fmt::print(" {:>9}", "mm  deg");
  fmt::print(" | {:>4} {:>5} {:>5}\n", "deg", "", "s");
}

void print_row(const Case& c) {
  fmt::print("{:>7} {:>5g} {:>+6.0f} |", c.variant, c.noise_hu, c.right_minus_muscle_hu);
  for (const Bound& bound : bounds)
    fmt::print(" {:5.3f} {:4.2f}", value_of(c, bound.region, "dice"),
               value_of(c, bound.region, "surface_distance_mean"));
  fmt::print(" |");
  for (const char* valve : valve_names) {
    const auto at = c.valves.find(valve);
    const ValveError error = at == c.valves.end() ? ValveError{} : at->second;
    fmt::print(" {:4.1f} {:4.1f}", error.center_mm, error.normal_deg);
  }
  fmt::print(" | {:4.1f} {:5.2f} {:5.1f}{}\n", c.axis_deg, c.confidence, c.seconds, misses(c).empty() ? "" : "  *");
  std::fflush(stdout);
}

Json as_json(const Case& c) {
  Json row{{"variant", c.variant},       {"noise_hu", c.noise_hu}, {"right_minus_muscle_hu", c.right_minus_muscle_hu},
           {"refusal", c.refusal},       {"regions", c.fit},       {"axis_deg", c.axis_deg},
           {"confidence", c.confidence}, {"warnings", c.warnings}, {"misses", misses(c)},
           {"seconds", c.seconds}};
  for (const auto& [name, error] : c.valves)
    row["valves"][name] = {{"center_mm", error.center_mm}, {"normal_deg", error.normal_deg}};
  return row;
}

double number(const Json& value) { return value.is_number() ? value.get<double>() : nothing; }

Case case_from_json(const Json& row) {
  Case c;
  c.variant = row.at("variant").get<int>();
  c.noise_hu = number(row.at("noise_hu"));
  c.right_minus_muscle_hu = number(row.at("right_minus_muscle_hu"));
  c.refusal = row.at("refusal").get<std::string>();
  for (const auto& [region, metrics] : row.at("regions").items())
    for (const auto& [metric, value] : metrics.items()) c.fit[region][metric] = number(value);
  if (row.contains("valves"))
    for (const auto& [valve, error] : row.at("valves").items())
      c.valves[valve] = {number(error.at("center_mm")), number(error.at("normal_deg"))};
  c.axis_deg = number(row.at("axis_deg"));
  c.confidence = number(row.at("confidence"));
  c.seconds = number(row.at("seconds"));
  c.warnings = row.at("warnings").get<std::vector<std::string>>();
  return c;
}

/// What tells one run's phantoms from another's.
Json grid_of(const phantom::PhantomSettings& settings) {
  const Vec3& mm = settings.spacing_mm;
  return {{"size", settings.size}, {"spacing_mm", {mm.x, mm.y, mm.z}}};
}

/// What the variants' hearts were made to be; empty where nothing was asked for.
Json heart_of(const phantom::PhantomSettings& settings) {
  const auto& heart = settings.overrides;
  Json json = Json::object();
  if (heart.lv_wall_mm) json["lv_wall_mm"] = *heart.lv_wall_mm;
  if (heart.rv_wall_mm) json["rv_wall_mm"] = *heart.rv_wall_mm;
  if (heart.scale) json["scale"] = *heart.scale;
  if (const auto& turn = heart.rotation_deg) json["rotation_deg"] = {turn->x, turn->y, turn->z};
  return json;
}

void write_case(const fs::path& file, const Case& c, const phantom::PhantomSettings& settings) {
  Json row = as_json(c);
  row["grid"] = grid_of(settings);
  row["heart"] = heart_of(settings);
  write_text(file, row.dump(1) + "\n");
}

/// The row of an earlier run; nothing where there is none, or one of another grid or heart, or one that was cut off.
std::optional<Case> read_case(const fs::path& file, const phantom::PhantomSettings& settings) {
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  try {
    const Json row = Json::parse(stream);
    if (row.at("grid") != grid_of(settings) || row.at("heart") != heart_of(settings)) return std::nullopt;
    return case_from_json(row);
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

/// Measured, or taken from an earlier run. @collective
Case measured_or_kept(const AccuracyCommand& command, const phantom::PhantomSettings& settings,
                      const parallel::Comm& comm) {
  const fs::path file = command.keep.empty() ? fs::path() : case_folder(command.keep, settings) / "case.json";
  std::optional<Case> kept;
  bool known = parallel::run_on_root(comm, [&] {
    if (command.resume) kept = read_case(file, settings);
    return kept.has_value();
  });
  parallel::broadcast(comm, known);
  if (known) return kept.value_or(Case{});
  Case c = measure(settings, command.keep, comm);
  if (comm.is_root() && !file.empty()) write_case(file, c, settings);
  return c;
}

/// The least Dice and the largest distance of each column.
void print_worst(const std::vector<Case>& cases) {
  fmt::print("{:>20} |", "worst");
  for (const Bound& bound : bounds) {
    double dice = 1, distance = 0;
    for (const Case& c : cases) {
      dice = std::fmin(dice, value_of(c, bound.region, "dice"));
      distance = std::fmax(distance, value_of(c, bound.region, "surface_distance_mean"));
    }
    fmt::print(" {:5.3f} {:4.2f}", dice, distance);
  }
  fmt::print(" |\n");
}

void print_summary(const std::vector<Case>& cases) {
  print_worst(cases);
  std::size_t good = 0;
  for (const Case& c : cases) {
    const auto missed = misses(c);
    good += missed.empty();
    if (!missed.empty()) fmt::print("* variant {}, noise {:g}: {}\n", c.variant, c.noise_hu, fmt::join(missed, "; "));
    for (const auto& warning : c.warnings)
      fmt::print("  variant {}, noise {:g} warns: {}\n", c.variant, c.noise_hu, warning);
  }
  fmt::print("{} of {} phantoms within every bound\n", good, cases.size());
}

/// The least Dice of all noises over the contrast, a curve per region.
study::Plot plot_of(const std::vector<Case>& cases) {
  study::Plot plot{.name = "accuracy",
                   .title = "Phantoms without a landmark",
                   .x_label = "right heart's blood minus muscle (HU)",
                   .y_label = "least Dice",
                   .curves = {}};
  for (const Bound& bound : bounds) {
    std::map<double, double> least;
    for (const Case& c : cases) {
      const double dice = c.refusal.empty() ? value_of(c, bound.region, "dice") : 0;
      const auto [at, fresh] = least.try_emplace(c.right_minus_muscle_hu, dice);
      if (!fresh) at->second = std::fmin(at->second, dice);
    }
    study::Curve curve{bound.heading, {}, {}};
    for (const auto& [contrast_hu, dice] : least) curve.x.push_back(contrast_hu), curve.y.push_back(dice);
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

/// Every variant at every noise.
std::vector<phantom::PhantomSettings> phantoms_of(const AccuracyCommand& command) {
  std::vector<phantom::PhantomSettings> phantoms;
  phantom::PhantomSettings settings;
  settings.size = command.size;
  settings.spacing_mm = command.spacing_mm;
  settings.overrides = command.heart;
  settings.companions = false;
  settings.fibers = false;
  for (const double noise : command.noise_hu)
    for (const int variant : variant_list(command.variants)) {
      settings.variant = variant;
      settings.noise_hu = noise;
      phantoms.push_back(settings);
    }
  return phantoms;
}

}  // namespace

int accuracy_command(const AccuracyCommand& command, const parallel::Comm& comm) {
  adapters::check_size(command.size, "--size", true);
  const auto phantoms = phantoms_of(command);
  if (command.of != "chambers") return accuracy_of_part(command, phantoms, comm);
  if (command.resume && command.keep.empty())
    throw UserError("there is nothing to resume", "accuracy --resume", "name the earlier run's folder with --keep");
  parallel::run_on_root(comm, [&] {
    if (!command.plot.empty()) check_output(command.plot);
  });
  const bool table = comm.is_root() && !command.json;
  if (table) print_heading();
  std::vector<Case> cases;
  for (const auto& settings : phantoms) {
    cases.push_back(measured_or_kept(command, settings, comm));
    if (table) print_row(cases.back());
  }
  if (table) print_summary(cases);
  parallel::run_on_root(comm, [&] {
    if (!command.plot.empty()) write_text(command.plot, study::svg(plot_of(cases)));
  });
  if (comm.is_root() && command.json) {
    Json rows = Json::array();
    for (const Case& c : cases) rows.push_back(as_json(c));
    fmt::print("{}\n", rows.dump(1));
  }
  const bool all_good = std::all_of(cases.begin(), cases.end(), [](const Case& c) { return misses(c).empty(); });
  return parallel::run_on_root(comm, [&] { return all_good ? 0 : below_bounds; });
}

}  // namespace heartgen::lab
