// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/painting/region_masks.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "generator/adapters/itk_io.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "generator/painting/triangles.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen::painting {
namespace {

namespace fs = std::filesystem;

/// A box of 2 x 3 x 4 mm, triangles outwards, turned so that nothing lies along an axis.
adapters::TriangleSurface turned_box() {
  adapters::TriangleSurface box;
  const double c = std::cos(0.4), s = std::sin(0.4);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{2.0 * (corner & 1), 3.0 * (corner >> 1 & 1), 4.0 * (corner >> 2)};
    const Vec3 q{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    box.points.push_back({10 + q.x, -20 + c * q.y - s * q.z, 5 + s * q.y + c * q.z});
  }
  box.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
               {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return box;
}

std::string text_stl(const adapters::TriangleSurface& surface) {
  std::string text = "solid box\n";
  for (const auto& face : surface.faces) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const auto n : face) {
      const Vec3& p = surface.points[static_cast<std::size_t>(n)];
      char line[100];
      std::snprintf(line, sizeof line, "vertex %.17g %.17g %.17g\n", p.x, p.y, p.z);
      text += line;
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

std::string binary_stl(const adapters::TriangleSurface& surface) {
  std::string bytes(80, ' ');
  const auto append = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  append(static_cast<std::uint32_t>(surface.faces.size()));
  for (const auto& face : surface.faces) {
    for (int i = 0; i < 3; ++i) append(0.0F);
    for (const auto n : face)
      for (int axis = 0; axis < 3; ++axis)
        append(static_cast<float>(surface.points[static_cast<std::size_t>(n)][axis]));
    append(std::uint16_t{0});
  }
  return bytes;
}

std::string legacy_vtk(const adapters::TriangleSurface& surface) {
  std::string text = "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET POLYDATA\nPOINTS " +
                     std::to_string(surface.points.size()) + " double\n";
  for (const auto& p : surface.points) {
    char line[100];
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", p.x, p.y, p.z);
    text += line;
  }
  text += "POLYGONS " + std::to_string(surface.faces.size()) + " " + std::to_string(4 * surface.faces.size()) + "\n";
  for (const auto& f : surface.faces)
    text += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) + "\n";
  return text;
}

double volume_of(const RegionMask& region) {
  double voxels = 0;
  for (const auto voxel : region.mask.voxels) voxels += voxel;
  return voxels * region.mask.grid.voxel_volume_mm3();
}

class Regions : public ::testing::Test {
 protected:
  fs::path folder = testing::scratch_folder("regions");

  std::string image(const std::string& name, const std::vector<std::uint8_t>& values) {
    Grid grid;
    grid.size = {4, 4, 4};
    Volume<std::uint8_t> labels(grid);
    for (std::size_t v = 0; v < values.size(); ++v) labels.voxels[21 + v] = values[v];
    adapters::write_volume((folder / name).string(), labels);
    return (folder / name).string();
  }
  std::string file(const std::string& name, const std::string& bytes) {
    testing::write_bytes(folder / name, bytes);
    return (folder / name).string();
  }
  static std::vector<std::string> names(const std::vector<RegionSettings>& files) {
    std::vector<std::string> result;
    for (const auto& region : read_regions(files)) result.push_back(region.name);
    return result;
  }
  using Names = std::vector<std::string>;
};

TEST_F(Regions, ArgumentsOfTheCommandLine) {
  EXPECT_EQ(region_argument("a/b.nii.gz").file, "a/b.nii.gz");
  EXPECT_TRUE(region_argument("a/b.nii.gz").names.empty());
  EXPECT_EQ(region_argument("b.nii.gz:core").names, Names{"core"});
  EXPECT_EQ(region_argument("b.nii.gz:grey_zone,core").names, (Names{"grey_zone", "core"}));
  EXPECT_EQ(region_argument("b.nii.gz:").names, Names{""});
  const auto odd = file("a:b.stl", text_stl(turned_box()));
  EXPECT_EQ(region_argument(odd).file, odd);
  EXPECT_EQ(region_argument(odd + ":line").file, odd);
}

TEST_F(Regions, NamesAreGivenOrThoseOfTheFile) {
  const auto one = image("my scar.nii.gz", {1, 1}), two = image("lge.nrrd", {2, 1, 1});
  EXPECT_EQ(names({{one, {}}}), Names{"my_scar"});
  EXPECT_EQ(names({{two, {}}}), (Names{"lge_1", "lge_2"}));
  EXPECT_EQ(names({{two, {"grey_zone", "core"}}, {one, {"line"}}}), (Names{"grey_zone", "core", "line"}));
  const std::vector<RegionSettings> files{{one, {}}, {two, {}}};
  const auto named = with_names(files, read_regions(files));
  EXPECT_EQ(named[0].names, Names{"my_scar"});
  EXPECT_EQ(named[1].names, (Names{"lge_1", "lge_2"}));
}

TEST_F(Regions, ARegionHasItsVoxelsAtTheirPlace) {
  const auto regions = read_regions({{image("lge.nii.gz", {2, 1, 1}), {}}});
  EXPECT_EQ(volume_of(regions[0]), 2);
  EXPECT_EQ(volume_of(regions[1]), 1);
  EXPECT_EQ(regions[1].mask.grid.origin_mm, (Vec3{1, 1, 1}));
}

TEST_F(Regions, WrongFilesAndNamesAreRefusedWithTheReason) {
  const auto one = image("scar.nii.gz", {1}), two = image("lge.nii.gz", {1, 2});
  const auto told = [&](const RegionSettings& file, const std::string& reason) {
    const auto text = testing::error_of([&] { read_regions({file}); });
    EXPECT_NE(text.find(reason), std::string::npos) << text;
    EXPECT_NE(text.find(fs::path(file.file).filename().string()), std::string::npos) << text;
  };
  told({(folder / "none.nii.gz").string(), {}}, "does not exist");
  told({image("empty.nii.gz", {0}), {}}, "all its voxels are 0");
  told({two, {"scar"}}, "2 regions (values 1, 2), and 1 name is given");
  told({one, {"a", "b"}}, "1 region (value 1), and 2 names are given");
  told({one, {""}}, "no word");
  told({one, {"my scar"}}, "no word");
  told({one, {"lv_myocardium"}}, "heartgen's own");
  told({one, {"epicardium"}}, "heartgen's own");
  told({two, {"a", "a"}}, "two regions");
  const auto pipe = folder / "pipe.nii.gz";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  told({pipe.string(), {}}, "pipe");
  const auto pipe_stl = folder / "pipe.stl";
  ASSERT_EQ(mkfifo(pipe_stl.c_str(), 0600), 0);
  told({pipe_stl.string(), {}}, "pipe");
}

TEST_F(Regions, EveryKindOfClosedSurfaceHasItsVolume) {
  const auto box = turned_box();
  TetMesh mesh;  // its faces are the surface
  mesh.nodes_mm = box.points;
  mesh.faces = box.faces;
  mesh.surface.assign(box.faces.size(), 101);
  adapters::write_vtp(folder / "box.vtp", mesh);
  for (const auto& path : {file("text.stl", text_stl(box)), file("binary.stl", binary_stl(box)),
                           file("box.vtk", legacy_vtk(box)), (folder / "box.vtp").string()}) {
    const auto regions = read_regions({{path, {}}});
    ASSERT_EQ(regions.size(), 1U) << path;
    EXPECT_NEAR(volume_of(regions[0]), 24, 0.02 * 24) << path;
  }
}

/// Rays through edges and corners: everything lies on the voxels' lines.
TEST_F(Regions, ABoxAlongTheAxesIsFilledExactly) {
  adapters::TriangleSurface box = turned_box();
  for (int corner = 0; corner < 8; ++corner)
    box.points[static_cast<std::size_t>(corner)] = {4.0 * (corner & 1), 4.0 * (corner >> 1 & 1), 4.0 * (corner >> 2)};
  const Mask mask = inside_of(box, 1, "box");
  double voxels = 0;
  for (const auto voxel : mask.voxels) voxels += voxel;
  EXPECT_EQ(voxels, 64);
}

TEST_F(Regions, OpenAndDamagedSurfacesAreRefused) {
  auto open = turned_box();
  open.faces.pop_back();
  const auto told = [&](const std::string& path, const std::string& reason) {
    const auto text = testing::error_of([&] { read_regions({{path, {}}}); });
    EXPECT_NE(text.find(reason), std::string::npos) << text;
  };
  told(file("open.stl", text_stl(open)), "3 of its edges have a triangle on one side alone");
  const auto whole = binary_stl(turned_box());
  told(file("cut.stl", whole.substr(0, whole.size() - 7)), "is no STL");
  told(file("none.stl", "solid a\nendsolid a\n"), "no triangle");
  told(file("words.stl", "solid a\nvertex 1 x 2\n"), "not three numbers");
  auto quads = legacy_vtk(turned_box());
  quads.replace(quads.find("POLYGONS"), std::string::npos, "POLYGONS 1 5\n4 0 1 3 2\n");
  told(file("quads.vtk", quads), "4 nodes instead of 3");
  told(file("empty.vtp", ""), "empty.vtp");
  auto metres = turned_box();
  for (auto& p : metres.points) p = 1000 * p;
  told(file("um.stl", text_stl(metres)), "mm wide");
}

}  // namespace
}  // namespace heartgen::painting
