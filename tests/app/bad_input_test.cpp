// SPDX-License-Identifier: GPL-3.0-or-later
// Every mistake of a user ends with exit code 2 and one line that says what, where, and what to do.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "generator/adapters/itk_io.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/program.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

class BadInput : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = testing::scratch_folder(std::string("bad_input_") +
                                     ::testing::UnitTest::GetInstance()->current_test_info()->name());
    Grid grid;
    grid.size = {24, 24, 24};
    grid.spacing_mm = {4, 4, 4};
    CtVolume ct(grid, -1000);
    for (std::int64_t k = 4; k < 20; ++k)
      for (std::int64_t j = 4; j < 20; ++j)
        for (std::int64_t i = 4; i < 20; ++i) ct(i, j, k) = 60;
    adapters::write_volume((folder / "ct.nii.gz").string(), ct);
  }

  void write_recipe(const std::string& extra) const {
    std::ofstream(folder / "recipe.toml") << "[input]\nct = \"ct.nii.gz\"\n" << extra;
  }

  /// Runs a command that must fail, and checks the form of the failure.
  std::string message_of(const std::string& arguments) const {
    const auto result = testing::heartgen(arguments, folder.string());
    EXPECT_EQ(result.exit_code, 2) << arguments << "\n" << result.errors;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_FALSE(fs::exists(folder / "out"));
    return result.errors;
  }

  void expect_message(const std::string& arguments, const std::vector<std::string>& words) const {
    const std::string message = message_of(arguments);
    for (const auto& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " not in: " << message;
  }

  fs::path folder;
};

TEST_F(BadInput, UnknownRecipeKey) {
  write_recipe("[mesh]\nheart_edge = 2\n");
  expect_message("build --quiet recipe.toml --output out", {"recipe.toml:4", "mesh.heart_edge", "heart_edge_mm"});
}

TEST_F(BadInput, MissingRecipe) { expect_message("build none.toml --output out", {"none.toml", "does not exist"}); }

TEST_F(BadInput, MissingCt) {
  write_recipe("[landmarks.seeds_mm]\nlv_blood = [0, 0, 0]\n");
  expect_message("build --quiet recipe.toml --ct none.nii.gz --output out",
                 {"none.nii.gz", "does not exist", "input.ct"});
}

TEST_F(BadInput, TruncatedCt) {
  write_recipe("[landmarks.seeds_mm]\nlv_blood = [48, 48, 48]\n");
  fs::resize_file(folder / "ct.nii.gz", fs::file_size(folder / "ct.nii.gz") / 2);
  expect_message("build --quiet recipe.toml --output out", {"ct.nii.gz", "truncated"});
}

TEST_F(BadInput, SeedOutsideTheImage) {
  write_recipe(
      "[landmarks.seeds_mm]\nlv_blood = [480, 48, 48]\nrv_blood = [40, 40, 40]\nla_blood = [40, 40, 40]\n"
      "ra_blood = [40, 40, 40]\n");
  expect_message("build --quiet recipe.toml --output out", {"lv_blood", "480", "outside"});
}

TEST_F(BadInput, NoSeedsInACtWithoutContrast) {
  write_recipe("");
  expect_message("build --quiet recipe.toml --output out", {"seed"});
  expect_message("landmarks ct.nii.gz", {"seed"});
}

TEST_F(BadInput, UnknownMesh) {
  write_recipe("[landmarks.seeds_mm]\nlv_blood = [0, 0, 0]\n[mesh]\nmeshes = [\"myocardium\", \"heart\"]\n");
  expect_message("build --quiet recipe.toml --output out", {"heart", "chambers"});
}

