// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What every program of ours does with its command line: parse it, run what was chosen, turn errors into one message
/// and an exit code, say that long work goes on, end cleanly.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "generator/parallel/comm.hpp"
#include "model/grid.hpp"

namespace heartgen::command_line {

/// The options of every command, and what the parsed one does.
struct CommandLine {
  CLI::App app;
  parallel::Comm comm;
  std::function<int()> chosen{};
  int threads = 0;
  std::string simd{};
  std::string memory_limit{};
  std::vector<std::string> talkative{};  ///< commands that tell of their progress themselves

  explicit CommandLine(const std::string& what) : app(what), comm(parallel::world()) {}
};

/// Adds a subcommand whose action is chosen when it is parsed.
CLI::App* add_command(CommandLine& line, const std::string& name, const std::string& what, const std::string& example,
                      std::function<int()> action);

/// Threads, vector instructions and memory: every command has them, after its name too.
void add_machine_options(CommandLine& line, CLI::App& app);

/// The action on the root alone, while the other ranks wait for its outcome.
std::function<int()> on_root(CommandLine& line, std::function<int()> action);

/// --size NX,NY,NZ and --spacing SX,SY,SZ of an image that the command makes.
void add_grid_options(CLI::App& command, Index3& size, Vec3& spacing_mm, const std::string& of = "");

/// Three numbers, comma-separated.
CLI::Option* add_vector(CLI::App& command, const std::string& name, Vec3& value, const std::string& text);

/// The whole of main(): `add_commands` adds the subcommands, whose settings must outlive it. Returns the exit code: 0,
/// 1 for a defect of ours, 2 for a mistake or what the machine lacks, or what the command returns. @collective
int run_program(int argc, char** argv, const std::string& what, const std::function<void(CommandLine&)>& add_commands);

}  // namespace heartgen::command_line
