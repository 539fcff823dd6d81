// SPDX-License-Identifier: GPL-3.0-or-later
// The whole road on a small phantom: CT to bundle, against the truth. That bits depend on nothing: selftest_test.cpp.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "generator/adapters/itk_io.hpp"
#include "model/crop.hpp"
#include "model/labels.hpp"
#include "support/data.hpp"
#include "support/program.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class EndToEnd : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder() = testing::scratch_folder("end_to_end").string();
    const auto phantom = testing::heartgen("phantom phantom --size 124,120,100 --spacing 1.8,1.8,1.8", folder());
    ASSERT_EQ(phantom.exit_code, 0) << phantom.errors;
    // Coarse meshes and a coarse alignment: what is tested here is the road, and it is built several times over.
    std::ofstream(folder() + "/phantom/recipe.toml", std::ios::app)
        << "\n[mesh]\nheart_edge_mm = 2.4\nblood_edge_mm = 8\ntorso_edge_mm = 25\ntrachea_edge_mm = 3\n"
           "carotid_edge_mm = 1.8\n[fibers]\ngrid_mm = 3\ndepth_grid_mm = 3\ndemons_iterations = [5, 3, 1]\n";
    const auto build = testing::heartgen("build phantom/recipe.toml --output bundle --no-cache", folder());
    ASSERT_EQ(build.exit_code, 0) << build.errors;
    const auto validate = testing::heartgen(
        "validate bundle --json --reference-labels phantom/truth/labels.nii.gz --reference-fibers phantom/truth",
        folder());
    EXPECT_EQ(validate.exit_code, 0) << validate.output.substr(0, 2000) << validate.errors;
    rows() = Json::parse(validate.output)["rows"];
  }

  static std::string& folder() {
    static std::string path;
    return path;
  }
  static Json& rows() {
    static Json json;
    return json;
  }
  static double value(const std::string& group, const std::string& scope, const std::string& metric) {
    for (const auto& row : rows())
      if (row["group"] == group && row["scope"] == scope && row["metric"] == metric) return row["value"].get<double>();
    ADD_FAILURE() << "no row " << group << " " << scope << " " << metric;
    return -1;
  }
  static Json manifest(const std::string& bundle) {
    return Json::parse(testing::text_of(folder() + "/" + bundle + "/manifest.json"));
  }
  static std::string content_id(const std::string& bundle) { return manifest(bundle)["content_id"]; }
};

// What needs the atlas or the CT is not measured again; it is kept.
TEST_F(EndToEnd, ValidateLosesNoRowOfTheBuild) {
  std::set<std::string> groups;
  const Json before = Json::parse(testing::text_of(folder() + "/bundle/validation/metrics.json"));
  for (const auto& row : before["rows"]) {
    const auto is_it = [&](const Json& other) {
      return other["group"] == row["group"] && other["scope"] == row["scope"] && other["metric"] == row["metric"];
    };
    EXPECT_EQ(std::ranges::count_if(rows(), is_it), 1) << row;
    groups.insert(row["group"].get<std::string>());
  }
  EXPECT_EQ(groups, (std::set<std::string>{"anatomy", "cavities", "fibers", "fit", "insulation", "labels", "mesh"}));
}

TEST_F(EndToEnd, LabelsAgreeWithTheTruth) {
  EXPECT_GE(value("fit", "lv_blood", "dice"), 0.95);
  EXPECT_GE(value("fit", "lv_myocardium", "dice"), 0.85);
  EXPECT_GE(value("fit", "rv_blood", "dice"), 0.93);
}

TEST_F(EndToEnd, FibresAgreeWithTheTruth) {
  EXPECT_LE(value("fibers", "lv_myocardium", "axis_error_mean"), 15);
  EXPECT_LE(value("fibers", "ventricles", "axis_error_mean"), 15);  // the right one alone: see docs/limitations.md
  EXPECT_GE(value("fibers", "lv_myocardium", "compared_fraction"), 0.8);
}

