// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/options.hpp"
#include "generator/command_line/heart_options.hpp"

namespace heartgen::app {
namespace {

using command_line::add_command;
using command_line::on_root;

void add_segment(Program& p) {
  auto* segment = add_command(p.line, "segment", "Run a recipe's tree of two-phase splits on an image, 2D or 3D",
                              "heartgen segment recipe.toml slice.nrrd leaves.nii.gz",
                              [&p] { return segment_command(p.segment, p.line.comm); });
  segment->add_option("recipe", p.segment.recipe, "recipe (.toml): its [denoise] and [[segmentation]]")->required();
  segment->add_option("image", p.segment.image, "image of any grey values")->required();
  segment->add_option("output", p.segment.output, "label image to write, one value per leaf of the tree")->required();
  segment->add_flag("--json", p.segment.json, "print steps and leaves as JSON");
}

void add_tools(Program& p) {
  auto* filter = add_command(p.line, "filter", "Apply a PDE filter to an image",
                             "heartgen filter perona_malik in.nii.gz out.nii.gz --iterations 10",
                             [&p] { return filter_command(p.filter, p.line.comm); });
  filter->footer(filter_help() + "Example:\n  heartgen filter heat in.nii.gz out.nii.gz --iterations 10");
  filter->add_option("name", p.filter.name, "filter")->required();
  filter->add_option("input", p.filter.input, "image")->required();
  filter->add_option("output", p.filter.output, "image to write")->required();
  add_machine_options(p.line, *filter);
  filter->fallthrough(false);
  filter->allow_extras();  // the filter's own parameters, checked against its table
  filter->callback([&p, filter] {
    p.filter.parameters = filter->remaining();
    p.line.chosen = [&p] { return filter_command(p.filter, p.line.comm); };
  });

  auto* mesh =
      add_command(p.line, "mesh", "Mesh a label map (.vtu with a .vtp of the labelled faces beside it, or .msh, .vtk)",
                  "heartgen mesh labels.nii.gz heart.vtu --edge 1.5\n"
                  "  heartgen mesh heartchambers.nii.gz heart.vtu --preset totalsegmentator_heart",
                  on_root(p.line, [&p] { return mesh_command(p.mesh); }));
  mesh->add_option("labels", p.mesh.labels, "label map, or a folder with one mask per structure")->required();
  mesh->add_option("output", p.mesh.output, "mesh to write (.vtu, .msh or .vtk)")->required();
  mesh->add_option("--preset", p.mesh.preset, "what its values and names mean (default auto): " + preset_names());
  mesh->add_option("--names", p.mesh.label_names, "table of value and name of every structure (.csv or .json)");
  mesh->add_option("--edge", p.mesh.edge_mm, "edge length in the walls of the heart, mm");
  mesh->add_option("--layers", p.mesh.wall_layers, "cells across thin walls, 0 to 4 (default: the recipe's)");
  mesh->add_option("--size-field", p.mesh.size_field, "image of edge lengths in mm, 0 where nothing is wished");
  mesh->add_option("--backend", p.mesh.backend, "lattice, distmesh, cgal or tetgen (default: the recipe's)");
  mesh->add_flag("--walls", p.mesh.walls,
                 "the walls of the heart alone, as five regions with rounded rims: half the time, no blood");
  mesh->add_flag("--json", p.mesh.json, "print the certificate as JSON");

  auto* landmarks = add_command(
      p.line, "landmarks", "Find seeds, valve planes and the long axis in a contrast CT (exit 3 for a doubtful heart)",
      "heartgen landmarks patient.nii.gz --output landmarks.json",
      on_root(p.line, [&p] { return landmarks_command(p.landmarks); }));
  landmarks->add_option("ct", p.landmarks.ct, "CT volume or DICOM folder")->required();
  landmarks->add_option("--phase", p.landmarks.phase, "which volume of a CT with several phases, from 1");
  landmarks->add_option("-o,--output", p.landmarks.output, "landmarks file to write, for build --landmarks");
  landmarks->add_option("--picture", p.landmarks.picture, "picture of what was found to write (.png)");
  landmarks->add_flag("--json", p.landmarks.json, "print as JSON");

  auto* phantom = add_command(p.line, "phantom", "Write the analytic phantom: CT, truth, landmarks, atlas and recipe",
                              "heartgen phantom demo/phantom --size 256,256,160 --spacing 1.4,1.4,1.9",
                              on_root(p.line, [&p] { return phantom_command(p.phantom); }));
  phantom->add_option("folder", p.phantom.folder, "folder to write into")->required();
  command_line::add_grid_options(*phantom, p.phantom.size, p.phantom.spacing_mm);
  phantom->add_option("--variant", p.phantom.variant, "another patient: pose, size, walls, contrast (default 0)");
  phantom->add_option("--noise", p.phantom.noise_hu, "standard deviation of the noise, HU (default 22)");
  command_line::add_heart_options(*phantom, p.phantom.heart);
  command_line::add_grey_options(*phantom, p.phantom.grey);
  phantom->add_flag("--json", p.phantom.json, "print as JSON");
}

void add_contours(Program& p) {
  auto& c = p.contours;
  auto* sub =
      add_command(p.line, "contours", "Snakes, active contours and subjective surfaces on an image, from a seed",
                  "heartgen contours geodesic in.nii.gz inside.nii.gz --seed 12,-40,90 --balloon 1",
                  [&p] { return contours_command(p.contours, p.line.comm); });
  sub->add_option("method", c.method, "snake, geometric, geodesic or subjective")->required();
  sub->add_option("input", c.input, "image, 2D or 3D (snake: 2D)")->required();
  sub->add_option("mask", c.output, "image to write: 1 inside the contour")->required();
  sub->add_option("--seed", c.seeds, "point inside the object, x,y,z in LPS mm; several in a row")->delimiter(',');
  sub->add_option("--radius", c.start_radius_mm, "of the start around the seeds, mm (default 5)");
  sub->add_option("--smoothing", c.smoothing_mm, "sigma of the Gaussian before the gradient, mm (default 1)");
  sub->add_option("--edge", c.edge_per_mm, "slope of an edge, grey values per mm (default: from the image)");
  sub->add_option("--curvature", c.curvature_mm, "weight of the curvature, mm (default 1; not for snakes)");
  sub->add_option("--attraction", c.attraction_mm, "pull of the edges (default: geodesic as --curvature, snake 4)");
  sub->add_option("--balloon", c.balloon, "outward speed where there is no edge, negative: inwards (default 0)");
  sub->add_option("--tension", c.tension_mm, "snake: against length (default 0.3)");
  sub->add_option("--rigidity", c.rigidity_mm3, "snake: against bending (default 1)");
  sub->add_option("--share", c.share, "subjective: level of the border, of the height at the seeds (default 0.5)");
  sub->add_option("--iterations", c.iterations, "steps at most (default 5000, 20000 for snakes and subjective)")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--surface", c.surface, "also write the level set function");
  sub->add_flag("--json", c.json, "print as JSON");
}

void add_slice(Program& p) {
  auto* sub = add_command(p.line, "slice",
                          "Mesh a transverse slice with four subdomains: myocardium, heart cavities, lungs, torso "
                          "(exit 3 when an angle is outside [28, 120] degrees)",
                          "heartgen slice bundle slice.vtu --z -40 --edge 0.5",
                          on_root(p.line, [&p] { return slice_command(p.slice); }));
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

void add_improve(Program& p) {
  auto& c = p.improve;
  auto* sub =
      add_command(p.line, "improve", "Raise the worst angles of any tetrahedral mesh; regions and surfaces stay",
                  "heartgen improve mine.msh better.msh --goal-deg 20\n"
                  "  heartgen improve heart.vtu better.vtu --slide 0.05",
                  on_root(p.line, [&p] { return improve_command(p.improve); }));
  sub->add_option("input", c.input, std::string("mesh: ") + mesh_kinds)->required();
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

void add_paint(Program& p) {
  auto& c = p.paint;
  auto* sub = add_command(p.line, "paint", "Paint regions of your own onto the cells of any tetrahedral mesh",
                          "heartgen paint mine.vtu scarred.vtu --regions lge.nii.gz:grey_zone,core\n"
                          "  heartgen paint mine.msh ablated.msh --regions line.stl:ablation --only la_wall",
                          on_root(p.line, [&p] { return paint_command(p.paint); }));
  sub->add_option("input", c.input, std::string("mesh in mm, in the frame LPS; its arrays stay: ") + mesh_kinds)
      ->required();
  sub->add_option("output", c.output, "mesh to write: .vtu, .vtk or .msh")->required();
  sub->add_option("--regions", c.regions,
                  "FILE, FILE:NAME or FILE:NAME,NAME: a label image or a closed surface (.stl, .vtp, .vtk); may be "
                  "given again")
      ->required()
      ->allow_extra_args(false);
  sub->add_option("--only", c.only, "regions of the mesh that are painted, names or numbers separated by commas")
      ->delimiter(',');
  sub->add_option("--region", c.region, "cell array with the mesh's regions (default: region, gmsh:physical ...)");
  sub->add_flag("--json", c.json, "print as JSON");
}

void add_inpaint(Program& p) {
  auto* sub = add_command(p.line, "inpaint", "Fill the gaps in an image of fibre axes by total variation",
                          "heartgen inpaint fibers filled --labels labels.nii.gz",
                          [&p] { return inpaint_command(p.inpaint, p.line.comm); });
  sub->add_option("input", p.inpaint.input, "folder with fiber_x.nrrd, fiber_y.nrrd, fiber_z.nrrd; 0 0 0: a gap")
      ->required();
  sub->add_option("output", p.inpaint.output, "folder for the same, filled")->required();
  sub->add_option("--labels", p.inpaint.labels, "label map with the tags of a bundle's manifest, on the same grid")
      ->required();
  sub->add_option("--regions", p.inpaint.regions, "what is filled (default lv_myocardium,rv_myocardium)")
      ->delimiter(',');
  sub->add_option("--iterations", p.inpaint.iterations, "Jacobi sweeps (default 200)");
  sub->add_option("--threads", p.line.threads, "threads per process (default: all)");
  sub->add_flag("--json", p.inpaint.json, "print the counts as JSON");
}

void add_selftest(Program& p) {
  auto* selftest = add_command(p.line, "selftest",
                               "Build a small built-in heart and compare its content id with the expected one (exit 3: "
                               "this machine computes other bits)",
                               "heartgen selftest", [&p] { return selftest_command(p.selftest, p.line.comm); });
  selftest->add_flag("--list", p.selftest.list, "print id and SHA-256 of every file instead");
  selftest->add_flag("--json", p.selftest.json, "print as JSON");
}

}  // namespace

void add_tool_options(Program& p) {
  add_segment(p);
  add_tools(p);
  add_contours(p);
  add_slice(p);
  add_improve(p);
  add_inpaint(p);
  add_paint(p);
  add_selftest(p);
}

}  // namespace heartgen::app
