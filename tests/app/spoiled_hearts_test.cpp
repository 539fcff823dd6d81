// SPDX-License-Identifier: GPL-3.0-or-later
// A yes that can be believed: a good heart passes, and hearts that are spoiled on purpose are caught, each by the row,
// the use or the message that names what is wrong.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "exporters/bundle.hpp"
#include "exporters/certificate_json.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/pipeline/bundle_stage.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"
#include "support/data.hpp"
#include "support/program.hpp"
#include "validation/uses.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;
using Meshes = std::map<std::string, TetMesh>;

bool fails(const Certificate& certificate, const std::string& scope, const std::string& metric) {
  return std::any_of(certificate.rows.begin(), certificate.rows.end(), [&](const ReportRow& row) {
    return row.scope == scope && row.metric == metric && row.verdict() == Verdict::failed;
  });
}

std::string findings(const Certificate& certificate) {
  std::string text;
  for (const auto& row : certificate.rows)
    if (row.verdict() > Verdict::passed)
      text += fmt::format("{} {} {} = {}\n", row.verdict() == Verdict::failed ? "FAILED" : "warns", row.scope,
                          row.metric, row.value);
  return text;
}

class SpoiledHearts : public ::testing::Test {
 protected:
  struct Heart {
    Meshes meshes;
    LabelVolume labels;
    Recipe recipe;
    Certificate certificate;
  };

  static void SetUpTestSuite() {
    folder() = testing::scratch_folder("spoiled_hearts").string();
    const auto phantom = testing::heartgen("phantom phantom --size 102,100,82 --spacing 2.4,2.4,2.4", folder());
    ASSERT_EQ(phantom.exit_code, 0) << phantom.errors;
    std::ofstream(folder() + "/phantom/recipe.toml", std::ios::app)
        << "\n[fibers]\ngrid_mm = 3\ndepth_grid_mm = 3\ndemons_iterations = [5, 3, 1]\n"
           "[mesh]\nmeshes = [\"myocardium\", \"chambers\"]\n";
    const auto built = build("bundle", "heart_edge_mm = 2\n");
    ASSERT_EQ(built.exit_code, 0) << built.output << built.errors;
    auto& heart = good();
    const auto bundle = folder() + "/bundle";
    for (const char* name : {"myocardium", "chambers"}) heart.meshes[name] = exporters::read_mesh(bundle, name);
    heart.labels = exporters::read_labels(bundle);
    heart.recipe = read_recipe(bundle + "/recipe.toml");
    heart.certificate = exporters::read_certificate(bundle);
  }

  /// From the phantom's exact labels; `more` is added to the recipe.
  static testing::ProgramResult build(const std::string& name, const std::string& more,
                                      const std::string& labels = "phantom/truth/labels.nii.gz") {
    const std::string recipe = folder() + "/phantom/" + name + ".toml";
    fs::copy_file(folder() + "/phantom/recipe.toml", recipe, fs::copy_options::overwrite_existing);
    std::ofstream(recipe, std::ios::app) << more;
    return testing::heartgen(
        fmt::format("build phantom/{}.toml --labels {} --preset heartgen --output {} --no-cache", name, labels, name),
        folder());
  }

  static Certificate certificate_of(const Meshes& meshes, const LabelVolume& labels) {
    const auto bounds = bounds_of(good().recipe);
    return validation::certified(pipeline::certificate(meshes, labels, good().recipe.mesh, bounds), {},
                                 pipeline::names_of(meshes), bounds);
  }

  static std::string& folder() {
    static std::string path;
    return path;
  }
  static Heart& good() {
    static Heart heart;
    return heart;
  }
};