TEST_F(BadInput, TorsoThatIsNoneOrTwo) {
  const auto refuse = [&](const std::string& section, const std::vector<std::string>& words) {
    write_recipe("[torso]\n" + section);
    expect_message("build --quiet recipe.toml --output out", words);
  };
  refuse("labels = \"none.nii.gz\"\n", {"none.nii.gz", "does not exist", "torso.labels"});
  refuse("labels = \"ct.nii.gz\"\nct = \"ct.nii.gz\"\n", {"[torso]", "both"});
  refuse("frame = \"torso\"\n", {"[torso]", "no torso"});
  refuse("labels = \"ct.nii.gz\"\nframe = \"lps\"\n", {"[torso]", "lps"});
  refuse("labels = \"ct.nii.gz\"\ntorso_from_heart = [1, 0, 0]\n", {"[torso]", "3 numbers"});
  refuse("labels = \"ct.nii.gz\"\ntorso_from_heart = [1, 0, 0, 5, 0, 1.2, 0, 5, 0, 0, 1, 5]\n", {"[torso]", "scale"});
  refuse("with_scale = 1\n", {"torso.with_scale", "true or false"});
}

TEST_F(BadInput, ResolutionsOutOfRangeOrTwice) {
  for (const char* list : {"[2, 0.3]", "[3.5]", "[nan]", "[2, 2.0]"}) {
    write_recipe(std::string("[landmarks.seeds_mm]\nlv_blood = [0, 0, 0]\n[mesh]\nresolutions_mm = ") + list + "\n");
    expect_message("build --quiet recipe.toml --output out", {"mesh.resolutions_mm"});
  }
  write_recipe("[mesh]\nresolutions_mm = 2\n");
  expect_message("build --quiet recipe.toml --output out", {"mesh.resolutions_mm", "list of numbers"});
}

TEST_F(BadInput, UnknownSubcommandAndOption) {
  expect_message("biuld recipe.toml", {"biuld", "\"build\""});
  message_of("build --quiet recipe.toml --outptu out");
  message_of("info");
}

TEST_F(BadInput, NotABundle) {
  expect_message("info .", {"manifest.json"});
  message_of("export . --to vtk --output out");
}

/// Files at which the libraries that read them write beyond their places, divide by zero or call themselves without
/// end.
TEST_F(BadInput, FilesThatEndALibraryEndInAMessage) {
  const auto refuse = [&](const std::string& file, const std::string& contents, const std::string& command) {
    testing::write_bytes(folder / file, contents);
    expect_message(command, {file});
  };
  refuse("comment.mha",
         "ObjectType = Image\nNDims = 3\nComment = " + std::string(300, 'c') +
             "\nDimSize = 2 2 2\nElementSpacing = 2 2 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
             std::string(16, '\0'),
         "filter heat comment.mha out.nrrd --iterations 1");
  refuse(
      "cells.vtk",
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 "
      "1\nCELLS 2 5\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n",
      "improve cells.vtk out.vtu --goal-deg 1");
  const std::string table = std::string("\x01\0\0\0\0\0\0\0", 8) + std::string(64, 'x');
  refuse("blocks.vtu",
         "<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"1\">"
         "<Points><DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"appended\" "
         "offset=\"0\"/></Points></Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_" +
             table + "</AppendedData></VTKFile>",
         "improve blocks.vtu out.vtu --goal-deg 1");
  std::string keys;
  for (int n = 0; n < 100000; ++n) keys += "a.";
  refuse("deep.toml", keys + "a = 1\n", "build deep.toml --output out --quiet");
}

TEST_F(BadInput, WorkThatNeedsMoreMemoryThanThereIsIsRefusedBeforeItBegins) {
  Grid grid;
  grid.size = {64, 64, 64};
  adapters::write_volume((folder / "ct.nii.gz").string(), CtVolume(grid, 0));
  expect_message("filter heat ct.nii.gz out.nii --iterations 1 --memory-limit 1M", {"ct.nii.gz", "10 MiB", "1 MiB"});
  for (const char* amount : {"lots", "8X", "0", "12"})
    expect_message(std::string("filter heat ct.nii.gz out.nii --iterations 1 --memory-limit ") + amount,
                   {"--memory-limit", amount});
  expect_message("phantom out --size 2048,2048,2048 --memory-limit 16G", {"--size", "320 GiB", "16 GiB"});
  expect_message("phantom out --size 999999,999999,999999", {"--size", "more than 2048"});
}

