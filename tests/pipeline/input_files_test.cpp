// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/input_files.hpp"

#include <gtest/gtest.h>

#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::write_bytes;

class InputFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = testing::scratch_folder(std::string("input_files_") +
                                     ::testing::UnitTest::GetInstance()->current_test_info()->name());
  }
  std::string hash(const char* name) const { return pipeline::hash_input("ct", (folder / name).string()).sha256; }
  fs::path folder;
};

TEST_F(InputFiles, APlainFileIsItself) {
  write_bytes(folder / "ct.nrrd", "voxels");
  EXPECT_EQ(pipeline::files_behind(folder / "ct.nrrd"), std::vector{folder / "ct.nrrd"});
  EXPECT_EQ(hash("ct.nrrd"), exporters::sha256_of_file(folder / "ct.nrrd"));
}

TEST_F(InputFiles, ChangedVoxelsBehindTheSameHeaderAreAnotherInput) {
  write_bytes(folder / "ct.mhd", "NDims = 3\nElementDataFile = ct.raw\n");
  write_bytes(folder / "ct.raw", "voxels");
  write_bytes(folder / "ct.nhdr", "NRRD0004\ndata file: ct.raw\n");
  const auto meta = hash("ct.mhd"), nrrd = hash("ct.nhdr");
  EXPECT_EQ(pipeline::files_behind(folder / "ct.mhd").size(), 2U);
  EXPECT_GT(pipeline::hash_input("ct", (folder / "ct.mhd").string()).bytes, 40);
  write_bytes(folder / "ct.raw", "other!");
  EXPECT_NE(hash("ct.mhd"), meta);
  EXPECT_NE(hash("ct.nhdr"), nrrd);
}

TEST_F(InputFiles, ListsAndPatternsOfSlices) {
  write_bytes(folder / "list.mhd", "ElementDataFile = LIST\na.raw\nb.raw\n");
  write_bytes(folder / "pattern.mhd", "ElementDataFile = %c.raw 97 98 1\n");
  for (const char* name : {"a.raw", "b.raw"}) write_bytes(folder / name, name);
  const auto list = hash("list.mhd"), pattern = hash("pattern.mhd");
  write_bytes(folder / "b.raw", "changed");
  EXPECT_NE(hash("list.mhd"), list);
  EXPECT_NE(hash("pattern.mhd"), pattern);
}

TEST_F(InputFiles, NodesAndElementsOfAnAtlasBelongTogether) {
  write_bytes(folder / "heart.exnode", "nodes");
  write_bytes(folder / "heart.exelem.gz", "elements");
  const auto before = hash("heart.exnode");
  EXPECT_EQ(pipeline::files_behind(folder / "heart.exnode"), pipeline::files_behind(folder / "heart.exelem.gz"));
  write_bytes(folder / "heart.exelem.gz", "others");
  EXPECT_NE(hash("heart.exnode"), before);
}

TEST_F(InputFiles, AFolderIsAllItsFiles) {
  write_bytes(folder / "1.dcm", "a");
  const auto one = hash("");
  write_bytes(folder / "2.dcm", "b");
  EXPECT_NE(hash(""), one);
}

}  // namespace
}  // namespace heartgen::pipeline