TEST_F(EndToEnd, BundleIsCompleteAndWhole) {
  const Json m = manifest("bundle");
  for (const char* mesh : {"myocardium", "chambers", "torso", "trachea", "carotid"}) {
    EXPECT_TRUE(m["meshes"].contains(mesh)) << mesh;
    EXPECT_GT(m["meshes"][mesh]["cells"].get<int>(), 100) << mesh;
  }
  EXPECT_EQ(testing::heartgen("verify bundle", folder()).exit_code, 0);
  EXPECT_EQ(testing::text_of(folder() + "/bundle/validation/report.html").find(folder()), std::string::npos);
}

TEST_F(EndToEnd, EveryResultIsReadableByMachines) {
  const auto json = [](const std::string& arguments) {
    const auto run = testing::heartgen(arguments + " --json", folder());
    EXPECT_EQ(run.exit_code, 0) << arguments << run.errors;
    return Json::parse(run.output, nullptr, false);
  };
  const Json info = json("info bundle");
  EXPECT_EQ(info["unit"], "mm");
  EXPECT_EQ(info["frame"], "LPS");
  EXPECT_EQ(info["fibres"], "atlas.vtk, point array \"fibers\"");
  EXPECT_GT(info["meshes"]["torso"]["labelled_faces"], 0);
  EXPECT_EQ(json("pack bundle one.tar.zst")["archive"], "one.tar.zst");
  EXPECT_EQ(json("unpack one.tar.zst unpacked")["bundle"], "unpacked");
  EXPECT_EQ(json("report bundle machine.html")["report"], "machine.html");
  EXPECT_TRUE(json("verify bundle").is_array());
  EXPECT_TRUE(json("export bundle --to msh --mesh trachea --output exported").is_array());
  // What we write in binary we read.
  const Json improved = json("improve exported/msh/trachea.msh again.vtu --goal-deg 1");
  EXPECT_EQ(improved["before"]["cells"], info["meshes"]["trachea"]["cells"]);
}

TEST_F(EndToEnd, GetComparesWithThePublishedChecksum) {
  const auto get = [](const std::string& arguments) { return testing::heartgen("get " + arguments, folder()); };
  ASSERT_EQ(testing::heartgen("pack bundle published.tar.zst", folder()).exit_code, 0);
  const auto unpublished = get("published.tar.zst got0");
  EXPECT_EQ(unpublished.exit_code, 0) << unpublished.errors;
  EXPECT_NE(unpublished.output.find("no checksum"), std::string::npos) << unpublished.output;
  ASSERT_EQ(std::system(("cd " + folder() + " && sha256sum published.tar.zst > published.tar.zst.sha256").c_str()), 0);
  for (const auto& source : {std::string("published.tar.zst"), "file://" + folder() + "/published.tar.zst"}) {
    const std::string name = "got_" + std::to_string(source.size());
    const auto got = get(source + " " + name);
    EXPECT_EQ(got.exit_code, 0) << got.errors;
    EXPECT_NE(got.output.find("is the published one"), std::string::npos) << got.output;
    EXPECT_EQ(testing::heartgen("verify " + name, folder()).exit_code, 0);
    EXPECT_EQ(get(source + " " + name).exit_code, 2) << "the folder exists";
    const auto other = get(source + " other --sha256 " + std::string(64, 'a'));
    EXPECT_EQ(other.exit_code, 2);
    EXPECT_NE(other.errors.find("its SHA-256 is"), std::string::npos) << other.errors;
    EXPECT_EQ(get(source + " other --sha256 12").exit_code, 2) << "that is no checksum";
  }
  EXPECT_EQ(get("file://" + folder() + "/none.tar.zst other").exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder() + "/other"));
  for (const auto& entry : std::filesystem::directory_iterator(folder()))
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path() << " was left";
}

