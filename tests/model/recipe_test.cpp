// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/recipe.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "model/error.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

std::string recipe_file(const std::string& text) {
  const auto path = testing::scratch_folder("recipe") / "recipe.toml";
  std::ofstream(path) << text;
  return path.string();
}

UserError refusal(const std::string& text) {
  try {
    read_recipe(recipe_file(text));
  } catch (const UserError& error) {
    return error;
  }
  ADD_FAILURE() << "accepted: " << text;
  return {"", "", ""};
}

TEST(Recipe, EmptyRecipeHasTheDefaults) {
  const Recipe recipe = read_recipe(recipe_file(""));
  EXPECT_EQ(recipe.segmentation.size(), default_segmentation().size());
  EXPECT_EQ(recipe.mesh.meshes.size(), 5U);
}

TEST(Recipe, UnknownKeyNamesTheNearestKnownOneAndItsLine) {
  const UserError error = refusal("[mesh]\nheart_edge = 2.0\n");
  EXPECT_NE(error.problem.find("mesh.heart_edge"), std::string::npos);
  EXPECT_NE(error.remedy.find("heart_edge_mm"), std::string::npos);
  EXPECT_NE(error.where.find("recipe.toml:2"), std::string::npos);
}

TEST(Recipe, UnknownSectionAndStepKeyAndSeedAreRefused) {
  EXPECT_NE(refusal("[messh]\n").remedy.find("mesh"), std::string::npos);
  EXPECT_NE(refusal("[[segmentation]]\nname = \"a\"\nlamda = 1\n").remedy.find("lambda"), std::string::npos);
  EXPECT_NE(refusal("[landmarks.seeds_mm]\nlv_blod = [1, 2, 3]\n").remedy.find("lv_blood"), std::string::npos);
  EXPECT_NE(
      refusal("[landmarks.valves.mitrall]\ncenter_mm=[0,0,0]\nnormal=[0,0,1]\nradius_mm=9\n").remedy.find("mitral"),
      std::string::npos);
}

TEST(Recipe, WrongTypesSayWhatIsExpected) {
  EXPECT_NE(refusal("[denoise]\niterations = 1.5\n").problem.find("whole number"), std::string::npos);
  EXPECT_NE(refusal("[mesh]\nmeshes = \"torso\"\n").problem.find("list of texts"), std::string::npos);
  EXPECT_NE(refusal("name = 3\n").problem.find("text"), std::string::npos);
  EXPECT_NE(refusal("[landmarks.seeds_mm]\nlv_blood = [1, 2]\n").problem.find("three numbers"), std::string::npos);
}

TEST(Recipe, NumbersThatNoSettingCanHaveAreRefusedWithTheirLine) {
  for (const char* text :
       {"[chambers]\nvein_stump_mm = -1\n", "[chambers]\ncava_stump_radii = -1\n", "[epicardium]\nduality_gap = nan\n",
        "[mesh]\ngrowth = inf\n", "[epicardium]\nmax_iterations = -5\n", "[fibers]\ndemons_iterations = [60, -1]\n",
        "[fibers.rule]\nrv_helix_endo_deg = nan\n", "[denoise]\niterations = 5000000000\n"}) {
    const UserError error = refusal(text);
    EXPECT_NE(error.problem.find("must"), std::string::npos) << text;
    EXPECT_NE(error.where.find("recipe.toml:2"), std::string::npos) << error.where;
  }
  EXPECT_NE(refusal("[landmarks.seeds_mm]\nlv_blood = [1, nan, 2]\n").problem.find("finite"), std::string::npos);
}

TEST(Recipe, AnglesOfTheRuleAreASectionOfTheirOwn) {
  const Recipe recipe = read_recipe(recipe_file("[fibers]\ngrid_mm = 2\n[fibers.rule]\nrv_helix_endo_deg = 75\n"));
  EXPECT_EQ(recipe.fibers.grid_mm, 2);
  EXPECT_EQ(recipe.fibers.rule.rv_helix_endo_deg, 75);
  EXPECT_NE(refusal("[fibers.rule]\nrv_helix_end_deg = 75\n").remedy.find("rv_helix_endo_deg"), std::string::npos);
  Recipe written = read_recipe(recipe_file(write_recipe(recipe, true)));
  EXPECT_EQ(written.fibers.rule.rv_helix_endo_deg, 75);
}

