// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Real data for tests: present on some machines, never in the repository.
#pragma once
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace heartgen::testing {

/// Path of a file of the real data sets, or empty where they are absent: HEARTGEN_DATA, else ../shared/data.
inline std::string real_data(const std::string& name) {
  const char* folder = std::getenv("HEARTGEN_DATA");
  const auto path =
      (folder ? std::filesystem::path(folder) : std::filesystem::path(HEARTGEN_TESTS_FOLDER) / "../../shared/data") /
      name;
  return std::filesystem::exists(path) ? std::filesystem::weakly_canonical(path).string() : "";
}

/// Of this process alone, so that tests may run side by side; goes with it.
inline const std::filesystem::path& scratch_root() {
  struct Root {
    pid_t owner = getpid();
    std::filesystem::path path = std::filesystem::temp_directory_path() / ("heartgen_test_" + std::to_string(getpid()));
    Root() { std::filesystem::create_directories(path); }
    ~Root() {
      std::error_code unheard;
      if (owner == getpid()) std::filesystem::remove_all(path, unheard);
    }
    Root(const Root&) = delete;
    Root& operator=(const Root&) = delete;
  };
  static const Root root;
  return root.path;
}

/// A fresh folder for one test, removed and made anew.
inline std::filesystem::path scratch_folder(const std::string& name) {
  const auto path = scratch_root() / name;
  std::filesystem::remove_all(path);
  std::filesystem::create_directories(path);
  return path;
}

}  // namespace heartgen::testing
