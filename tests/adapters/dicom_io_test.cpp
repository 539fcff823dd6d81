// SPDX-License-Identifier: GPL-3.0-or-later
// DICOM series written by hand: only what a reader needs, explicit little endian.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "generator/adapters/itk_io.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

template <class T>
std::string bytes(T value) {
  std::string text(sizeof(T), '\0');
  std::memcpy(text.data(), &value, sizeof(T));
  return text;
}

std::string element(int group, int number, const char* kind, std::string value) {
  const std::string type = kind;
  if (value.size() % 2) value += type == "UI" ? '\0' : ' ';
  std::string text = bytes(static_cast<std::uint16_t>(group)) + bytes(static_cast<std::uint16_t>(number)) + type;
  if (type == "OW" || type == "OB")
    text += std::string(2, '\0') + bytes(static_cast<std::uint32_t>(value.size()));
  else
    text += bytes(static_cast<std::uint16_t>(value.size()));
  return text + value;
}

constexpr int rows = 4, columns = 6;
constexpr double pixel_mm = 0.75, slice_mm = 2.5;

struct Slice {
  int instance = 0;
  double y_mm = -40, z_mm = 0;
  std::string series = "1.2.3.4";
  std::string trigger_ms{};
  int more = 0;  ///< added to the values
};

/// Stored values rise along the row and with the height; 1024 lies between them and Hounsfield units.
std::string dicom(const Slice& slice) {
  const std::string ct = "1.2.840.10008.5.1.4.1.1.2", id = fmt::format("1.2.3.9.{}", slice.instance);
  const std::string meta = element(2, 2, "UI", ct) + element(2, 3, "UI", id) +
                           element(2, 0x10, "UI", "1.2.840.10008.1.2.1") + element(2, 0x12, "UI", "1.2.3");
  std::string pixels;
  for (int p = 0; p < rows * columns; ++p)
    pixels += bytes(static_cast<std::uint16_t>(1024 + slice.more + 10 * (p % columns) + static_cast<int>(slice.z_mm)));
  const auto u16 = [](int value) { return bytes(static_cast<std::uint16_t>(value)); };
  return std::string(128, '\0') + "DICM" + element(2, 0, "UL", bytes(static_cast<std::uint32_t>(meta.size()))) + meta +
         element(8, 0x16, "UI", ct) + element(8, 0x18, "UI", id) + element(8, 0x60, "CS", "CT") +
         element(0x18, 0x50, "DS", fmt::format("{}", slice_mm)) +
         (slice.trigger_ms.empty() ? "" : element(0x18, 0x1060, "DS", slice.trigger_ms)) +
         element(0x20, 0x0d, "UI", "1.2.3") + element(0x20, 0x0e, "UI", slice.series) + element(0x20, 0x11, "IS", "1") +
         element(0x20, 0x13, "IS", std::to_string(slice.instance)) +
         element(0x20, 0x32, "DS", fmt::format("-30\\{}\\{}", slice.y_mm, slice.z_mm)) +
         element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0") + element(0x28, 2, "US", u16(1)) +
         element(0x28, 4, "CS", "MONOCHROME2") + element(0x28, 0x10, "US", u16(rows)) +
         element(0x28, 0x11, "US", u16(columns)) +
         element(0x28, 0x30, "DS", fmt::format("{}\\{}", pixel_mm, pixel_mm)) + element(0x28, 0x100, "US", u16(16)) +
         element(0x28, 0x101, "US", u16(16)) + element(0x28, 0x102, "US", u16(15)) +
         element(0x28, 0x103, "US", u16(0)) + element(0x28, 0x1052, "DS", "-1024") + element(0x28, 0x1053, "DS", "1") +
         element(0x7fe0, 0x10, "OW", pixels);
}

std::vector<Slice> typical_series() {
  std::vector<Slice> slices;
  for (int k = 0; k < 8; ++k) slices.push_back({.instance = k + 1, .z_mm = 100 + slice_mm * k});
  return slices;
}

/// File names fall while the slices rise.
std::string written(const std::string& name, const std::vector<Slice>& slices) {
  const auto folder = testing::scratch_folder("dicom_" + name);
  for (std::size_t n = 0; n < slices.size(); ++n)
    testing::write_bytes(folder / fmt::format("image {}", 99 - n), dicom(slices[n]));
  return folder.string();
}

std::string refusal(const std::string& name, const std::vector<Slice>& slices) {
  const auto folder = written(name, slices);
  return testing::error_of([&] { adapters::read_ct(folder); });
}

