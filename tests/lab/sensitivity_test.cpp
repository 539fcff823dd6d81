// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers about patients under observation, and the table of what they do.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "benchmarks/lab/moved_number.hpp"
#include "benchmarks/lab/sensitivity_command.hpp"
#include "benchmarks/lab/sensitivity_stages.hpp"
#include "model/error.hpp"
#include "model/numbers.hpp"
#include "model/priors.hpp"
#include "model/tissue.hpp"

namespace heartgen::lab {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string printed_by(const SensitivityCommand& command) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  sensitivity_command(command);
  testing::internal::GetCapturedStderr();
  return testing::internal::GetCapturedStdout();
}

TEST(MovedNumber, IsReadAsWhatItWasMovedToUntilItGoes) {
  const double own = tissue::fat_hu, other = tissue::fat_max_hu;
  {
    const NumberMoved moved(tissue::fat_hu, -123);
    EXPECT_EQ(tissue::fat_hu, -123);
    EXPECT_EQ(tissue::fat_max_hu, other);
  }
  EXPECT_EQ(tissue::fat_hu, own);
}

TEST(MovedNumber, ThoseReadAreNoted) {
  {
    const NumbersRead read;
    EXPECT_TRUE(read.so_far().empty());
    EXPECT_EQ(priors::artery_wall_mm + tissue::fat_hu, priors::artery_wall_mm.value + tissue::fat_hu.value);
    EXPECT_EQ(read.so_far(), (std::vector<const Number*>{&tissue::fat_hu, &priors::artery_wall_mm}));
  }
  const NumbersRead again;
  EXPECT_TRUE(again.so_far().empty());
}

TEST(Sensitivity, OfTheCarotidAloneIsARowPerNumberAndChange) {
  SensitivityCommand command;
  command.size = {24, 24, 24};
  command.spacing_mm = {6, 6, 6};
  command.stages = {"carotid"};
  command.json = true;
  const Json result = Json::parse(printed_by(command));
  std::set<std::string> moved;
  for (const auto& row : result["rows"]) {
    EXPECT_EQ(row["stages"], Json::array({"carotid"}));
    moved.insert(row["number"].get<std::string>());
  }
  EXPECT_EQ(moved, (std::set<std::string>{"carotid_contrast_min_hu", "carotid_edge_hu_per_mm", "carotid_max_ml",
                                          "carotid_section_min_mm2"}));
  EXPECT_EQ(result["rows"].size(), 2 * moved.size());
  EXPECT_EQ(result["not_read"].size() + moved.size(), patient_numbers().size());
}

TEST(Sensitivity, ANumberMovedFarRefusesAndIsFirst) {
  SensitivityCommand command;
  command.size = {24, 24, 24};
  command.spacing_mm = {6, 6, 6};
  command.stages = {"carotid"};
  command.only = {"carotid_section_min_mm2", "carotid_max_ml"};
  command.change = 99;
  command.json = true;
  const Json rows = Json::parse(printed_by(command))["rows"];
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[0]["number"], "carotid_max_ml");
  EXPECT_NEAR(rows[0]["moved_to"].get<double>(), 0.6, 1e-9);
  EXPECT_FALSE(rows[0]["refusal"].get<std::string>().empty());
  for (std::size_t n = 1; n < rows.size(); ++n) EXPECT_TRUE(rows[n]["refusal"].get<std::string>().empty());
}

TEST(Sensitivity, RefusesWhatItDoesNotKnow) {
  SensitivityCommand command;
  command.only = {"fat"};
  EXPECT_THROW(sensitivity_command(command), UserError);
  command = {};
  command.stages = {"mesh"};
  EXPECT_THROW(sensitivity_command(command), UserError);
  command = {};
  command.change = 100;
  EXPECT_THROW(sensitivity_command(command), UserError);
  command = {};
  command.phantoms = 0;
  EXPECT_THROW(sensitivity_command(command), UserError);
}

TEST(Sensitivity, StagesNeedWhatRunsBeforeThem) {
  std::set<std::string> before;
  for (const auto& stage : sensitivity_stages()) {
    for (const auto& need : stage.needs) EXPECT_TRUE(before.contains(need)) << stage.name << " needs " << need;
    EXPECT_TRUE(before.insert(stage.name).second);
  }
}

/// docs/numbers.md holds the table that `heartgen-lab sensitivity --list` prints.
TEST(Sensitivity, TheListIsTheDocumentation) {
  SensitivityCommand command;
  command.list = true;
  const std::string table = printed_by(command);
  std::ifstream in(fs::path(HEARTGEN_TESTS_FOLDER).parent_path() / "docs/numbers.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(page.find(table), std::string::npos) << "heartgen-lab sensitivity --list prints another table:\n" << table;
  EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')), patient_numbers().size() + 2);
}

}  // namespace
}  // namespace heartgen::lab