TEST_F(EndToEnd, AReportIsDrawnOverTheBundlesOwnCt) {
  const auto reported = testing::heartgen("report bundle again.html --ct phantom/ct.nii.gz", folder());
  ASSERT_EQ(reported.exit_code, 0) << reported.errors;
  EXPECT_EQ(testing::text_of(folder() + "/again.html").find("not, byte for byte"), std::string::npos);

  auto ct = adapters::read_ct(folder() + "/phantom/ct.nii.gz");
  ct.voxels.front() += 1;
  adapters::write_volume(folder() + "/other_bytes.nii.gz", ct);
  ASSERT_EQ(testing::heartgen("report bundle again.html --ct other_bytes.nii.gz", folder()).exit_code, 0);
  EXPECT_NE(testing::text_of(folder() + "/again.html").find("not, byte for byte"), std::string::npos);

  ct.grid.origin_mm.x += 1;
  adapters::write_volume(folder() + "/another.nii.gz", ct);
  const auto refused = testing::heartgen("report bundle none.html --ct another.nii.gz", folder());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("another.nii.gz"), std::string::npos) << refused.errors;
  const auto no_ct = testing::heartgen("report bundle none.html --ct bundle/images/labels.nii.gz", folder());
  EXPECT_EQ(no_ct.exit_code, 2);
  EXPECT_NE(no_ct.errors.find("label map"), std::string::npos) << no_ct.errors;
  EXPECT_FALSE(fs::exists(folder() + "/none.html"));
}

TEST_F(EndToEnd, ACacheChangesNothing) {
  const auto first = testing::heartgen("build phantom/recipe.toml --output again", folder());
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_EQ(content_id("again"), content_id("bundle"));
  fs::remove_all(folder() + "/again");
  const auto second = testing::heartgen("build phantom/recipe.toml --output again", folder());
  ASSERT_EQ(second.exit_code, 0) << second.errors;
  EXPECT_NE(second.errors.find("from the cache"), std::string::npos);
  EXPECT_EQ(content_id("again"), content_id("bundle"));

  const auto entries = [&] {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder() + "/again.cache")) names.insert(entry.path().filename());
    return names;
  };
  const auto used = entries();
  std::ofstream(folder() + "/again.cache/0123.stage") << "of an older program";
  const auto third = testing::heartgen("build phantom/recipe.toml --output again --force", folder());
  ASSERT_EQ(third.exit_code, 0) << third.errors;
  EXPECT_EQ(entries(), used) << "only what the last build used stays";
}

TEST_F(EndToEnd, AnExistingBundleIsNotOverwrittenUnasked) {
  const auto run = testing::heartgen("build phantom/recipe.toml --output bundle", folder());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.errors.find("--force"), std::string::npos);
}

TEST_F(EndToEnd, GivenLabelsReplaceTheSegmentation) {
  const auto run = testing::heartgen(
      "build phantom/recipe.toml --labels phantom/truth/labels.nii.gz --output from_labels --no-cache", folder());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto validate =
      testing::heartgen("validate from_labels --json --reference-labels phantom/truth/labels.nii.gz", folder());
  EXPECT_EQ(validate.exit_code, 0);
  const Json certificate = Json::parse(validate.output);
  int compared = 0;
  for (const auto& row : certificate["rows"])
    if (row["metric"] == "dice") {
      // But for a voxel that stands alone, and the rounded tips of arteries beyond their flat ends.
      const bool is_artery = row["scope"] == "aorta" || row["scope"] == "pulmonary_artery";
      EXPECT_GE(row["value"].get<double>(), is_artery ? 0.98 : 0.999) << row["scope"];
      ++compared;
    }
  EXPECT_GT(compared, 10);
}