/// 8 GiB of voxels that take no room on the disk: what is refused was not read.
TEST_F(BadInput, AVolumeOf2048CubedIsRefusedByItsHeader) {
  Grid grid;
  grid.size = {2, 2, 2};
  adapters::write_volume((folder / "large.nii").string(), LabelVolume(grid, 1));
  std::string bytes = testing::bytes_of(folder / "large.nii");
  for (int axis = 0; axis < 3; ++axis) {  // dim[1..3], 16 bits each
    bytes[static_cast<std::size_t>(42 + 2 * axis)] = 0;
    bytes[static_cast<std::size_t>(43 + 2 * axis)] = 8;
  }
  testing::write_bytes(folder / "large.nii", bytes);
  expect_message("filter heat large.nii out.nii --iterations 1 --memory-limit 64G", {"large.nii", "truncated"});
  std::error_code no_room;
  fs::resize_file(folder / "large.nii", 352 + (std::uintmax_t{1} << 33), no_room);
  if (no_room) GTEST_SKIP() << "no file of 8 GiB can be made here";
  expect_message("filter heat large.nii out.nii --iterations 1 --memory-limit 1G", {"large.nii", "320 GiB", "1 GiB"});
  fs::remove(folder / "large.nii");
}

TEST_F(BadInput, UnknownFilterAndParameter) {
  expect_message("filter heet ct.nii.gz out.nii.gz", {"heet", "heat"});
  expect_message("filter heat ct.nii.gz out.nii.gz --iteration 3", {"iteration", "iterations"});
  expect_message("filter heat ct.nii.gz out.nii.gz --iterations many", {"many", "number"});
}

TEST_F(BadInput, LabelMapWithForeignValues) {
  Grid grid;
  grid.size = {8, 8, 8};
  adapters::write_volume((folder / "labels.nrrd").string(), LabelVolume(grid, 200));
  expect_message("mesh labels.nrrd out", {"out", ".vtu"});
  expect_message("mesh labels.nrrd mesh.vtu", {"labels.nrrd", "200"});
}

TEST_F(BadInput, LabelsFromElsewhere) {
  write_recipe("[labels]\npreset = \"mmwhs\"\n");
  expect_message("build --quiet recipe.toml --output out", {"labels.preset", "mm_whs"});
  write_recipe("[labels]\ncomplete = [\"wals\"]\n");  // also where no labels are given
  expect_message("build --quiet recipe.toml --output out", {"labels.complete", "wals", "walls"});
  Grid grid;
  grid.size = {24, 24, 24};
  grid.spacing_mm = {4, 4, 4};
  LabelVolume labels(grid);
  labels(12, 12, 12) = 200;
  adapters::write_volume((folder / "labels.nrrd").string(), labels);
  write_recipe("");
  expect_message("build --quiet recipe.toml --labels labels.nrrd --output out",
                 {"labels.nrrd", "200", "labels.ignore"});
  write_recipe("[labels]\ncomplete = []\n[labels.regions]\nlv_blood = [200]\n");
  expect_message("build --quiet recipe.toml --labels labels.nrrd --output out", {"labels.nrrd", "lv_myocardium"});
}

TEST_F(BadInput, ReplacedStageOnAnotherGrid) {
  Grid grid;
  grid.size = {8, 8, 8};
  adapters::write_volume((folder / "labels.nrrd").string(), LabelVolume(grid, 1));
  write_recipe(
      "[landmarks.seeds_mm]\nlv_blood = [48, 48, 48]\nrv_blood = [40, 40, 40]\nla_blood = [40, 40, 40]\n"
      "ra_blood = [40, 40, 40]\n[replace]\nlabels = \"labels.nrrd\"\n");
  expect_message("build --quiet recipe.toml --output out", {"labels.nrrd", "grid"});
  fs::remove(folder / "labels.nrrd");
  expect_message("build --quiet recipe.toml --output out", {"labels.nrrd", "does not exist", "replace.labels"});
}

