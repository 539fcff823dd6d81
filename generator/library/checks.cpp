// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <heartgen/bundle.hpp>
#include <heartgen/checks.hpp>
#include <map>
#include <set>
#include <tuple>

#include "generator/pipeline/pipeline.hpp"
#include "model/labels.hpp"
#include "validation/contour_fit.hpp"
#include "validation/uses.hpp"

namespace heartgen {
namespace {

/// Angles with which solvers still get on; our own meshers promise more.
ValidationSettings bounds_of_any_mesh() {
  Recipe recipe;
  recipe.validation.minimum_dihedral_deg = 5;
  recipe.validation.maximum_dihedral_deg = 175;
  return bounds_of(recipe);
}

/// What the certificate calls a tag, and what the file does.
std::map<std::string, std::string> names_in_certificate(const TetMesh& mesh) {
  std::map<std::string, std::string> names;
  for (const auto& [of, name] : mesh.names)
    names[of.first == 3 ? region_name(of.second) : surface_name(of.second)] = name;
  return names;
}

void append(Report& report, const Report& rows) { report.insert(report.end(), rows.begin(), rows.end()); }

/// The rows of a bundle's metrics that are not measured again: they need the build's inputs, which a bundle does not
/// hold.
Report kept_rows(const Report& before, const Report& again) {
  const auto name = [](const ReportRow& row) { return std::tie(row.group, row.scope, row.metric); };
  std::set<std::tuple<std::string, std::string, std::string>> measured;
  for (const auto& row : again) measured.insert(name(row));
  Report kept;
  for (const auto& row : before)
    if (!measured.contains(name(row))) kept.push_back(row);
  return kept;
}

}  // namespace

Report check_mesh(const MeshFile& file) {
  Report report = validation::check_mesh(file.name, file.mesh, bounds_of_any_mesh());
  const auto names = names_in_certificate(file.mesh);
  for (auto& row : report) {
    const auto slash = row.scope.find('/');
    if (slash == std::string::npos) continue;
    const auto found = names.find(row.scope.substr(slash + 1));
    if (found != names.end()) row.scope = row.scope.substr(0, slash + 1) + found->second;
  }
  return report;
}

Certificate validate_bundle(const std::filesystem::path& folder, const KnownTruth& truth) {
  const auto problems = exporters::verify_bundle(folder);
  if (!problems.empty())
    throw UserError(fmt::format("{}: {}", problems.front().file, problems.front().what), folder.string(),
                    "heartgen verify lists every damaged file");
  const auto meshes = bundle::read_meshes(folder);
  const LabelVolume labels = exporters::read_labels(folder);
  const Recipe recipe = read_recipe((folder / "recipe.toml").string());
  const Report measured = pipeline::certificate(meshes, labels, recipe.mesh, bounds_of(recipe));
  Certificate certificate = exporters::read_certificate(folder);
  Report report = kept_rows(certificate.rows, measured);
  append(report, measured);
  if (truth.labels != nullptr) append(report, validation::compare_labels(labels, *truth.labels));
  if (truth.fibers != nullptr && meshes.contains("myocardium"))
    append(report, validation::compare_fibers(meshes.at("myocardium"), *truth.fibers));
  return validation::certified(std::move(report), std::move(certificate.warnings), pipeline::names_of(meshes),
                               bounds_of(recipe));
}

}  // namespace heartgen
