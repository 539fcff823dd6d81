// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <set>

#include "exporters/adjacency.hpp"
#include "exporters/bundle.hpp"
#include "exporters/cut.hpp"
#include "exporters/registry.hpp"
#include "model/error.hpp"
#include "support/client_script.hpp"
#include "support/comma_locale.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/two_region_mesh.hpp"

namespace heartgen::exporters {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::error_of;
using testing::scratch_folder;
using testing::two_region_mesh;

TEST(Export, UnknownFormatAndUnitNameTheKnownOnes) {
  const auto folder = scratch_folder("export_unknown");
  const TetMesh mesh = two_region_mesh(1);
  EXPECT_NE(error_of([&] { export_mesh("dwg", mesh, "m", folder); }).find("xdmf"), std::string::npos);
  EXPECT_NE(error_of([&] { export_mesh("vtk", mesh, "m", folder, "inch"); }).find("mm, um, cm, m"), std::string::npos);
}

TEST(Export, TableHasUniqueNames) {
  std::set<std::string_view> names;
  for (const auto& format : export_formats()) {
    EXPECT_TRUE(names.insert(format.name).second) << format.name;
    EXPECT_NO_THROW(unit_scale(format.unit)) << format.name;
  }
}

TEST(Export, SameBytesWhateverFolderTimeAndLocale) {
  const auto folder = scratch_folder("export_same");
  const TetMesh mesh = two_region_mesh(2);
  for (const auto& format : export_formats()) {
    const auto first = export_mesh(format.name, mesh, "m", folder / "a" / format.name);
    const testing::CommaLocale comma;
    const auto second = export_mesh(format.name, mesh, "m", folder / "b" / format.name);
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t f = 0; f < first.size(); ++f) {
      EXPECT_TRUE(fs::exists(first[f])) << first[f];
      EXPECT_EQ(bytes_of(first[f]), bytes_of(second[f])) << first[f];
    }
  }
}

TEST(Export, FilesThatCannotBeWrittenAreAnError) {
  const auto folder = scratch_folder("export_full");
  const TetMesh mesh = two_region_mesh(1);
  for (const auto& format : export_formats()) {
    const auto files = export_mesh(format.name, mesh, "m", folder / format.name);
    for (const auto& file : files) {
      fs::remove(file);
      fs::create_directory(file);  // a folder where the file should be
      EXPECT_NE(error_of([&] { export_mesh(format.name, mesh, "m", folder / format.name); }), "")
          << format.name << " " << file;
      fs::remove(file);
    }
  }
}

/// As openCARP keeps numbers, and as their shortest text reads.
Vec3 in_floats(const Vec3& v) {
  const auto one = [](double x) { return std::stod(fmt::format("{}", static_cast<float>(x))); };
  return {one(v.x), one(v.y), one(v.z)};
}

TEST(Export, UnitsScaleTheNodesOnly) {
  const auto folder = scratch_folder("export_units");
  const TetMesh mesh = two_region_mesh(1);
  export_mesh("opencarp", mesh, "m", folder);
  std::ifstream points(folder / "m.pts");
  std::size_t count = 0;
  Vec3 first;
  points >> count >> first.x >> first.y >> first.z;
  EXPECT_EQ(count, mesh.nodes_mm.size());
  EXPECT_EQ(first, in_floats(1000.0 * mesh.nodes_mm[0]));
  std::ifstream axes(folder / "m.lon");
  Vec3 fiber;
  int families = 0;
  axes >> families >> fiber.x >> fiber.y >> fiber.z;
  EXPECT_EQ(families, 2);
  EXPECT_EQ(fiber, in_floats(mesh.cell_fibers.fiber[0]));
}

TEST(Export, CardioidsMaterialComesFirst) {
  const auto folder = scratch_folder("export_cardioid");
  export_mesh("cardioid", two_region_mesh(1), "m", folder);
  const std::string text = bytes_of(folder / "m.vtk");
  EXPECT_LT(text.find("SCALARS material int"), text.find("VECTORS"));
  EXPECT_EQ(text.find("POINT_DATA"), std::string::npos);
}

