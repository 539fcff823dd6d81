// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/own_file.hpp"

#include <dlfcn.h>

#include <cerrno>
#include <string_view>
#include <system_error>

namespace heartgen {

std::filesystem::path own_file() {
  std::error_code unreadable;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unreadable);
  Dl_info found{};
  const bool is_found = dladdr(reinterpret_cast<const void*>(&own_file), &found) != 0 && found.dli_fname != nullptr;
  // The loader calls the program itself what it was called by.
  if (!is_found || std::string_view(found.dli_fname) == program_invocation_name) return program;
  return std::filesystem::weakly_canonical(found.dli_fname, unreadable);
}

}  // namespace heartgen
