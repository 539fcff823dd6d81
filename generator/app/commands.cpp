// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <heartgen/build.hpp>
#include <heartgen/bundle.hpp>
#include <heartgen/checks.hpp>
#include <heartgen/meshes.hpp>
#include <nlohmann/json.hpp>

#include "exporters/bundle.hpp"
#include "exporters/certificate_json.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/anatomy/hounsfield.hpp"
#include "generator/anatomy/padding.hpp"
#include "generator/app/own_mesh.hpp"
#include "generator/labels/given_labels.hpp"
#include "generator/labels/judge.hpp"
#include "generator/landmarks/judge.hpp"
#include "generator/landmarks/search.hpp"
#include "generator/mesh/heart_ends.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/mesh/walls.hpp"
#include "generator/painting/region_masks.hpp"
#include "generator/pde/filters.hpp"
#include "generator/pipeline/bundle_stage.hpp"
#include "generator/pipeline/check_inputs.hpp"
#include "generator/pipeline/input_files.hpp"
#include "generator/pipeline/landmarks_picture.hpp"
#include "generator/pipeline/mesh_certificate.hpp"
#include "generator/pipeline/pipeline.hpp"
#include "generator/pipeline/print_certificate.hpp"
#include "generator/pipeline/resolutions.hpp"
#include "generator/pipeline/stage_files.hpp"
#include "model/error.hpp"
#include "model/memory.hpp"
#include "model/recipe.hpp"
#include "model/text.hpp"
#include "validation/contour_fit.hpp"
#include "validation/mesh_checks.hpp"
#include "validation/reference_fibers.hpp"
#include "validation/report/report_html.hpp"
#include "validation/uses.hpp"

namespace heartgen::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int validation_failed = 3;

/// The CT that a report's outlines are drawn over. Throws UserError where it is not of the heart in `labels`.
CtVolume ct_of_labels(const std::string& path, const LabelVolume& labels) {
  CtVolume ct = adapters::read_ct(path);
  if (!labels::same_place(ct.grid, labels.grid))
    throw UserError("has another size, spacing or place than the bundle's label map", path,
                    "give the CT that the bundle was made from, or none");
  anatomy::require_hounsfield(ct, path);
  labels::refuse_labels_beside_heart(labels, ct, path);
  return ct;
}

std::string remark_on_ct(const std::string& path, const exporters::Manifest& manifest) {
  if (path.empty()) return "Made from the bundle alone: the CT is not part of it.";
  const auto given = pipeline::hash_input("ct", path).sha256;
  const bool is_input = std::any_of(manifest.inputs.begin(), manifest.inputs.end(),
                                    [&](const auto& input) { return input.sha256 == given; });
  return is_input ? "" : "Drawn over a CT that is not, byte for byte, one of the bundle's inputs.";
}

void append(Report& report, const Report& rows) { report.insert(report.end(), rows.begin(), rows.end()); }

validation::ReferenceFibers read_reference_fibers(const std::string& folder) {
  const auto component = [&](const char* name) { return adapters::read_image((fs::path(folder) / name).string()); };
  return {component("fiber_x.nrrd"), component("fiber_y.nrrd"), component("fiber_z.nrrd")};
}

/// Without the rows that passed or inform.
Certificate summary_of(const Certificate& certificate) {
  Certificate summary{{}, certificate.warnings, certificate.uses};
  std::copy_if(certificate.rows.begin(), certificate.rows.end(), std::back_inserter(summary.rows),
               [](const auto& row) { return row.verdict() > Verdict::passed; });
  return summary;
}

Json with_files(const Report& report, const std::vector<fs::path>& files) {
  Json out = Json::parse(exporters::certificate_json({report, {}, {}}));
  out["files"] = Json::array();
  for (const auto& file : files) out["files"].push_back(file.lexically_normal().string());
  return out;
}

/// What a command wrote that has nothing else to say.
void print_written(const char* what, const std::string& path, bool json) {
  fmt::print("{}\n", json ? Json::object({{what, path}}).dump(1) : path);
}

}  // namespace

