// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/uses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "validation/criteria.hpp"

namespace heartgen::validation {
namespace {

constexpr std::string_view out_of_reach = "uses.";  // how the codes of its warnings begin

/// A bound that one use sets on a row, beside the certificate's own.
struct Demand {
  const char* scope;
  const char* metric;
  std::optional<double> warn_above, unfit_above;
  const char* why;         ///< with its source
  const char* remedy;      ///< what mends it
  bool is_choice = false;  ///< the recipe's edges or the scan decide: a use that is not asked for may lack it
};

struct Use {
  const char* name;
  const char* mesh;
  bool needs_fibers;
  bool is_usual;  ///< a heart that cannot serve it says so, asked or not
  std::vector<Demand> demands;
};

std::vector<Use> all_uses() {
  const Demand lv_layers{"myocardium/lv_myocardium",
                         "layers_below_two",
                         0.02,
                         0.3,
                         "one layer of linear cells cannot bend",
                         "Set mesh.wall_layers = 2, or shorter edges.",
                         true};
  const Demand rv_layers{"myocardium/rv_myocardium",
                         "layers_below_two",
                         0.1,
                         0.5,
                         "one layer of linear cells cannot bend",
                         "Set mesh.wall_layers = 2, or shorter edges.",
                         true};
  const Demand locked{
      "*_endocardium", "locked_cells", 0.0, {}, "cells with all nodes on one surface cannot deform", ""};
  return {
      {"eikonal",
       "myocardium",
       true,
       true,
       {{"myocardium", "edge_mean", 1.6, 3.0, "eikonal solvers are run at edges of 1 to 1.5 mm (Gillette 2021)",
         "Set mesh.heart_edge_mm = 1.4.", true}}},
      {"monodomain",
       "myocardium",
       true,
       false,
       {{"myocardium", "edge_mean", 0.35, 0.5,
         "solvers disagree at edges of 0.5 mm, where many conduct too slowly, and agree at 0.1 mm (Niederer 2011)",
         "Set mesh.heart_edge_mm = 0.35, or refine in the solver.", true}}},
      {"mechanics", "myocardium", true, true, {lv_layers, rv_layers, locked}},
      {"ecg",
       "torso",
       false,
       false,
       {{"torso", "fov_cut_share", 0.6, 0.8, "electrodes need skin where the image ends",
         "Use a scan of the whole chest, or another patient's under [torso].", true}}},
      {"blood_flow",
       "chambers",
       false,
       false,
       {{"*_orifice",
         "missing",
         {},
         0.5,
         "a chamber without an outlet holds no flow",
         "Give labels of the great vessels, or the CT too.",
         true},
        {"chambers", "edge_mean", 1.5, 2.5, "flow in ventricles is resolved at edges of 1 mm and below (Chnafa 2014)",
         "Set mesh.blood_edge_mm = 1.", true}}},
      {"finite_volumes", "myocardium", true, false, {}},
  };
}

bool is_or_is_part_of(std::string_view scope, std::string_view mesh) {
  return scope == mesh || (scope.starts_with(mesh) && scope.size() > mesh.size() && scope[mesh.size()] == '/');
}

/// Whether a row speaks of what a use needs.
bool concerns(const ReportRow& row, const Use& use) {
  if (row.group == "mesh") return is_or_is_part_of(row.scope, use.mesh);
  if (row.group == "fibers") return use.needs_fibers && row.scope.find('/') == std::string::npos;
  if (row.group == "insulation") return row.scope == use.mesh && use.needs_fibers;
  if (row.group == "cavities") return std::string_view(use.name) == "mechanics";
  if (row.group == "anatomy") return std::string_view(use.mesh) == "chambers";
  return row.group == "labels" || row.group == "fit" || (row.group == "pose" && std::string_view(use.mesh) == "torso");
}

bool concerns(const Warning& warning, const Use& use) {
  return use.needs_fibers || !warning.code.starts_with("fibers.");
}

std::string described(const ReportRow& row) {
  return fmt::format("{} {} is {:.3g}{}", row.scope, row.metric, row.value,
                     row.unit == "1" || row.unit == "count" ? "" : " " + row.unit);
}

bool speaks_of(const Demand& demand, const Use& use, const ReportRow& row) {
  const std::string_view scope = demand.scope;
  const bool fits = scope.starts_with('*') ? row.scope.ends_with(scope.substr(1)) : row.scope == scope;
  return fits && row.metric == demand.metric && concerns(row, use);
}

/// A verdict in the making; its worst finding counts.
struct Finding {
  UseVerdict verdict;
  bool is_out_of_reach = false;  ///< by choice

