// SPDX-License-Identifier: GPL-3.0-or-later
// improve, mesh and place as a user runs them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "generator/adapters/itk_io.hpp"
#include "model/labels.hpp"
#include "support/data.hpp"
#include "support/program.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

/// A block of 3 × 3 × 3 cubes of six cells, the middle of it pulled into a corner; one region; legacy .vtk.
void write_block(const fs::path& path, const std::string& arrays) {
  std::ofstream out(path);
  out << "# vtk DataFile Version 3.0\nblock\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 64 double\n";
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) {
        const bool pulled = i == 1 && j == 1 && k == 1;
        out << (pulled ? 0.2 : i) << ' ' << (pulled ? 0.3 : j) << ' ' << (pulled ? 0.4 : k) << '\n';
      }
  out << "CELLS 162 810\n";
  constexpr int paths[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i)
        for (const auto& way : paths) {
          const auto corner = [&](int bits) {
            return ((k + (bits >> 2)) * 4 + j + ((bits >> 1) & 1)) * 4 + i + (bits & 1);
          };
          out << "4 " << corner(0) << ' ' << corner(way[0]) << ' ' << corner(way[1]) << ' ' << corner(7) << '\n';
        }
  out << "CELL_TYPES 162\n";
  for (int c = 0; c < 162; ++c) out << "10\n";
  out << arrays;
}

std::string numbers(int count) {
  std::string text = "POINT_DATA 64\nSCALARS id int 1\nLOOKUP_TABLE default\n";
  for (int i = 0; i < count; ++i) text += std::to_string(i) + "\n";
  return text;
}

TEST(ImproveCommand, RaisesAnglesAndKeepsGoingThroughFormats) {
  const auto folder = testing::scratch_folder("improve");
  write_block(folder / "block.vtk", "");
  const auto first = testing::heartgen("improve block.vtk better.msh --goal-deg 25 --json", folder.string());
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  const auto result = nlohmann::json::parse(first.output);
  EXPECT_LT(result["before"]["dihedral_min_deg"], 20);
  EXPECT_GE(result["after"]["dihedral_min_deg"], 25 - 1e-4);
  EXPECT_EQ(result["cells_below_goal"], 0);
  EXPECT_TRUE(result["surfaces_unchanged"]);
  const auto second = testing::heartgen("improve better.msh again.vtu --json", folder.string());
  ASSERT_EQ(second.exit_code, 0) << second.errors;
  EXPECT_EQ(nlohmann::json::parse(second.output)["before"]["dihedral_min_deg"], result["after"]["dihedral_min_deg"]);
}

TEST(ImproveCommand, NumbersOfNodesAreMadeAnewAndToldOf) {
  const auto folder = testing::scratch_folder("improve_ids");
  write_block(folder / "block.vtk", numbers(64));
  const auto run = testing::heartgen("improve block.vtk better.vtk", folder.string());
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_NE(run.output.find("ids made anew: id\n"), std::string::npos) << run.output;
  const auto both = testing::heartgen("improve block.vtk b.vtk --drop one,id,two", folder.string());
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_NE(both.errors.find("\"one\", \"two\""), std::string::npos) << "all at once: " << both.errors;
  EXPECT_EQ(testing::heartgen("improve block.vtk better.vtk --drop id", folder.string()).exit_code, 0);
  EXPECT_EQ(testing::heartgen("improve block.vtk better.stl", folder.string()).exit_code, 2);
  EXPECT_EQ(testing::heartgen("improve none.vtk better.vtk", folder.string()).exit_code, 2);
  EXPECT_EQ(testing::heartgen("improve block.vtk b.vtk --drop id --region wall", folder.string()).exit_code, 2);
}

/// A ball of blood in a wall of 6 mm.
void write_ball(const fs::path& path) {
  Grid grid;
  grid.size = {40, 40, 40};
  LabelVolume labels(grid, 0);
  for (std::int64_t k = 0; k < 40; ++k)
    for (std::int64_t j = 0; j < 40; ++j)
      for (std::int64_t i = 0; i < 40; ++i) {
        const double r = norm(Vec3{i - 20.0, j - 20.0, k - 20.0});
        if (r < 15) labels(i, j, k) = tag(r < 9 ? Region::lv_blood : Region::lv_myocardium);
      }
  adapters::write_volume(path.string(), labels);
}

