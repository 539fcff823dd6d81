// SPDX-License-Identifier: GPL-3.0-or-later
// heartgen-lab: how accurate and how fast the program is, and the thesis's own studies repeated.
#include "benchmarks/lab/accuracy_command.hpp"
#include "benchmarks/lab/bench_command.hpp"
#include "benchmarks/lab/broken_circle_command.hpp"
#include "benchmarks/lab/fiber_accuracy_command.hpp"
#include "benchmarks/lab/naming_command.hpp"
#include "benchmarks/lab/sensitivity_command.hpp"
#include "benchmarks/lab/study_command.hpp"
#include "generator/command_line/command_line.hpp"
#include "generator/command_line/heart_options.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::lab;
using command_line::add_command;
using command_line::CommandLine;
using command_line::on_root;

struct Lab {
  AccuracyCommand accuracy{};
  FiberAccuracyCommand fiber_accuracy{};
  SensitivityCommand sensitivity{};
  BenchCommand bench{};
  StudyCommand study{};
  BrokenCircleCommand broken_circle{};
  NamingCommand naming{};
};

void add_accuracy(CommandLine& line, Lab& p) {
  auto* sub =
      add_command(line, "accuracy",
                  "Segment phantoms without a landmark and compare with what they are (exit 3 "
                  "below the bounds)",
                  "heartgen-lab accuracy --variants 0-14 --noise 10,22,40 --size 512,512,199 --spacing 0.5,0.5,1.2",
                  [&line, &p] { return accuracy_command(p.accuracy, line.comm); });
  sub->add_option("--variants", p.accuracy.variants, "numbers and ranges (default 0-14)");
  sub->add_option("--of", p.accuracy.of, "chambers (default), or one step alone: walls, carotid, trachea");
  sub->add_option("--noise", p.accuracy.noise_hu, "standard deviations of the noise, HU (default 22)")->delimiter(',');
  command_line::add_grid_options(*sub, p.accuracy.size, p.accuracy.spacing_mm);
  command_line::add_heart_options(*sub, p.accuracy.heart);
  sub->add_option("--keep", p.accuracy.keep, "folder for each phantom's CT, truth, label map and row");
  sub->add_flag("--resume", p.accuracy.resume, "take the rows that an earlier run left in --keep");
  sub->add_option("--plot", p.accuracy.plot, "SVG to write: least Dice over the right heart's contrast");
  sub->add_flag("--json", p.accuracy.json, "print every number as JSON");
}

void add_fiber_accuracy(CommandLine& line, Lab& p) {
  auto& f = p.fiber_accuracy;
  auto* sub = add_command(line, "fiber-accuracy", "Carry an atlas to phantoms of known fibres and compare",
                          "heartgen-lab fiber-accuracy --cases 1,2,thick --atlas stand-in",
                          on_root(line, [&p] { return fiber_accuracy_command(p.fiber_accuracy); }));
  sub->add_option("--cases", f.cases,
                  "variants, thick, dilated, cut, tilted, uneven (surfaces moved by 0.4 mm rms at random, correlated "
                  "over 5 mm; uneven3: of variant 3; default 1-4 and all of these)")
      ->delimiter(',');
  sub->add_option("--atlas", f.atlas, "phantom, stand-in, or a file (default phantom: variant 0)");
  sub->add_option("--methods", f.methods, "local_angles, coordinates, jacobian (default all)")->delimiter(',');
  sub->add_option("--fields", f.fields, "uniform, regional (default uniform)")->delimiter(',');
  sub->add_option(
         "--atlas-frames", f.atlas_frames,
         "plain, turned, scaled, axes, metres, all, mirrored: the atlas's file in other frames (default plain)")
      ->delimiter(',');
  sub->add_option("--label-spacing", f.spacing_mm, "of the labels, mm: one number or X,Y,Z (default 0.5,0.5,1.2)")
      ->delimiter(',');
  sub->add_option("--depth-grid", f.depth_grid_mm,
                  "mm to which labels are resampled (default 0.85, as in a build; 0: the labels' finest spacing: with "
                  "--label-spacing 1.2, labels on a grid of their own)");
  sub->add_option("--mesh-edge", f.mesh_edge_mm, "also at nodes and cells of a mesh with this edge, mm");
  sub->add_flag("--json", f.json, "print as JSON");
}

void add_sensitivity(CommandLine& line, Lab& p) {
  auto& s = p.sensitivity;
  auto* sub = add_command(line, "sensitivity", "Move each number about patients on phantoms and print what it does",
                          "heartgen-lab sensitivity --only fat_hu,valve_plate_mm --phantoms 2 --stages chambers,walls",
                          on_root(line, [&p] { return sensitivity_command(p.sensitivity); }));
  sub->add_option("--only", s.only, "numbers to move (default: all that are read)")->delimiter(',');
  sub->add_option("--change", s.change, "percent, up and down (default 20)");
  sub->add_option("--phantoms", s.phantoms, "how many: variants 0, 1, ... (default 1)");
  sub->add_option("--stages", s.stages,
                  "of split, chambers, walls, body, carotid, fibers; those that they need run too (default all)")
      ->delimiter(',');
  command_line::add_grid_options(*sub, s.size, s.spacing_mm, "of the phantoms, ");
  sub->add_option("--noise", s.noise_hu, "standard deviation of the noise, HU (default 22)");
  sub->add_flag("--list", s.list, "print the numbers with unit, range and source, and move none");
  sub->add_flag("--json", s.json, "print as JSON");
}

