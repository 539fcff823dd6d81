// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Runs the heartgen program as a user would.
#pragma once
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

namespace heartgen::testing {

struct ProgramResult {
  int exit_code = -1;
  std::string output;  ///< standard output
  std::string errors;  ///< standard error
};

inline std::string text_of(const std::string& path) {
  std::string text;
  if (FILE* file = std::fopen(path.c_str(), "rb")) {
    std::array<char, 4096> buffer{};
    while (const auto size = std::fread(buffer.data(), 1, buffer.size(), file)) text.append(buffer.data(), size);
    std::fclose(file);
  }
  return text;
}

/// A launcher of so many ranks. What MPI's plugins keep has no name by which a leak could be suppressed: they are
/// unloaded before the sanitizers look for leaks.
inline std::string on_ranks(int ranks) {
  return "env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 "
         "ASAN_OPTIONS=detect_leaks=0 mpirun -n " +
         std::to_string(ranks);
}

/// `launcher` comes before the program: on_ranks(2), "LC_ALL=de_DE.UTF-8" or nothing.
inline ProgramResult run_program(const char* program, const std::string& arguments, const std::string& scratch,
                                 const std::string& launcher) {
  const std::string out = scratch + "/stdout.txt", err = scratch + "/stderr.txt";
  const std::string command =
      "cd " + scratch + " && " + launcher + " " + program + " " + arguments + " >" + out + " 2>" + err + " </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
}

inline ProgramResult heartgen(const std::string& arguments, const std::string& scratch,
                              const std::string& launcher = "") {
  return run_program(HEARTGEN_PROGRAM, arguments, scratch, launcher);
}

inline ProgramResult heartgen_lab(const std::string& arguments, const std::string& scratch) {
  return run_program(HEARTGEN_LAB_PROGRAM, arguments, scratch, "");
}

}  // namespace heartgen::testing