TEST(MeshCommand, WritesTheKindOfFileThatTheNameAsksFor) {
  const auto folder = testing::scratch_folder("mesh");
  write_ball(folder / "ball.nii.gz");
  std::vector<nlohmann::json> before;
  for (const std::string kind : {"vtu", "msh", "vtk"}) {
    const auto run = testing::heartgen("mesh ball.nii.gz new/ball." + kind + " --edge 3", folder.string());
    ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
    EXPECT_NE(run.output.find("new/ball." + kind), std::string::npos) << run.output;
    EXPECT_TRUE(fs::exists(folder / "new" / "ball_curves.vtp"));
    const auto again = testing::heartgen("improve new/ball." + kind + " again.vtu --json", folder.string());
    ASSERT_EQ(again.exit_code, 0) << again.errors;
    before.push_back(nlohmann::json::parse(again.output)["before"]);
    EXPECT_EQ(before.back(), before.front()) << kind;
  }
  EXPECT_GT(before.front()["cells"], 1000);
}

TEST(MeshCommand, MeshesTheWallsAloneAndTellsOfThoseThatAreTooThin) {
  const auto folder = testing::scratch_folder("mesh_walls");
  write_ball(folder / "ball.nii.gz");
  const auto run = testing::heartgen("mesh ball.nii.gz walls.vtu --edge 2 --walls --json", folder.string());
  ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
  EXPECT_EQ(run.errors.find("too thin"), std::string::npos) << run.errors;
  EXPECT_EQ(run.errors.find("has no cell"), std::string::npos) << run.errors;  // blood is not asked for
  std::ifstream file(folder / "walls_markers.json");
  const auto markers = nlohmann::json::parse(file);
  EXPECT_EQ(markers.size(), 3U) << markers;
  for (const auto* name : {"lv_myocardium", "lv_endocardium", "epicardium"})
    EXPECT_TRUE(markers.contains(name)) << markers;
  const auto coarse = testing::heartgen("mesh ball.nii.gz walls.vtu --edge 8 --walls --json", folder.string());
  EXPECT_NE(coarse.errors.find("of lv_myocardium is too thin"), std::string::npos) << coarse.errors;
  const auto refused = testing::heartgen("mesh ball.nii.gz w.vtu --walls --backend cgal", folder.string());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("--walls"), std::string::npos) << refused.errors;
}

TEST(MeshCommand, TakesAnotherProgramsNumbers) {
  const auto folder = testing::scratch_folder("mesh_preset");
  write_ball(folder / "ball.nii.gz");
  LabelVolume labels = adapters::read_labels((folder / "ball.nii.gz").string());
  for (auto& label : labels.voxels)  // heartchambers_highres: 1 wall, 3 left blood
    if (label == tag(Region::lv_blood)) label = 3;
  adapters::write_volume((folder / "chambers.nii.gz").string(), labels);
  const auto refused = testing::heartgen("mesh chambers.nii.gz heart.vtu --edge 3 --preset heartgen", folder.string());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("--preset totalsegmentator_heart"), std::string::npos) << refused.errors;
  const auto run = testing::heartgen("mesh chambers.nii.gz heart.vtu --edge 3", folder.string());
  ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
  std::ifstream file(folder / "heart_markers.json");
  EXPECT_TRUE(nlohmann::json::parse(file).contains("lv_blood"));
}

TEST(MeshCommand, EdgesThatNoMeshHasAreRefusedAsSuch) {
  const auto folder = testing::scratch_folder("mesh_edges");
  Grid grid;
  grid.size = {8, 8, 8};
  adapters::write_volume((folder / "labels.nii.gz").string(), LabelVolume(grid, tag(Region::lv_blood)));
  for (const char* edge : {"nan", "inf", "0", "-1", "1e9"}) {
    const auto refused = testing::heartgen(std::string("mesh labels.nii.gz m.vtu --edge ") + edge, folder.string());
    EXPECT_EQ(refused.exit_code, 2) << edge;
    EXPECT_NE(refused.errors.find("heart_edge_mm"), std::string::npos) << refused.errors;
    EXPECT_EQ(refused.errors.find("memory"), std::string::npos) << refused.errors;
  }
}

