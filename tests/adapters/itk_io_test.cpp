// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/itk_io.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iostream>
#include <utility>
#include <vector>

#include "generator/adapters/image_checks.hpp"
#include "model/error.hpp"
#include "model/memory.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

CtVolume small_ct() {
  Grid grid;
  grid.size = {7, 5, 4};
  grid.spacing_mm = {0.7, 0.9, 2.5};
  grid.origin_mm = {-171.7, 12.25, -301.5};
  CtVolume ct(grid);
  for (std::size_t i = 0; i < ct.voxels.size(); ++i) ct.voxels[i] = static_cast<std::int16_t>(37 * i % 1999 - 1000);
  return ct;
}

/// The same patient stored with axes (k, i flipped, j): what scanners and converters do.
CtVolume permuted(const CtVolume& ct) {
  Grid grid;
  grid.size = {ct.grid.size[2], ct.grid.size[0], ct.grid.size[1]};
  grid.spacing_mm = {ct.grid.spacing_mm.z, ct.grid.spacing_mm.x, ct.grid.spacing_mm.y};
  const double last = static_cast<double>(ct.grid.size[0] - 1);
  grid.origin_mm = lps_from_index(ct.grid, {last, 0, 0});
  grid.direction = {{Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{1, 0, 0}}};
  CtVolume out(grid);
  for (std::int64_t k = 0; k < ct.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < ct.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < ct.grid.size[0]; ++i) out(k, ct.grid.size[0] - 1 - i, j) = ct(i, j, k);
  return out;
}

class EveryFormat : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryFormat, GivesBackVoxelsAndGeometryExactly) {
  const auto path = (testing::scratch_folder("itk_io") / GetParam()).string();
  adapters::write_volume(path, small_ct());
  const CtVolume back = adapters::read_ct(path);
  EXPECT_EQ(back.grid, small_ct().grid);
  EXPECT_EQ(back.voxels, small_ct().voxels);
}

TEST_P(EveryFormat, PermutedAndFlippedAxesGiveTheSameVolume) {
  const auto path = (testing::scratch_folder("itk_io_permuted") / GetParam()).string();
  adapters::write_volume(path, permuted(small_ct()));
  const CtVolume back = adapters::read_ct(path);
  EXPECT_EQ(back.grid, small_ct().grid);
  EXPECT_EQ(back.voxels, small_ct().voxels);
}

TEST_P(EveryFormat, TruncatedFileIsRefusedByName) {
  const auto path = (testing::scratch_folder("itk_io_truncated") / GetParam()).string();
  adapters::write_volume(path, small_ct());
  // A header file (.mhd) has its voxels in a file beside it.
  const auto voxels = path.ends_with(".mhd") ? path.substr(0, path.size() - 4) + ".zraw" : path;
  const auto whole = std::filesystem::file_size(voxels);
  // What reads .nrrd does not look at the checksum behind the voxels.
  const std::uintmax_t checksum_bytes = path.ends_with(".nrrd") ? 64 : 1;
  for (const std::uintmax_t left : {whole - checksum_bytes, whole * 9 / 10, whole / 2}) {
    std::filesystem::resize_file(voxels, left);
    try {
      adapters::read_ct(path);
      FAIL() << left << " of " << whole << " bytes were read as if they were all";
    } catch (const UserError& error) {
      EXPECT_EQ(error.where, path);
      EXPECT_FALSE(error.remedy.empty());
    }
  }
}

TEST_P(EveryFormat, RefusesNan) {
  Volume<float> image(small_ct().grid, 1.0F);
  image(2, 2, 2) = std::numeric_limits<float>::quiet_NaN();
  const auto path = (testing::scratch_folder("itk_io_nan") / GetParam()).string();
  adapters::write_volume(path, image);
  EXPECT_THROW(adapters::read_ct(path), UserError);
}

TEST(ItkIo, ADamagedHeaderGivesOneMessageWithoutAddresses) {
  const auto path = (testing::scratch_folder("itk_io_header") / "ct.mha").string();
  testing::write_bytes(path, "ObjectType = Image\nNDims = 3\nnonsense\n");
  ::testing::internal::CaptureStderr();
  const auto message = testing::error_of([&] { adapters::read_ct(path); });
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_NE(message.find("cannot be read"), std::string::npos) << message;
  for (const char* noise : {"0x", "No such file"}) EXPECT_EQ(message.find(noise), std::string::npos) << message;
  EXPECT_TRUE(std::cerr.good());
}

/// A header of ours with one line changed, or a line more.
std::string meta_header(const std::string& key, const std::string& value) {
  std::string text;
  for (const auto& [name, usual] : std::vector<std::pair<std::string, std::string>>{{"ObjectType", "Image"},
                                                                                    {"NDims", "3"},
                                                                                    {"Comment", "none"},
                                                                                    {"BinaryData", "True"},
                                                                                    {"DimSize", "2 2 2"},
                                                                                    {"Offset", "0 0 0"},
                                                                                    {"ElementSpacing", "2 2 2"},
                                                                                    {"ElementType", "MET_SHORT"}})
    text += name + " = " + (name == key ? value : usual) + "\n";
  if (text.find("\n" + key + " =") == std::string::npos) text += key + " = " + value + "\n";
  return text + "ElementDataFile = LOCAL\n" + std::string(16, '\0');
}

