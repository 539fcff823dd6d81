// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/contract.hpp"

#include <fmt/format.h>

#include <string_view>

namespace heartgen {

void contract_violated(const char* kind, const char* condition, const char* file, int line) {
  std::string_view path = file;  // from the source's root on: no folder of the machine that compiled it
  for (const std::string_view top : {"model/", "generator/", "validation/", "exporters/", "datasets/", "benchmarks/"})
    if (const auto at = path.rfind(top); at != std::string_view::npos) {
      path.remove_prefix(at);
      break;
    }
  throw ContractViolation(fmt::format("{}:{}: {} {}", path, line, kind, condition));
}

}  // namespace heartgen
