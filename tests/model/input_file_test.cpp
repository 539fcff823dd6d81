// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/input_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

TEST(InputFile, IsAFileThatCanBeRead) {
  const auto folder = testing::scratch_folder("input_file");
  testing::write_bytes(folder / "file", "x");
  std::filesystem::create_symlink("file", folder / "link");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  const auto said = [&](const std::filesystem::path& path) {
    return testing::error_of([&] { require_input_file(path, "look there"); });
  };
  EXPECT_EQ(said(folder / "file"), "");
  EXPECT_EQ(said(folder / "link"), "");
  EXPECT_NE(said(folder / "none").find("does not exist (look there)"), std::string::npos);
  EXPECT_NE(said(folder).find("is a folder"), std::string::npos);
  EXPECT_NE(said(folder / "pipe").find("is a pipe or a device"), std::string::npos);
  EXPECT_NE(said("/dev/zero").find("is a pipe or a device"), std::string::npos);
}

}  // namespace
}  // namespace heartgen
