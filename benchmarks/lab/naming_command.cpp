// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/naming_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>

#include "benchmarks/lab/naming_cases.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/anatomy/padding.hpp"
#include "generator/landmarks/judge.hpp"
#include "generator/landmarks/search.hpp"
#include "generator/naming/naming.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heartgen::lab {
namespace {

using naming::Name;
using naming::Naming;
using naming::Verdict;

constexpr std::array<std::string_view, 3> verdict_words = {"found", "doubtful", "no heart"};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void print_naming(const std::string& ct, const Naming& n, double seconds) {
  fmt::print("{}: {} ({:.1f} s)\n", ct, verdict_words[static_cast<std::size_t>(n.verdict)], seconds);
  for (const auto& reason : n.reasons) fmt::print("  {}\n", reason);
  if (n.pieces == 0) return;
  fmt::print("  muscle {:.0f} HU, left blood {:.0f} HU, {} pieces\n", n.levels.muscle_hu, n.levels.blood_hu, n.pieces);
  const auto& t = n.terms;
  fmt::print(
      "  cost {:.1f} (mirrored {:.1f}): pieces {:.1f}, missing {:.1f}, volume {:.1f}, shape {:.1f}, grey {:.1f}, shell "
      "{:.1f}, place {:.1f}, openings {:.1f}, stream {:.1f}, touch {:.1f}, cut {:.1f}, lone {:.1f}\n",
      t.sum(), n.mirrored_energy, t.piece, t.missing, t.volume, t.shape, t.grey, t.shell, t.place, t.opening, t.stream,
      t.touch, t.cut, t.lone);
  for (int i = 1; i < naming::name_count; ++i) {
    const auto& body = n.bodies[static_cast<std::size_t>(i)];
    const auto& usual = naming::usual[static_cast<std::size_t>(i)];
    if (body.ml == 0)
      fmt::print("  {:<4} not found\n", usual.key);
    else
      fmt::print("  {:<4}{:6.0f} ml{:6.0f} HU  at {:6.0f} {:6.0f} {:6.0f}  margin {:4.1f} (else {})\n", usual.key,
                 body.ml, body.hu, body.center_mm.x, body.center_mm.y, body.center_mm.z, body.margin.cost,
                 naming::usual_of(body.margin.runner_up).key);
  }
}

/// What a voxel of the phantom should be called.
Name true_name(const phantom::HeartModel& model, const Vec3& at) {
  switch (phantom::region_at(model, at)) {
    case Region::lv_blood:
      return Name::lv;
    case Region::la_blood:
      return Name::la;
    case Region::rv_blood:
      return Name::rv;
    case Region::ra_blood:
      return Name::ra;
    case Region::aorta:
      return Name::aorta;
    case Region::pulmonary_artery:
      return Name::pulmonary_artery;
    default:
      break;
  }
  const auto tissue = phantom::tissue_at(model, at);
  return tissue == phantom::Tissue::upper_vein   ? Name::svc
         : tissue == phantom::Tissue::lower_vein ? Name::ivc
                                                 : Name::other;
}

using Counts = std::array<std::array<std::int64_t, naming::name_count>, naming::name_count>;

/// Voxels by found and true name; both parts of the aorta count as one.
Counts confusion(const LabelVolume& names, const phantom::HeartModel& model) {
  Counts counts{};
  std::size_t v = 0;
  for (std::int64_t k = 0; k < names.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < names.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < names.grid.size[0]; ++i, ++v) {
        const Vec3 at =
            lps_from_index(names.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        ++counts[names.voxels[v]][static_cast<std::size_t>(true_name(model, at))];
      }
  return counts;
}

/// What of a labelling is wrong, in words; empty: nothing. A chamber needs this Dice; of a vessel as much must lie in
/// its own. A right heart without contrast need not be named.
std::string mistakes(const LabelVolume& names, const phantom::HeartModel& model) {
  constexpr double min_dice = 0.6;
  constexpr double hardly_brighter_hu = 15;
  const bool right_is_grey = phantom::right_heart_contrast_hu(model) < hardly_brighter_hu;
  const Counts counts = confusion(names, model);
  std::string wrong;
  const auto say = [&](const std::string& what) { wrong += (wrong.empty() ? "" : ", ") + what; };
  for (int n = 1; n < naming::name_count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const auto name = static_cast<Name>(n);
    const auto truth = static_cast<std::size_t>(name == Name::descending_aorta ? Name::aorta : name);
    double found = 0, known = 0;
    for (std::size_t m = 0; m < naming::name_count; ++m) {
      found += static_cast<double>(counts[i][m]);
      known += static_cast<double>(counts[m][truth]);
    }
    const auto both = static_cast<double>(counts[i][truth]);
    const bool is_chamber = name == Name::lv || name == Name::la || name == Name::rv || name == Name::ra;
    const bool is_right = name == Name::rv || name == Name::ra || name == Name::pulmonary_artery;
    const bool is_needed = (is_chamber || name == Name::aorta || is_right) && !(is_right && right_is_grey);
    const auto key = naming::usual[i].key;
    if (found == 0) {
      if (is_needed) say(fmt::format("no {}", key));
    } else if (is_chamber) {
      if (const double dice = 2 * both / (found + known); dice < min_dice) say(fmt::format("{} {:.2f}", key, dice));
    } else if (both < min_dice * found) {
      say(fmt::format("{} {:.2f}", key, both / found));
    }
  }
  return wrong;
}

/// The names that the search for landmarks gives.
LabelVolume names_of(const LabelVolume& chambers) {
  static const std::map<Region, Name> names = {
      {Region::lv_blood, Name::lv}, {Region::la_blood, Name::la}, {Region::rv_blood, Name::rv},
      {Region::ra_blood, Name::ra}, {Region::aorta, Name::aorta}, {Region::pulmonary_artery, Name::pulmonary_artery}};
  LabelVolume result(chambers.grid);
  for (std::size_t v = 0; v < chambers.voxels.size(); ++v)
    if (const auto at = names.find(static_cast<Region>(chambers.voxels[v])); at != names.end())
      result.voxels[v] = static_cast<std::uint8_t>(at->second);
  return result;
}

struct Outcome {
  Verdict verdict = Verdict::no_heart;
  std::string wrong;    ///< of a heart that was not refused
  std::string reasons;  ///< of doubt or refusal
  double seconds = 0;
};

Outcome by_naming(const NamingCase& c) {
  const auto start = std::chrono::steady_clock::now();
  try {
    const Naming n = naming::name_blood(c.ct);
    const double seconds = seconds_since(start);
    std::string wrong = n.verdict == Verdict::no_heart ? "" : mistakes(n.names, c.model);
    return {n.verdict, std::move(wrong), fmt::format("{}", fmt::join(n.reasons, "; ")), seconds};
  } catch (const UserError& error) {
    return {Verdict::no_heart, "", error.problem + "; " + error.remedy, seconds_since(start)};
  }
}

Outcome by_tree(const NamingCase& c) {
  const auto start = std::chrono::steady_clock::now();
  try {
    const auto result = landmarks::search(c.ct);
    const double seconds = seconds_since(start);
    const auto trust = landmarks::trust_in(result.found.confidence);
    const auto verdict = trust == landmarks::Trust::sound       ? Verdict::found
                         : trust == landmarks::Trust::uncertain ? Verdict::doubtful
                                                                : Verdict::no_heart;
    std::string wrong = verdict == Verdict::no_heart ? "" : mistakes(names_of(result.chambers), c.model);
    return {verdict, std::move(wrong), fmt::format("{}", fmt::join(result.found.warnings, "; ")), seconds};
  } catch (const UserError& error) {
    return {Verdict::no_heart, "", error.problem + "; " + error.remedy, seconds_since(start)};
  }
}

/// right, right but doubtful, WRONG, wrong but doubtful, refused for the right reason, refused.
constexpr std::array<std::string_view, 6> classes = {"right", "right?", "WRONG", "wrong?", "refused+", "refused-"};

std::size_t class_of(const NamingCase& c, const Outcome& outcome) {
  const bool is_doubtful = outcome.verdict == Verdict::doubtful;
  if (outcome.verdict == Verdict::no_heart) {
    const bool is_right = std::any_of(c.reason_words.begin(), c.reason_words.end(), [&](const std::string& word) {
      return outcome.reasons.find(word) != std::string::npos;
    });
    return is_right ? 4 : 5;
  }
  const bool is_right = c.reason_words.empty() && outcome.wrong.empty();
  return (is_right ? 0U : 2U) + (is_doubtful ? 1U : 0U);
}

struct Tally {
  std::array<int, 6> count{};
  double seconds = 0;
};

std::string cells(const Tally& tally, int cases) {
  std::string text;
  for (const int n : tally.count) text += n > 0 ? fmt::format("{:>9}", n) : fmt::format("{:>9}", ".");
  return text + fmt::format("{:>7.1f}", tally.seconds / cases);
}

void print_header() {
  std::string line;
  for (const auto word : classes) line += fmt::format("{:>9}", word);
  fmt::print("{:<50}{}{:>7}\n", "", line, "s");
}

bool is_wanted(const NamingCommand& command, const std::string& kind) {
  return command.kinds.empty() || std::any_of(command.kinds.begin(), command.kinds.end(),
                                              [&](const std::string& begin) { return kind.starts_with(begin); });
}

void print_case(const NamingCase& c, const char* method, const Outcome& outcome) {
  fmt::print(stderr, "{} | {} | {} | {} | {} | {} | {:.1f} s\n", c.kind, c.name, method, classes[class_of(c, outcome)],
             outcome.wrong, outcome.reasons, outcome.seconds);
}

int print_table(const NamingCommand& command) {
  fmt::print(
      "phantoms of seed {}, {} of each kind; right?/wrong?: and said to be doubtful; refused+: for the right "
      "reason\n",
      command.seed, command.cases);
  print_header();
  std::map<std::string, Tally> all;
  int cases = 0;
  for (const auto& kind : naming_kinds()) {
    if (!is_wanted(command, kind.name)) continue;
    std::map<std::string, Tally> tallies;
    for (int n = 0; n < command.cases; ++n, ++cases) {
      const NamingCase c = kind.draw(static_cast<std::uint64_t>(command.seed), n);
      const auto count = [&](const char* method, const Outcome& outcome) {
        print_case(c, method, outcome);
        for (Tally* tally : {&tallies[method], &all[method]}) {
          ++tally->count[class_of(c, outcome)];
          tally->seconds += outcome.seconds;
        }
      };
      count("naming", by_naming(c));
      if (command.tree) count("tree", by_tree(c));
    }
    for (const auto& [method, tally] : tallies)
      fmt::print("{:<43}{:<7}{}\n", kind.name, method, cells(tally, command.cases));
    std::fflush(stdout);
  }
  for (const auto& [method, tally] : all) fmt::print("{:<43}{:<7}{}\n", "all", method, cells(tally, cases));
  return 0;
}

}  // namespace

int naming_command(const NamingCommand& command) {
  if (command.cts.empty()) return print_table(command);
  for (const auto& ct : command.cts) {
    auto image = adapters::read_ct(ct);
    anatomy::close_padding(image, anatomy::find_padding(image));
    const auto start = std::chrono::steady_clock::now();
    try {
      const Naming named = naming::name_blood(image);
      print_naming(ct, named, seconds_since(start));
      if (!command.output.empty() && &ct == &command.cts.front() && named.pieces > 0)
        adapters::write_volume(command.output, named.names);
    } catch (const UserError& error) {
      fmt::print("{}: no heart ({:.1f} s)\n  {}\n", ct, seconds_since(start), error.problem);
    }
  }
  return 0;
}

}  // namespace heartgen::lab
