// SPDX-License-Identifier: GPL-3.0-or-later
// The table of numbers about patients: whole, sourced, and read through one door.
#include "model/numbers.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "model/priors.hpp"
#include "model/recipe.hpp"
#include "model/tissue.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream in(fs::path(HEARTGEN_TESTS_FOLDER).parent_path() / path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Names as the headers declare them, and as each entry calls itself.
std::vector<std::pair<std::string, std::string>> declared_in(const char* header) {
  const std::regex entry(R"re(inline constexpr Number (\w+) =\s*number\(\s*"(\w+)")re");
  const std::string text = text_of(header);
  std::vector<std::pair<std::string, std::string>> names;
  for (std::sregex_iterator at(text.begin(), text.end(), entry), end; at != end; ++at)
    names.emplace_back((*at)[1], (*at)[2]);
  return names;
}

TEST(Numbers, AreAllListed) {
  auto names = declared_in("model/tissue.hpp");
  const auto more = declared_in("model/priors.hpp");
  names.insert(names.end(), more.begin(), more.end());
  ASSERT_EQ(patient_numbers().size(), names.size());
  for (std::size_t n = 0; n < names.size(); ++n) {
    EXPECT_EQ(names[n].first, names[n].second);
    EXPECT_EQ(patient_numbers()[n]->name, names[n].first);
  }
}

TEST(Numbers, EachHasOneNameAUnitARangeAndASource) {
  std::set<std::string> names;
  for (const Number* number : patient_numbers()) {
    const std::string name = number->name, unit = number->unit;
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_LT(number->min, number->max) << name;
    EXPECT_GE(number->value, number->min) << name;
    EXPECT_LE(number->value, number->max) << name;
    EXPECT_FALSE(std::string(number->meaning).empty()) << name;
    EXPECT_FALSE(std::string(number->source).empty()) << name;
    const std::string end = unit == "HU" ? "_hu" : unit == "HU/mm" ? "_hu_per_mm" : "_" + unit;
    if (unit == "1")
      for (const char* other : {"_hu", "_mm", "_ml", "_mm2", "_cm2"}) EXPECT_FALSE(name.ends_with(other)) << name;
    else
      EXPECT_TRUE(name.ends_with(end)) << name << " is in " << unit;
  }
}

/// No paper without its entry in the bibliography.
TEST(Numbers, PapersAreInTheBibliography) {
  const std::string bibliography = text_of("docs/references.bib");
  const std::regex key(R"re(\b([a-z]+(?:19|20)\d\d)\b)re");
  for (const Number* number : patient_numbers()) {
    const std::string source = number->source;
    std::size_t keys = 0;
    for (std::sregex_iterator at(source.begin(), source.end(), key), end; at != end; ++at, ++keys)
      EXPECT_NE(bibliography.find("{" + (*at)[1].str() + ","), std::string::npos) << number->name << ": " << (*at)[1];
    EXPECT_TRUE(number->basis != Basis::paper || keys > 0) << number->name;
  }
}

double twice(const Number& number) { return 2 * number.value; }

TEST(Numbers, AreReadThroughOneDoor) {
  EXPECT_EQ(tissue::fat_hu, -100);
  EXPECT_EQ(EpicardiumSettings{}.minimum_lv_wall_mm, 3);
  read_number_instead = twice;
  EXPECT_EQ(tissue::fat_hu, -200);
  EXPECT_EQ(EpicardiumSettings{}.minimum_lv_wall_mm, 6);
  read_number_instead = nullptr;
  EXPECT_EQ(tissue::fat_hu, -100);
}

/// What `heartgen phantom` and a recipe of no words promise.
TEST(Numbers, OfTheRecipeAreItsDefaults) {
  EXPECT_EQ(ChamberSettings{}.vessel_length_mm, priors::vessel_length_mm);
  EXPECT_EQ(ChamberSettings{}.papillary_closing_mm, priors::papillary_gap_mm);
  EXPECT_EQ(EpicardiumSettings{}.ventricle_band_mm, priors::lv_band_mm);
  EXPECT_EQ(EpicardiumSettings{}.edge_hu_per_mm, tissue::epicardial_edge_hu_per_mm);
  EXPECT_EQ(DenoiseSettings{}.edge_hu, tissue::soft_tissue_edge_hu);
}

}  // namespace
}  // namespace heartgen