/// Drops the cells of a mesh that `drop` names, and the faces that none of the others has.
template <class Drop>
void drop_cells(TetMesh& mesh, Drop&& drop) {
  std::size_t kept = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (drop(c)) continue;
    mesh.cells[kept] = mesh.cells[c];
    mesh.region[kept] = mesh.region[c];
    for (auto* axes : {&mesh.cell_fibers.fiber, &mesh.cell_fibers.sheet, &mesh.cell_fibers.sheet_normal})
      if (!axes->empty()) (*axes)[kept] = (*axes)[c];
    ++kept;
  }
  mesh.cells.resize(kept);
  mesh.region.resize(kept);
  for (auto* axes : {&mesh.cell_fibers.fiber, &mesh.cell_fibers.sheet, &mesh.cell_fibers.sheet_normal})
    if (!axes->empty()) axes->resize(kept);
}

Vec3 middle_of(const TetMesh& mesh, std::size_t c) {
  Vec3 sum;
  for (const auto n : mesh.cells[c]) sum += mesh.nodes_mm[static_cast<std::size_t>(n)];
  return sum / 4;
}

TEST_F(SpoiledHearts, TheGoodOnePasses) {
  EXPECT_NE(verdict_of(good().certificate), Verdict::failed) << findings(good().certificate);
  const auto again = certificate_of(good().meshes, good().labels);
  EXPECT_TRUE(all_passed(again.rows)) << findings(again);
  for (const auto& row : good().certificate.rows) EXPECT_FALSE(row.reason.empty()) << row.scope << " " << row.metric;
}

TEST_F(SpoiledHearts, APartCutOff) {
  auto meshes = good().meshes;
  auto& mesh = meshes.at("myocardium");
  const auto lowest = std::ranges::min(mesh.nodes_mm, {}, &Vec3::z).z;
  drop_cells(mesh, [&](std::size_t c) { return middle_of(mesh, c).z < lowest + 15; });
  const auto certificate = certificate_of(meshes, good().labels);
  EXPECT_TRUE(fails(certificate, "myocardium/rv_myocardium", "volume_difference")) << findings(certificate);
}

TEST_F(SpoiledHearts, ARegionShrunkByAFifth) {
  auto meshes = good().meshes;
  auto& mesh = meshes.at("chambers");
  std::vector<std::uint8_t> of_blood(mesh.nodes_mm.size());
  Vec3 sum;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(Region::lv_blood))
      for (const auto n : mesh.cells[c]) of_blood[static_cast<std::size_t>(n)] = 1;
  double count = 0;
  for (std::size_t n = 0; n < of_blood.size(); ++n)
    if (of_blood[n]) sum += mesh.nodes_mm[n], ++count;
  const Vec3 middle = sum / count;
  for (std::size_t n = 0; n < of_blood.size(); ++n)
    if (of_blood[n]) mesh.nodes_mm[n] = middle + std::cbrt(0.8) * (mesh.nodes_mm[n] - middle);
  const auto certificate = certificate_of(meshes, good().labels);
  EXPECT_TRUE(fails(certificate, "chambers/lv_blood", "volume_difference")) << findings(certificate);
}

TEST_F(SpoiledHearts, FibresShuffledInAWall) {
  for (const bool nodes : {true, false}) {
    auto meshes = good().meshes;
    auto& mesh = meshes.at("myocardium");
    auto& axes = nodes ? mesh.node_fibers : mesh.cell_fibers;
    std::vector<std::size_t> of_wall;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      if (mesh.region[c] == tag(Region::rv_myocardium)) {
        if (nodes)
          for (const auto n : mesh.cells[c]) of_wall.push_back(static_cast<std::size_t>(n));
        else
          of_wall.push_back(c);
      }
    std::ranges::sort(of_wall);
    of_wall.erase(std::ranges::unique(of_wall).begin(), of_wall.end());
    std::uint64_t state = 1;
    for (std::size_t i = of_wall.size(); i > 1; --i) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      const auto a = of_wall[i - 1], b = of_wall[(state >> 33) % i];
      for (auto* list : {&axes.fiber, &axes.sheet, &axes.sheet_normal}) std::swap((*list)[a], (*list)[b]);
    }
    const auto certificate = certificate_of(meshes, good().labels);
    EXPECT_TRUE(fails(certificate, "rv_myocardium", "cell_jump_p50")) << findings(certificate);
    EXPECT_EQ(fails(certificate, "rv_myocardium", "neighbour_jump_p50"), nodes);
  }
}