// The CT of these tests has no heart: what is refused before that is found was looked at before the first stage.
TEST_F(BadInput, WhatALateStageNeedsIsLookedAtFirst) {
  const auto refuse = [&](const std::string& recipe, const std::vector<std::string>& words) {
    write_recipe(recipe);
    expect_message("build --quiet recipe.toml --output out", words);
  };
  std::ofstream(folder / "notes.vtk") << "no mesh";
  refuse("atlas = \"notes.vtk\"\n", {"notes.vtk"});
  refuse("carotid = \"ct.nii.gz\"\n", {"carotid", "seed"});
  refuse("size_field = \"notes.vtk\"\n", {"notes.vtk"});
  refuse("[mesh]\nbackend = \"latice\"\n", {"latice", "lattice"});
  refuse("[mesh]\nheart_edge_mm = 0\n", {"heart_edge_mm"});
  refuse("[fibers]\nmethod = \"locl_angles\"\n", {"fibers.method", "local_angles"});
  refuse("[denoise]\ntime_step = 3\n", {"denoise", "time_step"});
  refuse("[chambers]\nblood = \"blod.above\"\n", {"chambers.blood", "blod.above", "blood"});
  refuse("[[segmentation]]\nname = \"body\"\nlambda = 0\n", {"body", "lambda"});
  refuse("[torso]\nlabels = \"ct.nii.gz\"\n", {"ct.nii.gz", "-1000"});
}

TEST_F(BadInput, OutputThatCannotBeIsRefusedFirst) {
  write_recipe("");
  std::ofstream(folder / "file") << "";
  expect_message("build --quiet recipe.toml --output file/out", {"file/out", "cannot be made"});
  fs::create_directory(folder / "photos");
  std::ofstream(folder / "photos" / "cat.jpg") << "meow";
  expect_message("build --quiet recipe.toml --force --output photos", {"photos", "not a bundle"});
  EXPECT_TRUE(fs::exists(folder / "photos" / "cat.jpg"));
  expect_message("landmarks ct.nii.gz --output file/out.json", {"file/out.json", "cannot be written"});
  expect_message("filter heat ct.nii.gz file/out.nrrd", {"file/out.nrrd", "cannot be written"});
  const auto study = testing::heartgen_lab("study --output file/out", folder.string());
  EXPECT_EQ(study.exit_code, 2);
  EXPECT_NE(study.errors.find("file/out"), std::string::npos) << study.errors;
  EXPECT_NE(study.errors.find("cannot be written"), std::string::npos) << study.errors;
  expect_message("mesh ct.nii.gz photos/cat.jpg", {"photos/cat.jpg", ".vtu"});
  expect_message("inpaint photos file/out --labels ct.nii.gz", {"file/out", "cannot be written"});
}

TEST_F(BadInput, NeitherAFullDiskNorAKillTakesAnOlderFileAway) {
  std::ofstream(folder / "old.nii") << "old";
  std::ofstream(folder / "old.mha") << "old";
  const auto filter = [&](const std::string& launcher, const std::string& name) {
    return testing::heartgen("filter heat ct.nii.gz " + name, folder.string(), "ulimit -c 0; " + launcher);
  };
  for (const std::string name : {"old.nii", "old.mha"}) {
    EXPECT_NE(filter("ulimit -f 1;", name).exit_code, 0);  // the system ends a program that writes more
    const auto full = filter("trap '' XFSZ; ulimit -f 1;", name);
    EXPECT_EQ(full.exit_code, 2) << full.errors;
    EXPECT_NE(full.errors.find(name + ": cannot be written"), std::string::npos) << full.errors;
    EXPECT_EQ(testing::text_of(folder / name), "old");
    EXPECT_FALSE(fs::exists(folder / (".partial." + name)));
  }
}