void add_bench(CommandLine& line, Lab& p) {
  auto* sub = add_command(line, "bench", "Measure the speed of the image stages", "", [&line, &p] {
    if (line.threads > 0) p.bench.threads = line.threads;
    return bench_command(p.bench, line.comm);
  });
  sub->footer(
      bench_help() +
      "Examples:\n  heartgen-lab bench sweep\n  mpirun -n 2 heartgen-lab bench ranks\n  heartgen-lab bench mesh\n"
      "  heartgen-lab bench mesh-torso --labels bundle/images/labels.nii.gz");
  sub->add_option("names", p.bench.names, "benchmarks (default: all)");
  command_line::add_grid_options(*sub, p.bench.size, p.bench.spacing_mm, "of the phantom, ");
  sub->add_option("--repeats", p.bench.repeats, "of short measurements, of which the median counts (default 7)")
      ->check(CLI::PositiveNumber);
  sub->add_option("--labels", p.bench.labels,
                  "label map for mesh-myocardium, -heart, -torso, -vessels and -slice (default: a phantom's)");
  sub->add_option("--variant", p.bench.variant, "of the phantom that they are made from otherwise (default 0)")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--heart-edge", p.bench.heart_edge_mm,
                  "mm, in the walls of mesh-myocardium and mesh-heart (default: for about 1.25 million cells)")
      ->check(CLI::PositiveNumber);
  sub->add_flag("--processor-time", p.bench.processor_time,
                "count processor time over threads, where the machine does other things meanwhile");
  sub->add_flag("--json", p.bench.json, "print as JSON");
}

void add_study(CommandLine& line, Lab& p) {
  auto* sub =
      add_command(line, "study", "Repeat the thesis's analysis of the Chan-Vese model: tables, curves, pictures", "",
                  on_root(line, [&p] { return study_command(p.study); }));
  sub->footer(study_help() + "Example:\n  heartgen-lab study lengths phases --output study");
  sub->add_option("name", p.study.names, "studies (default: all)");
  sub->add_option("-o,--output", p.study.output, "folder for tables, plots, pictures and index.html");
  sub->add_flag("--quick", p.study.quick, "small images and few iterations");
  sub->add_flag("--json", p.study.json, "print tables and statements as JSON");
}

void add_broken_circle(CommandLine& line, Lab& p) {
  auto& c = p.broken_circle;
  auto* sub = add_command(line, "broken-circle", "Close the thesis's broken circle by each deformable contour",
                          "heartgen-lab broken-circle --output pictures",
                          on_root(line, [&p] { return broken_circle_command(p.broken_circle); }));
  sub->add_option("-o,--output", c.folder, "folder for the pictures")->required();
  sub->add_option("--noise", c.noise, "standard deviation of the circle's noise, of 255 (default 0)");
  sub->add_flag("--json", c.json, "print as JSON");
}

void add_naming(CommandLine& line, Lab& p) {
  auto& n = p.naming;
  auto* sub = add_command(
      line, "naming", "Name the pieces of blood in CTs, or in phantoms of many kinds and count what is right",
      "heartgen-lab naming patient.nii.gz --output names.nii.gz\n  heartgen-lab naming --cases 3 --tree",
      on_root(line, [&p] { return naming_command(p.naming); }));
  sub->add_option("ct", n.cts, "CT volumes or DICOM folders (default: the table of phantoms)");
  sub->add_option("-o,--output", n.output, "label map of the names to write, of the first CT");
  sub->add_option("--kinds", n.kinds, "of phantoms, by the begin of their names (default: all)")->delimiter(',');
  sub->add_option("--cases", n.cases, "of each kind (default 3)")->check(CLI::PositiveNumber);
  sub->add_option("--seed", n.seed, "that the phantoms are drawn from (default 1)")->check(CLI::NonNegativeNumber);
  sub->add_flag("--tree", n.tree, "also what the search for landmarks finds");
}

}  // namespace

int main(int argc, char** argv) {
  Lab p;
  return command_line::run_program(argc, argv, "heartgen-lab: accuracy, speed and the thesis's studies of heartgen",
                                   [&](CommandLine& line) {
                                     line.talkative = {"bench", "sensitivity"};
                                     add_accuracy(line, p);
                                     add_fiber_accuracy(line, p);
                                     add_sensitivity(line, p);
                                     add_bench(line, p);
                                     add_study(line, p);
                                     add_broken_circle(line, p);
                                     add_naming(line, p);
                                   });
}