/// The library writes all of these into places that are too small for some.
TEST(ReadImage, LinesThatAMetaImageHasNoPlaceForAreRefused) {
  const auto path = (testing::scratch_folder("itk_io_lines") / "x.mha").string();
  const auto message_of = [&](const std::string& key, const std::string& value) {
    testing::write_bytes(path, meta_header(key, value));
    return testing::error_of([&] { adapters::read_image(path); });
  };
  EXPECT_EQ(message_of("Comment", std::string(200, 'c')), "");
  EXPECT_EQ(message_of("TransformMatrix",
                       "1.0000000000000000 0.0000000000000000 0.0000000000000000 0.0000000000000000 "
                       "1.0000000000000000 0.0000000000000000 0.0000000000000000 0.0000000000000000 "
                       "1.0000000000000000"),
            "");
  for (const auto& [key, value] :
       std::vector<std::pair<std::string, std::string>>{{"Comment", std::string(300, 'c')},
                                                        {"ObjectType", std::string(300, 'c')},
                                                        {std::string(300, 'k'), "1"},
                                                        {"NDims", "5000"},
                                                        {"NDims", "0"},
                                                        {"NDims", "three"},
                                                        {"DimSize", "2 2"},
                                                        {"DimSize", "2 2 -2"},
                                                        {"DimSize", "2 2 nan"},
                                                        {"DimSize", "99999 99999 99999"},
                                                        {"DimSize", "2 2 40"},
                                                        {"Offset", std::string(600, '1')},
                                                        {"ElementType", "MET_NONE"},
                                                        {"ElementSize", "1e99 1 1"}}) {
    const auto message = message_of(key, value);
    EXPECT_TRUE(key == "ElementSize" || message.find(path) != std::string::npos) << key << " " << value << message;
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0);
  }
  const auto whole = meta_header("NDims", "3");
  testing::write_bytes(path, std::string(whole).erase(whole.find("NDims"), std::string_view("NDims = 3\n").size()));
  EXPECT_NE(testing::error_of([&] { adapters::read_image(path); }).find("0 dimensions of sizes 2 2 2"),
            std::string::npos);
}