TEST_F(BadInput, AFileBeyondTheSystemsLimitIsTold) {
  const auto full = testing::heartgen("filter heat ct.nii.gz large.nii", folder.string(), "ulimit -c 0; ulimit -f 1;");
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_NE(full.errors.find("large.nii: cannot be written"), std::string::npos) << full.errors;
}

TEST_F(BadInput, DatesThatAreNone) {
  for (const char* date : {"tomorrow", "2026-13-01", "2026-02-30", "2026-1-001", "12026-01-01"}) {
    std::ofstream(folder / "recipe.toml") << "date_published = \"" << date << "\"\n[input]\nct = \"ct.nii.gz\"\n";
    expect_message("build --quiet recipe.toml --output out", {date, "date_published", "YYYY-MM-DD"});
  }
}

TEST_F(BadInput, WhatIsRefusedLeavesNoFolder) {
  for (const char* command :
       {"report none new/report.html", "mesh none.nii.gz new/mesh.vtu", "landmarks none.nii.gz --output new/seeds.json",
        "improve none.vtu new/mesh.vtu", "slice none.nii.gz new/slice.vtu", "transfer none none.vtu new/mesh.vtu",
        "filter heat none.nii.gz new/out.nrrd",
        "place none.nii.gz none.nii.gz new/labels.nii.gz --pose new/pose.json"}) {
    expect_message(command, {"none"});
    EXPECT_FALSE(fs::exists(folder / "new")) << command;
  }
}

TEST_F(BadInput, NamesThatCannotBeAFolders) {
  std::ofstream(folder / "recipe.toml") << "name = \"a/b\"\n[input]\nct = \"ct.nii.gz\"\n";
  expect_message("build --quiet recipe.toml --output out", {"a/b", "name"});
  std::ofstream(folder / "recipe.toml") << "version = \"1/2\"\n[input]\nct = \"ct.nii.gz\"\n";
  expect_message("build --quiet recipe.toml --output out", {"1/2", "version"});
}

TEST_F(BadInput, SeedsInAnotherFrame) {
  write_recipe("[landmarks.seeds_mm]\nlv_blood = [-40, -48, 48]\n");
  expect_message("build --quiet recipe.toml --output out", {"lv_blood", "outside", "RAS"});
  Grid grid;
  grid.size = {24, 24, 24};
  grid.origin_mm = {-200, -200, -200};
  adapters::write_volume((folder / "ct.nii.gz").string(), CtVolume(grid, -1000));
  write_recipe("[landmarks.seeds_mm]\nlv_blood = [12, 10, 13]\n");
  expect_message("build --quiet recipe.toml --output out", {"lv_blood", "outside", "voxel indices"});
}

TEST_F(BadInput, GreyValuesWithALostRescale) {
  Grid grid;
  grid.size = {24, 24, 24};
  grid.spacing_mm = {4, 4, 4};
  adapters::write_volume((folder / "ct.nii.gz").string(), CtVolume(grid, 1024));
  write_recipe("");
  expect_message("landmarks ct.nii.gz", {"Hounsfield", "rescale"});
  expect_message("build --quiet recipe.toml --output out", {"Hounsfield", "rescale"});
}

TEST_F(BadInput, ALabelMapIsNoCt) {
  Grid grid;
  grid.size = {24, 24, 24};
  grid.spacing_mm = {4, 4, 4};
  LabelVolume labels(grid);
  labels(12, 12, 12) = 17;
  adapters::write_volume((folder / "ct.nii.gz").string(), labels);
  write_recipe("");
  expect_message("landmarks ct.nii.gz", {"Hounsfield", "label map"});
  expect_message("build --quiet recipe.toml --output out", {"Hounsfield", "label map"});
}

