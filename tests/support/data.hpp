// Real data for tests: present on some machines, never in the repository.
#pragma once
#include <cstdlib>
#include <filesystem>
#include <string>

namespace heartgen::testing {

/// Path of a file of the real data sets, or empty where they are absent: HEARTGEN_DATA, else ../shared/data.
inline std::string real_data(const std::string& name) {
  const char* folder = std::getenv("HEARTGEN_DATA");
  const auto path =
      (folder ? std::filesystem::path(folder) : std::filesystem::path(HEARTGEN_TESTS_FOLDER) / "../../shared/data") /
      name;
  return std::filesystem::exists(path) ? std::filesystem::weakly_canonical(path).string() : "";
}

/// A fresh folder for one test, removed and made anew.
inline std::filesystem::path scratch_folder(const std::string& name) {
  const auto path = std::filesystem::temp_directory_path() / ("heartgen_test_" + name);
  std::filesystem::remove_all(path);
  std::filesystem::create_directories(path);
  return path;
}

}  // namespace heartgen::testing