/// Builds of the walls alone, at coarse edges: what is tested is which stage made what.
class StagesByHand : public EndToEnd {
 protected:
  static void SetUpTestSuite() {
    folder() = testing::scratch_folder("stages_by_hand").string();
    const auto phantom = testing::heartgen("phantom phantom --size 102,100,82 --spacing 2.2,2.2,2.2", folder());
    ASSERT_EQ(phantom.exit_code, 0) << phantom.errors;
  }
  static constexpr const char* quick =
      "[mesh]\nmeshes = [\"myocardium\"]\nheart_edge_mm = 4\n"
      "[fibers]\ngrid_mm = 3\ndepth_grid_mm = 3\ndemons_iterations = [5, 3, 1]\n"
      "[validation]\nuses = [\"finite_volumes\"]\n";  // such edges serve no other
  static void write_recipe(const std::string& name, const std::string& extra) {
    std::ofstream(folder() + "/" + name) << "[input]\nct = \"phantom/ct.nii.gz\"\n"
                                         << "landmarks = \"phantom/landmarks.json\"\n"
                                         << quick << extra;
  }
  /// The errors of the build; the cache spares what an earlier one has made.
  static std::string build(const std::string& arguments) {
    fs::remove_all(folder() + "/by_hand");
    const auto run = testing::heartgen("build --output by_hand " + arguments, folder());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return run.errors;
  }
  static void write_far_cell(const std::string& path) {
    std::ofstream(path) << "# vtk DataFile Version 3.0\nfar\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
                           "900 0 0 901 0 0 900 1 0 900 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
  }
  /// heartgen transfer on what stands in by_hand.
  static void expect_fibres_on_a_mesh_from_elsewhere() {
    const std::string walls = "by_hand/meshes/myocardium.vtu ";
    const auto run = testing::heartgen("transfer by_hand " + walls + "mine.vtu --json", folder());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const Json result = Json::parse(run.output);
    EXPECT_EQ(result["nodes"], manifest("by_hand")["meshes"]["myocardium"]["nodes"]);
    EXPECT_EQ(result["nodes_beyond_reach"], 0);
    EXPECT_EQ(testing::heartgen("transfer mine.vtu " + walls + "back.vtk", folder()).exit_code, 0);
    const auto refusal = [&](const std::string& arguments) {
      const auto refused = testing::heartgen("transfer " + arguments, folder());
      EXPECT_EQ(refused.exit_code, 2) << arguments;
      return refused.errors;
    };
    EXPECT_NE(refusal("by_hand " + walls + "none.stl").find("none.stl"), std::string::npos);
    EXPECT_NE(refusal("by_hand " + walls + "none.vtu --reach 0").find("--reach"), std::string::npos);
    EXPECT_NE(refusal("bare.vtk " + walls + "none.vtu").find("bare.vtk"), std::string::npos);
    write_far_cell(folder() + "/far.vtk");
    EXPECT_NE(refusal("by_hand far.vtk none.vtu").find("4 of 4 nodes"), std::string::npos);
    EXPECT_NE(refusal("far.vtk mine.vtu none.vtu").find("\"fiber\""), std::string::npos);
    EXPECT_FALSE(fs::exists(folder() + "/none.vtu"));
  }
  static LabelVolume labels(const std::string& path) { return adapters::read_labels(folder() + "/" + path); }
  static double dice(const LabelVolume& a, const LabelVolume& b, Region region) {
    std::int64_t both = 0, sum = 0;
    for (std::size_t v = 0; v < a.voxels.size(); ++v) {
      const bool in_a = a.voxels[v] == tag(region), in_b = b.voxels[v] == tag(region);
      both += in_a && in_b;
      sum += in_a + in_b;
    }
    return 2 * static_cast<double>(both) / static_cast<double>(sum);
  }
  static bool is_artery(Region region) { return region == Region::aorta || region == Region::pulmonary_artery; }
  /// Voxels with another label than given; the tips of arteries beyond their flat ends, a small part of them, do not
  /// count.
  static std::size_t changed_beside_tips(const LabelVolume& result, const LabelVolume& given) {
    std::size_t changed = 0;
    for (std::size_t v = 0; v < given.voxels.size(); ++v)
      changed += result.voxels[v] != given.voxels[v] && !is_artery(static_cast<Region>(given.voxels[v]));
    for (const Region artery : {Region::aorta, Region::pulmonary_artery}) EXPECT_GE(dice(result, given, artery), 0.95);
    return changed;
  }
};

