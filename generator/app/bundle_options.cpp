// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "exporters/registry.hpp"
#include "generator/app/options.hpp"

namespace heartgen::app {
namespace {

using command_line::add_command;
using command_line::on_root;

void add_build(Program& p) {
  auto* sub =
      add_command(p.line, "build", "Build a model bundle from a CT or labels",
                  "heartgen build --ct patient.nii.gz --output bundle\n"
                  "With settings of one's own:\n"
                  "  heartgen build recipe.toml --ct patient.nii.gz --output bundle\n"
                  "Labels from elsewhere; what they lack (thin walls, body) is made from the CT:\n"
                  "  heartgen build recipe.toml --ct ct.nii.gz --labels masks --preset totalsegmentator -o bundle\n"
                  "Correct one stage by hand:\n"
                  "  heartgen build recipe.toml --keep-stages stages -o first\n"
                  "  (edit stages/chambers.nii.gz; in the recipe: [replace] chambers = \"stages/chambers.nii.gz\")\n"
                  "  heartgen build recipe.toml -o corrected",
                  [&p] { return build_command(p.build, p.line.comm); });
  sub->add_option("recipe", p.build.recipe, "recipe (.toml; default: every setting's default)");
  sub->add_option("--ct", p.build.ct, "CT volume or DICOM folder, instead of the recipe's");
  sub->add_option("--labels", p.build.labels,
                  "labels from elsewhere: an image, or a folder with one mask per structure; what they lack is made "
                  "from the CT");
  sub->add_option("--preset", p.build.preset, "what their values and names mean: " + preset_names());
  sub->add_option(
      "--atlas", p.build.atlas,
      "fibre atlas (.vtk, .vtu, .msh, .exnode, an image of vectors or tensors, a folder of images), instead of the "
      "recipe's");
  sub->add_option("--atlas-array", p.build.atlas_array,
                  "its array with the fibres (default: the one with a known name: fib..., f0, e1 ...)");
  sub->add_option("--landmarks", p.build.landmarks, "seeds and valve planes (.json), instead of the recipe's");
  sub->add_option("-o,--output", p.build.output, "folder of the bundle")->required();
  sub->add_option("--keep-stages", p.build.keep_stages,
                  "folder for the results of the image stages, to correct and give back in [replace] of the recipe");
  sub->add_flag("--accept-doubtful", p.build.accept_doubtful,
                "go on where what was found in the CT can hardly be a heart, and mark the bundle: it fails (exit 3)");
  sub->add_flag("--force", p.build.force, "replace an existing bundle; refused where its folder holds other files");
  sub->add_flag(
      "--no-cache", p.build.no_cache,
      "neither read nor keep results of stages. OUTPUT.cache holds those of the last finished build and of "
      "unfinished ones after it, about 16 bytes for each voxel of the CT and the meshes; it may be removed at any "
      "time");
  sub->add_flag("--json", p.build.json, "print the result as JSON");
  sub->add_flag("--quiet", p.build.quiet, "no progress");
}

void add_own_mesh_options(CLI::App& sub, std::string& region, std::string& unit) {
  sub.add_option("--region", region, "of a mesh: cell array with its regions (default: region, gmsh:physical ...)");
  sub.add_option("--input-unit", unit, "of a mesh: mm, um, cm or m (default: um for openCARP's files, else mm)");
}

void add_bundle_commands(Program& p) {
  auto* validate = add_command(
      p.line, "validate", "Certify the meshes and fibres of a bundle, or any tetrahedral mesh (exit 3 below bounds)",
      "heartgen validate bundle --reference-labels truth/labels.nii.gz\n"
      "  heartgen validate mine.msh --all",
      on_root(p.line, [&p] { return validate_command(p.validate); }));
  validate->add_option("bundle", p.validate.bundle, std::string("folder of the bundle, or a mesh: ") + mesh_kinds)
      ->required();
  validate->add_option("--reference-labels", p.validate.reference_labels, "known label map: Dice and distances");
  validate->add_option("--reference-fibers", p.validate.reference_fibers,
                       "folder with fiber_x.nrrd, fiber_y.nrrd, fiber_z.nrrd: axis errors");
  add_own_mesh_options(*validate, p.validate.region, p.validate.input_unit);
  validate->add_flag("--all", p.validate.all_rows, "also rows without a bound");
  validate->add_flag("--json", p.validate.json, "print every row as JSON");

  auto* verify =
      add_command(p.line, "verify", "Check every file of a bundle against its manifest", "heartgen verify bundle",
                  on_root(p.line, [&p] { return verify_command(p.bundle, p.json); }));
  verify->add_option("bundle", p.bundle, "folder of the bundle")->required();
  verify->add_flag("--json", p.json, "print the problems as JSON");

  auto* info = add_command(p.line, "info", "Name, meshes, regions and surfaces of a bundle", "heartgen info bundle",
                           on_root(p.line, [&p] { return info_command(p.bundle, p.json); }));
  info->add_option("bundle", p.bundle, "folder of the bundle")->required();
  info->add_flag("--json", p.json, "print as JSON");

  auto* pack = add_command(p.line, "pack", "Pack a bundle into one file", "heartgen pack bundle heart-1.0.0.tar.zst",
                           on_root(p.line, [&p] { return pack_command(p.bundle, p.path, p.json); }));
  pack->add_option("bundle", p.bundle, "folder of the bundle")->required();
  pack->add_option("archive", p.path, "file to write (.tar.zst)")->required();
  pack->add_flag("--json", p.json, "print as JSON");

  auto* unpack =
      add_command(p.line, "unpack", "Unpack and verify a bundle", "heartgen unpack heart-1.0.0.tar.zst bundle",
                  on_root(p.line, [&p] { return unpack_command(p.path, p.bundle, p.json); }));
  unpack->add_option("archive", p.path, "file made by heartgen pack")->required();
  unpack->add_option("folder", p.bundle, "folder to make")->required();
  unpack->add_flag("--json", p.json, "print as JSON");

  auto& c = p.get;
  auto* get = add_command(p.line, "get", "Download a released bundle, check it and unpack it",
                          "heartgen get https://example.org/heart-1.0.0.tar.zst heart\n"
                          "  heartgen get heart-1.0.0.tar.zst heart",
                          on_root(p.line, [&p] { return get_command(p.get); }));
  get->add_option("source", c.source, "address, or file made by heartgen pack")->required();
  get->add_option("folder", c.folder, "folder to make")->required();
  get->add_option("--sha256", c.sha256, "checksum of the file (default: what SOURCE.sha256 says, where there is one)");
  get->add_flag("--json", c.json, "print as JSON");

  auto* report =
      add_command(p.line, "report", "Write the HTML report of a bundle again", "heartgen report bundle report.html",
                  on_root(p.line, [&p] { return report_command(p.bundle, p.path, p.ct, p.json); }));
  report->add_option("bundle", p.bundle, "folder of the bundle")->required();
  report->add_option("html", p.path, "file to write")->required();
  report->add_option("--ct", p.ct, "the CT, to show slices of it");
  report->add_flag("--json", p.json, "print as JSON");
}

void add_export(Program& p) {
  auto* sub = add_command(p.line, "export", "Write a bundle's meshes, or any tetrahedral mesh, for other programs",
                          "heartgen export bundle --to vtk,msh,xdmf --output export",
                          on_root(p.line, [&p] { return export_command(p.exporting); }));
  std::string formats;
  for (const auto& format : exporters::export_formats())
    formats += fmt::format("\n  {:<15} {:>2}  {}", format.name, format.unit, format.description);
  sub->footer("Formats, with the unit their readers expect:" + formats +
              "\nEvery export comes with NAME_README.md: what was written and how to run it; where there are fibres, "
              "with an input that runs.\nExamples:\n  heartgen export bundle --to xdmf,opencarp --output export\n  "
              "heartgen export bundle --to xdmf --only ventricles --output export\n"
              "  heartgen export mine.vtu --to opencarp --output export");
  sub->add_option("bundle", p.exporting.bundle, std::string("folder of the bundle, or a mesh: ") + mesh_kinds)
      ->required();
  sub->add_option("--to", p.exporting.formats, "formats, separated by commas")->required()->delimiter(',');
  sub->add_option("-o,--output", p.exporting.output, "folder to write into")->required();
  sub->add_option("--mesh", p.exporting.mesh, "only this mesh");
  sub->add_option("--only", p.exporting.only,
                  "cut out regions: names separated by commas, or ventricles, atria, walls, blood; where ventricles "
                  "and atria are parted, the new surface is \"base\"")
      ->delimiter(',');
  sub->add_flag("--no-interfaces", p.exporting.no_interfaces,
                "leave out triangles between regions, which some readers refuse");
  sub->add_option("--unit", p.exporting.unit, "mm, um, cm or m (default: what the format's readers expect)");
  add_own_mesh_options(*sub, p.exporting.region, p.exporting.input_unit);
  sub->add_flag("--json", p.exporting.json, "print the files written as JSON");
}

void add_transfer(Program& p) {
  auto& c = p.transfer;
  auto* sub = add_command(p.line, "transfer", "Put a bundle's fibres on another mesh of the same heart",
                          "heartgen transfer bundle mine.vtu mine_with_fibres.vtu",
                          on_root(p.line, [&p] { return transfer_command(p.transfer); }));
  sub->add_option("source", c.source, "folder of a bundle, or a mesh with the vectors fiber and sheet on its points")
      ->required();
  sub->add_option("input", c.input,
                  std::string("mesh in mm and in the bundle's frame; its other arrays stay: ") + mesh_kinds)
      ->required();
  sub->add_option("output", c.output, "mesh to write: .vtu, .vtk or .msh")->required();
  sub->add_option("--reach", c.reach_mm, "how far a node may lie from the source, mm (default 5)");
  sub->add_flag("--partial", c.partial, "leave nodes and cells farther away without fibres (zero), not refuse them");
  sub->add_flag("--json", c.json, "print as JSON");
}

void add_place(Program& p) {
  auto& c = p.place;
  auto* sub = add_command(p.line, "place", "Put a heart into another patient's torso: one label map to build from",
                          "heartgen place heart.nii.gz torso.nii.gz placed.nii.gz --scale --pose pose.json\n"
                          "  heartgen build recipe.toml --labels placed.nii.gz --output bundle",
                          on_root(p.line, [&p] { return place_command(p.place); }));
  sub->add_option("heart", c.heart, "label map with the heart, with the tags of a bundle")->required();
  sub->add_option("torso", c.torso, "label map with the torso, with the tags of a bundle")->required();
  sub->add_option("output", c.output, "label map to write: the heart's grid, continued")->required();
  sub->add_option("--heart-landmarks", c.heart_landmarks, "valves and apex of the heart (.json)");
  sub->add_option("--torso-landmarks", c.torso_landmarks, "valves and apex in the torso's image (.json)");
  sub->add_flag("--scale", c.with_scale, "let the torso's size follow the heart's");
  sub->add_option("--pose", c.pose, "file for the pose (.json)");
  sub->add_flag("--json", c.json, "print the pose as JSON");
}

}  // namespace

void add_bundle_options(Program& p) {
  add_build(p);
  add_bundle_commands(p);
  add_export(p);
  add_transfer(p);
  add_place(p);
}

}  // namespace heartgen::app
