// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/fov_cuts.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "generator/mesh/surfaces.hpp"
#include "model/labels.hpp"

namespace heartgen::pipeline {
namespace {

/// Cubes of 10 mm, six cells each, from the origin to (20, 20, 20); the outer faces are skin.
TetMesh block() {
  constexpr int nodes = 3, cubes = 2;
  constexpr double edge_mm = 10;
  constexpr int paths[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};
  TetMesh mesh;
  for (int n = 0; n < nodes * nodes * nodes; ++n)
    mesh.nodes_mm.push_back(edge_mm * Vec3{static_cast<double>(n % nodes), static_cast<double>(n / nodes % nodes),
                                           static_cast<double>(n / nodes / nodes)});
  for (int k = 0; k < cubes; ++k)
    for (int j = 0; j < cubes; ++j)
      for (int i = 0; i < cubes; ++i)
        for (const auto& way : paths) {
          const auto corner = [&](int bits) {
            return ((k + (bits >> 2)) * nodes + j + ((bits >> 1) & 1)) * nodes + i + (bits & 1);
          };
          mesh.cells.push_back({corner(0), corner(way[0]), corner(way[1]), corner(7)});
        }
  mesh.region.assign(mesh.cells.size(), tag(Region::torso));
  for (const auto& face : mesh::cell_faces(mesh.cells)) {
    if (face.other >= 0) continue;
    mesh.faces.push_back(face.nodes);
    mesh.surface.push_back(*surface_from_name("skin"));
  }
  return mesh;
}

TEST(FovCuts, TheBodyEndsInASurfaceOfItsOwnWherePaddingBegins) {
  Grid grid;
  grid.size = {40, 40, 40};
  grid.spacing_mm = {1, 1, 1};
  grid.origin_mm = {-10, -10, -10};
  anatomy::Padding padding;  // columns along z from x = 21 mm on
  padding.width = 40;
  padding.is_slice.assign(40, 0);
  for (int c = 0; c < 40 * 40; ++c) padding.is_column.push_back(c % 40 > 30);
  TetMesh mesh = block();
  pipeline::label_padding_cuts(mesh, grid, {});
  EXPECT_EQ(std::count(mesh.surface.begin(), mesh.surface.end(), *surface_from_name("fov_cut")), 0);
  pipeline::label_padding_cuts(mesh, grid, padding);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    double min_x_mm = 100;
    for (const auto node : mesh.faces[f])
      min_x_mm = std::min(min_x_mm, mesh.nodes_mm[static_cast<std::size_t>(node)].x);
    EXPECT_EQ(surface_name(mesh.surface[f]), min_x_mm == 20 ? "fov_cut" : "skin") << f;
  }
}

}  // namespace
}  // namespace heartgen::pipeline
