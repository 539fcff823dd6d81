// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/fiber_names.hpp"

#include <algorithm>
#include <initializer_list>
#include <string>

namespace heartgen {
namespace {

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

AxisName axis_name(std::string_view array) {
  std::string name(array);
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const auto has = [&name](std::string_view part) { return name.find(part) != std::string::npos; };
  if (has("sheet")) return has("norm") ? AxisName::sheet_normal : AxisName::sheet;
  if (is_one_of(name, {"s0", "s", "es", "e2"}) || name.starts_with("transvers")) return AxisName::sheet;
  if (is_one_of(name, {"n0", "en", "e3"})) return AxisName::sheet_normal;
  if (name.starts_with("fib") || has("fiber") || has("fibre") || name.starts_with("longitudinal") ||
      is_one_of(name, {"f0", "f", "ef", "e1", "lon"}))
    return AxisName::fiber;
  return AxisName::none;
}

}  // namespace heartgen
