// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The commands of heartgen: one struct that parsing fills, and the functions that add them with their options.
#pragma once
#include <string>

#include "generator/app/commands.hpp"
#include "generator/app/contours_command.hpp"
#include "generator/app/get_command.hpp"
#include "generator/app/improve_command.hpp"
#include "generator/app/inpaint_command.hpp"
#include "generator/app/place_command.hpp"
#include "generator/app/segment_command.hpp"
#include "generator/app/slice_command.hpp"
#include "generator/app/transfer_command.hpp"
#include "generator/command_line/command_line.hpp"

namespace heartgen::app {

struct Program {
  command_line::CommandLine& line;

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
  GetCommand get{};
  SliceCommand slice{};
  PhantomCommand phantom{};
  SelftestCommand selftest{};
  ContoursCommand contours{};
  std::string bundle{}, path{}, ct{};
  bool json = false;
};

/// Of label maps, for the help.
std::string preset_names();

/// The files of anybody's meshes that are read.
constexpr const char* mesh_kinds =
    ".vtu, .vtk, .msh, openCARP's .pts or .bpts, TetGen's or Chaste's .node, Medit's .mesh";

/// Name of the program, and what it is.
constexpr const char* description = "heartgen: simulation-ready heart models from CT";

void add_commands(Program& p);        ///< all of these:
void add_bundle_options(Program& p);  ///< what makes, checks and hands on bundles
void add_tool_options(Program& p);    ///< single steps on images, label maps and meshes
void group_by_road(Program& p);       ///< the order of --help: what a user has, and then does with it

}  // namespace heartgen::app