TEST(MeshCommand, ARegionThatIsTooSmallIsMissedAloud) {
  const auto folder = testing::scratch_folder("mesh_lost_region");
  Grid grid;
  grid.size = {30, 30, 30};
  LabelVolume labels(grid), dot(grid);
  for (std::int64_t k = 0; k < 30; ++k)
    for (std::int64_t j = 0; j < 30; ++j)
      for (std::int64_t i = 0; i < 30; ++i)
        if (norm(Vec3{static_cast<double>(i) - 12, static_cast<double>(j) - 12, static_cast<double>(k) - 12}) < 8)
          labels(i, j, k) = tag(Region::lv_blood);
  labels(27, 27, 27) = dot(27, 27, 27) = tag(Region::rv_blood);
  adapters::write_volume((folder / "labels.nii.gz").string(), labels);
  adapters::write_volume((folder / "dot.nii.gz").string(), dot);
  const auto result = testing::heartgen("mesh labels.nii.gz mesh.vtu --edge 4", folder.string());
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.errors.find("rv_blood (1 mm3 of the label map) has no cell"), std::string::npos) << result.errors;
  const auto none = testing::heartgen("mesh dot.nii.gz dot.vtu --edge 4", folder.string());
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.errors.find("dot.nii.gz: nothing of its regions is left"), std::string::npos) << none.errors;
  EXPECT_FALSE(fs::exists(folder / "dot.vtu"));
}

TEST(BuildCommand, EdgesOfLateMeshesAreLookedAtFirst) {
  const auto folder = testing::scratch_folder("late_edges");
  for (const std::string name : {"trachea_edge_mm", "carotid_edge_mm"}) {
    std::ofstream(folder / "recipe.toml") << "[input]\nlabels = \"recipe.toml\"\n[mesh]\n" << name << " = 0\n";
    const auto refused = testing::heartgen("build recipe.toml --output bundle", folder.string());
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.errors.find("mesh." + name), std::string::npos) << refused.errors;
  }
}

TEST(PlaceCommand, WritesTheLabelMapAndThePose) {
  const auto folder = testing::scratch_folder("place");
  const auto write = [&](const std::string& name, std::int64_t shift) {
    Grid grid;
    grid.size = {40, 40, 40};
    grid.spacing_mm = {3, 3, 3};
    LabelVolume person(grid, tag(Region::torso));
    const auto fill = [&](std::int64_t x, std::int64_t y, std::int64_t z, std::int64_t size, Region region) {
      for (auto k = z; k < z + size; ++k)
        for (auto j = y; j < y + size; ++j)
          for (auto i = x; i < x + size; ++i) person(i + shift, j, k) = tag(region);
    };
    fill(8, 10, 10, 18, Region::lv_myocardium);
    fill(10, 12, 12, 5, Region::lv_blood);
    fill(19, 12, 12, 5, Region::rv_blood);
    fill(10, 20, 12, 5, Region::la_blood);
    fill(19, 20, 20, 5, Region::ra_blood);
    adapters::write_volume((folder / name).string(), person);
  };
  write("heart.nii.gz", 0);
  write("torso.nii.gz", 4);
  const auto run =
      testing::heartgen("place heart.nii.gz torso.nii.gz placed.nii.gz --pose pose.json --json", folder.string());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto pose = nlohmann::json::parse(run.output);
  EXPECT_NEAR(pose["torso_from_heart"][0][3], 12, 1e-3);
  EXPECT_NEAR(pose["rms_mm"], 0, 1e-3);
  EXPECT_TRUE(fs::exists(folder / "pose.json"));
  const auto placed = adapters::read_labels((folder / "placed.nii.gz").string());
  EXPECT_GE(placed.grid.size[0], 44) << "the heart's grid, continued to hold the torso";
  EXPECT_EQ(testing::heartgen("place heart.nii.gz none.nii.gz placed.nii.gz", folder.string()).exit_code, 2);
}

}  // namespace
}  // namespace heartgen
