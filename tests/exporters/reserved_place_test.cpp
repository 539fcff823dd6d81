// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/reserved_place.hpp"

#include <gtest/gtest.h>

#include "exporters/bundle.hpp"
#include "exporters/files.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen::exporters {
namespace {

namespace fs = std::filesystem;
using testing::error_of;
using testing::scratch_folder;

TEST(ReservedPlace, IsOneRunsAloneAndLeavesNothing) {
  const auto folder = scratch_folder("place_alone");
  {
    const auto place = reserve_place(folder / "out", Existing::refuse);
    EXPECT_TRUE(fs::is_empty(place.partial));
    EXPECT_NE(error_of([&] { reserve_place(folder / "out", Existing::refuse); }).find("another run"),
              std::string::npos);
    EXPECT_EQ(error_of([&] { reserve_place(folder / "other", Existing::refuse); }), "");
  }
  EXPECT_TRUE(fs::is_empty(folder));
  EXPECT_EQ(error_of([&] { reserve_place(folder / "out", Existing::refuse); }), "");
}

TEST(ReservedPlace, IsMovedIntoItsPlace) {
  const auto folder = scratch_folder("place_moved");
  {
    const auto place = reserve_place(folder / "out", Existing::refuse);
    testing::write_bytes(place.partial / "file", "new");
    move_into_place(place, Existing::refuse);
  }
  EXPECT_EQ(testing::bytes_of(folder / "out" / "file"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
}

TEST(ReservedPlace, WhatIsNoBundleStaysWhatever) {
  const auto folder = scratch_folder("place_photos");
  fs::create_directory(folder / "photos");
  testing::write_bytes(folder / "photos" / "cat.jpg", "meow");
  for (const auto existing : {Existing::refuse, Existing::replace})
    EXPECT_NE(error_of([&] { reserve_place(folder / "photos", existing); }).find("not a bundle"), std::string::npos);
  // Put there while the bundle was made.
  const auto place = reserve_place(folder / "late", Existing::replace);
  fs::create_directory(folder / "late");
  testing::write_bytes(folder / "late" / "cat.jpg", "meow");
  EXPECT_NE(error_of([&] { move_into_place(place, Existing::replace); }).find("not a bundle"), std::string::npos);
  EXPECT_EQ(testing::bytes_of(folder / "late" / "cat.jpg"), "meow");
}

/// A bundle of one file, as any version writes it.
void write_small_bundle(const fs::path& folder, const std::string& recipe) {
  fs::create_directories(folder / "logs");
  testing::write_bytes(folder / "recipe.toml", recipe);
  testing::write_bytes(folder / "logs" / "build.log", "1 s");
  testing::write_bytes(folder / "manifest.json", R"({"schema": "heartgen-bundle-9", "files": [{"path": "recipe.toml",
      "bytes": 1, "sha256": ")" + sha256_of_text(recipe) +
                                                     "\"}]}");
}

TEST(ReservedPlace, NothingThatIsNotTheBundlesOwnIsReplaced) {
  const auto folder = scratch_folder("place_foreign"), out = folder / "out";
  write_small_bundle(out, "old");
  const auto refused = [&] { return error_of([&] { reserve_place(out, Existing::replace); }); };
  EXPECT_EQ(refused(), "");
  for (const char* file : {"notes.txt", "logs/mine.log", "my_simulation/results.dat"}) {
    fs::create_directories((out / file).parent_path());
    testing::write_bytes(out / file, "important");
    EXPECT_NE(refused().find(std::string("not in its manifest: ") + file), std::string::npos) << refused();
    EXPECT_EQ(testing::bytes_of(out / file), "important");
    fs::remove(out / file);
  }
  EXPECT_NE(refused().find("my_simulation"), std::string::npos) << "an empty folder is the user's too";
  fs::remove(out / "my_simulation");
  fs::create_symlink("recipe.toml", out / "link");
  EXPECT_NE(refused().find("not in its manifest: link"), std::string::npos) << refused();
  fs::remove(out / "link");
  testing::write_bytes(out / "recipe.toml", "mine");
  EXPECT_NE(refused().find("recipe.toml (changed)"), std::string::npos) << refused();
  EXPECT_EQ(testing::bytes_of(out / "recipe.toml"), "mine");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
}

TEST(ReservedPlace, WhatCameWhileTheBundleWasMadeStays) {
  const auto folder = scratch_folder("place_late"), out = folder / "out";
  write_small_bundle(out, "old");
  const auto place = reserve_place(out, Existing::replace);
  testing::write_bytes(place.partial / "recipe.toml", "new");
  testing::write_bytes(out / "results.dat", "important");
  EXPECT_NE(error_of([&] { move_into_place(place, Existing::replace); }).find("results.dat"), std::string::npos);
  EXPECT_EQ(testing::bytes_of(out / "results.dat"), "important");
  fs::remove(out / "results.dat");
  move_into_place(place, Existing::replace);
  EXPECT_EQ(testing::bytes_of(out / "recipe.toml"), "new");
}

TEST(ReservedPlace, AnOlderBundleLeftAsideIsPutBackAndTold) {
  const auto folder = scratch_folder("place_old"), out = folder / "out", old = folder / ".out.old";
  write_small_bundle(old, "old");
  EXPECT_NE(error_of([&] { require_bundle_folder(out); }).find(".out.old"), std::string::npos);
  const auto refused = error_of([&] { reserve_place(out, Existing::refuse); });
  EXPECT_NE(refused.find("put back"), std::string::npos) << refused;
  EXPECT_NE(refused.find("a bundle is there already"), std::string::npos) << refused;
  EXPECT_EQ(testing::bytes_of(out / "recipe.toml"), "old");
  fs::rename(out, old);
  EXPECT_NE(reserve_place(out, Existing::replace).remark.find("put back"), std::string::npos);
  EXPECT_EQ(testing::bytes_of(out / "recipe.toml"), "old");
  EXPECT_FALSE(fs::exists(old));
}

TEST(ReservedPlace, AnOlderBundleThatIsReplacedAlreadyGoesUnlessItHoldsMore) {
  const auto folder = scratch_folder("place_both"), out = folder / "out", old = folder / ".out.old";
  write_small_bundle(out, "new");
  write_small_bundle(old, "old");
  testing::write_bytes(old / "results.dat", "important");
  EXPECT_NE(reserve_place(out, Existing::replace).remark.find("move them away"), std::string::npos);
  EXPECT_EQ(testing::bytes_of(old / "results.dat"), "important");
  fs::remove(old / "results.dat");
  EXPECT_NE(reserve_place(out, Existing::replace).remark.find("removed"), std::string::npos);
  EXPECT_FALSE(fs::exists(old));
  EXPECT_EQ(testing::bytes_of(out / "recipe.toml"), "new");
  EXPECT_EQ(reserve_place(out, Existing::replace).remark, "");
}

TEST(ReservedPlace, FoldersMadeForItGoWithIt) {
  const auto folder = scratch_folder("place_deep");
  { const auto place = reserve_place(folder / "a" / "b" / "out", Existing::refuse); }
  EXPECT_TRUE(fs::is_empty(folder));
  {
    const auto place = reserve_place(folder / "a" / "b" / "out", Existing::refuse);
    move_into_place(place, Existing::refuse);
  }
  EXPECT_TRUE(fs::exists(folder / "a" / "b" / "out"));
}

TEST(ReservedPlace, AFileInTheWayIsNamed) {
  const auto folder = scratch_folder("place_file");
  testing::write_bytes(folder / "file", "");
  EXPECT_NE(error_of([&] { reserve_place(folder / "file" / "out", Existing::refuse); }).find("cannot be made"),
            std::string::npos);
}

}  // namespace
}  // namespace heartgen::exporters