  void add(Fitness fitness, std::string reason, const char* remedy = "") {
    if (fitness > verdict.fitness) verdict.remedy = remedy;
    verdict.fitness = std::max(verdict.fitness, fitness);
    verdict.reasons.push_back(std::move(reason));
  }
};

void apply_demand(const Demand& demand, const ReportRow& row, Finding& finding) {
  const bool unfit = demand.unfit_above && row.value > *demand.unfit_above;
  const bool warns = demand.warn_above && row.value > *demand.warn_above;
  if (!unfit && !warns) return;
  finding.is_out_of_reach |= unfit && demand.is_choice;
  finding.add(unfit ? Fitness::unfit : Fitness::fit_with_warnings, fmt::format("{}: {}.", described(row), demand.why),
              demand.remedy);
}

/// The gravest reasons first, a few of them: the rows tell the rest.
void shorten(std::vector<std::string>& reasons) {
  constexpr std::size_t max_reasons = 4;
  if (reasons.size() <= max_reasons) return;
  const auto left_out = reasons.size() - max_reasons;
  reasons.resize(max_reasons);
  reasons.push_back(fmt::format("{} more reasons stand in the certificate.", left_out));
}

Finding judge(const Use& use, const Report& rows, const std::vector<Warning>& warnings) {
  Finding finding;
  finding.verdict.use = use.name;
  for (const auto& warning : warnings)
    if (warning.level == WarningLevel::doubt) finding.add(Fitness::unfit, warning.text);
  for (const auto& row : rows)
    if (row.verdict() == Verdict::failed && concerns(row, use)) finding.add(Fitness::unfit, described(row) + ".");
  for (const auto& demand : use.demands)
    for (const auto& row : rows)
      if (speaks_of(demand, use, row)) apply_demand(demand, row, finding);
  const auto is_demanded = [&](const ReportRow& row) {
    return std::any_of(use.demands.begin(), use.demands.end(),
                       [&](const Demand& demand) { return speaks_of(demand, use, row); });
  };
  for (const auto& row : rows)
    if (row.verdict() == Verdict::warned && concerns(row, use) && !is_demanded(row))
      finding.add(Fitness::fit_with_warnings, described(row) + ".");
  for (const auto& warning : warnings)
    if (warning.level == WarningLevel::warning && concerns(warning, use))
      finding.add(Fitness::fit_with_warnings, warning.text);
  shorten(finding.verdict.reasons);
  return finding;
}

bool contains(const std::vector<std::string>& names, const char* name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::vector<std::string> use_names() {
  std::vector<std::string> names;
  for (const auto& use : all_uses()) names.emplace_back(use.name);
  return names;
}

std::vector<UseVerdict> judge_uses(const Report& rows, const std::vector<Warning>& warnings,
                                   const std::vector<std::string>& mesh_names, const std::vector<std::string>& asked) {
  std::vector<UseVerdict> verdicts;
  for (const auto& use : all_uses()) {
    if (!contains(mesh_names, use.mesh)) {
      if (contains(asked, use.name))
        verdicts.push_back({use.name,
                            Fitness::unfit,
                            true,
                            {fmt::format("The model has no mesh \"{}\".", use.mesh)},
                            fmt::format("Add \"{}\" to mesh.meshes.", use.mesh)});
      continue;
    }
    auto finding = judge(use, rows, warnings);
    finding.verdict.is_asked = asked.empty() ? !finding.is_out_of_reach : contains(asked, use.name);
    verdicts.push_back(std::move(finding.verdict));
  }
  return verdicts;
}

Certificate certified(Report rows, std::vector<Warning> warnings, const std::vector<std::string>& mesh_names,
                      const ValidationSettings& settings) {
  std::erase_if(warnings, [](const Warning& warning) { return warning.code.starts_with(out_of_reach); });
  Certificate certificate{judged(std::move(rows), settings), std::move(warnings), {}};
  certificate.uses = judge_uses(certificate.rows, certificate.warnings, mesh_names, settings.uses);
  if (!settings.uses.empty()) return certificate;
  for (const auto& use : all_uses())
    for (const auto& verdict : certificate.uses)
      if (use.is_usual && verdict.use == use.name && !verdict.remedy.empty() && verdict.fitness == Fitness::unfit &&
          !verdict.is_asked)
        certificate.warnings.push_back(
            {std::string(out_of_reach) + verdict.use, WarningLevel::warning,
             fmt::format("The model is unfit for {}: {} {}", verdict.use, verdict.reasons.front(), verdict.remedy)});
  return certificate;
}

}  // namespace heartgen::validation
