// SPDX-License-Identifier: GPL-3.0-or-later
// Regions of the user's own from the command line to the bundle, on a small phantom; and what is refused.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "generator/adapters/itk_io.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "model/labels.hpp"
#include "support/data.hpp"
#include "support/program.hpp"
#include "support/two_region_mesh.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// The muscle of the left ventricle below a height is grey zone (1), farther below core (2).
LabelVolume scar_in(const LabelVolume& labels) {
  LabelVolume scar(labels.grid);
  double sum = 0, count = 0;
  const auto each = [&](const auto& visit) {
    const auto& size = labels.grid.size;
    for (std::int64_t k = 0; k < size[2]; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j)
        for (std::int64_t i = 0; i < size[0]; ++i)
          if (labels(i, j, k) == tag(Region::lv_myocardium)) visit(i, j, k);
  };
  each([&](std::int64_t, std::int64_t, std::int64_t k) { sum += static_cast<double>(k), ++count; });
  each([&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const double below = sum / count - static_cast<double>(k);
    scar(i, j, k) = below > 3 ? 2 : below > 1 ? 1 : 0;
  });
  return scar;
}

class OwnRegions : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder() = testing::scratch_folder("own_regions");
    const auto made = testing::heartgen("phantom phantom --size 64,64,48 --spacing 5.4,5.4,6.3", folder().string());
    ASSERT_EQ(made.exit_code, 0) << made.errors;
    std::ofstream(folder() / "phantom/recipe.toml", std::ios::app)
        << "\n[mesh]\nmeshes = [\"myocardium\", \"chambers\", \"torso\"]\nheart_edge_mm = 5\nblood_edge_mm = 10\n"
           "torso_edge_mm = 40\nresolutions_mm = [3]\n\n[fibers]\nmethod = \"rule\"\n";
    const auto labels = adapters::read_labels((folder() / "phantom/truth/labels.nii.gz").string());
    adapters::write_volume((folder() / "lge.nii.gz").string(), scar_in(labels));
    const auto build = testing::heartgen(
        "build phantom/recipe.toml --quiet --regions lge.nii.gz:grey_zone,core --output bundle", folder().string());
    ASSERT_TRUE(build.exit_code == 0 || build.exit_code == 3) << build.errors;
  }
  static fs::path& folder() {
    static fs::path path;
    return path;
  }
  static Json json_of(const std::string& command) {
    const auto run = testing::heartgen(command, folder().string());
    EXPECT_TRUE(run.exit_code == 0 || run.exit_code == 3) << run.errors;
    return Json::parse(run.output);
  }
  static double value(const Json& rows, const std::string& scope, const std::string& metric) {
    for (const auto& row : rows)
      if (row["scope"] == scope && row["metric"] == metric) return row["value"].get<double>();
    ADD_FAILURE() << "no row " << scope << " " << metric;
    return -1;
  }
};

TEST_F(OwnRegions, AreInManifestMeshesRecipeAndCertificate) {
  const auto manifest = Json::parse(testing::text_of((folder() / "bundle/manifest.json").string()));
  EXPECT_EQ(manifest["user_regions"], (Json{{"grey_zone", 51}, {"core", 52}}));
  const auto& meshes = manifest["meshes"];
  for (const char* mesh : {"myocardium", "torso", "myocardium_3mm"})
    for (const char* region : {"grey_zone", "core"})
      EXPECT_GT(meshes[mesh]["user_regions"][region].get<int>(), 0) << mesh << " " << region;
  EXPECT_EQ(meshes["myocardium"]["user_regions"], meshes["torso"]["user_regions"]);
  EXPECT_FALSE(meshes["chambers"].contains("user_regions"));
  const auto recipe = testing::text_of((folder() / "bundle/recipe.toml").string());
  EXPECT_NE(recipe.find("[[regions]]\nfile = \"lge.nii.gz\""), std::string::npos);
  EXPECT_NE(recipe.find("names = [\"grey_zone\", \"core\"]"), std::string::npos);
  bool is_input = false;
  for (const auto& input : manifest["inputs"]) is_input |= input["name"] == "regions: lge.nii.gz";
  EXPECT_TRUE(is_input);
  const auto rows = json_of("validate bundle --json")["rows"];
  for (const char* region : {"myocardium/grey_zone", "myocardium/core"}) {
    EXPECT_GT(value(rows, region, "volume"), 1) << region;
    EXPECT_LT(value(rows, region, "outside_walls"), 0.35) << region;
  }
}

/// The stages before are in the cache: only the last one runs, and the walls stay the same.
TEST_F(OwnRegions, OtherRegionsLeaveTheMeshAsItIs) {
  const auto before = Json::parse(testing::text_of((folder() / "bundle/manifest.json").string()));
  const auto run = testing::heartgen(
      "build phantom/recipe.toml --force --regions lge.nii.gz:border,dense --output bundle --json --quiet",
      folder().string());
  ASSERT_TRUE(run.exit_code == 0 || run.exit_code == 3) << run.errors;
  const auto log = testing::text_of((folder() / "bundle/logs/build.log").string());
  EXPECT_NE(log.find("mesh"), std::string::npos);
  const auto after = Json::parse(testing::text_of((folder() / "bundle/manifest.json").string()));
  EXPECT_EQ(after["meshes"]["myocardium"]["cells"], before["meshes"]["myocardium"]["cells"]);
  EXPECT_TRUE(after["user_regions"].contains("border"));
  EXPECT_NE(after["content_id"], before["content_id"]);
}

