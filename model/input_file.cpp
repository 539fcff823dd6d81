// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/input_file.hpp"

#include <unistd.h>

#include "model/error.hpp"

namespace heartgen {

void require_input_file(const std::filesystem::path& path, const char* remedy) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) throw UserError("does not exist", path.string(), remedy);
  if (status.type() == fs::file_type::none)
    throw UserError("cannot be read: " + error.message(), path.string(), remedy);
  if (fs::is_directory(status)) throw UserError("is a folder, not a file", path.string(), remedy);
  if (!fs::is_regular_file(status))
    throw UserError("is a pipe or a device, not a file", path.string(), "save it as a file first");
  if (access(path.c_str(), R_OK) != 0) throw UserError("no right to read it", path.string(), "change its rights");
}

}  // namespace heartgen
