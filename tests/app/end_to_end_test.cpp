// The whole road on a small phantom: CT to bundle, against the truth; the same bits for any ranks, threads, locale.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/data.hpp"
#include "support/program.hpp"

namespace heart {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class EndToEnd : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder() = testing::scratch_folder("end_to_end").string();
    const auto phantom = testing::heartgen("phantom phantom --size 124,120,100 --spacing 1.8,1.8,1.8", folder());
    ASSERT_EQ(phantom.exit_code, 0) << phantom.errors;
    // Coarse meshes: what is tested here is the road, and it is built several times over.
    std::ofstream(folder() + "/phantom/recipe.toml", std::ios::app)
        << "\n[mesh]\nheart_edge_mm = 2.4\nblood_edge_mm = 8\ntorso_edge_mm = 25\ntrachea_edge_mm = 3\n"
           "carotid_edge_mm = 1.8\n";
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

  static void expect_same_content(const std::string& arguments, const std::string& launcher) {
    fs::remove_all(folder() + "/again");
    const auto run = testing::heartgen("build phantom/recipe.toml --output again " + arguments, folder(), launcher);
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(content_id("again"), content_id("bundle")) << launcher << " " << arguments;
  }
};

TEST_F(EndToEnd, LabelsAgreeWithTheTruth) {
  EXPECT_GE(value("fit", "lv_blood", "dice"), 0.95);
  EXPECT_GE(value("fit", "lv_myocardium", "dice"), 0.85);
  EXPECT_GE(value("fit", "rv_blood", "dice"), 0.93);
}

TEST_F(EndToEnd, FibresAgreeWithTheTruth) {
  EXPECT_LE(value("fibers", "lv_myocardium", "axis_error_mean"), 15);
  EXPECT_LE(value("fibers", "ventricles", "axis_error_mean"), 15);  // the right one alone: see CHANGELOG
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

TEST_F(EndToEnd, SameContentForOtherThreadsAndLocale) {
  expect_same_content("--no-cache --threads 1", "LC_ALL=de_DE.UTF-8 TZ=Asia/Tokyo");
}

TEST_F(EndToEnd, SameContentForTwoAndThreeRanks) {
  const std::string environment =
      "env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 ";
  expect_same_content("--no-cache --threads 1", environment + "mpirun -n 2");
  expect_same_content("--no-cache --threads 1", environment + "mpirun -n 3");
}

TEST_F(EndToEnd, ACacheChangesNothing) {
  expect_same_content("", "");
  fs::remove_all(folder() + "/again");
  const auto second = testing::heartgen("build phantom/recipe.toml --output again", folder());
  ASSERT_EQ(second.exit_code, 0) << second.errors;
  EXPECT_NE(second.errors.find("from the cache"), std::string::npos);
  EXPECT_EQ(content_id("again"), content_id("bundle"));
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
  for (const auto& row : Json::parse(validate.output)["rows"]) {
    if (row["metric"] == "dice") {
      EXPECT_EQ(row["value"].get<double>(), 1.0) << row["scope"];
    }
  }
}

}  // namespace
}  // namespace heart
