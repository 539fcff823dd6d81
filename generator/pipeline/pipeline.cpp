// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/pipeline.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/phantom/phantom.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/anatomy/vessel.hpp"
#include "generator/atlas/atlas.hpp"
#include "generator/fibers/map_fibers.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/mesh/mesh_vessel.hpp"
#include "generator/pipeline/check_inputs.hpp"
#include "generator/pipeline/fov_cuts.hpp"
#include "generator/pipeline/image_stages.hpp"
#include "generator/pipeline/input_files.hpp"
#include "generator/pipeline/mesh_certificate.hpp"
#include "generator/pipeline/print_certificate.hpp"
#include "generator/pipeline/resolutions.hpp"
#include "generator/pipeline/run.hpp"
#include "generator/pipeline/torso_stage.hpp"
#include "generator/pipeline/versions.hpp"
#include "model/error.hpp"
#include "model/memory.hpp"
#include "model/own_file.hpp"
#include "model/parent_fibers.hpp"
#include "validation/anatomy_checks.hpp"
#include "validation/contour_fit.hpp"
#include "validation/fiber_checks.hpp"
#include "validation/label_checks.hpp"
#include "validation/report/report_html.hpp"
#include "validation/uses.hpp"

namespace heartgen::pipeline {
namespace {

namespace fs = std::filesystem;
using Meshes = std::map<std::string, TetMesh>;

Mask region_mask(const LabelVolume& labels, Region region) {
  Mask mask(labels.grid);
  std::transform(labels.voxels.begin(), labels.voxels.end(), mask.voxels.begin(),
                 [&](std::uint8_t label) { return static_cast<std::uint8_t>(label == tag(region)); });
  return mask;
}

Meshes heart_meshes(const Recipe& recipe, const LabelVolume& labels) {
  if (recipe.input.size_field.empty()) return mesh::mesh_heart(labels, recipe.mesh);
  auto own_edges_mm = adapters::read_image(recipe.input.size_field);
  own_edges_mm.grid = grid_in_bundle(recipe, own_edges_mm.grid);
  return mesh::mesh_heart(labels, recipe.mesh, &own_edges_mm);
}

/// Where the body's field of view ends within its label map: at the border of another patient's image, which is not
/// that of the map, and at the padding of the body's image.
struct FieldOfView {
  const Grid* of_torso = nullptr;
  anatomy::Padding padding{};
};

Meshes make_meshes(const Recipe& recipe, const LabelVolume& labels, const FieldOfView& view) {
  Meshes meshes = heart_meshes(recipe, labels);
  if (meshes.contains("torso")) {
    if (view.of_torso != nullptr) label_torso_cuts(meshes.at("torso"), *view.of_torso);
    label_padding_cuts(meshes.at("torso"), view.of_torso != nullptr ? *view.of_torso : labels.grid, view.padding);
  }
  if (wants(recipe, "trachea") && labels::holds(labels, Region::trachea))
    meshes["trachea"] = mesh::mesh_vessel(region_mask(labels, Region::trachea), Region::trachea, recipe.mesh);
  if (wants(recipe, "carotid") && !recipe.input.carotid.empty()) {
    const Mask lumen = anatomy::segment_vessel(adapters::read_ct(recipe.input.carotid), carotid_seed(recipe));
    meshes["carotid"] = mesh::mesh_vessel(lumen, Region::carotid, recipe.mesh);
  }
  return meshes;
}

FiberAtlas read_atlas(const Recipe& recipe) {
  if (recipe.input.atlas.empty()) return standin_atlas();
  return atlas::read_fiber_atlas(recipe.input.atlas, recipe.input.atlas_array);
}

TetMesh with_fibers(TetMesh myocardium, const fibers::FiberResult& result) {
  myocardium.node_fibers = result.node;
  myocardium.cell_fibers = result.cell;
  myocardium.fiber_source = result.source;
  myocardium.rule_difference_deg = result.rule_difference_deg;
  return myocardium;
}

/// Of the meshes of the map, whatever is made beside them.
std::string mesh_section(Recipe recipe) {
  recipe.mesh.resolutions_mm.clear();
  return recipe_section(recipe, "mesh");
}

std::vector<Warning> all_warnings(const Recipe& recipe, const std::vector<Warning>& of_stages, const Meshes& meshes,
                                  const fibers::FiberResult& fibers) {
  std::vector<Warning> warnings;
  if (recipe.synthetic_image)
    warnings.push_back(
        {"image.synthetic", WarningLevel::note, "The image is synthetic: an analytic phantom, not a patient."});
  if (recipe.input.atlas.empty())
    warnings.push_back(
        {"fibers.standin_atlas", WarningLevel::note,
         "The fibres come from the built-in stand-in atlas, a synthetic heart with published helix angles, not from "
         "measurements."});
  warnings.insert(warnings.end(), of_stages.begin(), of_stages.end());
  warnings.insert(warnings.end(), fibers.warnings.begin(), fibers.warnings.end());
  for (const auto& name : recipe.mesh.meshes)
    if (!meshes.contains(name))
      warnings.push_back(
          {"mesh.missing", WarningLevel::note,
           fmt::format("The recipe asks for the mesh \"{}\", but the input does not contain it.", name)});
  return warnings;
}

std::vector<Region> needed_regions() {
  return {Region::lv_myocardium, Region::rv_myocardium, Region::lv_blood, Region::rv_blood};
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

Report all_metrics(const Recipe& recipe, const CtVolume& ct, const LabelVolume& labels, const Meshes& meshes,
                   const validation::FacesOfMeshes& faces, const fibers::FiberResult& fibers) {
  const auto bounds = bounds_of(recipe);
  ReportParts parts;
  parts.push_back({[&] { return validation::check_labels(labels, needed_regions()); }});
  for (auto& part : mesh_certificate(meshes, faces, labels, recipe.mesh, bounds)) parts.push_back(std::move(part));
  parts.push_back(
      {[&] { return validation::check_fibers(meshes.at("myocardium"), registration_figures(fibers), bounds); }});
  parts.push_back({[&] { return check_resolution_fibers(meshes, recipe.mesh, bounds); }});
  parts.push_back({[&] { return validation::check_orifices(meshes, labels); }});
  if (!ct.voxels.empty()) parts.push_back({[&] { return validation::check_contour_fit(meshes.at("myocardium"), ct); }});
  return joined(parts);
}

std::vector<exporters::BundleInput> hash_inputs(const Recipe& recipe) {
  std::vector<exporters::BundleInput> inputs;
  InputSettings::describe_files(
      [&](const char* key, const std::string& path, const char*) {
        if (!path.empty()) inputs.push_back(hash_input(key, path));
      },
      recipe.input);
  TorsoSettings::describe_files(
      [&](const char* key, const std::string& path, const char*) {
        if (!path.empty()) inputs.push_back(hash_input(std::string("torso.") + key, path));
      },
      recipe.torso);
  return inputs;
}

std::string hash_of(const std::vector<exporters::BundleInput>& inputs, const std::string& role) {
  for (const auto& input : inputs)
    if (input.name.starts_with(role + ": ")) return input.sha256;
  return "none";
}

report::ReportInput report_input(const Recipe& recipe, const exporters::Bundle& bundle, const CtVolume& ct) {
  report::ReportInput input;
  input.name = recipe.name;
  input.version = recipe.version;
  input.ct = ct.voxels.empty() ? nullptr : &ct;
  input.labels = &bundle.labels;
  input.meshes = &bundle.meshes;
  input.certificate = &bundle.certificate;
  input.atlas_name = bundle.atlas;
  for (const auto& file : bundle.inputs) input.inputs.emplace_back(file.name, file.sha256);
  for (const auto& [name, version] : bundle.tools) input.tools.emplace_back(name, version);
  return input;
}

std::string describe_atlas(const Recipe& recipe, const fibers::FiberResult& fibers) {
  if (recipe.input.atlas.empty()) return "heartgen's built-in stand-in atlas (synthetic)";
  const std::string array = fibers.atlas_array.empty() ? "" : ", " + fibers.atlas_array;
  return fs::path(recipe.input.atlas).filename().string() + array;
}

exporters::Bundle make_bundle(const Recipe& recipe, const CtVolume& ct, const LabelVolume& labels, Meshes meshes,
                              const fibers::FiberResult& fibers, const Resolutions& further,
                              std::vector<exporters::BundleInput> inputs, const std::vector<Warning>& warnings,
                              const Report& pose, PartClock& clock) {
  exporters::Bundle bundle;
  bundle.name = recipe.name;
  bundle.version = recipe.version;
  bundle.license = recipe.license;
  bundle.author = recipe.author;
  bundle.date_published = recipe.date_published;
  bundle.recipe = write_recipe(recipe, true);
  bundle.atlas = describe_atlas(recipe, fibers);
  bundle.torso_from_heart = recipe.torso.torso_from_heart;
  bundle.labels = labels;
  bundle.inputs = std::move(inputs);
  bundle.tools = tool_versions();
  auto all = all_warnings(recipe, warnings, meshes, fibers);
  bundle.meshes = std::move(meshes);
  bundle.meshes["myocardium"] = with_fibers(std::move(bundle.meshes["myocardium"]), fibers);
  if (const auto torso = bundle.meshes.find("torso"); torso != bundle.meshes.end())
    carry_fibers_to_parent(bundle.meshes.at("myocardium"), torso->second);
  bundle.meshes.insert(further.meshes.begin(), further.meshes.end());
  const auto faces = validation::faces_of_meshes(bundle.meshes);
  Report rows = all_metrics(recipe, ct, labels, bundle.meshes, faces, fibers);
  const Report distances = resolution_distances(further);
  rows.insert(rows.end(), distances.begin(), distances.end());
  rows.insert(rows.end(), pose.begin(), pose.end());
  if (auto text = validation::remark_on_jumps(rows); !text.empty())
    all.push_back({"fibers.too_coarse", WarningLevel::warning, std::move(text)});
  bundle.certificate =
      validation::certified(std::move(rows), std::move(all), names_of(bundle.meshes), bounds_of(recipe));
  clock.done("certificate");
  auto input = report_input(recipe, bundle, ct);
  input.faces = &faces;
  input.atlas_lv = validation::helix_profile(fibers.figures.atlas.lv);
  input.atlas_rv = validation::helix_profile(fibers.figures.atlas.rv);
  bundle.report_html = report::make_report(input);
  clock.done("report");
  return bundle;
}

/// As far as it is known: which image stages run depends on what the given labels lack.
std::vector<StagePlan> stage_plan(const Recipe& recipe, const labels::MissingGroups& missing) {
  std::vector<StagePlan> plan = {{"read", 1}};
  const auto add = [&](bool wanted, const std::string& stage, double weight) {
    if (wanted) plan.push_back({stage, weight});
  };
  const ReplaceSettings& files = recipe.replace;
  const bool chambers = (missing.chambers || missing.vessels) && files.chambers.empty();
  const bool body = missing.body && files.body.empty();
  const bool parts = files.labels.empty() &&
                     (missing.any() || !files.chambers.empty() || !files.epicardium.empty() || !files.body.empty());
  add(!recipe.input.labels.empty(), "given", 3);
  add((missing.chambers || missing.vessels) && !chambers_are_marked(recipe.landmarks), "landmarks", 8);
  add(parts && (chambers || body) && files.segment.empty(), "denoise", 2);
  add(parts && (chambers || body), "segment", 8);
  add(parts, "chambers", 8);
  add(parts, "epicardium", 10);
  add(parts, "body", 5);
  add(true, "labels", 3);
  add(recipe.torso.is_given(), "torso", recipe.torso.ct.empty() ? 3 : 30);
  add(true, "mesh", 25);
  add(true, "fibers", 20);
  add(!recipe.mesh.resolutions_mm.empty(), "resolutions", 20);
  add(true, "bundle", 8);
  return plan;
}

/// Regions that meshing and fibres cannot do without.
void refuse_empty_regions(const LabelVolume& labels, const Recipe& recipe) {
  if (recipe.input.labels.empty()) return;
  for (const Region region : needed_regions())
    if (!labels::holds(labels, region))
      throw UserError(fmt::format("no voxel is {}, and every heart needs it", region_name(tag(region))),
                      recipe.input.labels,
                      "map it in [labels.regions], or let labels.complete have it made from the CT");
}

/// What the image stages depend on, for recognising their files.
std::string origin_of(const Recipe& recipe, const Run& run, const std::vector<exporters::BundleInput>& inputs) {
  std::string text = run.program_hash;
  for (const char* input : {"ct", "labels", "label_names"}) text += hash_of(inputs, input) + "\n";
  for (const char* section : {"labels", "landmarks", "denoise", "segmentation", "chambers", "epicardium"})
    text += recipe_section(recipe, section);
  return exporters::sha256_of_text(text);
}

StageFiles stage_files(const Recipe& recipe, const BuildOptions& options) {
  StageFiles files;
  files.keep_folder = options.keep_stages;
  ReplaceSettings::describe(
      [&](const char* stage, const std::string& file, const char*) {
        if (!file.empty()) files.replaced_by[stage] = file;
      },
      recipe.replace);
  return files;
}

/// Of landmarks that are refused.
fs::path picture_beside(const BuildOptions& options) { return fs::path(options.output.string() + ".landmarks.png"); }

/// A cache that this run has made goes where its input is refused: nobody will ask for it again.
class NewCache {
 public:
  explicit NewCache(const fs::path& folder) : folder_(fs::exists(folder) ? fs::path() : folder) {}
  ~NewCache() {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
  }
  NewCache(const NewCache&) = delete;
  NewCache& operator=(const NewCache&) = delete;
  void keep() { folder_.clear(); }

 private:
  fs::path folder_;
};

/// Leaves in the recipe the files that changed a result, and says so.
void settle_replacements(const Run& run, ReplaceSettings& replace, std::vector<exporters::BundleInput>& inputs,
                         std::vector<Warning>& warnings) {
  const auto changed = [&](const std::string& stage) {
    return std::any_of(run.files.changed.begin(), run.files.changed.end(),
                       [&](const auto& entry) { return entry.substr(0, entry.find(' ')) == stage; });
  };
  ReplaceSettings::describe(
      [&](const char* stage, std::string& file, const char*) {
        if (!file.empty() && changed(stage)) {
          inputs.push_back(hash_input(stage, file));
          warnings.push_back({"stage.replaced", WarningLevel::note,
                              fmt::format("The result of the stage \"{}\" was replaced by the file {}.", stage,
                                          fs::path(file).filename().string())});
        } else {
          file.clear();
        }
      },
      replace);
}

}  // namespace

BuildResult build(const Recipe& given, const BuildOptions& options, const parallel::Comm& comm) {
  Recipe recipe = given;
  std::vector<exporters::BundleInput> inputs;
  std::vector<Warning> warnings;
  Run run;
  run.comm = comm;
  run.cache_folder = options.cache_folder;
  run.progress = make_progress(stage_plan(recipe, {true, false, true, true}), options.progress && comm.is_root());
  if (comm.is_root()) run.progress.on_stage = options.on_stage;
  run.files = stage_files(recipe, options);
  const auto existing = options.replace ? exporters::Existing::replace : exporters::Existing::refuse;
  exporters::ReservedPlace place;
  NewCache cache(comm.is_root() ? options.cache_folder : fs::path());
  parallel::run_on_root(comm, [&] {
    check_inputs(recipe);
    place = exporters::reserve_place(options.output, existing);
    if (!place.remark.empty() && options.tells_warnings) fmt::print(stderr, "heartgen: {}\n", place.remark);
    clear_unfinished_entries(options.cache_folder);
    inputs = hash_inputs(recipe);
    run.program_hash = exporters::sha256_of_file(own_file());
    run.files.origin = origin_of(recipe, run, inputs);
  });

  auto ct = run.root_stage("read", {hash_of(inputs, "ct")},
                           [&] { return recipe.input.ct.empty() ? CtVolume{} : adapters::read_ct(recipe.input.ct); });
  auto known = read_known_labels(run, ct, recipe, hash_of(inputs, "labels") + hash_of(inputs, "label_names"), warnings);
  run.progress.plan = stage_plan(recipe, known.missing);
  if (recipe.input.ct.empty()) ct.value.grid = known.given->labels.grid;  // without voxels
  run.files.grid = ct->grid;
  parallel::run_on_root(comm, [&] { check_seeds_inside(ct->grid, recipe.landmarks); });
  const auto padding = close_unmeasured(run, ct, recipe, warnings);
  const auto& files = run.files.replaced_by;
  const bool chambers_of_ct = known.missing.chambers && !files.contains("chambers") && !files.contains("labels");
  if (known.missing.chambers) {
    auto completed =
        complete_landmarks(run, ct, recipe.landmarks, warnings, {options.accept_doubtful, picture_beside(options)});
    recipe.landmarks = std::move(completed.landmarks);
    parallel::run_on_root(comm, [&] {
      if (chambers_of_ct) refuse_cut_ventricles(completed.ventricles_cut_cm2);
    });
  }
  if (known.missing.vessels) known.missing.vessels = find_vessels(run, ct, recipe.landmarks, warnings);
  auto heart = label_ct(run, ct, recipe, known, padding);
  parallel::run_on_root(comm, [&] {
    anatomy::reopen_padding(ct.value, padding);
    refuse_empty_regions(*heart, recipe);
    check_memory(*heart, recipe.mesh, memory_bytes());
    if (chambers_of_ct) refuse_cut_ventricles(*heart, padding);
    refuse_mirrored_heart(*heart, recipe.landmarks);
    const auto told = label_warnings(known.given->labels, *heart, !recipe.input.ct.empty());
    warnings.insert(warnings.end(), told.begin(), told.end());
    if (options.tells_warnings) print_warnings(warnings);  // not before: a refusal is one message
    settle_replacements(run, recipe.replace, inputs, warnings);
  });
  cache.keep();  // from here on nothing is refused, and what fails for want of room goes on where it stopped
  const auto torso_hash =
      hash_of(inputs, "torso.ct") + hash_of(inputs, "torso.labels") + hash_of(inputs, "torso.landmarks");
  const auto around = place_in_torso(run, heart, ct.value.grid, recipe, torso_hash, warnings);
  const bool has_torso = recipe.torso.is_given();
  const LabelVolume& labels = has_torso ? around->labels : *heart;
  const auto& labels_key = has_torso ? around.key : heart.key;
  const auto mesh_inputs = hash_of(inputs, "ct") + hash_of(inputs, "carotid") + hash_of(inputs, "size_field");
  const FieldOfView view{has_torso ? &around->torso_grid : nullptr, has_torso ? around->torso_padding : padding};
  const auto meshes = run.root_stage("mesh", {labels_key, mesh_inputs, mesh_section(recipe)},
                                     [&] { return make_meshes(recipe, labels, view); });
  const auto fibers =
      run.root_stage("fibers",
                     {meshes.key, hash_of(inputs, "atlas") + recipe.input.atlas_array,
                      recipe_section(recipe, "landmarks"), recipe_section(recipe, "fibers")},
                     [&] {
                       return fibers::map_fibers(meshes->at("myocardium"), *heart, landmarks_in_bundle(recipe),
                                                 read_atlas(recipe), recipe.fibers);
                     });
  run.times.back().parts = fibers->part_times;
  Staged<Resolutions> further;
  if (!recipe.mesh.resolutions_mm.empty())
    further = run.root_stage("resolutions", {labels_key, fibers.key, recipe_section(recipe, "mesh")}, [&] {
      return make_resolutions(*heart, recipe.mesh, with_fibers(meshes->at("myocardium"), *fibers));
    });
  BuildResult result;
  std::string fibers_from;
  run.cache_folder.clear();  // the bundle itself is on disk: no second copy
  PartClock clock;
  const auto content_id = run.root_stage("bundle", {}, [&] {
    const Report pose = has_torso ? torso_rows(*around) : Report{};
    auto bundle = make_bundle(recipe, *ct, labels, *meshes, *fibers, *further, inputs, warnings, pose, clock);
    fibers_from = fmt::format("{:<22} {}\n", "fibres from", bundle.atlas);
    bundle.logs["build.log"] = time_log(run) + fibers_from;
    result.certificate = bundle.certificate;
    auto id = exporters::write_bundle(bundle, place, existing);
    clock.done("files and their hashes");
    return id;
  });
  run.times.back().parts = clock.times;
  parallel::run_on_root(comm, [&] { forget_other_entries(options.cache_folder, run.used_keys); });
  finish(run.progress);
  result.content_id = *content_id;
  result.log = time_log(run) + fibers_from;
  return result;
}

FiberAtlas standin_atlas() {
  const TetMesh standin = phantom::make_standin_atlas();
  return atlas::make_fiber_atlas("stand-in atlas", standin.nodes_mm, standin.cells, standin.node_fibers.fiber);
}

std::vector<std::string> names_of(const Meshes& meshes) {
  std::vector<std::string> names;
  for (const auto& [name, mesh] : meshes) names.push_back(name);
  return names;
}

Report certificate(const Meshes& meshes, const LabelVolume& labels, const MeshSettings& mesh_settings,
                   const ValidationSettings& settings) {
  const auto faces = validation::faces_of_meshes(meshes);
  ReportParts parts = mesh_certificate(meshes, faces, labels, mesh_settings, settings);
  if (meshes.contains("myocardium"))
    parts.push_back({[&] { return validation::check_fibers(meshes.at("myocardium"), {}, settings); }});
  parts.push_back({[&] { return check_resolution_fibers(meshes, mesh_settings, settings); }});
  if (!labels.voxels.empty()) {
    parts.push_back({[&] { return validation::check_labels(labels, needed_regions()); }});
    parts.push_back({[&] { return validation::check_orifices(meshes, labels); }});
  }
  return joined(parts);
}

}  // namespace heartgen::pipeline
