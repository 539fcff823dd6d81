// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/size_field.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "generator/mesh/mesh_heart.hpp"
#include "generator/mesh/thin_walls.hpp"
#include "mesh/shapes.hpp"
#include "model/error.hpp"
#include "validation/wall_layers.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

MeshSettings settings_with(int layers) {
  MeshSettings settings;
  settings.heart_edge_mm = 1.8;
  settings.wall_layers = layers;
  return settings;
}

/// A ball of blood, its centre `offset_mm` off that of the ball of muscle around it: thin on one side.
LabelVolume shell(double outer_mm, double inner_mm, double offset_mm) {
  return label_cube(54, 1, [=](const Vec3& p) {
    return norm(p - Vec3{offset_mm, 0, 0}) < inner_mm ? Region::rv_blood
           : norm(p) < outer_mm                       ? Region::rv_myocardium
                                                      : Region::torso;
  });
}

double edge_in(const LabelVolume& labels, const MeshSettings& settings, const Vec3& at) {
  const auto domain = mesh::make_domain(labels, settings);
  return mesh::edge_at(mesh::size_field(domain, settings, mesh::regions_with_shape()), at);
}

TEST(WallLayers, OnlyThinWallsGetShorterEdges) {
  const auto labels = shell(20, 15, 3);  // 2 mm thick at +x, 8 mm at -x
  for (const int layers : {2, 3}) {
    EXPECT_NEAR(edge_in(labels, settings_with(layers), {19, 0, 0}), 0.9, 1e-6) << layers;
    EXPECT_NEAR(edge_in(labels, settings_with(layers), {-16, 0, 0}), 1.8, 1e-6) << layers;
  }
  for (const int layers : {0, 1}) EXPECT_GT(edge_in(labels, settings_with(layers), {19, 0, 0}), 1.75) << layers;
}

TEST(WallLayers, ThicknessIsThatOfTheLargestBallInTheWall) {
  constexpr double sample_mm = 0.5;
  for (const double thickness : {2.0, 3.0, 4.5}) {
    const auto domain = mesh::make_domain(shell(16 + thickness, 16, 0), 0.8);
    const auto share_below = [&](double limit_mm) {
      const auto thin = mesh::thin_walls(domain, limit_mm, sample_mm);
      double count = 0;
      for (const auto voxel : thin.voxels) count += voxel;
      return count * sample_mm * sample_mm * sample_mm /
             region_volume_mm3(shell(16 + thickness, 16, 0), Region::rv_myocardium);
    };
    // The surface of a map of voxels is known to a part of a voxel, that of the samples to half a sample on each side.
    EXPECT_LT(share_below(thickness - 0.9), 0.02) << thickness;
    EXPECT_GT(share_below(thickness + 0.9), 0.95) << thickness;
  }
}

TEST(WallLayers, AreInTheMesh) {
  const auto labels = shell(18, 16, 0);
  const auto layers_of = [&](int wanted) {
    return validation::wall_layers(mesh::mesh_labels(labels, settings_with(wanted))).at(tag(Region::rv_myocardium));
  };
  EXPECT_GT(layers_of(0).below_two, 0.5) << "no thin wall: the test would show nothing";
  const auto two = layers_of(2);
  EXPECT_GE(two.p5, 2);
  EXPECT_LT(two.below_two, 0.02);
}

// A plate of bone and one of lung, 4 mm thick.
TEST(SizeField, OnlyThinPartsOfTheResolvedRegionsGetShorterEdges) {
  MeshSettings settings;
  settings.torso_edge_mm = 12;
  const auto labels = label_cube(60, 1, [](const Vec3& p) {
    return std::abs(p.x + 12) < 2 ? Region::bone : std::abs(p.x - 12) < 2 ? Region::lung : Region::torso;
  });
  const auto domain = mesh::make_domain(labels, settings);
  const auto edges_with = [&](const mesh::LabelSet& resolved) {
    const auto sizes = mesh::size_field(domain, settings, resolved);
    return std::array{mesh::edge_at(sizes, {-12, 0, 0}), mesh::edge_at(sizes, {12, 0, 0})};
  };
  EXPECT_EQ(edges_with({}), (std::array{12.0, 12.0}));
  mesh::LabelSet bone{};
  bone[tag(Region::bone)] = true;
  const auto [in_bone, in_lung] = edges_with(bone);
  EXPECT_LT(in_bone, 7);
  EXPECT_EQ(in_lung, 12);
  const auto both = edges_with(mesh::regions_with_shape());
  EXPECT_EQ(both[0], in_bone);
  EXPECT_LT(both[1], 7);
}

TEST(WallLayers, RefusesWhatIsNoNumberOfLayersOrTooMuch) {
  const auto labels = shell(18, 16, 0);
  for (const int layers : {-1, 5}) EXPECT_THROW(mesh::mesh_labels(labels, settings_with(layers)), UserError) << layers;
  const auto domain_of = [](double thickness_mm) {
    return mesh::make_domain(label_cube(88, 1,
                                        [=](const Vec3& p) {
                                          return norm(p) < 38.5                  ? Region::rv_blood
                                                 : norm(p) < 38.5 + thickness_mm ? Region::rv_myocardium
                                                                                 : Region::torso;
                                        }),
                             0.8);
  };
  auto fine = settings_with(4);
  fine.heart_edge_mm = 0.65;  // 39 ml of wall, 13.5 cells per cube of the halved edge: 15 million
  EXPECT_NO_THROW(mesh::size_field(domain_of(2), fine));
  fine.heart_edge_mm = 0.57;  // 23 million
  EXPECT_THROW(mesh::size_field(domain_of(2), fine), UserError);
  EXPECT_NO_THROW(mesh::size_field(domain_of(4), fine)) << "no thin wall";
}

}  // namespace