TEST_F(StagesByHand, KeptFilesGivenBackChangeNothingAndCorrectedOnesAreUsed) {
  write_recipe("keep.toml", "");
  build("keep.toml --keep-stages stages");
  const std::string first = content_id("by_hand");
  std::string replace = "[replace]\n";
  for (const char* stage : {"denoise", "chambers", "epicardium", "body"})
    replace += fmt::format("{0} = \"stages/{0}.nii.gz\"\n", stage);
  write_recipe("back.toml", replace + "segment = \"stages/segment.json\"\n");
  EXPECT_NE(build("back.toml").find("from the given file"), std::string::npos);
  EXPECT_EQ(content_id("by_hand"), first);

  LabelVolume chambers = labels("stages/chambers.nii.gz");
  std::replace(chambers.voxels.begin(), chambers.voxels.end(), tag(Region::papillary), tag(Region::lv_blood));
  adapters::write_volume(folder() + "/corrected.nii.gz", chambers);
  write_recipe("corrected.toml", "[replace]\nchambers = \"corrected.nii.gz\"\n");
  build("corrected.toml");
  EXPECT_NE(content_id("by_hand"), first);
  const LabelVolume result = labels("by_hand/images/labels.nii.gz");
  EXPECT_EQ(std::count(result.voxels.begin(), result.voxels.end(), tag(Region::papillary)), 0);
  EXPECT_NE(testing::text_of(folder() + "/by_hand/recipe.toml").find("chambers = \"corrected.nii.gz\""),
            std::string::npos);
}

TEST_F(StagesByHand, ChambersFromElsewhereGetTheirWallsFromTheCt) {
  const LabelVolume truth = labels("phantom/truth/labels.nii.gz");
  Volume<std::int16_t> mm_whs(truth.grid);
  const std::map<Region, std::int16_t> values = {
      {Region::lv_myocardium, 205}, {Region::la_blood, 420}, {Region::lv_blood, 500},        {Region::ra_blood, 550},
      {Region::rv_blood, 600},      {Region::aorta, 820},    {Region::pulmonary_artery, 850}};
  for (std::size_t v = 0; v < truth.voxels.size(); ++v)
    if (const auto value = values.find(static_cast<Region>(truth.voxels[v])); value != values.end())
      mm_whs.voxels[v] = value->second;
  adapters::write_volume(folder() + "/mm_whs.nrrd", mm_whs);
  write_recipe("mm_whs.toml", "[labels]\npreset = \"mm_whs\"\n");
  build("mm_whs.toml --labels mm_whs.nrrd --no-cache");
  const LabelVolume result = labels("by_hand/images/labels.nii.gz");
  // What is given stays but for the tips of arteries beyond their flat ends, and for islands below a hundredth of their
  // region, which take the label around them.
  for (const auto& [region, value] : values)
    EXPECT_GE(dice(result, truth, region), is_artery(region) ? 0.95 : 0.999) << value;
  EXPECT_GE(dice(result, truth, Region::rv_myocardium), 0.7);
  EXPECT_GE(dice(result, truth, Region::lung), 0.95);
  EXPECT_GE(dice(result, truth, Region::torso), 0.9);  // what the CT-made lung and bone leave
}

TEST_F(StagesByHand, RulesNeedNoAtlas) {
  std::string recipe = quick;
  recipe.insert(recipe.find("grid_mm = 3"), "method = \"rule\"\n");
  std::ofstream(folder() + "/rule.toml") << recipe;
  build("rule.toml --labels phantom/truth/labels.nii.gz --no-cache");
  EXPECT_EQ(testing::text_of(folder() + "/by_hand/logs/build.log").find("alignment"), std::string::npos);
  EXPECT_EQ(manifest("by_hand")["atlas"], "no atlas: the rules of [fibers.rule]");
  rows() = Json::parse(testing::heartgen("validate by_hand --json", folder()).output)["rows"];
  EXPECT_EQ(value("fibers", "myocardium", "nodes_without_source"), 0);
  EXPECT_LE(value("fibers", "myocardium", "orthonormality_error_cells"), 1e-6);
}

TEST_F(StagesByHand, LabelsWithoutACt) {
  std::ofstream(folder() + "/no_ct.toml") << quick;
  const auto told = build("no_ct.toml --labels phantom/truth/labels.nii.gz --no-cache");
  const auto result = labels("by_hand/images/labels.nii.gz"), truth = labels("phantom/truth/labels.nii.gz");
  const std::size_t dropped = changed_beside_tips(result, truth);
  EXPECT_NE(manifest("by_hand")["warnings"].dump().find("beyond its flat end"), std::string::npos);
  EXPECT_LE(dropped, 4U) << "voxels of the thin atrial walls stand alone in the truth";
  EXPECT_EQ(dropped > 0, told.find("were dropped") != std::string::npos) << told;
}

