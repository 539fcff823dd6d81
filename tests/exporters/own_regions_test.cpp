// SPDX-License-Identifier: GPL-3.0-or-later
// Regions of the user's own and cavities, in the bundle and in every format.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "exporters/bundle.hpp"
#include "exporters/cut.hpp"
#include "exporters/registry.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "model/labels.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/two_region_mesh.hpp"

namespace heartgen::exporters {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::scratch_folder;

/// With two regions of the user's own, and the outer faces of the blood as a cavity, one side of it a cap.
TetMesh sample_mesh() {
  TetMesh mesh = testing::two_region_mesh(3);
  mesh.user_regions = {{"core", first_user_region, {}}, {"grey_zone", first_user_region + 1, {}}};
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const float part = static_cast<float>(c % 5) / 4;
    mesh.user_regions[0].fraction.push_back(c < 40 ? part : 0);
    mesh.user_regions[1].fraction.push_back(c < 40 ? 1 - part : 0);
    mesh.user_region.push_back(c >= 40 ? 0 : first_user_region + (part < 0.5F ? 1 : 0));
  }
  const auto wall = *surface_from_name("lv_endocardium");
  mesh.cavities.push_back({"lv_cavity", tag(Region::lv_blood), {}, {}});
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.surface[f] != wall) continue;
    mesh.cavities[0].faces.push_back(mesh.faces[f]);
    mesh.cavities[0].surface.push_back(
        mesh.cavities[0].faces.size() % 4 == 0 ? cap_tag(*surface_from_name("mitral_orifice")) : wall);
  }
  return mesh;
}

