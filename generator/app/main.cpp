// The command line: parses, calls one function per subcommand, turns errors into messages and exit codes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <clocale>
#include <functional>

#include "exporters/registry.hpp"
#include "generator/app/commands.hpp"
#include "generator/app/versions.hpp"
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
  MeshCommand mesh{};
  PhantomCommand phantom{};
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

void add_build(Program& p) {
  auto* sub = subcommand(p, "build", "Build a model bundle from a recipe and a CT",
                         "heartgen build recipe.toml --ct patient.nii.gz --output bundle",
                         [&p] { return build_command(p.build, p.comm); });
  sub->add_option("recipe", p.build.recipe, "recipe (.toml)")->required();
  sub->add_option("--ct", p.build.ct, "CT volume or DICOM folder, instead of the recipe's");
  sub->add_option("--labels", p.build.labels, "label map that replaces the segmentation");
  sub->add_option("--atlas", p.build.atlas, "fibre atlas (.vtk, .vtu), instead of the recipe's");
  sub->add_option("--landmarks", p.build.landmarks, "seeds and valve planes (.json), instead of the recipe's");
  sub->add_option("-o,--output", p.build.output, "folder of the bundle")->required();
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

int run(Program& p) {
  if (p.threads < 0) throw UserError("must be positive", "--threads", "give the number of threads");
  if (p.threads > 0) parallel::set_thread_count(p.threads);
  if (!p.size.empty()) p.phantom.size = {p.size[0], p.size[1], p.size[2]};
  if (!p.spacing.empty()) p.phantom.spacing_mm = {p.spacing[0], p.spacing[1], p.spacing[2]};
  return p.chosen();
}

/// CLI11 has exit codes of its own; ours are 0 for --help and 2 for a mistake.
int parse_failed(Program& p, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return p.comm.is_root() ? p.app.exit(error) : 0;
  if (p.comm.is_root()) fmt::print(stderr, "heartgen: {} (heartgen --help shows the commands)\n", error.what());
  return exit_user;
}

}  // namespace

int main(int argc, char** argv) {
  std::setlocale(LC_ALL, "C");
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
  add_tools(p);
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