TEST_F(OwnRegions, TheBundleHasCavitiesEndsAndInsulation) {
  const auto info = json_of("info bundle --json");
  const auto& walls = info["meshes"]["myocardium"];
  for (const char* cavity : {"lv_cavity", "rv_cavity", "la_cavity", "ra_cavity"})
    EXPECT_GT(walls["cavities"][cavity]["volume_ml"].get<double>(), 10) << cavity;
  EXPECT_TRUE(walls["regions"].contains("la_annulus"));
  EXPECT_TRUE(info["meshes"]["chambers"]["surfaces"].contains("aorta_end"));
  const auto rows = json_of("validate bundle --json")["rows"];
  for (const char* mesh : {"myocardium", "torso", "myocardium_3mm"}) {
    EXPECT_EQ(value(rows, mesh, "conducting_faces"), 0) << mesh;
    EXPECT_EQ(value(rows, mesh, "conducting_nodes"), 0) << mesh;
  }
  for (const char* cavity : {"lv_cavity", "rv_cavity", "la_cavity", "ra_cavity"})
    for (const char* defect : {"open_edges", "non_manifold_edges", "turned_edges", "cap_nodes_off_rims"})
      EXPECT_EQ(value(rows, std::string("myocardium/") + cavity, defect), 0) << cavity << " " << defect;
}

TEST_F(OwnRegions, WhatIsWrongIsRefusedBeforeTheWork) {
  const auto refuse = [&](const std::string& regions, const std::vector<std::string>& words) {
    const auto run =
        testing::heartgen("build phantom/recipe.toml --quiet --output none --regions " + regions, folder().string());
    EXPECT_EQ(run.exit_code, 2) << regions;
    for (const auto& word : words) EXPECT_NE(run.errors.find(word), std::string::npos) << run.errors;
    EXPECT_FALSE(fs::exists(folder() / "none")) << regions;
  };
  auto scar = adapters::read_labels((folder() / "lge.nii.gz").string());
  scar.grid.origin_mm.x += 2000;
  adapters::write_volume((folder() / "elsewhere.nii.gz").string(), scar);
  scar.voxels.assign(scar.voxels.size(), 0);
  adapters::write_volume((folder() / "empty.nii.gz").string(), scar);
  ASSERT_EQ(mkfifo((folder() / "pipe.nii.gz").c_str(), 0600), 0);
  refuse("missing.nii.gz", {"missing.nii.gz", "does not exist"});
  refuse("pipe.nii.gz", {"pipe.nii.gz", "pipe"});
  refuse("empty.nii.gz", {"empty.nii.gz", "all its voxels are 0"});
  refuse("elsewhere.nii.gz", {"elsewhere.nii.gz", "mm away from the heart's walls"});
  refuse("lge.nii.gz:scar", {"lge.nii.gz", "1 name is given"});
  refuse("lge.nii.gz:core,lv_blood", {"lv_blood", "heartgen's own"});
}

TEST_F(OwnRegions, PaintDoesTheSameToAnyMesh) {
  const TetMesh mesh = testing::two_region_mesh(8);
  adapters::write_vtu(folder() / "own.vtu", mesh);
  Grid grid;
  grid.size = {12, 8, 8};
  grid.origin_mm = {2, -6, 1};
  grid.spacing_mm = {0.5, 0.5, 0.5};
  LabelVolume scar(grid, 1);
  adapters::write_volume((folder() / "own.nii.gz").string(), scar);
  const auto told = json_of("paint own.vtu painted.vtu --regions own.nii.gz:scar --json");
  const double volume = 12 * 8 * 8 * 0.125 / 1000;
  EXPECT_NEAR(told["regions"][0]["volume_ml"].get<double>(), volume, 0.02 * volume);
  const auto painted = adapters::read_unstructured(folder() / "painted.vtu");
  EXPECT_TRUE(painted.cell_scalars.contains("fraction_scar"));
  EXPECT_TRUE(painted.cell_vectors.contains("fiber"));
  EXPECT_EQ(painted.cell_scalars.at("user_region").size(), mesh.cells.size());
  const auto only = testing::heartgen("paint own.vtu part.vtu --regions own.nii.gz --only lung", folder().string());
  EXPECT_EQ(only.exit_code, 2);
  EXPECT_NE(only.errors.find("its regions: lv_myocardium, lv_blood"), std::string::npos) << only.errors;
  const auto beside = testing::heartgen("paint own.vtu part.vtu --regions lge.nii.gz", folder().string());
  EXPECT_EQ(beside.exit_code, 2);
  EXPECT_FALSE(fs::exists(folder() / "part.vtu"));
}

}  // namespace
}  // namespace heartgen