TEST_F(BadInput, AnEdgeLongerThanTheSlice) {
  Grid grid;
  grid.size = {24, 24, 24};
  grid.spacing_mm = {4, 4, 4};
  adapters::write_volume((folder / "labels.nrrd").string(), LabelVolume(grid, 17));
  expect_message("slice labels.nrrd out.vtu --index 12 --edge 1e9", {"--edge", "1e+09 mm", "96 mm"});
  expect_message("slice labels.nrrd out.vtu --index 12 --torso-edge 97", {"--torso-edge", "97 mm", "96 mm"});
  EXPECT_FALSE(fs::exists(folder / "out.vtu"));
}

TEST_F(BadInput, PhantomOutOfRange) {
  message_of("phantom out --size 2,2,2");
  message_of("phantom out --spacing 0,1,1");
  message_of("phantom out --variant -1");
}

TEST_F(BadInput, FiltersThatCouldNotSayWhatTheyPromise) {
  Grid grid;
  grid.size = {24, 24, 24};
  Mask mask(grid);
  mask(12, 12, 12) = 1;
  adapters::write_volume((folder / "mask.nii.gz").string(), mask);
  for (const char* filter : {"redistance", "reinitialise"})
    expect_message(std::string("filter ") + filter + " mask.nii.gz out.nii.gz", {"zero level", "mask"});
  expect_message("filter redistance ct.nii.gz out.nii.gz --iterations 3", {"iterations", "takes none"});
  expect_message("filter sobolev ct.nii.gz out.nii.gz --length_mm 1e4", {"length_mm", "96 mm", "384"});
  EXPECT_FALSE(fs::exists(folder / "out.nii.gz"));
}

TEST_F(BadInput, SettingsThatCannotBe) {
  for (const auto& [section, key, value] : {std::array{"validation", "minimum_dihedral_deg", "400"},
                                            {"validation", "maximum_dihedral_deg", "20"},
                                            {"epicardium", "max_iterations", "0"},
                                            {"fibers", "demons_iterations", "[]"},
                                            {"fibers.rule", "lv_helix_endo_deg", "1e9"},
                                            {"mesh", "smoothing_mm", "100"}}) {
    write_recipe(std::string("[") + section + "]\n" + key + " = " + value + "\n");
    expect_message("build --quiet recipe.toml --output out", {key});
  }
}

TEST_F(BadInput, OptionsThatCannotBe) {
  expect_message("--threads 100000 info none", {"--threads", "100000"});
  for (const char* share : {"0", "-1", "2", "nan"})
    expect_message(std::string("contours subjective ct.nii.gz out.nii.gz --seed 50,50,50 --share ") + share,
                   {"--share"});
  expect_message("contours geodesic ct.nii.gz out.nii.gz --seed 50,50,50 --balloon 1e9", {"--balloon"});
  EXPECT_FALSE(fs::exists(folder / "out.nii.gz"));
}

TEST_F(BadInput, OutputsThatWouldSpoilOthers) {
  write_recipe("");
  expect_message("build --quiet recipe.toml --output out --keep-stages out/stages", {"--keep-stages", "out/stages"});
  expect_message("phantom .", {"recipe.toml", "another folder"});
  expect_message("pack sub sub/bundle.tar.zst", {"sub/bundle.tar.zst", "outside"});
  expect_message("report sub sub/report.html", {"sub/report.html", "outside"});
}

TEST_F(BadInput, AFrameThatTheLibraryMistakes) {
  std::ofstream(folder / "las.nrrd") << "NRRD0005\ntype: short\ndimension: 3\nspace: left-anterior-superior\n"
                                        "sizes: 4 4 4\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: domain domain "
                                        "domain\nendian: little\nencoding: raw\nspace origin: (1,2,3)\n\n"
                                     << std::string(128, '\0');
  expect_message("filter heat las.nrrd out.nii.gz", {"las.nrrd", "left-anterior-superior", "NIfTI"});
}

}  // namespace
}  // namespace heartgen