/// Geometry that cannot be, in every format that can say it.
TEST_P(EveryFormat, RefusesOriginsSpacingsAndAxesThatCannotBe) {
  const auto path = (testing::scratch_folder("itk_io_grids") / GetParam()).string();
  const auto refused = [&](const std::function<void(Grid&)>& change) {
    Volume<float> image(small_ct().grid, 1);
    change(image.grid);
    adapters::write_volume(path, image);
    for (const auto& read :
         std::vector<std::function<void()>>{[&] { adapters::read_image(path); }, [&] { adapters::read_ct(path); },
                                            [&] { adapters::read_label_image(path); }})
      if (testing::error_of(read).find(path) == std::string::npos) return false;
    return true;
  };
  EXPECT_FALSE(refused([](Grid&) {}));
  EXPECT_TRUE(refused([](Grid& grid) { grid.origin_mm.y = 1e6; }));
  EXPECT_TRUE(refused([](Grid& grid) { grid.spacing_mm = {1e6, 1e6, 1e6}; }));
  EXPECT_TRUE(refused([](Grid& grid) { grid.spacing_mm = {1e-8, 1e-8, 1e-8}; }));
  if (std::string(GetParam()).find("nii") != std::string::npos) return;  // its writer turns such axes
  EXPECT_TRUE(refused([](Grid& grid) { grid.direction = {{Vec3{1, 0.1, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}}; }));
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat, ::testing::Values("ct.nii", "ct.nii.gz", "ct.nrrd", "ct.mhd", "ct.mha"));

TEST(ReadCt, RefusesMissingFileAndForeignFile) {
  EXPECT_THROW(adapters::read_ct("no/such/file.nii"), UserError);
  const auto path = testing::scratch_folder("itk_io_foreign") / "notes.nii";
  std::ofstream(path) << "not an image";
  EXPECT_THROW(adapters::read_ct(path.string()), UserError);
}

TEST(ReadCt, RefusesAnisotropyBeyondTenToOne) {
  CtVolume ct = small_ct();
  ct.grid.spacing_mm = {0.5, 0.5, 5.1};
  const auto path = (testing::scratch_folder("itk_io_anisotropic") / "ct.nrrd").string();
  adapters::write_volume(path, ct);
  EXPECT_THROW(adapters::read_ct(path), UserError);
}

TEST(ReadCt, RefusesNegativeSpacingOfAMetaImage) {
  const auto path = testing::scratch_folder("itk_io_negative") / "ct.mhd";
  adapters::write_volume(path.string(), small_ct());
  std::string header = testing::bytes_of(path);
  header.insert(header.find("ElementSpacing = ") + 17, "-");
  testing::write_bytes(path, header);
  EXPECT_NE(testing::error_of([&] { adapters::read_ct(path.string()); }).find("not positive"), std::string::npos);
}

TEST(ReadImage, AnExponentIsNoNegativeSpacing) {
  Grid grid;
  grid.size = {4, 3, 2};
  grid.spacing_mm = {2e-5, 3e-5, 4e-5};
  const Volume<float> tiny(grid, 1);
  const auto path = (testing::scratch_folder("itk_io_exponent") / "tiny.mha").string();
  adapters::write_volume(path, tiny);
  EXPECT_NE(testing::bytes_of(path).find("e-05"), std::string::npos);
  EXPECT_EQ(adapters::read_image(path).voxels, tiny.voxels);
}

TEST(ReadCt, RefusesLengthsInAnotherUnit) {
  CtVolume ct = small_ct();
  ct.grid.spacing_mm = 1e-3 * ct.grid.spacing_mm;
  const auto path = (testing::scratch_folder("itk_io_unit") / "ct.nrrd").string();
  adapters::write_volume(path, ct);
  EXPECT_NE(testing::error_of([&] { adapters::read_ct(path); }).find("in mm"), std::string::npos);
}

/// As many slices of 2048 x 2048 x 2048 voxels as have more of them than 32 bits can count.
TEST(WithCanonicalAxes, FindsVoxelsBeyond32Bits) {
  constexpr double needed_bytes = 6e9;
  if (memory_bytes() < 2 * needed_bytes) GTEST_SKIP() << "needs a machine with 12 GB of memory";
  Grid grid;
  grid.size = {2048, 2048, 513};
  grid.direction = {{Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, -1}}};
  LabelVolume slab(grid);
  ASSERT_GT(grid.voxel_count(), std::int64_t{1} << 31);
  EXPECT_EQ(grid.offset(2047, 2047, 512), grid.voxel_count() - 1);
  slab(0, 0, 0) = 1;
  slab(2047, 2047, 512) = 2;
  slab(3, 5, 511) = 3;
  EXPECT_EQ(sample_linear(slab, {2047, 2047, 512}), 2);
  const LabelVolume turned = adapters::with_canonical_axes(slab);
  EXPECT_EQ(turned(2047, 0, 512), 1);
  EXPECT_EQ(turned(0, 2047, 0), 2);
  EXPECT_EQ(turned(2044, 5, 1), 3);
  EXPECT_EQ(std::count(turned.voxels.begin(), turned.voxels.end(), 0), grid.voxel_count() - 3);
}

TEST(CheckGrid, AddressesAllOf2048CubedAndNoMore) {
  Grid grid;
  grid.size = {2048, 2048, 2048};
  EXPECT_EQ(grid.offset(2047, 2047, 2047), (std::int64_t{1} << 33) - 1);
  EXPECT_EQ(testing::error_of([&] { adapters::check_grid(grid, "scan"); }), "");
  grid.size = {2048, 2048, 2049};
  EXPECT_NE(testing::error_of([&] { adapters::check_grid(grid, "scan"); }).find("2049"), std::string::npos);
  grid.size = {std::int64_t{1} << 32, std::int64_t{1} << 32, 1};  // 0 voxels, if 64 bits ran over
  EXPECT_NE(testing::error_of([&] { adapters::check_grid(grid, "scan"); }), "");
}

TEST(ReadLabels, RefusesFractions) {
  const auto path = (testing::scratch_folder("itk_io_fraction") / "labels.nrrd").string();
  adapters::write_volume(path, Volume<float>(small_ct().grid, 0.5F));
  EXPECT_THROW(adapters::read_labels(path), UserError);
}

TEST(ReadCt, RealDicomSeriesHasItsSlices) {
  const auto folder = testing::real_data("chest-dicom-small");
  if (folder.empty()) GTEST_SKIP() << "real data absent";
  const CtVolume ct = adapters::read_ct(folder);
  EXPECT_EQ(ct.grid.size, (Index3{100, 100, 47}));
  EXPECT_NEAR(ct.grid.spacing_mm.z, 6, 1e-6);
  EXPECT_GT(ct.grid.direction[2].z, 0.99);
}

TEST(ReadCt, RealScansHaveThePatientUpright) {
  const auto path = testing::real_data("chest-ct-lidc-0001/ct.nii.gz");
  if (path.empty()) GTEST_SKIP() << "real data absent";
  const CtVolume ct = adapters::read_ct(path);
  EXPECT_EQ(ct.grid.size, (Index3{512, 512, 133}));
  // The table lies behind the patient: brighter than air at the back, air in front.
  EXPECT_GT(ct.grid.direction[1].y, 0.99);
}

}  // namespace
}  // namespace heartgen
