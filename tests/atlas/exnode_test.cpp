// SPDX-License-Identifier: GPL-3.0-or-later
// Atlases in the exchange format of CMISS and OpenCMISS-Zinc.
#include "generator/atlas/exnode.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

#include "generator/atlas/atlas_image.hpp"
#include "generator/fibers/transfer.hpp"
#include "generator/ventricles/ventricles.hpp"
#include "model/error.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/model_heart.hpp"

namespace heartgen::atlas {
namespace {

/// One brick of 80 mm by 60 by 30 with fibres at 30 degrees to its longest side; linear but for x, which is Hermite
/// along xi1 with slopes that make it linear again.
struct BrickFiles {
  std::filesystem::path folder = testing::scratch_folder("exnode");

  std::string write(const std::string& first_basis = "c.Hermite") const {
    std::ofstream nodes(folder / "brick.exnode"), elements(folder / "brick.exelem");
    nodes
        << " Group name: brick\n #Fields=2\n 1) coordinates, coordinate, rectangular cartesian, #Components=3\n"
           "   x.  Value index= 1, #Derivatives= 1 (d/ds1)\n   y.  Value index= 3, #Derivatives= 0\n"
           "   z.  Value index= 4, #Derivatives= 0\n 2) fibres, anatomical, fibre, #Components=3\n"
           "   fibre angle.  Value index= 5, #Derivatives= 0\n   imbrication angle.  Value index= 6, #Derivatives= 0\n"
           "   sheet angle.  Value index= 7, #Derivatives= 0\n";
    for (int n = 0; n < 8; ++n)
      nodes << " Node: " << n + 1 << "\n  " << 80 * (n & 1) << " 0.8E+02\n  " << 60 * ((n >> 1) & 1) << "\n  "
            << 30 * (n >> 2) << "\n  0.5235987755982988 0 0\n";
    elements << " Group name: brick\n Shape.  Dimension=3\n #Scale factor sets= 1\n   l.Lagrange, #Scale factors= 2\n"
                " #Nodes= 8\n #Fields=2\n";
    const auto component = [&](const std::string& name, const std::string& basis, bool slope) {
      elements << "   " << name << ".  " << basis << "*l.Lagrange*l.Lagrange, no modify, standard node based.\n";
      for (int n = 1; n <= 8; ++n)
        elements << "      " << n << ".  #Values=1\n       Value indices: 1" << (slope ? " 2" : "")
                 << "\n       Scale factor indices: 1" << (slope ? " 2" : "") << "\n";
    };
    elements << " 1) coordinates, coordinate, rectangular cartesian, #Components=3\n";
    component("x", first_basis, true);
    component("y", "l.Lagrange", false);
    component("z", "l.Lagrange", false);
    elements << " 2) fibres, anatomical, fibre, #Components=3\n";
    component("fibre angle", "l.Lagrange", false);
    component("imbrication angle", "l.Lagrange", false);
    component("sheet angle", "l.Lagrange", false);
    elements << " Element: 1 0 0\n   Nodes:\n     1 2 3 4 5 6 7 8\n   Scale factors:\n     1 1\n";
    return (folder / "brick.exelem").string();
  }
};

TEST(Exnode, ABrickIsFilledWithCellsAndItsFibersLieAtTheirAngle) {
  const auto atlas = read_exnode_atlas(BrickFiles{}.write());
  EXPECT_EQ(atlas.name, "brick.exelem");
  TetMesh mesh;
  mesh.nodes_mm = atlas.points_mm;
  double volume = 0;
  for (const Cell& cell : atlas.cells) volume += cell_volume_mm3(mesh, cell);
  EXPECT_NEAR(volume, 80 * 60 * 30, 1e-6);
  EXPECT_EQ(atlas.points_mm.size(), 11U * 9 * 7);
  for (const Vec3& f : atlas.fiber)
    ASSERT_LT(testing::axis_angle_deg(f, {std::cos(std::acos(-1.0) / 6), 0.5, 0}), 1e-6);
}

TEST(Exnode, WhatCannotBeUnderstoodIsAUserError) {
  const BrickFiles files;
  EXPECT_THROW(read_exnode_atlas(files.write("q.Lagrange")), UserError);
  const auto path = files.write();
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 40);
  EXPECT_THROW(read_exnode_atlas(path), UserError);
  files.write();
  std::filesystem::resize_file(files.folder / "brick.exnode", 700);
  EXPECT_THROW(read_exnode_atlas(path), UserError);
  std::filesystem::remove(files.folder / "brick.exnode");
  EXPECT_THROW(read_exnode_atlas(path), UserError);
}

TEST(Exnode, TheAucklandHeartHasTheFibersOfItsTetrahedra) {
  const std::string elements = testing::real_data("auckland-heart/heart.exelem.gz");
  const std::string mesh = testing::real_data("auckland-heart/auckland_ventricles.vtk");
  if (elements.empty() || mesh.empty()) GTEST_SKIP() << "no real data on this machine";
  const auto ours = read_fiber_atlas(elements), known = read_fiber_atlas(mesh);
  // Elements that lie a turn apart would leave gaps in the walls.
  const auto volume_of = [](const ventricles::AtlasImage& image) {
    return std::count_if(image.ventricles.parts.voxels.begin(), image.ventricles.parts.voxels.end(),
                         ventricles::is_wall);
  };
  const auto wall = volume_of(atlas::image_of_atlas(ours, 2));
  EXPECT_NEAR(static_cast<double>(volume_of(atlas::image_of_atlas(known, 2))), static_cast<double>(wall),
              0.02 * static_cast<double>(wall));
  TetMesh mesh_of_ours;
  mesh_of_ours.nodes_mm = ours.points_mm;
  mesh_of_ours.cells = ours.cells;
  mesh_of_ours.node_fibers.fiber = ours.fiber;
  for (const Vec3& f : ours.fiber)
    mesh_of_ours.node_fibers.sheet.push_back(normalized(cross(f, std::abs(f.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})));
  const auto at_known = fibers::transfer_fibers(mesh_of_ours, known.points_mm, {}, 1);
  std::vector<double> angle_deg;
  for (std::size_t n = 0; n < known.points_mm.size(); ++n)
    if (norm(at_known.node.fiber[n]) > 0.5)
      angle_deg.push_back(testing::axis_angle_deg(known.fiber[n], at_known.node.fiber[n]));
  EXPECT_LT(at_known.farthest_mm, 0.5);
  std::sort(angle_deg.begin(), angle_deg.end());
  const auto quantile = [&](double q) {
    return angle_deg[static_cast<std::size_t>(q * static_cast<double>(angle_deg.size() - 1))];
  };
  RecordProperty("median_deg", std::to_string(quantile(0.5)));
  EXPECT_LT(quantile(0.5), 1);
  EXPECT_LT(quantile(0.95), 5);
}

}  // namespace
}  // namespace heartgen::atlas
