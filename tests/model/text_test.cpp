#include "model/text.hpp"

#include <gtest/gtest.h>

#include "support/data.hpp"
#include "support/files.hpp"

namespace heart {
namespace {

namespace fs = std::filesystem;
using testing::error_of;

TEST(PrepareOutput, MakesTheFolderAndTouchesNoFile) {
  const auto folder = testing::scratch_folder("prepare_output");
  prepare_output(folder / "deep" / "er" / "out.json");
  EXPECT_TRUE(fs::is_empty(folder / "deep" / "er"));
  testing::write_bytes(folder / "old.json", "{}");
  prepare_output(folder / "old.json");
  EXPECT_EQ(testing::bytes_of(folder / "old.json"), "{}");
}

TEST(CheckOutput, LeavesNothingBehind) {
  const auto folder = testing::scratch_folder("check_output");
  check_output(folder / "deep" / "er" / "out.json");
  EXPECT_TRUE(fs::is_empty(folder));
  check_output("not_made_yet/out.json");
  EXPECT_FALSE(fs::exists("not_made_yet"));
}

TEST(PrepareOutput, RefusesAFolderAndAFileInTheWay) {
  const auto folder = testing::scratch_folder("prepare_output_refused");
  testing::write_bytes(folder / "file", "");
  for (const fs::path& path : {folder, folder / "file" / "out.json", fs::path("")})
    for (const auto& refuse : {check_output, prepare_output})
      EXPECT_NE(error_of([&] { refuse(path); }).find("cannot be written"), std::string::npos) << path;
}

}  // namespace
}  // namespace heart