TEST(Dicom, ASeriesIsStackedByPlaceWithItsRescale) {
  const CtVolume ct = adapters::read_ct(written("usual", typical_series()));
  EXPECT_EQ(ct.grid.size, (Index3{columns, rows, 8}));
  EXPECT_EQ(ct.grid.origin_mm, (Vec3{-30, -40, 100}));
  EXPECT_EQ(ct.grid.spacing_mm, (Vec3{pixel_mm, pixel_mm, slice_mm}));
  EXPECT_EQ(ct(3, 0, 0), 30 + 100);
  EXPECT_EQ(ct(3, 2, 7), 30 + 117);
}

TEST(Dicom, AMissingSliceIsNamed) {
  auto slices = typical_series();
  slices.erase(slices.begin() + 3);
  EXPECT_NE(refusal("missing", slices).find("5.00 mm between slices 3 and 4"), std::string::npos);
}

/// Two phases, the later one's slices first; its values are higher by 500.
std::vector<Slice> two_phases(const std::vector<std::string>& trigger_ms) {
  std::vector<Slice> slices;
  for (const int late : {1, 0})
    for (const auto& slice : typical_series())
      slices.push_back({.instance = slice.instance + (late != 0 ? 0 : 100),
                        .z_mm = slice.z_mm,
                        .trigger_ms = trigger_ms.empty() ? "" : trigger_ms[static_cast<std::size_t>(late)],
                        .more = 500 * late});
  return slices;
}

TEST(Dicom, OneOfTwoPhasesIsChosen) {
  const auto message = refusal("phases", two_phases({"100", "420.5"}));
  EXPECT_NE(message.find("2 volumes"), std::string::npos) << message;
  EXPECT_NE(message.find("--phase 1 to 2"), std::string::npos) << message;
  const auto folder = written("phases", two_phases({"100", "420.5"}));
  const auto alone = adapters::read_ct(written("one_phase", typical_series()));
  const auto first = adapters::read_ct(folder, 1), second = adapters::read_ct(folder, 2);
  EXPECT_EQ(first.voxels, alone.voxels) << "by trigger time, whatever the numbers say";
  ASSERT_EQ(second.voxels.size(), alone.voxels.size());
  for (std::size_t v = 0; v < alone.voxels.size(); ++v) ASSERT_EQ(second.voxels[v], alone.voxels[v] + 500);
  EXPECT_NE(testing::error_of([&] { adapters::read_ct(folder, 3); }).find("no phase 3"), std::string::npos);
  const auto by_number = written("numbered_phases", two_phases({}));
  EXPECT_EQ(adapters::read_ct(by_number, 2).voxels, alone.voxels) << "by number, where nothing else tells";
}

TEST(Dicom, SlicesThatLieTwiceInPlacesAreRefused) {
  auto slices = two_phases({"100", "420.5"});
  slices.pop_back();
  EXPECT_NE(refusal("uneven_phases", slices).find("7 of its 15 slices lie where another"), std::string::npos);
}

TEST(Dicom, ATiltedGantryIsRefused) {
  auto slices = typical_series();
  for (auto& slice : slices) slice.y_mm += 0.3 * (slice.z_mm - 100);
  EXPECT_NE(refusal("tilted", slices).find("tilted gantry"), std::string::npos);
}

TEST(Dicom, ATruncatedSliceIsNamedWhereverItEnds) {
  const fs::path folder = written("truncated", typical_series());
  const auto whole = fs::file_size(folder / "image 95");
  for (const auto bytes : {whole - 10, whole - 30, std::uintmax_t{300}, std::uintmax_t{133}}) {
    fs::resize_file(folder / "image 95", bytes);
    EXPECT_NE(testing::error_of([&] { adapters::read_ct(folder.string()); }), "") << bytes;
  }
}

