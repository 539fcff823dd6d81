// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers about patients stand in model/tissue.hpp and model/priors.hpp, and nowhere else.
//
// A constant with a unit of length, area, volume or grey value is a number about patients, unless its name says that
// the program uses it to look, and how: one of the words of `words_of_method` ("smoothing_mm", "grid_mm",
// "heart_edge_mm"). Of 0.001 and less, and of 100,000 and more, nobody has parts: these are rounding, and no limit at
// all. A constant that says what a body is like belongs into the two files, whatever its name.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <set>
#include <sstream>

#include "architecture/source_files.hpp"

namespace heartgen {
namespace {

const std::set<std::string> the_two_files = {"model/tissue.hpp", "model/priors.hpp"};

// The search for seeds and chambers has numbers of its own until it is one: the naming of the blood with its own table
// of priors, what lies around the heart, the landmarks, and what marks and floods the blood from them, faint or not.
constexpr std::array<const char*, 3> search_rooms = {"generator/chest/", "generator/naming/", "generator/landmarks/"};
const std::set<std::string> chamber_search = {"blood_pool",     "chambers",        "faint_blood",   "faint_right_heart",
                                              "muscle_bundles", "right_partition", "wall_thickness"};

const std::set<std::string> words_of_method = {
    "grid",      "lattice",   "spacing",  "voxel",      "voxels", "pixel",   "cell",
    "slice",     "bin",       "step",     "scale",      "unit",                          // samples
    "edge",                                                                              // meshes
    "smoothing", "blur",      "sigma",    "noise",      "blend",  "closing", "opening",  // filters
    "curvature", "tension",   "rigidity", "attraction",                                  // snakes
    "search",    "ball",      "fit",      "lever",      "margin", "clip",    "start",    // how far the program looks
    "tolerance", "precision", "rounding", "level",                                       // when it stops
    "picture"};                                                                          // what it draws

// Not looked at: datasets/ makes a patient of its own, which must not follow from what the program assumes of patients;
// validation/ judges by published bounds, each with its source (validation/criteria_*.cpp), and must not either; a
// benchmark's numbers change no heart.
std::vector<fs::path> sources() { return sources_in({"model", "generator", "exporters"}); }

bool is_search(const fs::path& source) {
  const auto name = fs::relative(source, root).string();
  return std::any_of(search_rooms.begin(), search_rooms.end(),
                     [&](const char* room) { return name.starts_with(room); }) ||
         (name.starts_with("generator/anatomy/") && chamber_search.contains(source.stem().string()));
}

bool is_of_method(const std::string& name) {
  std::istringstream words(name);
  for (std::string word; std::getline(words, word, '_');)
    if (words_of_method.contains(word)) return true;
  return false;
}

/// "file:line: name = value" of every number about patients in the text.
std::vector<std::string> patient_constants(const std::string& text, const std::string& file) {
  static const std::regex constant(
      R"re(\b(\w+_(?:hu|mm|mm2|mm3|ml|cm|cm2|cm3)(?:_per_[a-z]+)?)\s*(?:=|\{)\s*(-?[0-9][0-9.e]*)[fF]?\s*[;,)}])re");
  static const std::regex conversion("(?:mm|cm|ml)[23]?_per_.*");
  constexpr double smallest = 1e-3, largest = 1e5;
  std::vector<std::string> found;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; ++number, std::getline(lines, line);) {
    line.resize(std::min(line.find("//"), line.size()));
    for (std::sregex_iterator at(line.begin(), line.end(), constant), end; at != end; ++at) {
      const std::string name = (*at)[1], value = (*at)[2];
      const double size = std::abs(std::stod(value));
      if (size > smallest && size < largest && !is_of_method(name) && !std::regex_match(name, conversion))
        found.push_back(fmt::format("{}:{}: {} = {}", file, number, name, value));
    }
  }
  return found;
}

std::vector<std::string> patient_constants(const fs::path& source) {
  return patient_constants(text_of(source), fs::relative(source, root).string());
}

TEST(Numbers, AboutPatientsStandInTwoFiles) {
  std::vector<std::string> outside;
  std::size_t in_search = 0;
  for (const auto& source : sources()) {
    if (the_two_files.contains(fs::relative(source, root).string())) continue;
    const auto found = patient_constants(source);
    if (is_search(source))
      in_search += found.size();
    else
      outside.insert(outside.end(), found.begin(), found.end());
  }
  fmt::print("{} constants about patients outside of their two files, {} more in the search for the heart's parts\n",
             outside.size(), in_search);
  EXPECT_TRUE(outside.empty()) << fmt::format("{}", fmt::join(outside, "\n"))
                               << "\nMove them to model/tissue.hpp or model/priors.hpp, with a source; or say in the "
                                  "name what the program does with them.";
}

TEST(Numbers, TheSearchThatMayKeepThemIsThere) {
  for (const auto& name : chamber_search)
    EXPECT_TRUE(fs::exists(root / "generator/anatomy" / (name + ".cpp"))) << name << " needs no exception any more";
}

TEST(Numbers, ConstantsAreSeen) {
  const auto count = [](const std::string& text) { return patient_constants(text, "here").size(); };
  EXPECT_EQ(count("constexpr int fat_hu = -90;"), 1U);
  EXPECT_EQ(count("constexpr float near_mm = 3, far_ml{2.5F};"), 2U);
  EXPECT_EQ(count("  double wall_mm = 2;  ///< of a member"), 1U);
  EXPECT_EQ(count("grow({.liver_ml = 2800, .depth_mm = 18});"), 2U);
  EXPECT_EQ(count("constexpr double slope_hu_per_mm = 12;"), 1U);
  for (const char* other : {"double fat_hu = 0;", "double smoothing_mm = 1;", "double heart_edge_mm = 1.5;",
                            "constexpr double anywhere_mm = 1e9, rounding_error_mm = 1e-6;", "// fat_hu = -90;",
                            "constexpr double mm2_per_cm2 = 100;", "double wall_mm = priors::lv_wall_min_mm;"})
    EXPECT_EQ(count(other), 0U) << other;
}

}  // namespace
}  // namespace heartgen
