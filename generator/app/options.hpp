// What the command line can hold: one struct that parsing fills, and the subcommands with their options.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "generator/app/accuracy_command.hpp"
#include "generator/app/bench_command.hpp"
#include "generator/app/commands.hpp"
#include "generator/app/contours_command.hpp"
#include "generator/app/fiber_accuracy_command.hpp"
#include "generator/app/improve_command.hpp"
#include "generator/app/inpaint_command.hpp"
#include "generator/app/place_command.hpp"
#include "generator/app/segment_command.hpp"
#include "generator/app/slice_command.hpp"
#include "generator/app/study_command.hpp"
#include "generator/app/transfer_command.hpp"

namespace heart::app {

struct Program {
  CLI::App app{"heartgen: simulation-ready heart models from CT"};
  parallel::Comm comm;
  std::function<int()> chosen{};  // what the parsed subcommand does
  int threads = 0;
  std::string simd;
  std::string memory_limit;

  BuildCommand build{};
  ValidateCommand validate{};
  ExportCommand exporting{};
  FilterCommand filter{};
  SegmentCommand segment{};
  MeshCommand mesh{};
  LandmarksCommand landmarks{};
  ImproveCommand improve{};
  InpaintCommand inpaint{};
  TransferCommand transfer{};
  PlaceCommand place{};
  SliceCommand slice{};
  PhantomCommand phantom{};
  SelftestCommand selftest{};
  ContoursCommand contours{};
  AccuracyCommand accuracy{};
  FiberAccuracyCommand fiber_accuracy{};
  BenchCommand bench{};
  StudyCommand study{};
  std::string bundle{}, path{}, ct{};
  bool json = false;
  std::vector<std::int64_t> size{};
  std::vector<double> spacing{}, rotation{};
};

/// Adds a subcommand whose action is chosen when it is parsed.
CLI::App* subcommand(Program& p, const std::string& name, const std::string& what, const std::string& example,
                     std::function<int()> action);

/// The action on the root alone, while the other ranks wait for its outcome.
std::function<int()> on_root(Program& p, std::function<int()> action);

/// Of label maps, for the help.
std::string preset_names();

/// Threads, vector instructions and memory, of every command.
void add_machine_options(Program& p, CLI::App& app);

/// What makes a phantom's heart unusual.
void add_heart_options(Program& p, CLI::App& sub, datasets::HeartOverrides& heart);

/// The files of anybody's meshes that are read.
constexpr const char* mesh_kinds =
    ".vtu, .vtk, .msh, openCARP's .pts or .bpts, TetGen's or Chaste's .node, Medit's .mesh";

void add_bundle_options(Program& p);   ///< what makes, checks and hands on bundles
void add_tool_options(Program& p);     ///< single steps on images, label maps and meshes
void add_measure_options(Program& p);  ///< accuracy and speed, and the thesis's studies

}  // namespace heart::app
