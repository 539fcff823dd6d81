// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/own_edges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "generator/mesh/mesh_heart.hpp"
#include "generator/mesh/size_field.hpp"
#include "mesh/shapes.hpp"
#include "model/error.hpp"
#include "validation/mesh_checks.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

LabelVolume ball() {
  return label_cube(40, 1, [](const Vec3& p) {
    return norm(p) < 9 ? Region::lv_blood : norm(p) < 15 ? Region::lv_myocardium : Region::torso;
  });
}

/// Wishes of `edge_mm` where x is positive, on a grid of 2 mm that is turned by half a turn and covers x > -4 alone.
Volume<float> wishes(float edge_mm) {
  Grid grid;
  grid.size = {14, 26, 26};
  grid.spacing_mm = {2, 2, 2};
  grid.direction.rows = {Vec3{-1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}};
  grid.origin_mm = {23, 25, -25};
  Volume<float> image(grid, 0);
  for (std::int64_t v = 0; v < grid.voxel_count(); ++v) {
    const auto i = static_cast<double>(v % 14);
    if (23 - 2 * i > 0) image.voxels[static_cast<std::size_t>(v)] = edge_mm;
  }
  return image;
}

MeshSettings coarse() {
  MeshSettings settings;
  settings.heart_edge_mm = 2.4;
  settings.blood_edge_mm = 3;
  return settings;
}

double mean_cell_volume_mm3(const TetMesh& mesh, double from_x, double to_x) {
  double volume = 0, count = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (mesh.region[c] != tag(Region::lv_myocardium)) continue;
    const auto at = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(mesh.cells[c][i])]; };
    const double x = (at(0).x + at(1).x + at(2).x + at(3).x) / 4;
    if (x < from_x || x > to_x) continue;
    volume += dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) / 6;
    ++count;
  }
  return volume / count;
}

TEST(OwnEdges, ComeFromTheNearestVoxelWhateverTheImagesGrid) {
  const auto labels = ball();
  const auto edges = mesh::own_edges_on(wishes(1.2F), labels.grid);
  std::size_t at = 0;
  for (std::int64_t k = 0; k < labels.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < labels.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < labels.grid.size[0]; ++i, ++at) {
        const Vec3 p =
            lps_from_index(labels.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        EXPECT_EQ(edges[at], p.x > 0 ? 1.2F : 0.0F) << p.x << " " << p.y << " " << p.z;
      }
}

TEST(OwnEdges, AreInTheMeshAndTheRestIsAsWithout) {
  const auto labels = ball();
  const auto image = wishes(1.2F);
  const auto without = mesh::mesh_labels(labels, coarse());
  const auto with = mesh::mesh_labels(labels, coarse(), nullptr, &image);
  const double ratio = mean_cell_volume_mm3(without, 4, 15) / mean_cell_volume_mm3(with, 4, 15);
  EXPECT_GT(ratio, 5) << "half the edge is an eighth of the volume";
  EXPECT_LT(ratio, 10);
  EXPECT_NEAR(mean_cell_volume_mm3(without, -15, -11) / mean_cell_volume_mm3(with, -15, -11), 1, 0.15);
  const auto report = validation::check_mesh("mesh", with, {});
  EXPECT_GE(row_value(report, "mesh", "dihedral_min"), 30);
  EXPECT_LE(row_value(report, "mesh", "dihedral_max"), 143);
}

TEST(OwnEdges, MayBeLongerThanTheWalls) {
  const auto labels = ball();
  const auto image = wishes(4.8F);
  auto settings = coarse();
  settings.heart_edge_mm = 1.2;
  const auto without = mesh::mesh_labels(labels, settings);
  const auto with = mesh::mesh_labels(labels, settings, nullptr, &image);
  EXPECT_GT(mean_cell_volume_mm3(with, 9, 15) / mean_cell_volume_mm3(without, 9, 15), 5);
}

TEST(OwnEdges, RefusesWhatIsNoLengthOrNotHereOrTooMuch) {
  const auto labels = ball();
  for (const float edge : {-1.0F, 0.01F, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_THROW(mesh::own_edges_on(wishes(edge), labels.grid), UserError) << edge;
  auto elsewhere = wishes(1);
  elsewhere.grid.origin_mm = {500, 0, 0};
  EXPECT_THROW(mesh::own_edges_on(elsewhere, labels.grid), UserError);
  EXPECT_THROW(mesh::own_edges_on(wishes(0), labels.grid), UserError);
  const auto domain = mesh::make_domain(labels, coarse());
  const auto finest = mesh::own_edges_on(wishes(0.1F), labels.grid);
  EXPECT_THROW(mesh::size_field(domain, coarse(), {}, finest), UserError);
}

}  // namespace
