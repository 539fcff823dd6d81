// SPDX-License-Identifier: GPL-3.0-or-later
// Labels from elsewhere: values, names, folders, other grids, and what they replace.
#include "generator/labels/given_labels.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "generator/adapters/itk_io.hpp"
#include "generator/labels/judge.hpp"
#include "generator/labels/names_file.hpp"
#include "generator/labels/presets.hpp"
#include "model/error.hpp"
#include "support/data.hpp"

namespace heartgen::labels {
namespace {

namespace fs = std::filesystem;

Grid small_grid() {
  Grid grid;
  grid.size = {6, 5, 4};
  grid.spacing_mm = {1, 2, 3};
  grid.origin_mm = {-10, 20, 30};
  return grid;
}

/// Voxel (i, 0, 0) holds the i-th value; the rest is background.
Volume<std::int16_t> row_of(const std::vector<std::int16_t>& values) {
  Volume<std::int16_t> image(small_grid());
  std::copy(values.begin(), values.end(), image.voxels.begin());
  return image;
}

class GivenLabelsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = testing::scratch_folder(std::string("given_labels_") +
                                     ::testing::UnitTest::GetInstance()->current_test_info()->name());
    input.labels = (folder / "seg.nii.gz").string();
  }

  LabelVolume read(const Grid* grid = nullptr) const { return read_given_labels(input, settings, grid).labels; }

  UserError refusal(const Grid* grid = nullptr) const {
    try {
      read(grid);
    } catch (const UserError& error) {
      return error;
    }
    ADD_FAILURE() << "was accepted";
    return {"", "", ""};
  }

  void write_text_file(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }

  void write_mask(const std::string& name, std::int64_t first, std::int64_t last) const {
    LabelVolume mask(small_grid());
    for (std::int64_t i = first; i <= last; ++i) mask(i, 0, 0) = 1;
    adapters::write_volume((folder / "masks" / name).string(), mask);
  }

  fs::path folder;
  InputSettings input;
  LabelSettings settings;
};

TEST(LabelPresets, NumberTheStructuresAsTheirProgramsDo) {
  const auto& v2 = label_preset("totalsegmentator").values;
  EXPECT_EQ(v2.size(), 117U);
  EXPECT_EQ(v2.at(16).name, "trachea");
  EXPECT_EQ(v2.at(26).name, "vertebrae_S1");
  EXPECT_EQ(v2.at(27).name, "vertebrae_L5");
  EXPECT_EQ(v2.at(50).name, "vertebrae_C1");
  EXPECT_EQ(v2.at(51).name, "heart");
  EXPECT_EQ(v2.at(51).region, Region::none);  // one blob has no chambers
  EXPECT_EQ(v2.at(52).region, Region::aorta);
  EXPECT_EQ(v2.at(53).name, "pulmonary_vein");
  EXPECT_EQ(v2.at(79).name, "spinal_cord");
  EXPECT_EQ(v2.at(91).name, "skull");
  EXPECT_EQ(v2.at(92).name, "rib_left_1");
  EXPECT_EQ(v2.at(115).name, "rib_right_12");
  EXPECT_EQ(v2.at(115).region, Region::bone);
  EXPECT_EQ(v2.at(117).name, "costal_cartilages");
  const auto& v1 = label_preset("totalsegmentator_v1").values;
  EXPECT_EQ(v1.size(), 104U);
  EXPECT_EQ(v1.at(43).name, "trachea");
  EXPECT_EQ(v1.at(44).region, Region::lv_myocardium);
  EXPECT_EQ(v1.at(49).region, Region::pulmonary_artery);
  EXPECT_EQ(v1.at(70).name, "rib_right_1");
  EXPECT_EQ(v1.at(93).name, "face");
  EXPECT_EQ(v1.at(104).name, "urinary_bladder");
  const auto& heart = label_preset("totalsegmentator_heart").values;
  EXPECT_EQ(heart.size(), 7U);
  EXPECT_EQ(heart.at(2).region, Region::la_blood);
  EXPECT_EQ(heart.at(5).region, Region::rv_blood);
  EXPECT_EQ(label_preset("mm_whs").values.at(550).region, Region::ra_blood);
  EXPECT_THROW(label_preset("totalsegmenter"), UserError);
}

TEST(LabelPresets, OwnTagsMeanThemselves) {
  const auto& own = label_preset("heartgen");
  for (const auto& row : region_table()) {
    if (is_annulus(static_cast<Region>(row.tag))) continue;  // of meshes alone
    EXPECT_EQ(tag(own.values.at(row.tag).region), row.tag);
    EXPECT_EQ(tag(own.names.at(std::string(row.name))), row.tag);
  }
}

