#include "exporters/reserved_place.hpp"

#include <gtest/gtest.h>

#include "support/data.hpp"
#include "support/files.hpp"

namespace heart::exporters {
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

TEST(ReservedPlace, AFileInTheWayIsNamed) {
  const auto folder = scratch_folder("place_file");
  testing::write_bytes(folder / "file", "");
  EXPECT_NE(error_of([&] { reserve_place(folder / "file" / "out", Existing::refuse); }).find("cannot be made"),
            std::string::npos);
}

}  // namespace
}  // namespace heart::exporters
