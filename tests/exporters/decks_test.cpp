// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/decks.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "exporters/cut.hpp"
#include "exporters/registry.hpp"
#include "support/client_script.hpp"
#include "support/data.hpp"
#include "support/fibred_heart.hpp"
#include "support/files.hpp"

namespace heartgen::exporters {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::fibred_heart;
using testing::scratch_folder;
using testing::two_region_mesh;

TEST(Decks, EveryFormatHasAPageWithItsTags) {
  const auto folder = scratch_folder("decks_readme");
  const TetMesh mesh = two_region_mesh(1);
  for (const auto& format : export_formats()) {
    export_mesh(format.name, mesh, "m", folder / format.name);
    const std::string page = bytes_of(folder / format.name / "m_README.md");
    EXPECT_NE(page.find("| `lv_myocardium` | 1 | 6 |"), std::string::npos) << format.name;
    EXPECT_NE(page.find("| `epicardium` | 101 |"), std::string::npos) << format.name;
    EXPECT_NE(page.find(", in " + std::string(format.unit) + "."), std::string::npos) << format.name;
    EXPECT_LT(std::count(page.begin(), page.end(), '\n'), 70) << format.name;
  }
}

TEST(Decks, InputsComeWhereThereIsMuscleWithFibresAlone) {
  const auto folder = scratch_folder("decks_inputs");
  const auto has = [&](const TetMesh& mesh, const char* format, const char* file) {
    export_mesh(format, mesh, "m", folder / format);
    const bool found = fs::exists(folder / format / file);
    fs::remove_all(folder / format);
    return found;
  };
  const TetMesh with_blood = two_region_mesh(1), heart = only_regions(with_blood, {tag(Region::lv_myocardium)});
  TetMesh bare = heart;
  bare.cell_fibers = bare.node_fibers = {};
  for (const auto& [format, file] : {std::pair{"xdmf", "m_activation.py"},
                                     {"medit", "m_activation.edp"},
                                     {"opencarp", "m_activation.par"},
                                     {"opencarp-binary", "m_activation.par"},
                                     {"chaste", "m_activation.xml"},
                                     {"openfoam", "m/constant/stimulusProtocol"}}) {
    EXPECT_TRUE(has(with_blood, format, file)) << file;
    EXPECT_TRUE(has(heart, format, file)) << file;
    EXPECT_FALSE(has(bare, format, file)) << file;
  }
  for (const auto& [format, file] :
       {std::pair{"svmultiphysics", "m_activation.xml"}, {"abaqus", "m_inflate.inp"}, {"febio", "m_inflate.feb"}}) {
    EXPECT_FALSE(has(with_blood, format, file)) << file;
    EXPECT_TRUE(has(heart, format, file)) << file;
  }
  EXPECT_TRUE(has(with_blood, "xdmf", "m_potential.py"));
  EXPECT_FALSE(has(heart, "xdmf", "m_potential.py"));
}

TEST(Decks, TheSiteIsOnTheLeftOfTheSeptum) {
  const TetMesh heart = fibred_heart(5);
  const Vec3 site = septal_site(heart);
  EXPECT_LT(site.x, -10) << "the right ventricle lies on the -x side";
  EXPECT_GT(site.x, -30);
  EXPECT_NE(std::find(heart.nodes_mm.begin(), heart.nodes_mm.end(), site), heart.nodes_mm.end());
}

/// The solver tells 31 domains apart and takes none below 1.
TEST(Decks, RegionsThatSvMultiPhysicsCannotTellApartAreRefused) {
  const auto folder = scratch_folder("decks_domains");
  const auto refusal = [&](std::int32_t own_tag) {
    TetMesh mesh = two_region_mesh(1);
    mesh.region.assign(mesh.region.size(), own_tag);
    mesh.names[{3, own_tag}] = "mine";
    return testing::error_of([&] { export_mesh("svmultiphysics", mesh, "m", folder); });
  };
  for (const std::int32_t own_tag : {-1, 0, 30, 42, 99}) {
    const std::string text = refusal(own_tag);
    EXPECT_NE(text.find(fmt::format("mine has the number {}", own_tag)), std::string::npos) << text;
    EXPECT_NE(text.find("from 1 to 29"), std::string::npos) << text;
    EXPECT_TRUE(fs::is_empty(folder)) << "nothing is half written";
  }
  for (const std::int32_t own_tag : {1, 29}) EXPECT_EQ(refusal(own_tag), "");
}

/// By the real programs where they are installed: make test-clients installs them.
TEST(Decks, RunInTheSolversThatAreInstalled) {
  const auto folder = scratch_folder("decks_run");
  const TetMesh heart = fibred_heart(3);
  for (const auto& format : export_formats()) export_mesh(format.name, heart, "heart", folder / format.name);
  for (const char* format : {"msh2", "msh-ascii"})
    export_mesh(format, without_interfaces(heart), "heart", folder / "outer" / format);
  testing::expect_script_succeeds("run_decks.py", {folder});
}

}  // namespace
}  // namespace heartgen::exporters
