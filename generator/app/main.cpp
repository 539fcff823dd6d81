// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "generator/app/options.hpp"

int main(int argc, char** argv) {
  using namespace heartgen;
  std::optional<app::Program> program;
  return command_line::run_program(argc, argv, app::description, [&](command_line::CommandLine& line) {
    line.talkative = {"build"};
    program.emplace(app::Program{line});
    app::add_commands(*program);
  });
}
