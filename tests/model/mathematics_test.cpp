// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mathematics.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <regex>
#include <string>
#include <vector>

namespace heartgen {
namespace {

namespace fs = std::filesystem;

struct OneArgument {
  const char* name;
  double (*ours)(double);
  double (*by_c_name)(double);
  long double (*exact)(long double);
  double low, high;
};

// The C library's names must lead to our unit too: std::sin(double) is the C function.
const std::vector<OneArgument>& functions() {
  static const std::vector<OneArgument> table{
      {"exp", math::exp, std::exp, std::exp, -700, 700},
      {"exp2", math::exp2, std::exp2, std::exp2, -1000, 1000},
      {"log", math::log, std::log, std::log, 1e-9, 1e9},
      {"log2", math::log2, std::log2, std::log2, 1e-9, 1e9},
      {"log10", math::log10, std::log10, std::log10, 1e-9, 1e9},
      {"cbrt", math::cbrt, std::cbrt, std::cbrt, -1e6, 1e6},
      {"sin", math::sin, std::sin, std::sin, -100, 100},
      {"cos", math::cos, std::cos, std::cos, -100, 100},
      {"tan", math::tan, std::tan, std::tan, -100, 100},
      {"asin", math::asin, std::asin, std::asin, -1, 1},
      {"acos", math::acos, std::acos, std::acos, -1, 1},
      {"atan", math::atan, std::atan, std::atan, -1e3, 1e3},
      {"sinh", math::sinh, std::sinh, std::sinh, -300, 300},
      {"cosh", math::cosh, std::cosh, std::cosh, -300, 300},
      {"tanh", math::tanh, std::tanh, std::tanh, -20, 20},
      {"erfc", math::erfc, std::erfc, std::erfc, -5, 20},
  };
  return table;
}

constexpr int places = 4001;
double place(double low, double high, int i) { return low + (high - low) * (i + 0.37) / places; }

double units_in_last_place(double value, long double exact) {
  const auto rounded = static_cast<double>(exact);
  return static_cast<double>(std::abs(value - exact) /
                             (std::nextafter(std::abs(rounded), INFINITY) - std::abs(rounded)));
}

TEST(Mathematics, IsWithinOneAndAHalfUnitsOfTheLastPlace) {
  for (const auto& f : functions())
    for (int i = 0; i < places; ++i) {
      const double x = place(f.low, f.high, i);
      ASSERT_LE(units_in_last_place(f.ours(x), f.exact(x)), 1.5) << f.name << " of " << x;
    }
  for (int i = 0; i < places; ++i) {
    const double x = place(0.01, 50, i), y = place(-20, 20, (i * 37) % places);
    const auto lx = static_cast<long double>(x), ly = static_cast<long double>(y);
    ASSERT_LE(units_in_last_place(math::pow(x, y), std::pow(lx, ly)), 1.5) << x << " " << y;
    ASSERT_LE(units_in_last_place(math::atan2(y, x), std::atan2(ly, lx)), 1.5) << x << " " << y;
    ASSERT_LE(units_in_last_place(math::hypot(x, y), std::hypot(lx, ly)), 1.5) << x << " " << y;
  }
}

TEST(Mathematics, TheNamesOfTheCLibraryGiveTheSameBits) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  for (const auto& f : functions())
    for (int i = 0; i < places; ++i) {
      volatile double x = place(f.low, f.high, i);
      ASSERT_EQ(bits(f.by_c_name(x)), bits(f.ours(x))) << f.name << " of " << x;
    }
  for (int i = 0; i < places; ++i) {
    volatile double x = place(0.01, 50, i), y = place(-20, 20, (i * 37) % places);
    ASSERT_EQ(bits(std::pow(x, y)), bits(math::pow(x, y)));
    ASSERT_EQ(bits(std::atan2(y, x)), bits(math::atan2(y, x)));
    ASSERT_EQ(bits(std::hypot(x, y)), bits(math::hypot(x, y)));
  }
}

// Written down once, on one machine: another that rounds otherwise is seen here and not in a heart.
TEST(Mathematics, HasTheseBits) {
  std::uint64_t mixed = 0;  // FNV-1a over the bits of every value
  const auto mix = [&](double value) { mixed = (mixed ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3; };
  for (const auto& f : functions())
    for (int i = 0; i < places; ++i) mix(f.ours(place(f.low, f.high, i)));
  for (int i = 0; i < places; ++i) {
    const double x = place(0.01, 50, i), y = place(-20, 20, (i * 37) % places);
    for (const double value : {math::pow(x, y), math::atan2(y, x), math::hypot(x, y)}) mix(value);
  }
  EXPECT_EQ(mixed, 4751877848118496922U);
}

TEST(Mathematics, EdgesAreThoseOfTheStandard) {
  EXPECT_EQ(math::pow(0, 0), 1);
  EXPECT_EQ(math::pow(-2, 3), -8);
  EXPECT_TRUE(std::isnan(math::pow(-2, 0.5)));
  EXPECT_TRUE(std::isnan(math::acos(1.0000001)));
  EXPECT_EQ(math::acos(1), 0);
  EXPECT_EQ(math::exp(1000), INFINITY);
  EXPECT_EQ(math::exp(-1000), 0);
  EXPECT_EQ(math::log(0), -INFINITY);
  EXPECT_EQ(math::atan2(0, -1), std::numbers::pi);
  EXPECT_EQ(math::hypot(3e300, 4e300), 5e300);
  EXPECT_EQ(math::hypot(2, 3, 6), 7);
}

/// Source files of the program, not of its tests.
std::vector<fs::path> sources() {
  std::vector<fs::path> found;
  const fs::path root = fs::path(HEARTGEN_TESTS_FOLDER).parent_path();
  for (const char* folder : {"model", "generator", "validation", "exporters", "datasets"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
      if (const auto kind = entry.path().extension(); kind == ".cpp" || kind == ".hpp") found.push_back(entry.path());
  return found;
}

TEST(Mathematics, NoSourceFileCallsTheCLibrarys) {
  const std::regex call(
      R"(std::(sin|cos|tan|asin|acos|atan2?|sinh|cosh|tanh|exp2?|expm1|log(2|10|1p)?|pow|cbrt|hypot|erfc?|tgamma|lgamma)\()");
  const auto files = sources();
  ASSERT_GT(files.size(), 300U);
  for (const auto& file : files) {
    if (file.filename() == "mathematics.hpp") continue;  // hypot of three: square roots
    std::ifstream in(file);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    std::smatch found;
    EXPECT_FALSE(std::regex_search(text, found, call)) << file << ": " << found.str() << ": write math:: instead";
  }
}

}  // namespace
}  // namespace heartgen
