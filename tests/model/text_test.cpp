// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/text.hpp"

#include <gtest/gtest.h>

#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;
using testing::error_of;

TEST(MakeFolderOf, TouchesNoFile) {
  const auto folder = testing::scratch_folder("make_folder_of");
  make_folder_of(folder / "deep" / "er" / "out.json");
  EXPECT_TRUE(fs::is_empty(folder / "deep" / "er"));
  testing::write_bytes(folder / "old.json", "{}");
  make_folder_of(folder / "old.json");
  EXPECT_EQ(testing::bytes_of(folder / "old.json"), "{}");
}

TEST(LiesIn, KnowsFoldersHoweverTheyAreWritten) {
  const auto folder = testing::scratch_folder("lies_in");
  fs::create_directories(folder / "bundle" / "meshes");
  for (const char* path : {"bundle", "bundle/", "bundle/new/file.txt", "bundle/meshes/../x", "other/../bundle/x"})
    EXPECT_TRUE(lies_in(folder / path, folder / "bundle")) << path;
  for (const char* path : {"", "bundle.tar", "bundles/x", "bundle/../x", "meshes"})
    EXPECT_FALSE(lies_in(folder / path, folder / "bundle")) << path;
  fs::create_directory_symlink(folder / "bundle", folder / "link");
  EXPECT_TRUE(lies_in(folder / "link" / "x", folder / "bundle" / ""));
}

TEST(CheckOutput, LeavesNothingBehind) {
  const auto folder = testing::scratch_folder("check_output");
  check_output(folder / "deep" / "er" / "out.json");
  EXPECT_TRUE(fs::is_empty(folder));
  check_output("not_made_yet/out.json");
  EXPECT_FALSE(fs::exists("not_made_yet"));
}

TEST(CheckOutput, RefusesAFolderAndAFileInTheWay) {
  const auto folder = testing::scratch_folder("check_output_refused");
  testing::write_bytes(folder / "file", "");
  // Folders in /proc look as if they could be written, to whoever may write anywhere.
  for (const fs::path& path : {folder, folder / "file" / "out.json", fs::path(""), fs::path("/proc/heart/out.json")})
    EXPECT_NE(error_of([&] { check_output(path); }).find("cannot be written"), std::string::npos) << path;
  EXPECT_NE(error_of([&] { make_folder_of(folder / "file" / "out.json"); }).find("cannot be written"),
            std::string::npos);
}

}  // namespace
}  // namespace heartgen