TEST(Recipe, FibresByRuleAreNoGaps) {
  Recipe recipe;
  recipe.validation.minimum_dihedral_deg = 20;
  EXPECT_EQ(bounds_of(recipe).maximum_inpainted_fraction, 0.5);
  recipe.fibers.method = "rule";
  EXPECT_EQ(bounds_of(recipe).maximum_inpainted_fraction, 1);
  EXPECT_EQ(bounds_of(recipe).minimum_dihedral_deg, 20);
}

TEST(Recipe, BrokenTomlNamesTheLine) {
  EXPECT_NE(refusal("name = \"a\"\n[mesh\n").where.find(":2"), std::string::npos);
}

std::string error_of(const std::string& text) {
  return testing::error_of([&] { read_recipe(recipe_file(text)); });
}

/// The parser, and what takes its tables away, go one call deeper for each.
TEST(Recipe, TablesWithinTablesWithoutEndAreRefused) {
  const auto repeated = [](const std::string& text, int count) {
    std::string all;
    for (int n = 0; n < count; ++n) all += text;
    return all;
  };
  const int many = 100000;
  for (const auto& text :
       {repeated("a.", many) + "a = 1\n", "[" + repeated("a.", many) + "a]\n", "[[" + repeated("a.", many) + "a]]\n",
        "a = " + repeated("[", many), "a = " + repeated("{a=", many), "a = " + repeated("[{a.b.c=", many),
        repeated("a . ", many) + "a = 1\n", repeated("\"a\".", many) + "a = 1\n", repeated("'.'.", many) + "a = 1\n",
        "a = 'x'\n" + repeated("a.", many), "a = \"\"\"\n\"\"\"\n" + repeated("a.", many),
        "#\"\n" + repeated("a.", many)})
    EXPECT_NE(error_of(text).find("not valid TOML"), std::string::npos) << text.substr(0, 30);
  EXPECT_NE(error_of(std::string(5 << 20, '#')).find("too large"), std::string::npos);
  // Points in texts, notes and numbers nest nothing.
  EXPECT_EQ(error_of("name = \"" + repeated("a.", 100) + "\" #" + repeated("a.", 100) +
                     "\n[mesh]\nresolutions_mm = [1.0" + repeated(", 1.0", 60) + "]\n"),
            "");
}

TEST(Recipe, MissingFileIsAUserError) { EXPECT_THROW(read_recipe("no/such/recipe.toml"), UserError); }

TEST(Recipe, InputPathsAreRelativeToTheRecipe) {
  const auto path = recipe_file("[input]\nct = \"scan/ct.nrrd\"\natlas = \"/data/atlas.vtk\"\n");
  const Recipe recipe = read_recipe(path);
  EXPECT_EQ(recipe.input.ct, (std::filesystem::path(path).parent_path() / "scan/ct.nrrd").string());
  EXPECT_EQ(recipe.input.atlas, "/data/atlas.vtk");
}

TEST(Recipe, WrittenRecipeReadsBackTheSame) {
  Recipe recipe =
      read_recipe(recipe_file("name = \"a \\\"b\\\"\"\n[mesh]\nheart_edge_mm = 1.25\n"
                              "[landmarks.seeds_mm]\nlv_blood = [1, 2.5, -3]\n"
                              "[landmarks.valves.aortic]\ncenter_mm=[1,2,3]\nnormal=[0,0,1]\nradius_mm=12\n"));
  recipe.landmarks.lv_apex_mm = Vec3{0.1, 0.2, 0.3};
  const std::string text = write_recipe(recipe, false);
  const Recipe back = read_recipe(recipe_file(text));
  EXPECT_EQ(write_recipe(back, false), text);
  EXPECT_EQ(back.landmarks.valves.at("aortic").radius_mm, 12);
  EXPECT_EQ(back.landmarks.seeds_mm.at("lv_blood"), (Vec3{1, 2.5, -3}));
  EXPECT_EQ(back.name, "a \"b\"");
}

