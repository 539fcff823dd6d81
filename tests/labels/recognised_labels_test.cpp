// SPDX-License-Identifier: GPL-3.0-or-later
// Labels whose numbering nobody names: recognised by names, by values and where these lie.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "generator/adapters/itk_io.hpp"
#include "generator/labels/given_labels.hpp"
#include "labels/toy_heart.hpp"
#include "model/error.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen::labels {
namespace {

namespace fs = std::filesystem;
using testing::toy_heart;
using enum Region;

using Numbers = std::map<Region, int>;
const Numbers heartchambers = {{lv_myocardium, 1}, {la_blood, 2}, {lv_blood, 3}, {ra_blood, 4}, {rv_blood, 5}};
const Numbers imagechd = {{lv_blood, 1}, {rv_blood, 2}, {la_blood, 3}, {ra_blood, 4}, {lv_myocardium, 5}};
const Numbers mm_whs = {{lv_myocardium, 205}, {la_blood, 420}, {lv_blood, 500}, {ra_blood, 550}, {rv_blood, 600}};
const Numbers slicer = {{lv_blood, 3}, {lv_myocardium, 4}, {rv_blood, 9}, {la_blood, 1}, {ra_blood, 2}};

class Recognised : public ::testing::Test {
 protected:
  fs::path folder = testing::scratch_folder("recognised_labels");

  std::string write(const std::string& name, const Numbers& numbers) const {
    const auto toy = toy_heart();
    Volume<std::int16_t> image(toy.grid);
    for (std::size_t v = 0; v < toy.voxels.size(); ++v)
      if (const auto at = numbers.find(static_cast<Region>(toy.voxels[v])); at != numbers.end())
        image.voxels[v] = static_cast<std::int16_t>(at->second);
    adapters::write_volume((folder / name).string(), image);
    return (folder / name).string();
  }
  static GivenLabels read(const std::string& path) {
    InputSettings input;
    input.labels = path;
    return read_given_labels(input, {}, nullptr);
  }
  static void expect_heart(const GivenLabels& given, const Numbers& numbers, const std::string& preset) {
    const auto toy = toy_heart();
    for (std::size_t v = 0; v < toy.voxels.size(); ++v)
      if (numbers.contains(static_cast<Region>(toy.voxels[v]))) {
        ASSERT_EQ(given.labels.voxels[v], toy.voxels[v]);
      }
    const auto& text = given.warnings.at(1).text;
    EXPECT_NE(text.find("preset \"" + preset + "\""), std::string::npos) << text;
  }
};

TEST_F(Recognised, ByValuesAndWhereTheyLie) {
  expect_heart(read(write("a.nii.gz", heartchambers)), heartchambers, "totalsegmentator_heart");
  expect_heart(read(write("b.nii.gz", imagechd)), imagechd, "imagechd");
  expect_heart(read(write("c.nrrd", mm_whs)), mm_whs, "mm_whs");
  Numbers own;
  for (const auto& [region, number] : mm_whs) own[region] = tag(region);
  expect_heart(read(write("d.nii.gz", own)), own, "heartgen");
}

/// Puts a table of names behind the header, as TotalSegmentator does.
void add_names(const std::string& path, const std::map<int, std::string>& names) {
  std::string bytes = testing::bytes_of(path);
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?> <CaretExtension> <VolumeInformation Index=\"0\"> <LabelTable>";
  for (const auto& [value, name] : names)
    xml += fmt::format("<Label Key=\"{}\" Red=\"1\" Green=\"0\" Blue=\"0\" Alpha=\"1\"><![CDATA[{}]]></Label>\n", value,
                       name);
  xml += "  </LabelTable>  <StudyMetaDataLinkSet>  </StudyMetaDataLinkSet> </VolumeInformation></CaretExtension>";
  xml.resize((xml.size() + 8 + 15) / 16 * 16 - 8, '\0');
  const auto size = static_cast<std::int32_t>(xml.size() + 8), code = std::int32_t{0};
  std::string extension(8, '\0');
  std::memcpy(extension.data(), &size, 4);
  std::memcpy(extension.data() + 4, &code, 4);
  const float offset = 352.0F + static_cast<float>(size);
  std::memcpy(bytes.data() + 108, &offset, 4);
  bytes[348] = 1;
  bytes.insert(352, extension + xml);
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST_F(Recognised, ByTheNamesInANiftiHeader) {
  const auto path = write("named.nii", slicer);
  add_names(path, {{1, "heart_atrium_left"},
                   {2, "heart_atrium_right"},
                   {3, "heart_ventricle_left"},
                   {4, "heart_myocardium"},
                   {9, "heart_ventricle_right"},
                   {77, "spleen"}});
  expect_heart(read(path), slicer, "totalsegmentator");
  const auto usual = write("usual.nii", slicer);
  add_names(usual, {{1, "LA"}, {2, "RA"}, {3, "LV blood"}, {4, "LV wall"}, {9, "RV blood"}});
  expect_heart(read(usual), slicer, "names");
}

TEST_F(Recognised, UnknownNamesAreToldAllAtOnce) {
  const auto path = write("unknown.nii", slicer);
  add_names(path, {{1, "LA"}, {2, "gizzard"}, {3, "LV blood"}, {4, "kidney stone"}, {9, "RV blood"}});
  const auto message = testing::error_of([&] { read(path); });
  for (const char* name : {"\"gizzard\"", "\"kidney stone\""})
    EXPECT_NE(message.find(name), std::string::npos) << message;
}

TEST_F(Recognised, UnknownValuesAreToldAllAtOnce) {
  const auto message = testing::error_of([&] { read(write("values.nii.gz", {{lv_blood, 301}, {la_blood, 302}})); });
  EXPECT_NE(message.find("301, 302"), std::string::npos) << message;
}

TEST_F(Recognised, ADamagedTableOfNamesHasNone) {
  const auto path = write("damaged.nii", heartchambers);
  add_names(path, {{1, ""}, {2, "LA"}});
  auto bytes = testing::bytes_of(path);
  bytes.replace(bytes.find("</Label>", bytes.find("LA]]")), 8, "        ");
  std::ofstream(path, std::ios::binary) << bytes;
  expect_heart(read(path), heartchambers, "totalsegmentator_heart");
}

}  // namespace
}  // namespace heartgen::labels