std::size_t lines_of(const fs::path& path) {
  const auto text = bytes_of(path);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

bool holds(const fs::path& path, const std::string& words) { return bytes_of(path).find(words) != std::string::npos; }

class OwnRegions : public ::testing::Test {
 protected:
  fs::path folder = scratch_folder("own_regions");
  TetMesh mesh = sample_mesh();
  std::int64_t in_core = std::count(mesh.user_region.begin(), mesh.user_region.end(), first_user_region);

  fs::path exported(const std::string& format) {
    export_mesh(format, mesh, "m", folder / format);
    return folder / format;
  }
};

TEST_F(OwnRegions, ComeBackFromABundleWithTheirNames) {
  Bundle bundle;
  bundle.name = "heart";
  bundle.version = "1.0.0";
  bundle.license = "CC-BY-4.0";
  bundle.recipe = "name = \"heart\"\n";
  bundle.report_html = "<html></html>";
  bundle.meshes["myocardium"] = mesh;
  write_bundle(bundle, folder / "bundle");
  const auto manifest = read_manifest(folder / "bundle");
  EXPECT_EQ(manifest.user_regions, (std::map<std::string, std::int32_t>{{"core", 51}, {"grey_zone", 52}}));
  EXPECT_EQ(manifest.caps, (std::map<std::string, std::int32_t>{{"mitral_orifice_cap", 2106}}));
  const auto& entry = manifest.meshes.at("myocardium");
  EXPECT_EQ(entry.user_regions.at("core"), in_core);
  EXPECT_EQ(entry.cavities.at("lv_cavity").blood, "lv_blood");
  EXPECT_EQ(entry.cavities.at("lv_cavity").caps, std::vector<std::string>{"mitral_orifice_cap"});
  EXPECT_NEAR(entry.cavities.at("lv_cavity").volume_ml,
              enclosed_volume_mm3(mesh.nodes_mm, mesh.cavities[0].faces) / 1000, 1e-12);
  const TetMesh back = read_mesh(folder / "bundle", "myocardium");
  EXPECT_EQ(back.user_region, mesh.user_region);
  ASSERT_EQ(back.user_regions.size(), 2U);
  for (const auto& region : mesh.user_regions) {
    const auto found = std::find_if(back.user_regions.begin(), back.user_regions.end(),
                                    [&](const UserRegion& r) { return r.name == region.name; });
    ASSERT_NE(found, back.user_regions.end());
    EXPECT_EQ(found->tag, region.tag);
    EXPECT_EQ(found->fraction, region.fraction);
  }
  ASSERT_EQ(back.cavities.size(), 1U);
  EXPECT_EQ(back.cavities[0].name, "lv_cavity");
  EXPECT_EQ(back.cavities[0].region, mesh.cavities[0].region);
  EXPECT_EQ(back.cavities[0].faces, mesh.cavities[0].faces);
  EXPECT_EQ(back.cavities[0].surface, mesh.cavities[0].surface);
  EXPECT_TRUE(verify_bundle(folder / "bundle").empty());
}

TEST_F(OwnRegions, ABundleWithoutThemSaysNothingOfThem) {
  Bundle bundle;
  bundle.name = "heart";
  bundle.version = "1.0.0";
  bundle.meshes["myocardium"] = testing::two_region_mesh(2);
  write_bundle(bundle, folder / "plain");
  for (const char* word : {"user_region", "cavit", "\"caps\""})
    EXPECT_FALSE(holds(folder / "plain" / "manifest.json", word)) << word;
}

TEST_F(OwnRegions, AreArraysWhereAFormatHasSome) {
  for (const char* words : {"SCALARS user_region int 1", "SCALARS fraction_core float 1"})
    EXPECT_TRUE(holds(exported("vtk-ascii") / "m.vtk", words)) << words;
  for (const char* words : {"\"user_region\"", "\"fraction_grey_zone\""}) {
    EXPECT_TRUE(holds(exported("msh-ascii") / "m.msh", words)) << words;
    EXPECT_TRUE(holds(exported("msh2") / "m_cells.msh", words)) << words;
    EXPECT_TRUE(holds(exported("xdmf") / "m.xdmf", words)) << words;
  }
  const TetMesh back = adapters::read_vtu(exported("vtu") / "m.vtu");
  EXPECT_EQ(back.user_region, mesh.user_region);
  const auto solver =
      adapters::read_unstructured(exported("svmultiphysics") / "m-mesh-complete/mesh-complete.mesh.vtu");
  EXPECT_TRUE(solver.cell_scalars.contains("user_region"));
}

TEST_F(OwnRegions, AreSetsOrListsElsewhere) {
  EXPECT_EQ(lines_of(exported("opencarp") / "m_core.regele"), static_cast<std::size_t>(in_core) + 1);
  EXPECT_TRUE(holds(exported("abaqus") / "m.inp", "*ELSET, ELSET=grey_zone\n"));
  EXPECT_TRUE(holds(exported("febio") / "m.feb", "<ElementSet name=\"core\">"));
  EXPECT_TRUE(fs::exists(exported("openfoam") / "m/constant/polyMesh/sets/core"));
  EXPECT_TRUE(holds(exported("openfoam") / "m/0/fraction_core", "volScalarField"));
  for (const char* format :
       {"opencarp", "opencarp-binary", "chaste", "medit", "mfem", "abaqus", "febio", "svmultiphysics"}) {
    const auto table = exported(format) / "m_user_regions.csv";
    ASSERT_TRUE(fs::exists(table)) << format;
    EXPECT_EQ(lines_of(table), 41U) << format;
    EXPECT_TRUE(holds(table, "cell,user_region,fraction_core,fraction_grey_zone\n")) << format;
  }
}

TEST_F(OwnRegions, EveryPageAndVolumeNamesThem) {
  for (const auto& format : export_formats()) {
    const auto place = exported(std::string(format.name));
    EXPECT_TRUE(holds(place / "m_README.md", "grey_zone")) << format.name;
    EXPECT_TRUE(holds(place / "m_README.md", "lv_cavity")) << format.name;
    if (format.description.starts_with("every surface")) continue;
    const auto table = place / "m_cavities.csv";
    ASSERT_TRUE(fs::exists(table)) << format.name;
    EXPECT_EQ(lines_of(table), mesh.cavities[0].faces.size() + 1) << format.name;
    EXPECT_TRUE(holds(table, "lv_cavity,mitral_orifice_cap,")) << format.name;
  }
}

TEST_F(OwnRegions, CavitiesAreSurfacesOfTheirOwn) {
  for (const char* format : {"stl", "ply", "obj", "vtp"})
    for (const char* name : {"m_lv_cavity", "m_lv_cavity_mitral_orifice_cap"})
      EXPECT_TRUE(fs::exists(exported(format) / (std::string(name) + "." + format))) << format << name;
  EXPECT_EQ(lines_of(exported("opencarp") / "m_lv_cavity.surf"), mesh.cavities[0].faces.size() + 1);
  for (const auto& path :
       {exported("vtu") / "m_cavities.vtp", exported("svmultiphysics") / "m-mesh-complete/cavities.vtp"}) {
    TetMesh back;
    back.nodes_mm = mesh.nodes_mm;
    adapters::read_cavities(path, back);
    EXPECT_EQ(back.cavities[0].faces, mesh.cavities[0].faces);
  }
}

TEST_F(OwnRegions, StayWithTheRegionsThatAreCutOut) {
  const TetMesh part = only_regions(mesh, {tag(Region::lv_myocardium)});
  ASSERT_EQ(part.user_regions.size(), 2U);
  for (std::size_t c = 0; c < part.cells.size(); ++c) {
    const auto parent = static_cast<std::size_t>(part.parent_cell[c]);
    EXPECT_EQ(part.user_region[c], mesh.user_region[parent]);
    EXPECT_EQ(part.user_regions[1].fraction[c], mesh.user_regions[1].fraction[parent]);
  }
  ASSERT_EQ(part.cavities.size(), 0U) << "some of its faces are the blood's alone";
}

}  // namespace
}  // namespace heartgen::exporters
