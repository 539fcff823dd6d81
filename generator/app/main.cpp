// The command line: parses, calls one function per subcommand, turns errors into messages and exit codes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <clocale>
#include <cstdio>
#include <functional>

#include "exporters/registry.hpp"
#include "generator/app/accuracy_command.hpp"
#include "generator/app/bench_command.hpp"
#include "generator/app/commands.hpp"
#include "generator/app/contours_command.hpp"
#include "generator/app/fiber_accuracy_command.hpp"
#include "generator/app/improve_command.hpp"
#include "generator/app/place_command.hpp"
#include "generator/app/segment_command.hpp"
#include "generator/app/slice_command.hpp"
#include "generator/app/study_command.hpp"
#include "generator/app/transfer_command.hpp"
#include "generator/app/versions.hpp"
#include "generator/labels/presets.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"

namespace {

using namespace heart;
using namespace heart::app;

constexpr int exit_defect = 1;
constexpr int exit_user = 2;

struct Program {
  CLI::App app{"heartgen: simulation-ready heart models from CT"};
  parallel::Comm comm;
  std::function<int()> chosen{};  // what the parsed subcommand does
  int threads = 0;

  BuildCommand build{};
  ValidateCommand validate{};
  ExportCommand exporting{};
  FilterCommand filter{};
  SegmentCommand segment{};
  MeshCommand mesh{};
  ImproveCommand improve{};
  TransferCommand transfer{};
  PlaceCommand place{};
  SliceCommand slice{};
  PhantomCommand phantom{};
  ContoursCommand contours{};
  AccuracyCommand accuracy{};
  FiberAccuracyCommand fiber_accuracy{};
  BenchCommand bench{};
  StudyCommand study{};
  std::string bundle{}, path{}, ct{};
  bool json = false;
  std::vector<std::int64_t> size{};
  std::vector<double> spacing{};
};

CLI::App* subcommand(Program& p, const std::string& name, const std::string& what, const std::string& example,
                     std::function<int()> action) {
  auto* sub = p.app.add_subcommand(name, what);
  sub->footer("Example:\n  " + example);
  sub->callback([&p, action = std::move(action)] { p.chosen = action; });
  return sub;
}

/// All ranks work, or the root alone while the others wait for its outcome.
std::function<int()> on_root(Program& p, std::function<int()> action) {
  return [&p, action = std::move(action)] { return parallel::run_on_root(p.comm, action); };
}

std::string preset_names() {
  std::string names;
  for (const auto& preset : labels::label_presets()) names += (names.empty() ? "" : ", ") + std::string(preset.name);
  return names;
}

void add_build(Program& p) {
  auto* sub =
      subcommand(p, "build", "Build a model bundle from a recipe and a CT",
                 "heartgen build recipe.toml --ct patient.nii.gz --output bundle\n"
                 "Labels from elsewhere; what they lack (thin walls, body) is made from the CT:\n"
                 "  heartgen build recipe.toml --ct ct.nii.gz --labels masks --preset totalsegmentator -o bundle\n"
                 "Correct one stage by hand:\n"
                 "  heartgen build recipe.toml --keep-stages stages -o first\n"
                 "  (edit stages/chambers.nii.gz; in the recipe: [replace] chambers = \"stages/chambers.nii.gz\")\n"
                 "  heartgen build recipe.toml -o corrected",
                 [&p] { return build_command(p.build, p.comm); });
  sub->add_option("recipe", p.build.recipe, "recipe (.toml)")->required();
  sub->add_option("--ct", p.build.ct, "CT volume or DICOM folder, instead of the recipe's");
  sub->add_option("--labels", p.build.labels,
                  "labels from elsewhere: an image, or a folder with one mask per structure; what they lack is made "
                  "from the CT");
  sub->add_option("--preset", p.build.preset, "what their values and names mean: " + preset_names());
  sub->add_option("--atlas", p.build.atlas, "fibre atlas (.vtk, .vtu, .exnode), instead of the recipe's");
  sub->add_option("--landmarks", p.build.landmarks, "seeds and valve planes (.json), instead of the recipe's");
  sub->add_option("-o,--output", p.build.output, "folder of the bundle")->required();
  sub->add_option("--keep-stages", p.build.keep_stages,
                  "folder for the results of the image stages, to correct and give back in [replace] of the recipe");
  sub->add_flag("--force", p.build.force, "replace an existing bundle");
  sub->add_flag("--no-cache", p.build.no_cache, "neither read nor keep results of stages (OUTPUT.cache)");
  sub->add_flag("--json", p.build.json, "print the result as JSON");
  sub->add_flag("--quiet", p.build.quiet, "no progress");
}

void add_bundle_commands(Program& p) {
  auto* validate = subcommand(p, "validate", "Certify the meshes and fibres of a bundle (exit 3 below its bounds)",
                              "heartgen validate bundle --reference-labels truth/labels.nii.gz",
                              on_root(p, [&p] { return validate_command(p.validate); }));
  validate->add_option("bundle", p.validate.bundle, "folder of the bundle")->required();
  validate->add_option("--reference-labels", p.validate.reference_labels, "known label map: Dice and distances");
  validate->add_option("--reference-fibers", p.validate.reference_fibers,
                       "folder with fiber_x.nrrd, fiber_y.nrrd, fiber_z.nrrd: axis errors");
  validate->add_flag("--all", p.validate.all_rows, "also rows without a bound");
  validate->add_flag("--json", p.validate.json, "print every row as JSON");

  auto* verify = subcommand(p, "verify", "Check every file of a bundle against its manifest", "heartgen verify bundle",
                            on_root(p, [&p] { return verify_command(p.bundle, p.json); }));
  verify->add_option("bundle", p.bundle, "folder of the bundle")->required();
  verify->add_flag("--json", p.json, "print the problems as JSON");

  auto* info = subcommand(p, "info", "Name, meshes, regions and surfaces of a bundle", "heartgen info bundle",
                          on_root(p, [&p] { return info_command(p.bundle, p.json); }));
  info->add_option("bundle", p.bundle, "folder of the bundle")->required();
  info->add_flag("--json", p.json, "print as JSON");

  auto* pack = subcommand(p, "pack", "Pack a bundle into one file", "heartgen pack bundle heart-1.0.0.tar.zst",
                          on_root(p, [&p] { return pack_command(p.bundle, p.path); }));
  pack->add_option("bundle", p.bundle, "folder of the bundle")->required();
  pack->add_option("archive", p.path, "file to write (.tar.zst)")->required();

  auto* unpack = subcommand(p, "unpack", "Unpack and verify a bundle", "heartgen unpack heart-1.0.0.tar.zst bundle",
                            on_root(p, [&p] { return unpack_command(p.path, p.bundle); }));
  unpack->add_option("archive", p.path, "file made by heartgen pack")->required();
  unpack->add_option("folder", p.bundle, "folder to make")->required();

  auto* report =
      subcommand(p, "report", "Write the HTML report of a bundle again", "heartgen report bundle report.html",
                 on_root(p, [&p] { return report_command(p.bundle, p.path, p.ct); }));
  report->add_option("bundle", p.bundle, "folder of the bundle")->required();
  report->add_option("html", p.path, "file to write")->required();
  report->add_option("--ct", p.ct, "the CT, to show slices of it");
}

void add_export(Program& p) {
  auto* sub = subcommand(p, "export", "Write a bundle's meshes for other programs",
                         "heartgen export bundle --to vtk,msh,xdmf --output export",
                         on_root(p, [&p] { return export_command(p.exporting); }));
  std::string formats;
  for (const auto& format : exporters::export_formats())
    formats += fmt::format("\n  {:<12} {}", format.name, format.description);
  sub->footer("Formats:" + formats + "\nExample:\n  heartgen export bundle --to vtk,msh,xdmf --output export");
  sub->add_option("bundle", p.exporting.bundle, "folder of the bundle")->required();
  sub->add_option("--to", p.exporting.formats, "formats, separated by commas")->required()->delimiter(',');
  sub->add_option("-o,--output", p.exporting.output, "folder to write into")->required();
  sub->add_option("--mesh", p.exporting.mesh, "only this mesh");
  sub->add_option("--unit", p.exporting.unit, "mm, um, cm or m (default: what the format's readers expect)");
  sub->add_flag("--json", p.exporting.json, "print the files written as JSON");
}

void add_segment(Program& p) {
  auto* segment = subcommand(p, "segment", "Run a recipe's tree of two-phase splits on an image, 2D or 3D",
                             "heartgen segment recipe.toml slice.nrrd leaves.nii.gz",
                             [&p] { return segment_command(p.segment, p.comm); });
  segment->add_option("recipe", p.segment.recipe, "recipe (.toml): its [denoise] and [[segmentation]]")->required();
  segment->add_option("image", p.segment.image, "image of any grey values")->required();
  segment->add_option("output", p.segment.output, "label image to write, one value per leaf of the tree")->required();
  segment->add_flag("--json", p.segment.json, "print steps and leaves as JSON");
}

void add_tools(Program& p) {
  auto* filter = subcommand(p, "filter", "Apply a PDE filter to an image",
                            "heartgen filter perona_malik in.nii.gz out.nii.gz --iterations 10",
                            [&p] { return filter_command(p.filter, p.comm); });
  filter->footer(filter_help() + "Example:\n  heartgen filter heat in.nii.gz out.nii.gz --iterations 10");
  filter->add_option("name", p.filter.name, "filter")->required();
  filter->add_option("input", p.filter.input, "image")->required();
  filter->add_option("output", p.filter.output, "image to write")->required();
  filter->add_option("--threads", p.threads, "threads per process (default: all)");
  filter->fallthrough(false);
  filter->allow_extras();  // the filter's own parameters, checked against its table
  filter->callback([&p, filter] {
    p.filter.parameters = filter->remaining();
    p.chosen = [&p] { return filter_command(p.filter, p.comm); };
  });

  auto* mesh =
      subcommand(p, "mesh", "Mesh a label map (.vtu for the cells, .vtp beside it for the labelled faces)",
                 "heartgen mesh labels.nii.gz heart.vtu --edge 1.5", on_root(p, [&p] { return mesh_command(p.mesh); }));
  mesh->add_option("labels", p.mesh.labels, "label map with the tags of a bundle's manifest")->required();
  mesh->add_option("output", p.mesh.output, "mesh to write (.vtu)")->required();
  mesh->add_option("--edge", p.mesh.edge_mm, "edge length in the walls of the heart, mm");
  mesh->add_option("--layers", p.mesh.wall_layers, "cells across thin walls, 0 to 4 (default: the recipe's)");
  mesh->add_option("--size-field", p.mesh.size_field, "image of edge lengths in mm, 0 where nothing is wished");
  mesh->add_option("--backend", p.mesh.backend, "lattice, distmesh, cgal or tetgen (default: the recipe's)");
  mesh->add_flag("--json", p.mesh.json, "print the certificate as JSON");

  auto* landmarks = subcommand(p, "landmarks", "Find seeds, valve planes and the long axis in a contrast CT",
                               "heartgen landmarks patient.nii.gz --output landmarks.json",
                               on_root(p, [&p] { return landmarks_command(p.ct, p.path, p.json); }));
  landmarks->add_option("ct", p.ct, "CT volume or DICOM folder")->required();
  landmarks->add_option("-o,--output", p.path, "landmarks file to write, for input.landmarks of a recipe");
  landmarks->add_flag("--json", p.json, "print as JSON");

  auto* phantom = subcommand(p, "phantom", "Write the analytic phantom: CT, truth, landmarks, atlas and recipe",
                             "heartgen phantom demo/phantom --size 256,256,160 --spacing 1.4,1.4,1.9",
                             on_root(p, [&p] { return phantom_command(p.phantom); }));
  phantom->add_option("folder", p.phantom.folder, "folder to write into")->required();
  phantom->add_option("--size", p.size, "voxels NX,NY,NZ (default 256,256,160)")->delimiter(',')->expected(3);
  phantom->add_option("--spacing", p.spacing, "mm SX,SY,SZ (default 1.4,1.4,1.9)")->delimiter(',')->expected(3);
  phantom->add_option("--variant", p.phantom.variant, "another patient: pose, size, walls, contrast (default 0)");
  phantom->add_option("--noise", p.phantom.noise_hu, "standard deviation of the noise, HU (default 22)");
}

void add_slice(Program& p) {
  auto* sub = subcommand(p, "slice",
                         "Mesh a transverse slice with four subdomains: myocardium, heart cavities, lungs, torso "
                         "(exit 3 when an angle is outside [28, 120] degrees)",
                         "heartgen slice bundle slice.vtu --z -40 --edge 0.5",
                         on_root(p, [&p] { return slice_command(p.slice); }));
  sub->add_option("labels", p.slice.input, "label map, or folder of a bundle")->required();
  sub->add_option("output", p.slice.output,
                  "mesh to write: .vtu (labelled edges in a .vtp beside it) or .msh (gmsh 2.2)")
      ->required();
  sub->add_option("--index", p.slice.index, "slice, counted from 0 along the third axis of the label map");
  sub->add_option("--z", p.slice.z_mm, "height of the slice instead, LPS z in mm");
  sub->add_option("--edge", p.slice.edge_mm,
                  "edge length in the myocardium, mm; half of it at interfaces (default 0.5)");
  sub->add_option("--torso-edge", p.slice.torso_edge_mm, "edge length far from the heart, mm (default 6)");
  sub->add_option("--growth", p.slice.growth, "increase of the edge length per mm from the myocardium (default 0.12)");
  sub->add_flag("--json", p.slice.json, "print as JSON");
}

void add_place(Program& p) {
  auto& c = p.place;
  auto* sub = subcommand(p, "place", "Put a heart into another patient's torso: one label map to build from",
                         "heartgen place heart.nii.gz torso.nii.gz placed.nii.gz --scale --pose pose.json\n"
                         "  heartgen build recipe.toml --labels placed.nii.gz --output bundle",
                         on_root(p, [&p] { return place_command(p.place); }));
  sub->add_option("heart", c.heart, "label map with the heart, with the tags of a bundle")->required();
  sub->add_option("torso", c.torso, "label map with the torso, with the tags of a bundle")->required();
  sub->add_option("output", c.output, "label map to write: the heart's grid, continued")->required();
  sub->add_option("--heart-landmarks", c.heart_landmarks, "valves and apex of the heart (.json)");
  sub->add_option("--torso-landmarks", c.torso_landmarks, "valves and apex in the torso's image (.json)");
  sub->add_flag("--scale", c.with_scale, "let the torso's size follow the heart's");
  sub->add_option("--pose", c.pose, "file for the pose (.json)");
  sub->add_flag("--json", c.json, "print the pose as JSON");
}

void add_improve(Program& p) {
  auto& c = p.improve;
  auto* sub = subcommand(p, "improve", "Raise the worst angles of any tetrahedral mesh; regions and surfaces stay",
                         "heartgen improve mine.msh better.msh --goal-deg 20\n"
                         "  heartgen improve heart.vtu better.vtu --slide 0.05 --drop GlobalNodeID",
                         on_root(p, [&p] { return improve_command(p.improve); }));
  sub->add_option("input", c.input, "mesh: .vtu, .vtk or .msh (2.2 or 4.1 as text)")->required();
  sub->add_option("output", c.output, "mesh to write: .vtu, .vtk or .msh")->required();
  sub->add_option("--goal-deg", c.settings.goal_deg, "dihedral angles to reach, 1 to 40 (default 20)");
  sub->add_option("--slide", c.settings.slide_mm,
                  "how far surfaces may come off the given ones, in the mesh's unit (default 0: unchanged)");
  sub->add_option("--feature-deg", c.settings.feature_deg,
                  "with --slide: edges where a surface turns by more stay (default 30)");
  sub->add_option("--budget", c.settings.budget, "attempts on bad cells at most (default 10 000 000)");
  sub->add_option("--region", c.region, "cell array with the regions (default: region, gmsh:physical, material ...)");
  sub->add_option("--drop", c.drop, "arrays to leave out, separated by commas")->delimiter(',');
  sub->add_flag("--json", c.json, "print as JSON");
}

void add_transfer(Program& p) {
  auto& c = p.transfer;
  auto* sub = subcommand(p, "transfer", "Put a bundle's fibres on another mesh of the same heart",
                         "heartgen transfer bundle mine.vtu mine_with_fibres.vtu",
                         on_root(p, [&p] { return transfer_command(p.transfer); }));
  sub->add_option("source", c.source,
                  "folder of a bundle, or a mesh (.vtu, .vtk) with the vectors fiber and sheet on its points")
      ->required();
  sub->add_option("input", c.input, "mesh in mm and in the bundle's frame, .vtu or .vtk; its other arrays stay")
      ->required();
  sub->add_option("output", c.output, "mesh to write, .vtu or .vtk")->required();
  sub->add_option("--reach", c.reach_mm, "how far a node may lie from the source, mm (default 5)");
  sub->add_flag("--partial", c.partial, "leave nodes and cells farther away without fibres (zero), not refuse them");
  sub->add_flag("--json", c.json, "print as JSON");
}

void add_accuracy(Program& p) {
  auto* sub = subcommand(p, "accuracy",
                         "Segment phantoms without a landmark and compare with what they are (exit 3 "
                         "below the bounds)",
                         "heartgen accuracy --variants 0-14 --noise 10,22,40 --size 512,512,199 --spacing 0.5,0.5,1.2",
                         [&p] { return accuracy_command(p.accuracy, p.comm); });
  sub->add_option("--variants", p.accuracy.variants, "numbers and ranges (default 0-14)");
  sub->add_option("--of", p.accuracy.of, "chambers (default), or one step alone: walls, carotid, trachea");
  sub->add_option("--noise", p.accuracy.noise_hu, "standard deviations of the noise, HU (default 22)")->delimiter(',');
  sub->add_option("--size", p.size, "voxels NX,NY,NZ (default 256,256,160)")->delimiter(',')->expected(3);
  sub->add_option("--spacing", p.spacing, "mm SX,SY,SZ (default 1.4,1.4,1.9)")->delimiter(',')->expected(3);
  sub->add_option("--keep", p.accuracy.keep, "folder for each phantom's CT, truth, label map and row");
  sub->add_flag("--resume", p.accuracy.resume, "take the rows that an earlier run left in --keep");
  sub->add_option("--plot", p.accuracy.plot, "SVG to write: least Dice over the right heart's contrast");
  sub->add_flag("--json", p.accuracy.json, "print every number as JSON");
}

void add_fiber_accuracy(Program& p) {
  auto& f = p.fiber_accuracy;
  auto* sub = subcommand(p, "fiber-accuracy", "Carry an atlas to phantoms of known fibres and compare",
                         "heartgen fiber-accuracy --cases 1,2,thick --atlas stand-in",
                         on_root(p, [&p] { return fiber_accuracy_command(p.fiber_accuracy); }));
  sub->add_option("--cases", f.cases, "variants, thick, dilated, cut, tilted (default 1-4 and all of these)")
      ->delimiter(',');
  sub->add_option("--atlas", f.atlas, "phantom, stand-in, or a file (default phantom: variant 0)");
  sub->add_option("--methods", f.methods, "local_angles, coordinates, jacobian (default all)")->delimiter(',');
  sub->add_option("--fields", f.fields, "uniform, regional (default uniform)")->delimiter(',');
  sub->add_option(
         "--atlas-frames", f.atlas_frames,
         "plain, turned, scaled, axes, metres, all, mirrored: the atlas's file in other frames (default plain)")
      ->delimiter(',');
  sub->add_option("--label-spacing", f.spacing_mm, "of the exact labels, mm (default 1.2)");
  sub->add_option("--mesh-edge", f.mesh_edge_mm, "also at nodes and cells of a mesh with this edge, mm");
  sub->add_flag("--json", f.json, "print as JSON");
}

void add_study(Program& p) {
  auto* sub = subcommand(p, "study", "Repeat the thesis's analysis of the Chan-Vese model: tables, curves, pictures",
                         "", on_root(p, [&p] { return study_command(p.study); }));
  sub->footer(study_help() + "Example:\n  heartgen study lengths phases --output study");
  sub->add_option("name", p.study.names, "studies (default: all)");
  sub->add_option("-o,--output", p.study.output, "folder for tables, plots, pictures and index.html");
  sub->add_flag("--quick", p.study.quick, "small images and few iterations");
  sub->add_flag("--json", p.study.json, "print tables and statements as JSON");
}

void add_bench(Program& p) {
  auto* sub = subcommand(p, "bench", "Measure the speed of the image stages", "", [&p] {
    if (p.threads > 0) p.bench.threads = p.threads;
    return bench_command(p.bench, p.comm);
  });
  sub->footer(bench_help() +
              "Examples:\n  heartgen bench sweep\n  mpirun -n 2 heartgen bench ranks\n  heartgen bench mesh\n"
              "  heartgen bench mesh-torso --labels bundle/images/labels.nii.gz");
  sub->add_option("names", p.bench.names, "benchmarks (default: all)");
  sub->add_option("--size", p.size, "of the phantom, voxels NX,NY,NZ (default 512,512,199)")
      ->delimiter(',')
      ->expected(3);
  sub->add_option("--spacing", p.spacing, "mm SX,SY,SZ (default 0.5,0.5,1.2)")->delimiter(',')->expected(3);
  sub->add_option("--repeats", p.bench.repeats, "of short measurements, of which the median counts (default 7)")
      ->check(CLI::PositiveNumber);
  sub->add_option("--labels", p.bench.labels, "label map for mesh-torso, -vessels and -slice (default: a phantom's)");
  sub->add_option("--variant", p.bench.variant, "of the phantom that they are made from otherwise (default 0)")
      ->check(CLI::NonNegativeNumber);
  sub->add_flag("--processor-time", p.bench.processor_time,
                "count processor time over threads, where the machine does other things meanwhile");
  sub->add_flag("--json", p.bench.json, "print as JSON");
}

void add_contours(Program& p) {
  auto& c = p.contours;
  auto* sub = subcommand(p, "contours", "Snakes, active contours and subjective surfaces on an image, from a seed",
                         "heartgen contours geodesic in.nii.gz inside.nii.gz --seed 12,-40,90 --balloon 1\n"
                         "  heartgen contours broken-circle --output pictures",
                         [&p] { return contours_command(p.contours, p.comm); });
  sub->add_option("method", c.method, "snake, geometric, geodesic, subjective or broken-circle")->required();
  sub->add_option("input", c.input, "image, 2D or 3D (snake: 2D)");
  sub->add_option("mask", c.output, "image to write: 1 inside the contour");
  sub->add_option("--seed", c.seeds, "point inside the object, x,y,z in LPS mm; several in a row")->delimiter(',');
  sub->add_option("--radius", c.radius_mm, "of the start around the seeds, mm (default 5)");
  sub->add_option("--smoothing", c.smoothing_mm, "sigma of the Gaussian before the gradient, mm (default 1)");
  sub->add_option("--edge", c.edge_per_mm, "slope of an edge, grey values per mm (default: from the image)");
  sub->add_option("--curvature", c.curvature_mm, "weight of the curvature, mm (default 1; not for snakes)");
  sub->add_option("--attraction", c.attraction_mm, "pull of the edges (default: geodesic as --curvature, snake 4)");
  sub->add_option("--balloon", c.balloon, "outward speed where there is no edge, negative: inwards (default 0)");
  sub->add_option("--tension", c.tension_mm, "snake: against length (default 0.3)");
  sub->add_option("--rigidity", c.rigidity_mm3, "snake: against bending (default 1)");
  sub->add_option("--share", c.share, "subjective: level of the border, of the height at the seeds (default 0.5)");
  sub->add_option("--iterations", c.iterations, "steps at most (default 5000, 20000 for snakes and subjective)");
  sub->add_option("--surface", c.surface, "also write the level set function");
  sub->add_option("-o,--output", c.folder, "broken-circle: folder for the pictures");
  sub->add_option("--noise", c.noise, "broken-circle: standard deviation of its noise, of 255 (default 0)");
  sub->add_flag("--json", c.json, "print as JSON");
}

int run(Program& p) {
  if (p.threads < 0) throw UserError("must be positive", "--threads", "give the number of threads");
  if (p.threads > 0) parallel::set_thread_count(p.threads);
  if (!p.size.empty()) p.phantom.size = p.accuracy.size = p.bench.size = {p.size[0], p.size[1], p.size[2]};
  if (!p.spacing.empty())
    p.phantom.spacing_mm = p.accuracy.spacing_mm = p.bench.spacing_mm = {p.spacing[0], p.spacing[1], p.spacing[2]};
  return p.chosen();
}

/// CLI11 has exit codes of its own; ours are 0 for --help and 2 for a mistake.
int parse_failed(Program& p, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return p.comm.is_root() ? p.app.exit(error) : 0;
  if (p.comm.is_root()) fmt::print(stderr, "heartgen: {} (heartgen --help shows the commands)\n", error.what());
  return exit_user;
}

/// Mistakes and defects become messages and exit codes.
int command_line(int argc, char** argv) {
  const parallel::Environment environment(&argc, &argv);
  Program p;
  p.comm = parallel::world();
  p.app.set_version_flag("--version", program_version());
  p.app.require_subcommand(1);
  p.app.add_option("--threads", p.threads, "threads per process (default: all)");
  p.app.fallthrough();
  add_build(p);
  add_bundle_commands(p);
  add_export(p);
  add_segment(p);
  add_tools(p);
  add_contours(p);
  add_slice(p);
  add_improve(p);
  add_transfer(p);
  add_place(p);
  add_accuracy(p);
  add_fiber_accuracy(p);
  add_bench(p);
  add_study(p);
  try {
    p.app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return parse_failed(p, error);
  }
  try {
    return run(p);
  } catch (const UserError& error) {
    if (p.comm.is_root()) fmt::print(stderr, "heartgen: {}\n", error.what());
    return exit_user;
  } catch (const std::exception& error) {
    if (p.comm.is_root()) fmt::print(stderr, "heartgen: internal error: {}\n", error.what());
    return exit_defect;
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::setlocale(LC_ALL, "C");
  try {
    return command_line(argc, argv);
  } catch (...) {  // what is thrown before a command runs or while its message is printed; nothing may leave main
    std::fputs("heartgen: internal error\n", stderr);
    return exit_defect;
  }
}
