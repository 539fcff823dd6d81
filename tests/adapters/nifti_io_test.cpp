// SPDX-License-Identifier: GPL-3.0-or-later
// Headers as other programs write them, made by changing bytes of a file of ours.
#include <gtest/gtest.h>

#include <cstring>

#include "generator/adapters/itk_io.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

constexpr std::size_t datatype_at = 70, bits_at = 72, spacing_at = 80, units_at = 123, quaternion_offset_at = 268,
                      matrix_at = 280, voxels_at = 352;

CtVolume small_ct() {
  Grid grid;
  grid.size = {5, 4, 3};
  grid.spacing_mm = {0.7, 0.9, 2.5};
  grid.origin_mm = {-171.7, 12.25, -301.5};
  CtVolume ct(grid);
  for (std::size_t i = 0; i < ct.voxels.size(); ++i) ct.voxels[i] = static_cast<std::int16_t>(37 * i % 1999 - 1000);
  return ct;
}

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

std::string header_of_ours(const std::filesystem::path& folder) {
  adapters::write_volume((folder / "ours.nii").string(), small_ct());
  return testing::bytes_of(folder / "ours.nii");
}

TEST(Nifti, LengthsInMetresAndMicrometresBecomeMillimetres) {
  const auto folder = testing::scratch_folder("nifti_units");
  for (const auto& [code, per_mm] : {std::pair{'\x01', 1e-3}, {'\x02', 1.0}, {'\x03', 1e3}}) {
    std::string bytes = header_of_ours(folder);
    bytes[units_at] = code;
    const auto scale = [&](std::size_t from, std::size_t count) {
      for (std::size_t at = from; at < from + 4 * count; at += 4)
        put(bytes, at, static_cast<float>(per_mm * static_cast<double>(value_at<float>(bytes, at))));
    };
    scale(spacing_at, 3);
    scale(quaternion_offset_at, 3);
    scale(matrix_at, 12);
    testing::write_bytes(folder / "other.nii", bytes);
    EXPECT_EQ(adapters::read_ct((folder / "other.nii").string()).grid, small_ct().grid) << per_mm;
  }
}

TEST(Nifti, LabelsOf64BitsAreRead) {
  const auto folder = testing::scratch_folder("nifti_64_bits");
  std::string bytes = header_of_ours(folder).substr(0, voxels_at);
  put<std::int16_t>(bytes, datatype_at, 1024);
  put<std::int16_t>(bytes, bits_at, 64);
  const std::size_t count = small_ct().voxels.size();
  bytes.resize(voxels_at + 8 * count);
  for (std::size_t v = 0; v < count; ++v) put(bytes, voxels_at + 8 * v, static_cast<std::int64_t>(v % 18));
  testing::write_bytes(folder / "labels.nii", bytes);
  const LabelVolume labels = adapters::read_labels((folder / "labels.nii").string());
  for (std::size_t v = 0; v < count; ++v) ASSERT_EQ(labels.voxels[labels.voxels.size() - 1 - v], (count - 1 - v) % 18);
}

TEST(Nifti, OneVolumeOfSeveralIsChosen) {
  constexpr std::size_t dimensions_at = 40;
  const auto folder = testing::scratch_folder("nifti_4d");
  std::string bytes = header_of_ours(folder);
  const std::string one = bytes.substr(voxels_at);
  put<std::int16_t>(bytes, dimensions_at, 4);
  put<std::int16_t>(bytes, dimensions_at + 8, 3);
  for (const std::int16_t more : {1, 2}) {
    std::string other = one;
    for (std::size_t at = 0; at < other.size(); at += 2)
      put<std::int16_t>(other, at, static_cast<std::int16_t>(value_at<std::int16_t>(one, at) + more));
    bytes += other;
  }
  const std::string path = (folder / "phases.nii").string();
  testing::write_bytes(path, bytes);
  auto expected = small_ct();
  for (const int phase : {1, 2, 3}) {
    const auto ct = adapters::read_ct(path, phase);
    EXPECT_EQ(ct.grid, expected.grid);
    EXPECT_EQ(ct.voxels, expected.voxels) << phase;
    for (auto& value : expected.voxels) ++value;
  }
  for (const int phase : {0, 4, -1})
    EXPECT_NE(testing::error_of([&] { adapters::read_ct(path, phase); }).find("--phase 1 to 3"), std::string::npos);
  EXPECT_NE(testing::error_of([&] { adapters::read_ct((folder / "ours.nii").string(), 2); }).find("no phase 2"),
            std::string::npos);
  testing::write_bytes(path, bytes.substr(0, bytes.size() - 7));
  EXPECT_NE(testing::error_of([&] { adapters::read_ct(path, 1); }), "") << "cut off in another phase";
}

TEST(Nifti, Version2IsNamed) {
  const auto path = testing::scratch_folder("nifti_2") / "ct.nii";
  std::string bytes(1000, '\0');
  put<std::int32_t>(bytes, 0, 540);
  testing::write_bytes(path, bytes);
  EXPECT_NE(testing::error_of([&] { adapters::read_ct(path.string()); }).find("version 2"), std::string::npos);
}

}  // namespace
}  // namespace heartgen
