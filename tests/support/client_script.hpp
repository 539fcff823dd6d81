// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Scripts of tests/clients, which read files with other people's programs.
#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace heartgen::testing {

/// Its output is shown where it fails; a script that ends with 77 lacks its programs: the test is skipped.
inline void expect_script_succeeds(const std::string& script, const std::vector<std::filesystem::path>& arguments) {
  const auto path = std::filesystem::path(HEARTGEN_TESTS_FOLDER) / "clients" / script;
  std::string command = "/usr/bin/python3 '" + path.lexically_normal().string() + "'";
  for (const auto& argument : arguments) command += " '" + argument.string() + "'";
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string output;
  std::array<char, 4096> block;
  while (const auto bytes = std::fread(block.data(), 1, block.size(), pipe)) output.append(block.data(), bytes);
  const int status = pclose(pipe);
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (code == 77 || code == 127) GTEST_SKIP() << output;
  EXPECT_EQ(code, 0) << output;
}

}  // namespace heartgen::testing
