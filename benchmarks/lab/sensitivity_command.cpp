// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/sensitivity_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "benchmarks/lab/moved_number.hpp"
#include "benchmarks/lab/sensitivity_stages.hpp"
#include "generator/adapters/image_checks.hpp"
#include "model/error.hpp"
#include "model/numbers.hpp"

namespace heartgen::lab {
namespace {

using Json = nlohmann::json;
using Names = std::set<std::string>;

/// A column of the table: the figures whose names begin so, and how far they move.
struct Column {
  const char* figures;
  const char* heading;
  double effect;     ///< that a change of one counts for, against a Dice of one
  bool is_relative;  ///< percent of the figure
  int digits;
};
constexpr std::array columns = {Column{"chambers.dice.", "chambers, Dice", 1, false, 3},
                                Column{"walls.dice.", "walls, Dice", 1, false, 3},
                                Column{"walls.mm.", "walls, mm", 0, false, 2},
                                Column{"body.dice.", "body, Dice", 1, false, 3},
                                Column{"carotid.dice.", "carotid, Dice", 1, false, 3},
                                Column{"fibers.deg.", "fibres, degrees", 1 / 90.0, false, 2},
                                Column{".ml.", "volume, %", 0, true, 1}};

/// The figure of a column that moves farthest.
struct Move {
  std::string figure;
  double by = 0;
};

struct Row {
  const Number* number = nullptr;
  double value = 0;  ///< that it was moved to
  Names stages{};    ///< that ran again
  std::array<Move, columns.size()> moves{};
  std::string refusal{};

  double effect() const {
    if (!refusal.empty()) return 1e9;
    double most = 0;
    for (std::size_t c = 0; c < columns.size(); ++c) most = std::max(most, columns[c].effect * std::abs(moves[c].by));
    return most;
  }
  bool changes_anything() const {
    return !refusal.empty() || std::any_of(moves.begin(), moves.end(), [](const Move& m) { return m.by != 0; });
  }
};

/// The stages' results without a change, and what each stage reads.
struct Baseline {
  Specimen on;
  Made made;
  std::map<std::string, std::vector<const Number*>> reads;
};

bool is_wanted(const SensitivityStage& stage, const Names& wanted) { return wanted.contains(stage.name); }

/// Those asked for, with what they need.
Names stages_of(const SensitivityCommand& command) {
  Names wanted(command.stages.begin(), command.stages.end());
  const auto& all = sensitivity_stages();
  for (const auto& name : command.stages)
    if (std::none_of(all.begin(), all.end(), [&](const auto& stage) { return stage.name == name; }))
      throw UserError(fmt::format("\"{}\" is no stage", name), "--stages",
                      "choose of split, chambers, walls, body, carotid, fibers");
  for (auto stage = all.rbegin(); stage != all.rend(); ++stage) {
    if (wanted.empty() || command.stages.empty()) wanted.insert(stage->name);
    if (wanted.contains(stage->name)) wanted.insert(stage->needs.begin(), stage->needs.end());
  }
  return wanted;
}

std::vector<const Number*> numbers_of(const SensitivityCommand& command) {
  const auto all = patient_numbers();
  if (command.only.empty()) return {all.begin(), all.end()};
  std::vector<const Number*> numbers;
  for (const auto& name : command.only) {
    const auto at = std::find_if(all.begin(), all.end(), [&](const Number* number) { return number->name == name; });
    if (at == all.end())
      throw UserError(fmt::format("\"{}\" is no number about patients", name), "--only",
                      "heartgen-lab sensitivity --list names them");
    numbers.push_back(*at);
  }
  return numbers;
}

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void tell(const std::string& what) { fmt::print(stderr, "{}\n", what); }

Baseline make_baseline(const SensitivityCommand& command, int variant, const Names& wanted) {
  phantom::PhantomSettings settings;
  settings.size = command.size;
  settings.spacing_mm = command.spacing_mm;
  settings.noise_hu = command.noise_hu;
  Baseline base{make_specimen(settings, variant), {}, {}};
  for (const auto& stage : sensitivity_stages()) {
    if (!is_wanted(stage, wanted)) continue;
    const double start_s = now_s();
    const NumbersRead read;
    stage.make(base.on, base.made);
    base.reads[stage.name] = read.so_far();
    tell(fmt::format("phantom {}: {} as it is, {:.1f} s, reads {} numbers", variant, stage.name, now_s() - start_s,
                     base.reads[stage.name].size()));
  }
  return base;
}

/// The stages that read the number, and those that need their results.
Names touched_by(const Number& number, const Baseline& base, const Names& wanted) {
  Names touched;
  for (const auto& stage : sensitivity_stages()) {
    if (!is_wanted(stage, wanted)) continue;
    const auto& reads = base.reads.at(stage.name);
    if (std::find(reads.begin(), reads.end(), &number) != reads.end() ||
        std::any_of(stage.needs.begin(), stage.needs.end(), [&](const auto& need) { return touched.contains(need); }))
      touched.insert(stage.name);
  }
  return touched;
}

/// Keeps what moves farther than what is known.
void add_moves(const Made& before, const Made& after, Row& row) {
  for (const auto& [figure, value] : after.figures) {
    const auto old = before.figures.find(figure);
    if (old == before.figures.end()) continue;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto at = figure.find(columns[c].figures);
      if (at == std::string::npos) continue;
      const double scale = columns[c].is_relative ? 100 / std::max(std::abs(old->second), 1e-9) : 1;
      const double by = scale * (value - old->second);
      if (std::abs(by) > std::abs(row.moves[c].by)) row.moves[c] = {figure.substr(figure.rfind('.') + 1), by};
    }
  }
}

void move_number(const Baseline& base, const Names& wanted, Row& row) {
  const Names touched = touched_by(*row.number, base, wanted);
  row.stages.insert(touched.begin(), touched.end());
  Made made = base.made;
  try {
    const NumberMoved moved(*row.number, row.value);
    for (const auto& stage : sensitivity_stages())
      if (touched.contains(stage.name)) stage.make(base.on, made);
    add_moves(base.made, made, row);
  } catch (const UserError& error) {
    row.refusal = error.problem;
  }
}

std::string text_of(const Move& move, const Column& column) {
  return move.figure.empty() ? "" : fmt::format("{:+.{}f} {}", move.by, column.digits, move.figure);
}

void print_rows(const std::vector<Row>& rows) {
  fmt::print("| number | value | moved to |");
  for (const Column& column : columns) fmt::print(" {} |", column.heading);
  fmt::print("\n|---|---|---|");
  for (std::size_t c = 0; c < columns.size(); ++c) fmt::print("---|");
  fmt::print("\n");
  for (const Row& row : rows) {
    if (!row.changes_anything()) continue;
    fmt::print("| {} | {:g} | {:g} |", row.number->name, row.number->value, row.value);
    if (!row.refusal.empty()) fmt::print(" refused: {} |", row.refusal);
    for (std::size_t c = row.refusal.empty() ? 0 : 1; c < columns.size(); ++c)
      fmt::print(" {} |", text_of(row.moves[c], columns[c]));
    fmt::print("\n");
  }
}

/// Numbers of which neither change does anything.
std::vector<std::string> without_change(const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const Row& row : rows) {
    const auto changes = [&](const Row& other) { return other.number == row.number && other.changes_anything(); };
    if (std::none_of(rows.begin(), rows.end(), changes) &&
        std::find(names.begin(), names.end(), row.number->name) == names.end())
      names.emplace_back(row.number->name);
  }
  return names;
}

