// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <string_view>
#include <vector>

#include "datasets/phantom/anatomy.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace heartgen::phantom {
namespace {

struct Part {
  std::string_view name;
  std::optional<double> GreyValues::*value;
};
constexpr std::array<Part, 11> parts = {{{"lv", &GreyValues::lv},
                                         {"la", &GreyValues::la},
                                         {"aorta", &GreyValues::aorta},
                                         {"rv", &GreyValues::rv},
                                         {"ra", &GreyValues::ra},
                                         {"pa", &GreyValues::pa},
                                         {"svc", &GreyValues::svc},
                                         {"ivc", &GreyValues::ivc},
                                         {"jet", &GreyValues::jet},
                                         {"muscle", &GreyValues::muscle},
                                         {"vertebrae", &GreyValues::vertebrae}}};

constexpr const char* example = "give them as lv=350,rv=300,ra=450,pa=310,svc=900,muscle=105";

}  // namespace

GreyValues grey_without_contrast() {
  GreyValues grey;
  grey.lv = grey.rv = 42;
  grey.svc = grey.ivc = 40;
  grey.muscle = 48;
  return grey;
}

void set_grey(GreyValues& grey, const std::string& assignment) {
  constexpr const char* where = "the phantom's grey values";
  const auto equals = assignment.find('=');
  const std::string name = assignment.substr(0, equals);
  std::vector<std::string> known;
  for (const auto& part : parts) known.emplace_back(part.name);
  const char* const from = assignment.data() + (equals == std::string::npos ? assignment.size() : equals + 1);
  const char* const end = assignment.data() + assignment.size();
  double hu = 0;
  const auto [rest, error] = std::from_chars(from, end, hu);
  if (equals == std::string::npos || error != std::errc{} || rest != end)
    throw UserError(fmt::format("\"{}\" is no part with a number of HU", assignment), where, example);
  for (const auto& part : parts)
    if (part.name == name) {
      grey.*part.value = hu;
      return;
    }
  throw UserError(fmt::format("unknown part \"{}\"", name), where,
                  fmt::format("did you mean {}? Known: {}", nearest_name(name, known), fmt::join(known, ", ")));
}

}  // namespace heartgen::phantom