TEST(LabelNames, AreComparedWithoutCaseAndPunctuation) {
  EXPECT_EQ(plain_name(" Left-Ventricle  (blood)"), "left_ventricle_blood");
  EXPECT_EQ(plain_name("rib_left_12"), "rib_left_12");
  EXPECT_EQ(plain_name("--"), "");
  EXPECT_EQ(plain_name("左心房 (1)"), "左心房_1");
  EXPECT_NE(plain_name("左心房"), plain_name("左心室"));
}

TEST_F(GivenLabelsTest, ValuesOfAPreset) {
  adapters::write_volume(input.labels, row_of({205, 420, 500, 550, 600, 850}));
  settings.preset = "mm_whs";
  const LabelVolume labels = read();
  const Region expected[] = {Region::lv_myocardium, Region::la_blood, Region::lv_blood,
                             Region::ra_blood,      Region::rv_blood, Region::pulmonary_artery};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(labels(i, 0, 0), tag(expected[i])) << i;
  EXPECT_EQ(labels(0, 1, 0), 0);
}

TEST_F(GivenLabelsTest, UnknownValueIsNamedWithItsFileAndARemedy) {
  adapters::write_volume(input.labels, row_of({500, 333}));
  settings.preset = "mm_whs";
  const UserError error = refusal();
  EXPECT_NE(error.problem.find("333"), std::string::npos);
  EXPECT_EQ(error.where, input.labels);
  EXPECT_NE(error.remedy.find("labels.ignore"), std::string::npos);
  settings.ignore.keys = {"333"};
  EXPECT_EQ(read()(1, 0, 0), 0);
  settings.ignore.keys = {"*"};
  EXPECT_EQ(read()(0, 0, 0), tag(Region::lv_blood));
}

TEST_F(GivenLabelsTest, TheUsersMapGoesBeforeThePreset) {
  adapters::write_volume(input.labels, row_of({500, 333, 600}));
  settings.preset = "mm_whs";
  settings.regions["rv_blood"].keys = {"333", "500"};
  settings.ignore.keys = {"right ventricle blood cavity"};  // the preset's name for 600
  const LabelVolume labels = read();
  EXPECT_EQ(labels(0, 0, 0), tag(Region::rv_blood));
  EXPECT_EQ(labels(1, 0, 0), tag(Region::rv_blood));
  EXPECT_EQ(labels(2, 0, 0), 0);
  settings.regions["aorta"].keys = {"820"};
  EXPECT_NE(refusal().problem.find("820"), std::string::npos);  // mapped, and no voxel has it
  settings.regions["aorta"].keys = {"500"};
  EXPECT_NE(refusal().problem.find("two regions"), std::string::npos);
}

TEST_F(GivenLabelsTest, FractionsAndMapsWithoutAnyRegionAreRefused) {
  Volume<float> image(small_grid());
  image(1, 1, 1) = 0.5F;
  adapters::write_volume(input.labels, image);
  EXPECT_NE(refusal().problem.find("0.5"), std::string::npos);
  adapters::write_volume(input.labels, row_of({51}));
  settings.preset = "totalsegmentator";
  EXPECT_NE(refusal().problem.find("no region at all"), std::string::npos);
}

TEST_F(GivenLabelsTest, NamesFilesInCsvAndJson) {
  const auto names_of = [&](const std::string& file, const std::string& text) {
    write_text_file(file, text);
    return read_label_names((folder / file).string());
  };
  const std::map<std::int32_t, std::string> expected = {{1, "spleen"}, {52, "aorta"}};
  EXPECT_EQ(names_of("a.csv", "group,original_idx,structure,id\norgans,1,spleen,1\ncardiac,2,aorta,52"), expected);
  EXPECT_EQ(names_of("b.csv", "1,spleen\r\n52,\"aorta\"\r\n"), expected);
  EXPECT_EQ(names_of("c.csv", "aorta\t52\nspleen\t1\n"), expected);
  EXPECT_EQ(names_of("d.json", R"({"1": "spleen", "52": "aorta"})"), expected);
  EXPECT_EQ(names_of("e.json", R"({"labels": {"aorta": 52, "spleen": 1}})"), expected);
  EXPECT_THROW(names_of("f.csv", "1,spleen\n1,aorta\n"), UserError);
  EXPECT_THROW(names_of("g.csv", "1,spleen\nx,aorta\n"), UserError);
  EXPECT_THROW(names_of("h.csv", "kind,colour\n1,red\n"), UserError);
  EXPECT_THROW(names_of("i.csv", ""), UserError);
  EXPECT_THROW(names_of("j.json", R"({"1": 2.5})"), UserError);
}

