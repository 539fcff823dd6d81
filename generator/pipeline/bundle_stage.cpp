// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/bundle_stage.hpp"

#include <fmt/format.h>

#include "generator/mesh/heart_ends.hpp"
#include "generator/mesh/insulation.hpp"
#include "generator/pipeline/mesh_certificate.hpp"
#include "generator/pipeline/mesh_stages.hpp"
#include "generator/pipeline/torso_stage.hpp"
#include "generator/pipeline/user_regions.hpp"
#include "generator/pipeline/versions.hpp"
#include "model/parent_fibers.hpp"
#include "validation/anatomy_checks.hpp"
#include "validation/cavity_checks.hpp"
#include "validation/contour_fit.hpp"
#include "validation/fiber_checks.hpp"
#include "validation/insulation_checks.hpp"
#include "validation/label_checks.hpp"
#include "validation/region_checks.hpp"
#include "validation/report/report_html.hpp"
#include "validation/uses.hpp"

namespace heartgen::pipeline {
namespace {

namespace fs = std::filesystem;

void append(Report& rows, const Report& more) { rows.insert(rows.end(), more.begin(), more.end()); }

bool has_both_walls(const std::string& mesh_name) {
  return mesh_name == "torso" || mesh_name.starts_with("myocardium");
}

/// Walls whose nodes are split have a torso whose nodes are not: blood and lungs go on past both.
void insulate(Meshes& meshes, mesh::Insulation how) {
  for (auto& [name, mesh] : meshes) {
    if (!has_both_walls(name) || how == mesh::Insulation::none) continue;
    if (how == mesh::Insulation::split && name != "torso")
      mesh::split_nodes(mesh);
    else
      mesh::add_annuli(mesh);
  }
}

void take_out_insulation(Meshes& meshes, mesh::Insulation how) {
  for (auto& [name, mesh] : meshes) {
    if (!has_both_walls(name) || how == mesh::Insulation::none) continue;
    if (how == mesh::Insulation::split && name != "torso")
      mesh::merge_split_nodes(mesh);
    else
      mesh::take_out_annuli(mesh);
  }
}

Notes all_notes(const Build& b) {
  const Recipe& recipe = b.recipe;
  Notes notes;
  if (recipe.synthetic_image)
    notes.push_back(
        {"image.synthetic", WarningLevel::note, "The image is synthetic: an analytic phantom, not a patient."});
  const bool by_rule = recipe.fibers.method == "rule";
  if (by_rule && !recipe.input.atlas.empty())
    notes.push_back({"fibers.atlas_unused", WarningLevel::warning,
                     "The fibres come from rules (fibers.method): the atlas that was given was not used."});
  if (!by_rule && recipe.input.atlas.empty())
    notes.push_back(
        {"fibers.standin_atlas", WarningLevel::note,
         "The fibres come from the built-in stand-in atlas, a synthetic heart with published helix angles, not from "
         "measurements."});
  notes.insert(notes.end(), b.run.notes.begin(), b.run.notes.end());
  for (const auto& name : recipe.mesh.meshes)
    if (!b.meshes->contains(name))
      notes.push_back({"mesh.missing", WarningLevel::note,
                       fmt::format("The recipe asks for the mesh \"{}\", but the input does not contain it.", name)});
  return notes;
}

validation::RegistrationFigures registration_figures(const fibers::FiberResult& fibers) {
  const auto& figures = fibers.figures;
  return {fibers.min_jacobian,
          fibers.affine_rms_mm,
          fibers.atlas_overlap,
          fibers.second_mean_deg,
          fibers.second_p95_deg,
          figures.turn_p99_deg_per_mm,
          figures.atlas.lv,
          figures.atlas.rv,
          figures.carried.lv,
          figures.carried.rv,
          figures.there.lv,
          figures.there.rv,
          figures.atlas_turn_p99_deg_per_wall,
          figures.carried_turn_p99_deg_per_wall,
          figures.atlas_junction_turn_p99_deg_per_mm,
          figures.jump_p99_deg,
          figures.edge_p50_mm};
}

Report all_metrics(const Build& b, const LabelVolume& labels, const Meshes& meshes,
                   const validation::FacesOfMeshes& faces) {
  const Recipe& recipe = b.recipe;
  const CtVolume& ct = *b.ct;
  const auto bounds = bounds_of(recipe);
  const auto figures =
      recipe.fibers.method == "rule" ? validation::RegistrationFigures{} : registration_figures(*b.fibers);
  ReportParts parts;
  parts.push_back({[&] { return validation::check_labels(labels, needed_regions()); }});
  for (auto& part : mesh_certificate(meshes, faces, labels, recipe.mesh, bounds)) parts.push_back(std::move(part));
  parts.push_back({[&] { return validation::check_fibers(meshes.at("myocardium"), figures, bounds); }});
  parts.push_back({[&] { return check_resolution_fibers(meshes, recipe.mesh, bounds); }});
  parts.push_back({[&] { return validation::check_orifices(meshes, labels); }});
  parts.push_back({[&] { return validation::check_cavities(meshes); }});
  parts.push_back({[&] { return validation::check_user_regions(meshes); }});
  if (!ct.voxels.empty()) parts.push_back({[&] { return validation::check_contour_fit(meshes.at("myocardium"), ct); }});
  Report rows = joined(parts);
  const Report distances = resolution_distances(*b.further), pose = b.has_torso() ? torso_rows(*b.around) : Report{};
  append(rows, distances);
  append(rows, pose);
  return rows;
}

report::ReportInput report_input(const Build& b, const exporters::Bundle& bundle) {
  report::ReportInput input;
  input.name = bundle.name;
  input.version = bundle.version;
  input.ct = b.ct->voxels.empty() ? nullptr : &*b.ct;
  input.labels = &bundle.labels;
  input.meshes = &bundle.meshes;
  input.certificate = &bundle.certificate;
  input.atlas_name = bundle.atlas;
  for (const auto& file : bundle.inputs) input.inputs.emplace_back(file.name, file.sha256);
  for (const auto& [name, version] : bundle.tools) input.tools.emplace_back(name, version);
  input.atlas_lv = validation::helix_profile(b.fibers->figures.atlas.lv);
  input.atlas_rv = validation::helix_profile(b.fibers->figures.atlas.rv);
  return input;
}

std::string describe_atlas(const Recipe& recipe, const fibers::FiberResult& fibers) {
  if (recipe.fibers.method == "rule") return "no atlas: the rules of [fibers.rule]";
  if (recipe.input.atlas.empty()) return "heartgen's built-in stand-in atlas (synthetic)";
  const std::string array = fibers.atlas_array.empty() ? "" : ", " + fibers.atlas_array;
  return fs::path(recipe.input.atlas).filename().string() + array;
}

Meshes all_meshes(const Build& b) {
  Meshes meshes = *b.meshes;
  meshes["myocardium"] = with_fibers(std::move(meshes["myocardium"]), *b.fibers);
  if (const auto torso = meshes.find("torso"); torso != meshes.end())
    carry_fibers_to_parent(meshes.at("myocardium"), torso->second);
  meshes.insert(b.further->meshes.begin(), b.further->meshes.end());
  return meshes;
}

/// All but certificate and report.
exporters::Bundle describe_bundle(const Build& b) {
  const Recipe& recipe = b.recipe;
  exporters::Bundle bundle;
  bundle.name = recipe.name;
  bundle.version = recipe.version;
  bundle.license = recipe.license;
  bundle.author = recipe.author;
  bundle.attribution = recipe.attribution;
  bundle.date_published = recipe.date_published;
  bundle.recipe = write_recipe(recipe, true);
  bundle.atlas = describe_atlas(recipe, *b.fibers);
  bundle.torso_from_heart = recipe.torso.torso_from_heart;
  bundle.labels = b.labels();
  bundle.inputs = b.inputs;
  bundle.tools = tool_versions();
  bundle.meshes = all_meshes(b);
  return bundle;
}

/// The label map of a bundle ends where its meshes do. What that takes from given labels is told.
Notes end_arteries(const Build& b, LabelVolume& labels) {
  Notes notes;
  for (const auto& [artery, ml] : mesh::cut_at_ends(labels))
    if (b.has_labels() && labels::holds(*b.given, artery))
      notes.push_back({"labels.ends", WarningLevel::note,
                       fmt::format("Of the given {}, {:.2g} ml lie beyond its flat end and are no part of it here.",
                                   region_name(tag(artery)), ml)});
  return notes;
}

exporters::Bundle make_bundle(const Build& b, PartClock& clock) {
  auto bundle = describe_bundle(b);
  const Notes ended = end_arteries(b, bundle.labels);
  const Report painted = paint_meshes(bundle.meshes, b.regions, b.recipe);
  const auto faces = validation::faces_of_meshes(bundle.meshes);
  Report rows = all_metrics(b, bundle.labels, bundle.meshes, faces);
  append(rows, painted);
  insulate(bundle.meshes, mesh::insulation_named(b.recipe.mesh.insulation));
  append(rows, validation::check_insulation(bundle.meshes, b.recipe.mesh.insulation != "none"));
  Notes notes = all_notes(b);
  notes.insert(notes.end(), ended.begin(), ended.end());
  if (auto text = validation::remark_on_jumps(rows); !text.empty())
    notes.push_back({"fibers.too_coarse", WarningLevel::warning, std::move(text)});
  bundle.certificate =
      validation::certified(std::move(rows), std::move(notes), names_of(bundle.meshes), bounds_of(b.recipe));
  clock.done("certificate");
  auto input = report_input(b, bundle);
  input.faces = &faces;
  bundle.report_html = report::make_report(input);
  clock.done("report");
  return bundle;
}

Noted<Written> write_bundle(const Build& b) {
  PartClock clock;
  auto bundle = make_bundle(b, clock);
  Written written;
  written.fibers_from = fmt::format("{:<22} {}\n", "fibres from", bundle.atlas);
  written.certificate = bundle.certificate;
  bundle.logs["build.log"] = time_log(b.run) + written.fibers_from;
  written.content_id = exporters::write_bundle(bundle, b.place, existing_output(b.options));
  clock.done("files and their hashes");
  return {std::move(written), {}, clock.times};
}

}  // namespace

exporters::Existing existing_output(const BuildOptions& options) {
  return options.replace ? exporters::Existing::replace : exporters::Existing::refuse;
}

Stages bundle_stages() { return {last_stage("bundle", 8, always, &Build::written, write_bundle)}; }

std::vector<Region> needed_regions() {
  return {Region::lv_myocardium, Region::rv_myocardium, Region::lv_blood, Region::rv_blood};
}

std::vector<std::string> names_of(const Meshes& meshes) {
  std::vector<std::string> names;
  for (const auto& [name, mesh] : meshes) names.push_back(name);
  return names;
}

Report certificate(Meshes meshes, const LabelVolume& labels, const MeshSettings& mesh_settings,
                   const ValidationSettings& settings) {
  const Report insulation = validation::check_insulation(meshes, mesh_settings.insulation != "none");
  take_out_insulation(meshes, mesh::insulation_named(mesh_settings.insulation));
  const auto faces = validation::faces_of_meshes(meshes);
  ReportParts parts = mesh_certificate(meshes, faces, labels, mesh_settings, settings);
  if (meshes.contains("myocardium"))
    parts.push_back({[&] { return validation::check_fibers(meshes.at("myocardium"), {}, settings); }});
  parts.push_back({[&] { return check_resolution_fibers(meshes, mesh_settings, settings); }});
  parts.push_back({[&] { return validation::check_cavities(meshes); }});
  parts.push_back({[&] { return validation::check_user_regions(meshes); }});
  if (!labels.voxels.empty()) {
    parts.push_back({[&] { return validation::check_labels(labels, needed_regions()); }});
    parts.push_back({[&] { return validation::check_orifices(meshes, labels); }});
  }
  Report rows = joined(parts);
  append(rows, insulation);
  return rows;
}

}  // namespace heartgen::pipeline