int build_command(const BuildCommand& command, const parallel::Comm& comm) {
  pipeline::BuildOptions options;
  if (command.output.empty()) throw UserError("no folder is named", "--output", "name the folder of the bundle");
  // Every rank reads the recipe, so that all fail or go on together.
  Recipe recipe = command.recipe.empty() ? default_recipe() : read_recipe(command.recipe);
  if (!command.ct.empty()) recipe.input.ct = command.ct;
  if (command.phase != 0) recipe.input.phase = command.phase;
  if (!command.labels.empty()) recipe.input.labels = command.labels;
  if (!command.preset.empty()) recipe.labels.preset = command.preset;
  if (!command.atlas.empty()) recipe.input.atlas = command.atlas;
  if (!command.atlas_array.empty()) recipe.input.atlas_array = command.atlas_array;
  if (!command.landmarks.empty()) recipe.landmarks = read_landmarks(command.landmarks);
  if (!command.regions.empty()) recipe.regions.clear();
  for (const auto& text : command.regions) recipe.regions.push_back(painting::region_argument(text));
  options.output = fs::path(command.output).lexically_normal();
  if (options.output.filename().empty()) options.output = options.output.parent_path();
  if (!command.no_cache) options.cache_folder = fs::path(options.output.string() + ".cache");
  options.keep_stages = command.keep_stages;
  if (!command.keep_stages.empty() && lies_in(command.keep_stages, options.output))
    throw UserError("lies in the folder of the bundle", "--keep-stages " + command.keep_stages,
                    "name a folder beside it");
  options.replace = command.force;
  options.progress = !command.quiet;
  options.accept_doubtful = command.accept_doubtful;
  const pipeline::BuildResult result = pipeline::build(recipe, options, comm);
  if (!comm.is_root()) return 0;
  const int exit_code = verdict_of(result.certificate) == Verdict::failed ? validation_failed : 0;
  if (command.json) {
    Json out = Json::parse(exporters::certificate_json(summary_of(result.certificate)));
    out["bundle"] = command.output;
    out["content_id"] = result.content_id;
    out["report"] = (options.output / "validation" / "report.html").string();
    fmt::print("{}\n", out.dump(1));
    return exit_code;
  }
  fmt::print("{}\n", result.log);
  pipeline::print_certificate(result.certificate, false);
  fmt::print("bundle      {}\ncontent id  {}\nreport      {}\n", command.output, result.content_id,
             (options.output / "validation" / "report.html").string());
  return exit_code;
}

int validate_command(const ValidateCommand& command) {
  if (is_own_mesh(command.bundle)) return validate_own_mesh(command);
  std::optional<LabelVolume> known_labels;
  if (!command.reference_labels.empty()) known_labels = adapters::read_labels(command.reference_labels);
  std::optional<validation::ReferenceFibers> known_fibers;
  if (!command.reference_fibers.empty()) known_fibers = read_reference_fibers(command.reference_fibers);
  const Certificate certificate = validate_bundle(
      command.bundle, {known_labels ? &*known_labels : nullptr, known_fibers ? &*known_fibers : nullptr});
  if (command.json)
    fmt::print("{}\n", exporters::certificate_json(certificate));
  else
    pipeline::print_certificate(certificate, command.all_rows);
  // What the user asked to compare is shown without --all.
  if (!command.json && !command.all_rows)
    for (const auto& row : certificate.rows)
      if (row.metric == "dice" || row.metric.starts_with("axis_error") || row.metric == "surface_distance_mean")
        pipeline::print_row(row);
  return verdict_of(certificate) == Verdict::failed ? validation_failed : 0;
}

int verify_command(const std::string& bundle, bool json) {
  const auto problems = exporters::verify_bundle(bundle);
  if (json) {
    Json list = Json::array();
    for (const auto& problem : problems) list.push_back({{"file", problem.file}, {"problem", problem.what}});
    fmt::print("{}\n", list.dump(1));
  } else if (problems.empty()) {
    fmt::print("{} is whole: content id {}\n", bundle, exporters::read_manifest(bundle).content_id);
  } else {
    for (const auto& problem : problems) fmt::print("{}: {}\n", problem.file, problem.what);
  }
  if (!problems.empty())
    throw UserError(fmt::format("{} of its files do not agree with the manifest", problems.size()), bundle,
                    "copy or download the bundle again");
  return 0;
}

int pack_command(const std::string& bundle, const std::string& archive, bool json) {
  exporters::refuse_inside(archive, bundle);
  exporters::pack_bundle(bundle, archive);
  print_written("archive", archive, json);
  return 0;
}

int unpack_command(const std::string& archive, const std::string& folder, bool json) {
  exporters::unpack_bundle(archive, folder);
  print_written("bundle", folder, json);
  return 0;
}