// A field of view whose border cuts the lungs, in padding.
TEST_F(StagesByHand, LabelsOfAFileStayWhereNothingWasMeasured) {
  CtVolume ct = adapters::read_ct(folder() + "/phantom/ct.nii.gz");
  const auto nx = ct.grid.size[0], ny = ct.grid.size[1];
  for (std::size_t v = 0; v < ct.voxels.size(); ++v) {
    const auto i = static_cast<std::int64_t>(v) % nx, j = static_cast<std::int64_t>(v) / nx % ny;
    if (std::min(i, nx - 1 - i) < 20 || std::min(j, ny - 1 - j) < 20) ct.voxels[v] = -2000;
  }
  adapters::write_volume(folder() + "/padded.nrrd", ct);
  write_recipe("padded.toml", "[replace]\nlabels = \"phantom/truth/labels.nii.gz\"\n");
  build("padded.toml --ct padded.nrrd --no-cache");
  EXPECT_EQ(changed_beside_tips(labels("by_hand/images/labels.nii.gz"), labels("phantom/truth/labels.nii.gz")), 0U);
  EXPECT_NE(testing::text_of(folder() + "/by_hand/validation/report.html").find("holds -2000 HU"), std::string::npos);
}

template <class T>
Volume<T> mirrored(Volume<T> image) {
  const auto nx = image.grid.size[0];
  for (auto row = image.voxels.begin(); row != image.voxels.end(); row += nx) std::reverse(row, row + nx);
  return image;
}

TEST_F(StagesByHand, MirroredHeartsAreRefusedBeforeTheyAreMeshed) {
  adapters::write_volume(folder() + "/mirrored.nrrd", mirrored(labels("phantom/truth/labels.nii.gz")));
  adapters::write_volume(folder() + "/mirrored_ct.nrrd", mirrored(adapters::read_ct(folder() + "/phantom/ct.nii.gz")));
  std::ofstream(folder() + "/mirrored.toml") << quick;
  for (const char* input : {"--labels mirrored.nrrd", "--ct mirrored_ct.nrrd"}) {
    const auto refused =
        testing::heartgen(std::string("build mirrored.toml --output none --no-cache ") + input, folder());
    EXPECT_EQ(refused.exit_code, 2) << refused.errors;
    EXPECT_NE(refused.errors.find("mirrored"), std::string::npos) << refused.errors;
    EXPECT_EQ(refused.errors.find("] mesh"), std::string::npos) << refused.errors;
  }
}

TEST_F(StagesByHand, WhatCanHardlyBeAHeartIsRefused) {
  const auto phantom =
      testing::heartgen("phantom turned --variant 12 --size 128,128,100 --spacing 2.2,2.2,2.6", folder());
  ASSERT_EQ(phantom.exit_code, 0) << phantom.errors;
  auto ct = adapters::read_ct(folder() + "/turned/ct.nii.gz");
  for (int axis = 0; axis < 2; ++axis) {  // prone, without a word of it in the header
    ct.grid.direction[axis] = -1 * ct.grid.direction[axis];
    ct.grid.origin_mm[axis] = -ct.grid.origin_mm[axis];
  }
  adapters::write_volume(folder() + "/turned.nrrd", ct);
  std::ofstream(folder() + "/turned.toml") << quick;
  const auto refused = testing::heartgen("build turned.toml --ct turned.nrrd --output none --no-cache", folder());
  EXPECT_EQ(refused.exit_code, 2) << refused.errors;
  EXPECT_NE(refused.errors.find("can hardly be a heart"), std::string::npos) << refused.errors;
}

TEST_F(StagesByHand, AHeartThatTheFieldOfViewCutsIsRefusedBeforeTheImageStages) {
  auto ct = adapters::read_ct(folder() + "/phantom/ct.nii.gz");
  const auto truth = labels("phantom/truth/labels.nii.gz");
  auto box = bounding_box(truth, 0, [](std::uint8_t label) { return label == tag(Region::rv_blood); });
  box = {{0, box.begin[1] + 6, 0}, ct.grid.size};
  adapters::write_volume(folder() + "/cut.nrrd", crop(ct, box));
  std::ofstream(folder() + "/cut.toml") << quick;
  const auto refused = testing::heartgen("build cut.toml --ct cut.nrrd --output none --no-cache", folder());
  EXPECT_EQ(refused.exit_code, 2) << refused.errors;
  EXPECT_NE(refused.errors.find("cuts the ventricles"), std::string::npos) << refused.errors;
  EXPECT_EQ(refused.errors.find("] denoise"), std::string::npos) << refused.errors;
}

