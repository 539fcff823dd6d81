// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/print_certificate.hpp"

#include <fmt/format.h>

#include <string>

namespace heartgen::pipeline {
namespace {

std::string bound_text(const ReportRow& row) {
  const bool warns = row.verdict() == Verdict::warned;
  const auto& low = warns ? row.warn_below : row.at_least;
  const auto& high = warns ? row.warn_above : row.at_most;
  std::string text;
  if (low) text += fmt::format(" >= {:g}", *low);
  if (high) text += fmt::format(" <= {:g}", *high);
  return text;
}

const char* lamp(Verdict verdict) {
  constexpr const char* lamps[] = {"", "ok", "warns", "FAILED"};
  return lamps[static_cast<std::size_t>(verdict)];
}

const char* verdict_sentence(Verdict verdict) {
  constexpr const char* sentences[] = {"nothing was judged", "PASSED", "PASSED WITH WARNINGS", "FAILED"};
  return sentences[static_cast<std::size_t>(verdict)];
}

}  // namespace

void print_row(const ReportRow& row) {
  fmt::print("{:<6} {:<38} {:<34} {:>12.4g} {:<6}{}\n", lamp(row.verdict()), row.scope, row.metric, row.value,
             row.unit == "1" ? "" : row.unit, bound_text(row));
}

void print_rows(const Report& report, bool all_rows) {
  for (const auto& row : report) {
    const auto verdict = row.verdict();
    if (all_rows || verdict == Verdict::warned || verdict == Verdict::failed) print_row(row);
    if (verdict == Verdict::failed && !row.reason.empty()) fmt::print("       {}\n", row.reason);
  }
  const auto passed = count_of(report, Verdict::passed), warned = count_of(report, Verdict::warned);
  const auto failed = count_of(report, Verdict::failed);
  fmt::print("{} of {} checks passed", passed + warned, passed + warned + failed);
  fmt::print("{}\n", warned > 0 ? fmt::format(", {} of them with a warning", warned) : "");
}

void print_trust(const std::vector<UseVerdict>& uses, const std::vector<Warning>& warnings) {
  for (const auto& use : uses) {
    fmt::print("{:<15} {}{}\n", use.use, fitness_names.at(static_cast<std::size_t>(use.fitness)),
               use.fitness == Fitness::unfit && !use.is_asked ? " (not asked for)" : "");
    for (const auto& reason : use.reasons) fmt::print("                {}\n", reason);
    if (!use.remedy.empty()) fmt::print("                {}\n", use.remedy);
  }
  for (const auto& warning : warnings)
    fmt::print("{}: {} [{}]\n", warning_level_names.at(static_cast<std::size_t>(warning.level)), warning.text,
               warning.code);
}

void print_warnings(const std::vector<Warning>& warnings) {
  for (const auto& warning : warnings)
    if (warning.level != WarningLevel::note) fmt::print(stderr, "warning: {}\n", warning.text);
}

void print_certificate(const Certificate& certificate, bool all_rows) {
  print_rows(certificate.rows, all_rows);
  print_trust(certificate.uses, certificate.warnings);
  fmt::print("verdict     {}\n", verdict_sentence(verdict_of(certificate)));
}

}  // namespace heartgen::pipeline
