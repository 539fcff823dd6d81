// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/own_file.hpp"

#include <dlfcn.h>

#include <cerrno>
#include <string_view>

namespace heartgen {

std::filesystem::path own_file() {
  Dl_info found{};
  const bool is_found = dladdr(reinterpret_cast<const void*>(&own_file), &found) != 0 && found.dli_fname != nullptr;
  // The loader calls the program itself what it was called by.
  if (!is_found || std::string_view(found.dli_fname) == program_invocation_name) return "/proc/self/exe";
  return std::filesystem::absolute(found.dli_fname);
}

}  // namespace heartgen