int info_command(const std::string& bundle, bool json) {
  const auto manifest = exporters::read_manifest(bundle);
  if (json) {
    Json out{{"name", manifest.name}, {"version", manifest.version}, {"content_id", manifest.content_id},
             {"unit", manifest.unit}, {"frame", manifest.frame},     {"fibres", manifest.atlas}};
    const Json certificate = Json::parse(exporters::certificate_json({{}, manifest.warnings, manifest.uses}));
    out["warnings"] = certificate.at("warnings");
    out["uses"] = certificate.at("uses");
    for (const auto& [name, mesh] : manifest.meshes)
      out["meshes"][name] = {{"nodes", mesh.nodes},     {"cells", mesh.cells},       {"labelled_faces", mesh.faces},
                             {"regions", mesh.regions}, {"surfaces", mesh.surfaces}, {"rims", mesh.rims}};
    for (const auto& [name, mesh] : manifest.meshes) {
      if (!mesh.user_regions.empty()) out["meshes"][name]["user_regions"] = mesh.user_regions;
      for (const auto& [cavity, entry] : mesh.cavities)
        out["meshes"][name]["cavities"][cavity] = {{"volume_ml", entry.volume_ml}, {"caps", entry.caps}};
    }
    fmt::print("{}\n", out.dump(1));
    return 0;
  }
  fmt::print("{} {}  content id {}\nunit {}, frame {}, fibres: {}\n", manifest.name, manifest.version,
             manifest.content_id, manifest.unit, manifest.frame, manifest.atlas.empty() ? "none" : manifest.atlas);
  pipeline::print_trust(manifest.uses, manifest.warnings);
  for (const auto& [name, mesh] : manifest.meshes) {
    fmt::print("\n{}: {} nodes, {} cells, {} labelled faces\n", name, mesh.nodes, mesh.cells, mesh.faces);
    for (const auto& [region, cells] : mesh.regions) fmt::print("  region  {:<28} {:>9} cells\n", region, cells);
    for (const auto& [surface, faces] : mesh.surfaces) fmt::print("  surface {:<28} {:>9} faces\n", surface, faces);
    for (const auto& [rim, nodes] : mesh.rims) fmt::print("  rim     {:<28} {:>9} nodes\n", rim, nodes);
    for (const auto& [region, cells] : mesh.user_regions) fmt::print("  yours   {:<28} {:>9} cells\n", region, cells);
    for (const auto& [cavity, entry] : mesh.cavities)
      fmt::print("  cavity  {:<28} {:>9.1f} ml, {}\n", cavity, entry.volume_ml, fmt::join(entry.caps, ", "));
  }
  return 0;
}

int report_command(const std::string& bundle, const std::string& html, const std::string& ct_path, bool json) {
  exporters::refuse_inside(html, bundle);
  check_output(html);
  const auto manifest = exporters::read_manifest(bundle);
  const auto meshes = bundle::read_meshes(bundle);
  const LabelVolume labels = exporters::read_labels(bundle);
  Certificate certificate = exporters::read_certificate(bundle);
  const CtVolume ct = ct_path.empty() ? CtVolume{} : ct_of_labels(ct_path, labels);
  report::ReportInput input;
  input.name = manifest.name;
  input.version = manifest.version;
  input.ct = ct_path.empty() ? nullptr : &ct;
  input.labels = &labels;
  input.meshes = &meshes;
  input.certificate = &certificate;
  input.atlas_name = manifest.atlas;
  for (const auto& file : manifest.inputs) input.inputs.emplace_back(file.name, file.sha256);
  for (const auto& [name, version] : manifest.tools) input.tools.emplace_back(name, version);
  if (const auto remark = remark_on_ct(ct_path, manifest); !remark.empty())
    certificate.warnings.push_back({"report.ct", WarningLevel::note, remark});
  write_text(html, report::make_report(input));
  print_written("report", html, json);
  return 0;
}

int filter_command(const FilterCommand& command, const parallel::Comm& comm) {
  std::map<std::string, double> parameters;
  for (std::size_t i = 0; i < command.parameters.size(); i += 2) {
    const std::string& key = command.parameters[i];
    if (!key.starts_with("--") || i + 1 == command.parameters.size())
      throw UserError(fmt::format("\"{}\" is not a parameter with a value", key), "filter " + command.name,
                      "write --name value");
    parameters[key.substr(2)] = parse_number(command.parameters[i + 1], "filter " + command.name + " " + key);
  }
  adapters::check_image_output(command.output);
  const auto image = parallel::run_on_root(comm, [&] { return adapters::read_image(command.input); });
  const auto result = pde::apply_filter(command.name, image, parameters, comm);
  parallel::run_on_root(comm, [&] { adapters::write_volume(command.output, result); });
  return 0;
}