TEST_F(GivenLabelsTest, NamesGoBeforeThePresetsValues) {
  adapters::write_volume(input.labels, row_of({52, 118}));
  settings.preset = "totalsegmentator";
  input.label_names = (folder / "names.csv").string();
  write_text_file("names.csv", "118,aorta\n52,costal_cartilages\n");
  const LabelVolume labels = read();
  EXPECT_EQ(labels(0, 0, 0), 0);
  EXPECT_EQ(labels(1, 0, 0), tag(Region::aorta));
}

TEST_F(GivenLabelsTest, AFolderOfMasksIsReadByItsNames) {
  input.labels = (folder / "masks").string();
  fs::create_directories(input.labels);
  write_mask("heart_ventricle_left.nii.gz", 0, 1);
  write_mask("body_trunc.nii.gz", 0, 5);  // overlaps the others, and lies below them
  write_mask("rib_right_3.nrrd", 3, 4);
  write_mask("spleen.nii.gz", 2, 2);
  write_text_file("masks/notes.txt", "not an image");
  settings.preset = "totalsegmentator";
  const LabelVolume labels = read();
  EXPECT_EQ(labels(1, 0, 0), tag(Region::lv_blood));
  EXPECT_EQ(labels(2, 0, 0), tag(Region::torso));
  EXPECT_EQ(labels(3, 0, 0), tag(Region::bone));
  EXPECT_EQ(labels(5, 0, 0), tag(Region::torso));
  write_mask("heart_ventricle_lft.nii.gz", 0, 1);
  EXPECT_NE(refusal().remedy.find("heart_ventricle_left"), std::string::npos);
  settings.ignore.keys = {"heart_ventricle_lft"};
  EXPECT_EQ(read().voxels, labels.voxels);
}

std::string slicer_header(const std::string& dimension, const std::string& sizes) {
  return "NRRD0004\ntype: unsigned char\ndimension: " + dimension + "\nspace: left-posterior-superior\n" + sizes +
         "encoding: raw\nspace origin: (0,0,0)\n"
         "Segment0_ID:=Segment_1\nSegment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Name:=LV cavity\n"
         "Segment1_ID:=Segment_2\nSegment1_LabelValue:=2\nSegment1_Layer:=0\nSegment1_Name:=aorta\n"
         "Segment2_ID:=Segment_3\nSegment2_LabelValue:=1\nSegment2_Layer:=LAYER\nSegment2_Name:=torso\n\n";
}

TEST_F(GivenLabelsTest, ASlicerSegmentationBringsItsNamesAndLayers) {
  input.labels = (folder / "heart.seg.nrrd").string();
  settings.regions["lv_blood"].keys = {"lv-cavity"};
  std::string header = slicer_header("4",
                                     "sizes: 2 2 2 2\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"
                                     "kinds: list domain domain domain\n");
  header.replace(header.find("LAYER"), 5, "1");
  std::string voxels(16, '\0');  // layer fastest
  voxels[0] = 1, voxels[1] = 1;  // blood, and torso below it
  voxels[2] = 2;                 // aorta
  voxels[5] = 1;                 // torso alone
  write_text_file("heart.seg.nrrd", header + voxels);
  const LabelVolume labels = read();
  EXPECT_EQ(labels(0, 0, 0), tag(Region::lv_blood));
  EXPECT_EQ(labels(1, 0, 0), tag(Region::aorta));
  EXPECT_EQ(labels(0, 1, 0), tag(Region::torso));
  EXPECT_EQ(labels(1, 1, 1), 0);
  header.replace(header.find("Segment2_Layer:=1"), 17, "Segment2_Layer:=7");
  write_text_file("heart.seg.nrrd", header + voxels);
  EXPECT_NE(refusal().problem.find("layer 7"), std::string::npos);
}

TEST_F(GivenLabelsTest, ASlicerSegmentationOfOneLayerAndAnUnknownName) {
  input.labels = (folder / "heart.seg.nrrd").string();
  std::string header = slicer_header("3",
                                     "sizes: 2 2 2\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
                                     "kinds: domain domain domain\n");
  header.replace(header.find("LAYER"), 5, "0");
  header.replace(header.find("Segment2_LabelValue:=1"), 22, "Segment2_LabelValue:=3");
  write_text_file("heart.seg.nrrd", header + std::string("\1\2\3\0\0\0\0\0", 8));
  EXPECT_EQ(read()(0, 0, 0), tag(Region::lv_blood)) << "by what people call it";
  settings.preset = "heartgen";
  EXPECT_NE(refusal().problem.find("LV cavity"), std::string::npos);
  EXPECT_NE(refusal().remedy.find("did you mean"), std::string::npos);
  settings.regions["lv_blood"].keys = {"1"};
  const LabelVolume labels = read();
  EXPECT_EQ(labels(0, 0, 0), tag(Region::lv_blood));
  EXPECT_EQ(labels(0, 1, 0), tag(Region::torso));
}