TEST(Dicom, NoFileOfTheFolderIsDropped) {
  const std::string slice = dicom(typical_series().front());
  std::string without_mark = slice, long_element = slice;
  without_mark[128] = 'X';
  const auto thickness = long_element.find(std::string("\x18\0\x50\0DS", 6));
  ASSERT_NE(thickness, std::string::npos);
  long_element[thickness + 7] = '\x7f';
  for (const auto& [name, contents] : std::map<std::string, std::string>{{"empty", ""},
                                                                         {"short.dcm", slice.substr(0, 100)},
                                                                         {"text.dcm", "not a slice"},
                                                                         {"no mark", without_mark},
                                                                         {"cut", slice.substr(0, slice.size() / 2)},
                                                                         {"long element", long_element}}) {
    const fs::path folder = written("dropped", typical_series());
    testing::write_bytes(folder / name, contents);
    const auto message = testing::error_of([&] { adapters::read_ct(folder.string()); });
    EXPECT_NE(message.find((folder / name).string()), std::string::npos) << name << ": " << message;
    fs::remove(folder / name);
    EXPECT_EQ(adapters::read_ct(folder.string()).grid.size[2], 8) << name;
  }
  const fs::path folder = written("lost link", typical_series());
  fs::create_symlink("nowhere", folder / "slice");
  EXPECT_NE(testing::error_of([&] { adapters::read_ct(folder.string()); }).find("slice"), std::string::npos);
}

TEST(Dicom, NotesAndHiddenFilesAreNoSlices) {
  const fs::path folder = written("notes", typical_series());
  testing::write_bytes(folder / "README", "eight slices of a phantom\n");
  testing::write_bytes(folder / ".DS_Store", std::string(600, '\0'));
  testing::write_bytes(folder / "DICOMDIR", std::string(600, '\0'));
  fs::create_directory(folder / "other");
  EXPECT_EQ(adapters::read_ct(folder.string()).grid.size[2], 8);
}

/// GDCM reads such an element as if its 4 GB were there, and takes them.
TEST(Dicom, ALengthBeyondTheFileIsRefusedBeforeMemoryIsTaken) {
  const fs::path folder = written("4gb", typical_series());
  std::string slice = dicom(typical_series()[3]);
  const auto pixels = slice.find(std::string("\xe0\x7f\x10\0OW", 6));
  ASSERT_NE(pixels, std::string::npos);
  slice.replace(pixels + 8, 4, "\x00\x11\xff\xff", 4);
  testing::write_bytes(folder / "image 96", slice);
  const auto message = testing::error_of([&] { adapters::read_ct(folder.string()); });
  EXPECT_NE(message.find("image 96"), std::string::npos) << message;
  EXPECT_NE(message.find("(7fe0,0010)"), std::string::npos) << message;
}

TEST(Dicom, SequencesOfUndefinedLengthAreFollowed) {
  const fs::path folder = written("sequences", typical_series());
  const std::string undefined_length(4, '\xff');
  const auto head = [&](std::string tag, const std::string& kind) { return tag + kind + undefined_length; };
  const std::string item = head(std::string("\xfe\xff\x00\xe0", 4), ""), ends_item{"\xfe\xff\x0d\xe0\0\0\0\0", 8},
                    ends_sequence{"\xfe\xff\xdd\xe0\0\0\0\0", 8};
  const std::string known = head(std::string("\x08\0\x11\x11", 4), std::string("SQ\0\0", 4)) + item +
                            element(8, 0x1150, "UI", "1.2.3") + ends_item + ends_sequence;
  const std::string implicit = std::string("\x08\0\x50\x11", 4) + bytes(std::uint32_t{6}) + std::string("1.2.3\0", 6);
  const std::string unknown =
      head(std::string("\x09\0\x11\x11", 4), std::string("UN\0\0", 4)) + item + implicit + ends_item + ends_sequence;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::string slice = testing::bytes_of(entry.path());
    slice.insert(slice.find(std::string("\x18\0\x50\0DS", 6)), known + unknown);
    testing::write_bytes(entry.path(), slice);
  }
  EXPECT_EQ(adapters::read_ct(folder.string()).grid.size[2], 8);
  const auto whole = fs::file_size(folder / "image 96");
  fs::resize_file(folder / "image 96", whole - rows * columns * 2 - 60);
  EXPECT_NE(testing::error_of([&] { adapters::read_ct(folder.string()); }).find("image 96"), std::string::npos);
}

TEST(Dicom, SeveralSeriesASingleSliceAndOneFileAreRefused) {
  auto slices = typical_series();
  for (const auto& slice : typical_series())
    slices.push_back({.instance = slice.instance + 100, .z_mm = slice.z_mm, .series = "1.2.3.5"});
  EXPECT_NE(refusal("several", slices).find("2 DICOM series"), std::string::npos);
  EXPECT_NE(refusal("single", {typical_series().front()}).find("single slice"), std::string::npos);
  const fs::path file = fs::path(written("one_file", typical_series())) / "image 99";
  EXPECT_NE(testing::error_of([&] { adapters::read_ct(file.string()); }).find("folder"), std::string::npos);
}

}  // namespace
}  // namespace heartgen