void print_names(const char* what, const std::vector<std::string>& names) {
  if (!names.empty()) fmt::print("\n{}: {}.\n", what, fmt::join(names, ", "));
}

Json as_json(const std::vector<Row>& rows, const std::vector<std::string>& unread) {
  Json list = Json::array();
  for (const Row& row : rows) {
    Json one{{"number", row.number->name},
             {"value", row.number->value},
             {"moved_to", row.value},
             {"stages", row.stages},
             {"refusal", row.refusal}};
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (!row.moves[c].figure.empty())
        one["moves"][columns[c].heading] = {{"figure", row.moves[c].figure}, {"by", row.moves[c].by}};
    list.push_back(one);
  }
  return {{"rows", list}, {"not_read", unread}};
}

void print_numbers() {
  fmt::print("| number | value | unit | range | meaning | basis | source |\n|---|---|---|---|---|---|---|\n");
  for (const Number* n : patient_numbers())
    fmt::print("| {} | {:g} | {} | {:g} to {:g} | {} | {} | {} |\n", n->name, n->value, n->unit, n->min, n->max,
               n->meaning, basis_name(n->basis),
               n->basis == Basis::unrecorded && std::string_view(n->source) == not_recorded ? "" : n->source);
}

/// Every number of `numbers` that is read, up and down.
std::vector<Row> rows_of(const SensitivityCommand& command, const std::vector<const Number*>& numbers,
                         const std::vector<Baseline>& bases, const Names& wanted) {
  std::vector<Row> rows;
  for (const Number* number : numbers)
    if (std::any_of(bases.begin(), bases.end(), [&](const auto& b) { return !touched_by(*number, b, wanted).empty(); }))
      for (const double sign : {-1.0, 1.0})
        rows.push_back({.number = number, .value = number->value * (1 + sign * command.change / 100)});
  const double start_s = now_s();
  for (std::size_t n = 0; n < rows.size(); ++n) {
    for (const Baseline& base : bases)
      if (rows[n].refusal.empty()) move_number(base, wanted, rows[n]);
    const double spent_s = now_s() - start_s,
                 left_s = spent_s / static_cast<double>(n + 1) * static_cast<double>(rows.size() - n - 1);
    tell(fmt::format("{} of {}: {} moved to {:g} ({}), about {:.0f} s left", n + 1, rows.size(), rows[n].number->name,
                     rows[n].value, fmt::join(rows[n].stages, ", "), left_s));
  }
  return rows;
}

void check_command(const SensitivityCommand& command) {
  adapters::check_size(command.size, "--size", true);
  if (command.phantoms < 1) throw UserError("there is no phantom to try", "--phantoms", "give 1 or more");
  if (!(command.change > 0 && command.change < 100))
    throw UserError(fmt::format("a change of {:g} % is out of range", command.change), "--change",
                    "give more than 0 and less than 100");
}

}  // namespace

int sensitivity_command(const SensitivityCommand& command) {
  if (command.list) return print_numbers(), 0;
  check_command(command);
  const auto numbers = numbers_of(command);
  const Names wanted = stages_of(command);
  std::vector<Baseline> bases;
  for (int variant = 0; variant < command.phantoms; ++variant) bases.push_back(make_baseline(command, variant, wanted));
  auto rows = rows_of(command, numbers, bases, wanted);
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.effect() > b.effect(); });
  std::vector<std::string> unread;
  for (const Number* number : numbers)
    if (std::none_of(rows.begin(), rows.end(), [&](const Row& row) { return row.number == number; }))
      unread.emplace_back(number->name);
  if (command.json) return fmt::print("{}\n", as_json(rows, unread).dump(1)), 0;
  print_rows(rows);
  print_names("Moved, and nothing changes", without_change(rows));
  print_names("No stage reads, on these phantoms", unread);
  return 0;
}

}  // namespace heartgen::lab
