// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// One function per subcommand. Each returns the exit code: 0 done, 3 validation below its thresholds. User mistakes
/// are thrown as UserError (2). Results go to standard output, as text or, with `json`, as one JSON document.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/phantom/anatomy.hpp"
#include "generator/parallel/comm.hpp"
#include "model/grid.hpp"

namespace heartgen::app {

struct BuildCommand {
  int phase = 0;
  std::string recipe, ct, labels, preset, atlas, atlas_array, landmarks, keep_stages, output;
  std::vector<std::string> regions;  ///< FILE, FILE:NAME or FILE:NAME,NAME
  bool no_cache = false, force = false, accept_doubtful = false, json = false, quiet = false;
};
/// @collective
int build_command(const BuildCommand& command, const parallel::Comm& comm);

struct ValidateCommand {
  std::string bundle;  ///< its folder, or a mesh file of the user's own, of which the mesh's rows are printed
  std::string reference_labels, reference_fibers;
  std::string region, input_unit;  ///< of a mesh file: the array with its regions, its unit; empty: see own_mesh.hpp
  bool json = false, all_rows = false;
};
int validate_command(const ValidateCommand& command);

struct ExportCommand {
  std::string bundle;  ///< its folder, or a mesh file of the user's own
  std::string output, mesh, unit;
  std::string region, input_unit;          ///< as in ValidateCommand
  std::vector<std::string> formats, only;  ///< only: regions to cut out; empty: all
  bool no_interfaces = false;
  bool json = false;
};
int export_command(const ExportCommand& command);

int verify_command(const std::string& bundle, bool json);
int pack_command(const std::string& bundle, const std::string& archive, bool json);
int unpack_command(const std::string& archive, const std::string& folder, bool json);
int info_command(const std::string& bundle, bool json);
int report_command(const std::string& bundle, const std::string& html, const std::string& ct, bool json);

struct FilterCommand {
  std::string name, input, output;
  std::vector<std::string> parameters;  ///< "--key", "value" pairs as they stood on the command line
};
/// @collective
int filter_command(const FilterCommand& command, const parallel::Comm& comm);
std::string filter_help();

struct MeshCommand {
  std::string labels, preset, label_names, output, backend, size_field;
  std::optional<double> edge_mm;
  std::optional<int> wall_layers;
  bool walls = false;  ///< these alone
  bool json = false;
};
int mesh_command(const MeshCommand& command);

struct LandmarksCommand {
  std::string ct, output, picture;  ///< files to write; empty: none
  int phase = 0;
  bool json = false;
};
/// Prints what was found and how far to trust it; 3 where that can hardly be a heart.
int landmarks_command(const LandmarksCommand& command);

struct PhantomCommand {
  std::string folder;
  Index3 size{256, 256, 160};
  Vec3 spacing_mm{1.4, 1.4, 1.9};
  int variant = 0;
  double noise_hu = 22;
  phantom::HeartOverrides heart;
  phantom::GreyValues grey;
  bool json = false;
};
int phantom_command(const PhantomCommand& command);

struct SelftestCommand {
  bool list = false;  ///< print the hashes that the program shall expect from now on
  bool json = false;
};
/// @collective
int selftest_command(const SelftestCommand& command, const parallel::Comm& comm);

}  // namespace heartgen::app