TEST_F(StagesByHand, AFurtherResolutionHasTheRegionsSurfacesAndFibresOfTheMainMesh) {
  const std::string name = "myocardium_2.8mm";
  std::string recipe = quick;
  recipe.insert(recipe.find("heart_edge_mm"), "resolutions_mm = [2.8]\n");
  std::ofstream(folder() + "/further.toml")
      << "[input]\nct = \"phantom/ct.nii.gz\"\nlandmarks = \"phantom/landmarks.json\"\n"
      << recipe;
  build("further.toml");
  const std::string first = content_id("by_hand");
  EXPECT_NE(build("further.toml --threads 1").find("from the cache"), std::string::npos);
  EXPECT_EQ(content_id("by_hand"), first);

  const Json meshes = manifest("by_hand")["meshes"];
  ASSERT_TRUE(meshes.contains(name));
  const Json &main = meshes["myocardium"], &further = meshes[name];
  EXPECT_GT(further["cells"].get<int>(), main["cells"].get<int>());
  for (const char* tags : {"regions", "surfaces"})
    for (const auto& [tag, count] : main[tags].items()) EXPECT_TRUE(further[tags].contains(tag)) << tag;
  rows() = Json::parse(testing::heartgen("validate by_hand --json", folder()).output)["rows"];
  for (const char* metric : {"missing_nodes", "missing_cells", "nodes_without_source"})
    EXPECT_EQ(value("fibers", name, metric), 0) << metric;
  EXPECT_LE(value("fibers", name, "orthonormality_error_cells"), 1e-6);
  EXPECT_GT(value("mesh", name, "dihedral_min"), 5);
  EXPECT_LE(std::abs(value("mesh", name + "/lv_myocardium", "volume_difference")), 5);
  EXPECT_EQ(testing::heartgen("export by_hand --to vtk,opencarp --output exported --mesh " + name, folder()).exit_code,
            0);
  expect_fibres_on_a_mesh_from_elsewhere();
}

TEST_F(StagesByHand, TheTreeAloneOnASlice) {
  const CtVolume ct = adapters::read_ct(folder() + "/phantom/ct.nii.gz");
  CtVolume slice;
  slice.grid = ct.grid;
  slice.grid.size[2] = 1;
  const auto area = static_cast<std::size_t>(slice.grid.voxel_count());
  slice.voxels.assign(ct.voxels.begin() + static_cast<std::ptrdiff_t>(41 * area),
                      ct.voxels.begin() + static_cast<std::ptrdiff_t>(42 * area));
  adapters::write_volume(folder() + "/slice.nrrd", slice);
  write_recipe("tree.toml", "");
  const auto serial = testing::heartgen("segment tree.toml slice.nrrd leaves.nii.gz --json", folder());
  ASSERT_EQ(serial.exit_code, 0) << serial.errors;
  const Json result = Json::parse(serial.output);
  ASSERT_EQ(result["steps"].size(), 3U);
  EXPECT_EQ(result["leaves"].size(), 4U);  // air, fat, muscle, blood
  EXPECT_LT(result["steps"][0]["c_below"].get<double>(), -500);
  EXPECT_GT(result["steps"][2]["c_above"].get<double>(), result["steps"][2]["c_below"].get<double>() + 50);
  const auto parallel =
      testing::heartgen("segment tree.toml slice.nrrd parallel.nii.gz", folder(), testing::on_ranks(2));
  ASSERT_EQ(parallel.exit_code, 0) << parallel.errors;
  EXPECT_EQ(adapters::read_image(folder() + "/leaves.nii.gz").voxels,
            adapters::read_image(folder() + "/parallel.nii.gz").voxels);
}

}  // namespace
}  // namespace heartgen