TEST_F(GivenLabelsTest, AnotherGridGivesEveryVoxelItsNearest) {
  adapters::write_volume(input.labels, row_of({1, 2, 3, 4, 5, 6}));
  Grid fine = small_grid();
  fine.size = {14, 9, 7};
  fine.spacing_mm = {0.5, 1, 1.5};
  fine.origin_mm = {-10.1, 20.1, 30.2};
  const auto given = read_given_labels(input, settings, &fine);
  EXPECT_EQ(given.labels.grid, fine);
  ASSERT_EQ(given.warnings.size(), 3U);
  EXPECT_EQ(given.warnings.back().code, "labels.resampled");
  for (std::int64_t k = 0; k < 7; ++k)
    for (std::int64_t j = 0; j < 9; ++j)
      for (std::int64_t i = 0; i < 14; ++i) {
        const auto x = std::lround((0.5 * static_cast<double>(i) - 0.1) / 1);
        const auto y = std::lround((static_cast<double>(j) + 0.1) / 2);
        const auto z = std::lround((1.5 * static_cast<double>(k) + 0.2) / 3);
        EXPECT_EQ(given.labels(i, j, k), x < 6 && y == 0 && z == 0 ? x + 1 : 0) << i << " " << j << " " << k;
      }
  fine.origin_mm = {500, 0, 0};
  EXPECT_NE(refusal(&fine).problem.find("reach"), std::string::npos);
}

TEST_F(GivenLabelsTest, FlippedAxesChangeNothing) {
  const auto image = row_of({1, 2, 3, 4, 5, 6});
  adapters::write_volume(input.labels, image);
  const Grid grid = small_grid();
  const LabelVolume expected = read(&grid);
  Volume<std::int16_t> flipped = image;
  std::reverse(flipped.voxels.begin(), flipped.voxels.end());
  flipped.grid.origin_mm = lps_from_index(grid, {5, 4, 3});
  for (int axis = 0; axis < 3; ++axis) flipped.grid.direction[axis][axis] = -1;
  adapters::write_volume(input.labels, flipped);
  const auto given = read_given_labels(input, settings, &grid);
  EXPECT_EQ(given.labels.voxels, expected.voxels);
  EXPECT_NE(given.warnings.back().code, "labels.resampled");
}

LabelVolume map_of(const std::vector<Region>& row) {
  LabelVolume labels(small_grid());
  for (std::size_t i = 0; i < row.size(); ++i) labels.voxels[i] = tag(row[i]);
  return labels;
}

TEST(LabelsBesideTheHeart, AreRefusedWhereAirIsInTheirHeart) {
  const auto labels = [](std::int64_t first) {
    LabelVolume volume(small_grid());
    for (std::int64_t j = 0; j < 5; ++j) volume(first, j, 0) = tag(j < 3 ? Region::lv_blood : Region::lv_myocardium);
    return volume;
  };
  CtVolume ct(small_grid(), -800);
  for (std::int64_t k = 0; k < 4; ++k)
    for (std::int64_t j = 0; j < 5; ++j) ct(2, j, k) = 120;
  EXPECT_NO_THROW(refuse_labels_beside_heart(labels(2), ct, "seg.nii.gz"));
  EXPECT_THROW(refuse_labels_beside_heart(labels(4), ct, "seg.nii.gz"), UserError);
  EXPECT_NO_THROW(refuse_labels_beside_heart(LabelVolume(small_grid()), ct, "seg.nii.gz")) << "no heart at all";
}

TEST(MissingGroups, AreThoseThatTheLabelsLackAndTheRecipeWants) {
  using enum Region;
  const LabelVolume nothing(small_grid());
  const auto chambers = map_of({lv_blood, rv_blood, la_blood, ra_blood});
  const auto heart = map_of({lv_blood, rv_blood, la_blood, ra_blood, lv_myocardium, rv_myocardium, la_wall, ra_wall});
  EXPECT_TRUE(missing_groups(nothing, {}).chambers && missing_groups(nothing, {}).walls &&
              missing_groups(nothing, {}).body);
  EXPECT_TRUE(!missing_groups(chambers, {}).chambers && missing_groups(chambers, {}).walls);
  EXPECT_TRUE(!missing_groups(heart, {}).walls && missing_groups(heart, {}).body);
  EXPECT_FALSE(missing_groups(nothing, {.complete = {}}).any());
  EXPECT_TRUE(missing_groups(nothing, {.complete = {"walls"}}).walls);
  EXPECT_FALSE(missing_groups(nothing, {.complete = {"walls"}}).body);
  EXPECT_THROW(check_settings({.complete = {"wals"}}), UserError);
  EXPECT_NO_THROW(check_settings({}));
}

