// SPDX-License-Identifier: GPL-3.0-or-later
// What a user meets first: --help, and a build without a recipe.
#include <gtest/gtest.h>

#include "support/data.hpp"
#include "support/program.hpp"

namespace heartgen::app {
namespace {

std::string help_of(const std::string& command) {
  return testing::heartgen(command + " --help", testing::scratch_folder("help").string()).output;
}

TEST(Help, GoesAlongTheRoads) {
  const auto text = help_of("");
  std::size_t at = 0;
  for (const char* line : {"You have a scan", "  build ", "You have a bundle", "  export ", "You have an image",
                           "  filter ", "You have a label map", "  improve ", "You have nothing yet", "  phantom "}) {
    const auto found = text.find(line, at);
    ASSERT_NE(found, std::string::npos) << line << "\n" << text;
    at = found;
  }
  EXPECT_EQ(text.find("Subcommands:"), std::string::npos) << "a command belongs to no road";
  EXPECT_EQ(text.find("  study "), std::string::npos);
}

TEST(Help, EveryCommandHasAnExample) {
  for (const char* command : {"build",  "landmarks", "place",    "info",    "verify",  "validate", "report",
                              "export", "transfer",  "pack",     "unpack",  "get",     "mesh",     "improve",
                              "slice",  "filter",    "contours", "segment", "inpaint", "phantom",  "selftest"})
    EXPECT_NE(help_of(command).find(std::string("heartgen ") + command), std::string::npos) << command;
}

TEST(Build, NeedsNoRecipe) {
  const auto folder = testing::scratch_folder("no_recipe").string();
  const auto nothing = testing::heartgen("build --output out", folder);
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_NE(nothing.errors.find("no CT given"), std::string::npos) << nothing.errors;
  const auto missing = testing::heartgen("build --ct none.nii.gz --output out", folder);
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_NE(missing.errors.find("none.nii.gz"), std::string::npos) << missing.errors;
}

}  // namespace
}  // namespace heartgen::app