TEST_F(SpoiledHearts, SurfacesMovedByAMillimetre) {
  auto meshes = good().meshes;
  for (auto& [name, mesh] : meshes)
    for (auto& p : mesh.nodes_mm) p.y += 1;
  const auto certificate = certificate_of(meshes, good().labels);
  for (const char* region : {"myocardium/lv_myocardium", "chambers/lv_blood", "chambers/ra_blood"})
    EXPECT_TRUE(fails(certificate, region, "centroid_shift")) << findings(certificate);
}

TEST_F(SpoiledHearts, AnOrificeClosed) {
  auto meshes = good().meshes;
  auto& mesh = meshes.at("chambers");
  const auto mitral = surface_from_name("mitral_orifice"), wall = surface_from_name("la_endocardium");
  ASSERT_TRUE(mitral && wall);
  std::ranges::replace(mesh.surface, *mitral, *wall);
  const auto certificate = certificate_of(meshes, good().labels);
  EXPECT_TRUE(fails(certificate, "mitral_orifice", "area")) << findings(certificate);
}

TEST_F(SpoiledHearts, Islands) {
  auto meshes = good().meshes;
  auto& mesh = meshes.at("myocardium");
  const auto count = mesh.cells.size();
  for (std::size_t c = 0; c < 20; ++c) {
    auto cell = mesh.cells[c];
    for (auto& n : cell) {
      const auto old = static_cast<std::size_t>(n);
      n = static_cast<std::int32_t>(mesh.nodes_mm.size());
      mesh.nodes_mm.push_back(mesh.nodes_mm[old] + Vec3{100.0 + 5.0 * static_cast<double>(c), 0, 0});
    }
    mesh.cells.push_back(cell);
    mesh.region.push_back(mesh.region[c]);
  }
  ASSERT_EQ(mesh.cells.size(), count + 20);
  const auto certificate = certificate_of(meshes, good().labels);
  EXPECT_TRUE(fails(certificate, "myocardium", "floating_parts")) << findings(certificate);
}

TEST_F(SpoiledHearts, MirroredFibres) {
  auto meshes = good().meshes;
  auto& mesh = meshes.at("myocardium");
  // In the plane of wall and fibre, the helix changes its sign when the part along the long axis does. The phantom's
  // axis is found as the direction from the base of the left ventricle to its apex: mirror across the plane normal to
  // it.
  Vec3 base, apex;
  double nodes = 0;
  const auto mitral = surface_from_name("mitral_orifice");
  const auto& chambers = good().meshes.at("chambers");
  for (std::size_t f = 0; f < chambers.faces.size(); ++f)
    if (chambers.surface[f] == mitral)
      for (const auto n : chambers.faces[f]) base += chambers.nodes_mm[static_cast<std::size_t>(n)], ++nodes;
  base = base / nodes;
  double farthest = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(Region::lv_myocardium))
      if (const Vec3 p = middle_of(mesh, c); norm(p - base) > farthest) farthest = norm(p - base), apex = p;
  const Vec3 axis = normalized(apex - base);
  for (auto* axes : {&mesh.node_fibers, &mesh.cell_fibers})
    for (auto* list : {&axes->fiber, &axes->sheet, &axes->sheet_normal})
      for (auto& v : *list) v = v - 2 * dot(v, axis) * axis;
  const auto certificate = certificate_of(meshes, good().labels);
  EXPECT_TRUE(fails(certificate, "lv_myocardium", "helix_endocardium_median")) << findings(certificate);
  EXPECT_TRUE(fails(certificate, "rv_myocardium", "helix_fall")) << findings(certificate);
}

