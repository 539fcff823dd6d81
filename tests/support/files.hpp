// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Bytes of files, and the message of what is refused.
#pragma once
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "model/error.hpp"

namespace heartgen::testing {

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The message of the UserError that `run` throws; empty where it throws none.
inline std::string error_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const UserError& error) {
    return error.message;
  }
  return "";
}

}  // namespace heartgen::testing