std::string filter_help() {
  std::string text = "Filters and their parameters:\n";
  for (const auto& filter : pde::filters()) {
    text += fmt::format("  {:<20} {}\n  {:<20} {}\n", filter.name, filter.help, "", filter.equation);
    for (const auto& parameter : filter.parameters)
      text += fmt::format("      --{:<16} {} (default {})\n", parameter.name, parameter.help, parameter.default_value);
  }
  return text;
}

namespace {

/// Tells of walls that are too thin for their edges.
void remark_on_thin_walls(const mesh::WallLevelSets& walls) {
  constexpr double told = 0.03;
  std::array<double, 256> before{}, after{};  // voxels
  for (const auto label : walls.domain.voxels) ++before[label];
  for (const auto label : mesh::labels_of(walls).voxels) ++after[label];
  for (const auto label : walls.labels)
    if (const double lost = 1 - after[label] / before[label]; lost > told)
      fmt::print(stderr, "heartgen mesh: {:.0f} % of {} is too thin for these edges and left out: give shorter ones\n",
                 100 * lost, region_name(label));
}

void require_cells(const TetMesh& mesh, const MeshSettings& settings, const std::string& labels) {
  if (mesh.cells.empty())
    throw UserError(fmt::format("nothing of its regions is left at edges of {:g} mm", settings.heart_edge_mm), labels,
                    "shorter edges keep what is small or thin: --edge");
}

void remark_on_lost_regions(const TetMesh& mesh, const LabelVolume& labels, const MeshCommand& command,
                            double edge_mm) {
  std::array<std::int64_t, 256> voxels{}, cells{};
  for (const auto label : labels.voxels) ++voxels[label];
  for (const auto region : mesh.region) ++cells[static_cast<std::size_t>(region)];
  const auto is_wanted = [&](const NamedTag& row) {
    return row.tag > 0 && (!command.walls || is_myocardium(static_cast<Region>(row.tag)));
  };
  for (const auto& row : region_table())
    if (is_wanted(row) && voxels[row.tag] > 0 && cells[row.tag] == 0)
      fmt::print(stderr,
                 "warning: {} ({:.3g} mm3 of the label map) has no cell at edges of {:g} mm: use shorter ones\n",
                 row.name, static_cast<double>(voxels[row.tag]) * labels.grid.voxel_volume_mm3(), edge_mm);
}

}  // namespace

namespace {

/// Read and refused as `build` does.
LabelVolume labels_to_mesh(const MeshCommand& command) {
  InputSettings input;
  input.labels = command.labels;
  input.label_names = command.label_names;
  LabelSettings settings;
  if (!command.preset.empty()) settings.preset = command.preset;
  auto given = labels::read_given_labels(input, settings, nullptr);
  labels::refuse_no_heart(given.labels, command.labels);
  return std::move(given.labels);
}

}  // namespace