TEST(Overlay, AGivenRegionReplacesTheWholeOfOurs) {
  using enum Region;
  const auto own = map_of({aorta, aorta, lv_blood, lv_blood, rv_blood});
  const auto given = map_of({none, aorta, aorta, lung, torso});
  const auto result = with_given(own, given, Group::chambers);
  EXPECT_EQ(result.voxels, map_of({none, aorta, aorta, none, rv_blood}).voxels);
  const auto around = with_given(map_of({bone, lung, lung, liver, torso}), given, Group::body);
  EXPECT_EQ(around.voxels, map_of({bone, torso, torso, lung, torso}).voxels);
  EXPECT_EQ(with_given(own, {}, Group::chambers).voxels, own.voxels);
}

TEST(Overlay, WallsWithoutAnImageHaveTheLeastThickness) {
  Grid grid;
  grid.size = {40, 30, 30};
  LabelVolume chambers(grid);
  for (std::int64_t k = 10; k < 20; ++k)
    for (std::int64_t j = 10; j < 20; ++j)
      for (std::int64_t i = 8; i < 32; ++i)
        chambers(i, j, k) = tag(i < 18 ? Region::la_blood : i < 20 ? Region::none : Region::rv_blood);
  LabelVolume given(grid);
  const auto walls = min_walls(chambers, given, {.minimum_rv_wall_mm = 3, .minimum_atrial_wall_mm = 0.5});
  EXPECT_EQ(walls(7, 15, 15), tag(Region::la_wall));  // touches, though 0.5 mm is less than a voxel
  EXPECT_EQ(walls(6, 15, 15), 0);
  EXPECT_EQ(walls(34, 15, 15), tag(Region::rv_myocardium));
  EXPECT_EQ(walls(35, 15, 15), 0);
  EXPECT_EQ(walls(18, 15, 15), tag(Region::la_wall));  // half of the gap belongs to each
  EXPECT_EQ(walls(19, 15, 15), tag(Region::rv_myocardium));
  EXPECT_EQ(walls(12, 15, 15), 0);  // no wall inside the blood
  given(34, 15, 15) = tag(Region::lv_myocardium);
  EXPECT_EQ(min_walls(chambers, given, {.minimum_rv_wall_mm = 3})(34, 15, 15), tag(Region::lv_myocardium));
}

TEST(Overlay, PocketsInTheGivenHeartAreMuscleInVentriclesAndBloodInAtria) {
  Grid grid;
  grid.size = {40, 20, 20};
  LabelVolume given(grid);
  for (std::int64_t k = 5; k < 15; ++k)
    for (std::int64_t j = 5; j < 15; ++j)
      for (std::int64_t i = 5; i < 35; ++i) given(i, j, k) = tag(i < 20 ? Region::lv_blood : Region::la_blood);
  given(10, 10, 10) = given(30, 10, 10) = 0;
  given(5, 10, 10) = 0;  // a notch in the surface is no pocket
  const auto filled = with_filled_pockets(given, given, 0);
  EXPECT_EQ(filled(10, 10, 10), tag(Region::papillary));
  EXPECT_EQ(filled(30, 10, 10), tag(Region::la_blood));
  EXPECT_EQ(filled(5, 10, 10), 0);
  EXPECT_EQ(filled(2, 2, 2), 0);
  EXPECT_EQ(with_filled_pockets(given, given, 2)(10, 10, 10), tag(Region::lv_blood)) << "too small for a muscle";
  given(10, 10, 11) = 0;
  EXPECT_EQ(with_filled_pockets(given, given, 2)(10, 10, 10), tag(Region::papillary));
}

TEST(Overlay, VesselsAreFollowedNoFartherThanTheReach) {
  Grid grid;
  grid.size = {60, 3, 3};
  LabelVolume chambers(grid);
  for (std::int64_t i = 0; i < 60; ++i) chambers(i, 1, 1) = tag(i < 10 ? Region::lv_blood : Region::aorta);
  const auto near = near_heart(chambers, 20);
  EXPECT_EQ(near(29, 1, 1), tag(Region::aorta));
  EXPECT_EQ(near(30, 1, 1), 0);
}

}  // namespace
}  // namespace heartgen::labels