TEST(Adjacency, FacesKnowTheirCells) {
  const TetMesh mesh = two_region_mesh(3);
  const auto sides = cells_of_faces(mesh);
  std::size_t inner = 0;
  for (std::size_t f = 0; f < sides.size(); ++f) {
    ASSERT_GE(sides[f][0], 0);
    for (const auto side : sides[f]) {
      if (side < 0) continue;
      const auto& cell = mesh.cells[static_cast<std::size_t>(side)];
      for (const auto node : mesh.faces[f]) EXPECT_NE(std::find(cell.begin(), cell.end(), node), cell.end());
    }
    if (sides[f][1] < 0) continue;
    ++inner;
    EXPECT_NE(mesh.region[static_cast<std::size_t>(sides[f][0])], mesh.region[static_cast<std::size_t>(sides[f][1])]);
  }
  EXPECT_EQ(inner, 2U * 3 * 3);
}

/// A bundle of a wall with its blood and of a mesh without fibres, exported in every format.
fs::path exported_bundle(const char* scratch) {
  const auto folder = scratch_folder(scratch);
  Bundle bundle;
  bundle.name = "clients";
  bundle.version = "1.0.0";
  bundle.license = "CC0-1.0";
  auto& with_blood = bundle.meshes["torso"] = two_region_mesh(3);
  for (std::size_t c = 0; c < with_blood.cells.size(); ++c)
    if (with_blood.region[c] != tag(Region::lv_myocardium))
      with_blood.cell_fibers.fiber[c] = with_blood.cell_fibers.sheet[c] = with_blood.cell_fibers.sheet_normal[c] = {};
  bundle.meshes["myocardium"] = only_regions(with_blood, {tag(Region::lv_myocardium)});
  TetMesh bare = two_region_mesh(2, Region::trachea);
  bare.node_fibers = bare.cell_fibers = {};
  bare.fiber_source.clear();
  bundle.meshes["trachea"] = bare;
  write_bundle(bundle, folder / "bundle");
  for (const auto& [name, mesh] : bundle.meshes)
    for (const auto& format : export_formats())
      export_mesh(format.name, read_mesh(folder / "bundle", name), name, folder / "exports" / format.name);
  return folder;
}

TEST(Clients, OtherReadersAgreeWithTheBundle) {
  const auto folder = exported_bundle("clients");
  testing::expect_script_succeeds("check_exports.py", {folder / "bundle", folder / "exports"});
}

TEST(Clients, SolversThatAreNotPackagedWouldReadThemAndRefuseSpoiledOnes) {
  const auto folder = exported_bundle("rules");
  testing::expect_script_succeeds("reader_rules.py", {folder / "exports"});
}

/// A block of right atrium beside a block of ventricle, with and without a layer of annulus between.
TEST(Clients, AWaveOfTheAtriumStopsAtTheAnnulusInFreeFem) {
  TetMesh mesh = two_region_mesh(4, Region::ra_wall);
  const auto folder = scratch_folder("pacing");
  export_mesh("medit", mesh, "joined", folder / "joined" / "medit");
  testing::expect_script_succeeds("pacing.py", {folder / "joined", "passes"});
  std::set<std::int32_t> ventricle;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(Region::lv_myocardium)) ventricle.insert(mesh.cells[c].begin(), mesh.cells[c].end());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(Region::ra_wall) &&
        std::any_of(mesh.cells[c].begin(), mesh.cells[c].end(), [&](auto n) { return ventricle.contains(n); }))
      mesh.region[c] = tag(Region::ra_annulus);
  export_mesh("medit", mesh, "parted", folder / "parted" / "medit");
  testing::expect_script_succeeds("pacing.py", {folder / "parted", "stops"});
}

TEST(Export, NamesOfAFileDoNotLeaveTheFolder) {
  const auto folder = testing::scratch_folder("export_names");
  TetMesh mesh = testing::two_region_mesh(2);
  for (const char* name : {"../../escaped", "/escaped", "\x1b[2J"}) {
    for (const auto tag : mesh.surface) mesh.names[{2, tag}] = name;
    for (const char* format : {"stl", "ply", "obj", "vtp", "opencarp", "svmultiphysics"})
      EXPECT_NE(testing::error_of([&] {
                  export_mesh(format, mesh, "mesh", folder / "in" / "out");
                }).find("cannot be part of a file's name"),
                std::string::npos)
          << format;
  }
  for (const char* name : {"../escaped", "..", "/escaped"})
    EXPECT_NE(testing::error_of([&] { export_mesh("vtk", mesh, name, folder / "in" / "out"); }), "") << name;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    EXPECT_EQ(entry.path().string().find("escaped"), std::string::npos) << entry.path();
}

}  // namespace
}  // namespace heartgen::exporters