TEST_F(SpoiledHearts, AVentricleOfTwentyMillilitres) {
  auto labels = good().labels;
  // All but a ball of 20 ml around the middle of the ventricle's blood becomes wall.
  const double radius_mm = std::cbrt(20000 * 3 / (4 * std::numbers::pi));
  Vec3 sum;
  double count = 0;
  const auto each = [&](auto&& visit) {
    std::size_t v = 0;
    for (std::int64_t k = 0; k < labels.grid.size[2]; ++k)
      for (std::int64_t j = 0; j < labels.grid.size[1]; ++j)
        for (std::int64_t i = 0; i < labels.grid.size[0]; ++i, ++v)
          if (labels.voxels[v] == tag(Region::lv_blood))
            visit(labels.voxels[v], lps_from_index(labels.grid, {static_cast<double>(i), static_cast<double>(j),
                                                                 static_cast<double>(k)}));
  };
  each([&](std::uint8_t&, const Vec3& p) { sum += p, ++count; });
  const Vec3 middle = sum / count;
  each([&](std::uint8_t& label, const Vec3& p) {
    if (norm(p - middle) > radius_mm) label = tag(Region::lv_myocardium);
  });
  const auto certificate = certificate_of(good().meshes, labels);
  EXPECT_TRUE(fails(certificate, "lv_blood", "volume")) << findings(certificate);
}

TEST_F(SpoiledHearts, SmoothedByEightMillimetres) {
  const auto built = build("smooth", "heart_edge_mm = 2\nsmoothing_mm = 8\n");
  EXPECT_EQ(built.exit_code, 3) << built.output << built.errors;
  const auto certificate = exporters::read_certificate(folder() + "/smooth");
  EXPECT_TRUE(fails(certificate, "myocardium/la_wall", "volume_difference")) << findings(certificate);
  EXPECT_TRUE(fails(certificate, "myocardium/ra_wall", "dice_with_labels")) << findings(certificate);
}

TEST_F(SpoiledHearts, CoarseEdges) {
  const auto built = build("coarse", "heart_edge_mm = 6\n");
  const auto certificate = exporters::read_certificate(folder() + "/coarse");
  EXPECT_GE(verdict_of(certificate), Verdict::warned) << built.output << built.errors;
  EXPECT_NE(built.output.find("unfit for eikonal: myocardium edge_mean"), std::string::npos) << built.output;
  EXPECT_NE(std::ranges::find(certificate.warnings, "uses.eikonal", &Warning::code), certificate.warnings.end());
  const auto& uses = certificate.uses;
  const auto eikonal = std::ranges::find(uses, "eikonal", &UseVerdict::use);
  ASSERT_NE(eikonal, uses.end());
  EXPECT_EQ(eikonal->fitness, Fitness::unfit);
  EXPECT_NE(eikonal->remedy.find("heart_edge_mm"), std::string::npos) << eikonal->remedy;
  EXPECT_FALSE(eikonal->is_asked);
  const auto asked = build("coarse_asked", "heart_edge_mm = 6\n[validation]\nuses = [\"eikonal\"]\n");
  EXPECT_EQ(asked.exit_code, 3) << asked.output << asked.errors;
}

TEST_F(SpoiledHearts, SwappedVentricles) {
  auto labels = adapters::read_labels(folder() + "/phantom/truth/labels.nii.gz");
  for (auto& label : labels.voxels)
    for (const auto& [a, b] :
         {std::pair{Region::lv_blood, Region::rv_blood}, {Region::lv_myocardium, Region::rv_myocardium}})
      if (label == tag(a) || label == tag(b)) {
        label = label == tag(a) ? tag(b) : tag(a);
        break;
      }
  adapters::write_volume(folder() + "/swapped.nii.gz", labels);
  const auto built = build("swapped", "", "swapped.nii.gz");
  EXPECT_EQ(built.exit_code, 2) << built.output;
  EXPECT_NE(built.errors.find("exchanged"), std::string::npos) << built.errors;
  EXPECT_FALSE(fs::exists(folder() + "/swapped"));
}

}  // namespace
}  // namespace heartgen