TEST(Recipe, LabelsFromElsewhereTakeNumbersAndNames) {
  const Recipe recipe = read_recipe(
      recipe_file("[input]\nlabels = \"masks/\"\n[labels]\nignore = [7, \"spleen\"]\ncomplete = [\"walls\"]\n"
                  "[labels.regions]\nlv_blood = [500, \"left ventricle\"]\n"));
  EXPECT_EQ(recipe.labels.preset, "none");  // what the user maps is all there is
  EXPECT_EQ(recipe.labels.ignore.keys, (std::vector<std::string>{"7", "spleen"}));
  EXPECT_EQ(recipe.labels.regions.at("lv_blood").keys, (std::vector<std::string>{"500", "left ventricle"}));
  const std::string text = write_recipe(recipe, true);
  EXPECT_NE(text.find("labels = \"masks\""), std::string::npos);
  const Recipe back = read_recipe(recipe_file(text));
  EXPECT_EQ(recipe_section(back, "labels"), recipe_section(recipe, "labels"));
  EXPECT_EQ(read_recipe(recipe_file("")).labels.preset, "auto");
  EXPECT_EQ(read_recipe(recipe_file("[labels]\npreset = \"mm_whs\"\n[labels.regions]\naorta = [1]\n")).labels.preset,
            "mm_whs");
  EXPECT_NE(refusal("[labels.regions]\nlv_blod = [500]\n").remedy.find("lv_blood"), std::string::npos);
  EXPECT_NE(refusal("[labels.regions]\nlv_blood = 500\n").problem.find("list of values or names"), std::string::npos);
  EXPECT_NE(refusal("[replace]\nwalls = \"a\"\n").problem.find("replace.walls"), std::string::npos);
}

TEST(Recipe, ReplacedStagesAreRelativeToTheRecipeToo) {
  const auto path = recipe_file("[replace]\nchambers = \"stages/chambers.nii.gz\"\n");
  EXPECT_EQ(read_recipe(path).replace.chambers,
            (std::filesystem::path(path).parent_path() / "stages/chambers.nii.gz").string());
}

TEST(Recipe, CopyForABundleHoldsNoFolders) {
  const Recipe recipe = read_recipe(
      recipe_file("[input]\nct = \"/home/somebody/ct.nii.gz\"\n[replace]\nbody = \"/home/somebody/body.nii.gz\"\n"));
  EXPECT_EQ(write_recipe(recipe, true).find("somebody"), std::string::npos);
}

TEST(Landmarks, WrittenFileReadsBackTheSame) {
  Landmarks landmarks;
  landmarks.seeds_mm["rv_blood"] = {0.1, 1e-7, -300};
  landmarks.valves["pulmonary"] = {{1, 2, 3}, {0, 0.6, 0.8}, 11.5};
  landmarks.lv_apex_mm = Vec3{4, 5, 6};
  const auto path = testing::scratch_folder("landmarks") / "landmarks.json";
  std::ofstream(path) << write_landmarks(landmarks);
  EXPECT_EQ(write_landmarks(read_landmarks(path.string())), write_landmarks(landmarks));
}

TEST(Landmarks, WhatTheCommandPrintsBesideThemIsNoMistake) {
  EXPECT_TRUE(
      parse_landmarks("{\"confidence\": 0.9, \"warnings\": [], \"volumes_ml\": {}, \"long_axis\": [0, 0, 1]}", "")
          .seeds_mm.empty());
  EXPECT_THROW(parse_landmarks("{\"confidense\": 0.9}", ""), UserError);
  EXPECT_THROW(parse_landmarks("{\"seeds_mm\": null}", ""), UserError);
}

TEST(Landmarks, DamagedFilesAreRefused) {
  const auto path = testing::scratch_folder("landmarks_bad") / "landmarks.json";
  for (const char* text : {"{", "[]", "{\"seed\": {}}", "{\"seeds_mm\": {\"lv_blood\": [1, 2]}}",
                           "{\"valves\": {\"mitral\": {\"center_mm\": [0, 0, 0]}}}"}) {
    std::ofstream(path) << text;
    EXPECT_THROW(read_landmarks(path.string()), UserError) << text;
  }
}

}  // namespace
}  // namespace heartgen