int mesh_command(const MeshCommand& command) {
  MeshSettings settings;
  if (command.edge_mm) settings.heart_edge_mm = *command.edge_mm;
  if (command.wall_layers) settings.wall_layers = *command.wall_layers;
  if (!command.backend.empty()) settings.backend = command.backend;
  pipeline::check_edges(settings);
  mesh::check_settings(settings);
  if (command.walls && settings.backend != MeshSettings{}.backend)
    throw UserError(fmt::format("--walls does not go with the back end \"{}\"", settings.backend), "--backend",
                    "leave one of them out");
  mesh_files::check_mesh_output(command.output);
  Recipe recipe;
  recipe.mesh = settings;
  const auto bounds = bounds_of(recipe);  // what the mesher promises
  mesh::LatticeReport steps;
  steps.on_step = [](const std::string& step, double seconds) {
    fmt::print(stderr, "  {:<8} {:7.2f} s\n", step, seconds);
    std::fflush(stderr);
  };
  LabelVolume labels = labels_to_mesh(command);
  pipeline::check_memory(labels, settings, memory_bytes());
  Volume<float> own_edges_mm;
  if (!command.size_field.empty()) own_edges_mm = adapters::read_image(command.size_field);
  const Volume<float>* edges = command.size_field.empty() ? nullptr : &own_edges_mm;
  const std::string name = fs::path(command.output).stem().string();
  TetMesh mesh;
  Report fidelity;
  if (command.walls) {
    const auto walls = mesh::wall_level_sets(labels, settings);
    remark_on_thin_walls(walls);
    mesh = mesh::mesh_walls(walls, settings, &steps, edges);
    fidelity = pipeline::check_fidelity(name, mesh, walls, bounds);
  } else {
    mesh = mesh::mesh_labels(labels, settings, &steps, edges);
    mesh::cut_at_ends(labels);
    fidelity = pipeline::check_fidelity(name, mesh, labels, settings, bounds);
  }
  require_cells(mesh, settings, command.labels);
  remark_on_lost_regions(mesh, labels, command, settings.heart_edge_mm);
  const auto files = write_mesh(command.output, mesh);
  Report report = validation::check_mesh(name, mesh, bounds);
  append(report, fidelity);
  if (command.json)
    fmt::print("{}\n", with_files(report, files).dump(1));
  else {
    fmt::print("{} nodes, {} cells in\n", mesh.nodes_mm.size(), mesh.cells.size());
    for (const auto& file : files) fmt::print("  {}\n", file.lexically_normal().string());
    pipeline::print_rows(report, false);
  }
  return all_passed(report) ? 0 : validation_failed;
}

namespace {

void print_found(const landmarks::FoundLandmarks& found) {
  fmt::print("confidence {:.2f}   (positions in LPS mm)\n", found.confidence);
  for (const auto& [name, p] : found.landmarks.seeds_mm) {
    const auto volume = found.volumes_ml.find(name);
    fmt::print("seed   {:<18} {:8.1f} {:8.1f} {:8.1f}", name, p.x, p.y, p.z);
    fmt::print("{}\n", volume == found.volumes_ml.end() ? "" : fmt::format("   pool of {:.0f} ml", volume->second));
  }
  for (const auto& [name, valve] : found.landmarks.valves)
    fmt::print("valve  {:<18} {:8.1f} {:8.1f} {:8.1f}   normal {:5.2f} {:5.2f} {:5.2f}   diameter {:.0f} mm\n", name,
               valve.center_mm.x, valve.center_mm.y, valve.center_mm.z, valve.normal.x, valve.normal.y, valve.normal.z,
               2 * valve.radius_mm);
  fmt::print("long axis of the left ventricle, base to apex: {:.3f} {:.3f} {:.3f}\n", found.long_axis.x,
             found.long_axis.y, found.long_axis.z);
  for (const auto& warning : found.warnings) fmt::print("warning: {}\n", warning);
  constexpr const char* sentences[] = {"sound: nothing of weight speaks against it",
                                       "uncertain: look at it before you build from it",
                                       "DOUBTFUL: this can hardly be a heart, and build would refuse it"};
  fmt::print("{}\n", sentences[static_cast<std::size_t>(landmarks::trust_in(found.confidence))]);
}

Json json_of(const landmarks::FoundLandmarks& found) {
  Json out = Json::parse(write_landmarks(found.landmarks));
  out["confidence"] = found.confidence;
  out["trust"] = landmarks::trust_names.at(static_cast<std::size_t>(landmarks::trust_in(found.confidence)));
  out["warnings"] = found.warnings;
  out["volumes_ml"] = found.volumes_ml;
  out["long_axis"] = {found.long_axis.x, found.long_axis.y, found.long_axis.z};
  return out;
}

}  // namespace

int landmarks_command(const LandmarksCommand& command) {
  for (const auto& file : {command.output, command.picture})
    if (!file.empty()) check_output(file);
  auto image = adapters::read_ct(command.ct, command.phase);
  anatomy::close_padding(image, anatomy::find_padding(image));
  const auto result = landmarks::search(image);
  if (!command.output.empty()) write_text(command.output, write_landmarks(result.found.landmarks));
  if (!command.picture.empty()) {
    const auto png = pipeline::landmarks_picture(image, result);
    write_text(command.picture, std::string(png.begin(), png.end()));
  }
  if (command.json)
    fmt::print("{}\n", json_of(result.found).dump(1));
  else
    print_found(result.found);
  for (const auto& file : {command.output, command.picture})
    if (!file.empty() && !command.json) fmt::print("{}\n", file);
  return landmarks::trust_in(result.found.confidence) == landmarks::Trust::doubtful ? validation_failed : 0;
}

}  // namespace heartgen::app
