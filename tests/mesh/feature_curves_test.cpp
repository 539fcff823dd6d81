// SPDX-License-Identifier: GPL-3.0-or-later
// The curves that a mesh holds, and how the certificate measures them.
#include "model/mesh_queries/feature_curves.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "generator/mesh/mesh_heart.hpp"
#include "mesh/shapes.hpp"
#include "validation/curve_fidelity.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

constexpr double radius_mm = 9;

/// Two halves of a ball of blood in a wall: their orifice is a disc, its rim a circle.
Region two_halves(const Vec3& p) {
  if (norm(p) > 14) return Region::none;
  if (norm(p) > radius_mm) return Region::lv_myocardium;
  return p.z > 0.13 ? Region::la_blood : Region::lv_blood;
}

TetMesh mesh_of_halves(const LabelVolume& labels) {
  MeshSettings settings;
  settings.heart_edge_mm = settings.blood_edge_mm = 2;
  return mesh::mesh_labels(labels, settings);
}

const mesh_queries::FeatureCurve* curve_named(const std::vector<mesh_queries::FeatureCurve>& curves,
                                              const std::string& name) {
  for (const auto& curve : curves)
    if (mesh_queries::curve_name(curve) == name) return &curve;
  return nullptr;
}

constexpr const char* rim = "lv_endocardium+la_endocardium+mitral_orifice";

TEST(FeatureCurves, RimOfAnOrificeIsAClosedCircle) {
  const auto mesh = mesh_of_halves(label_cube(34, 1, two_halves));
  const auto curves = mesh_queries::feature_curves(mesh);
  const auto* curve = curve_named(curves, rim);
  ASSERT_NE(curve, nullptr);
  std::map<std::int32_t, int> uses;
  double length = 0;
  for (const auto& [a, b] : curve->edges) {
    const Vec3 p = mesh.nodes_mm[static_cast<std::size_t>(a)], q = mesh.nodes_mm[static_cast<std::size_t>(b)];
    length += norm(p - q);
    ++uses[a];
    ++uses[b];
    EXPECT_NEAR(std::hypot(p.x, p.y), radius_mm, 0.6);
    EXPECT_NEAR(p.z, 0.13, 0.7);
  }
  for (const auto& [node, count] : uses) EXPECT_EQ(count, 2) << node;
  EXPECT_NEAR(length, 2 * std::numbers::pi * radius_mm, 0.06 * 2 * std::numbers::pi * radius_mm);
}

TEST(FeatureCurves, OneSurfaceAloneHasNone) {
  const auto labels = label_cube(24, 1, [](const Vec3& p) { return norm(p) < 8 ? Region::lv_blood : Region::none; });
  EXPECT_TRUE(mesh_queries::feature_curves(mesh_of_halves(labels)).empty());
}

TEST(FeatureCurves, TheCertificateMeasuresHowFarAMovedMapIs) {
  constexpr double shift_mm = 0.9;
  const auto labels = label_cube(34, 1, two_halves);
  const auto mesh = mesh_of_halves(labels);
  const auto curves = mesh_queries::feature_curves(mesh);
  const auto* curve = curve_named(curves, rim);
  ASSERT_NE(curve, nullptr);
  const auto faces = validation::mesh_faces(mesh);
  const auto rows_at = [&](double z) {
    return validation::check_curves("m", mesh, faces, labels, [=](const Vec3& p) -> int {
      return tag(two_halves(p - Vec3{0, 0, z}));
    });
  };
  const std::string scope = std::string("m/") + rim;
  const auto here = rows_at(0), moved = rows_at(shift_mm);
  const double edge_mm = row_value(here, scope, "curve_length") / static_cast<double>(curve->edges.size());
  EXPECT_LT(row_value(here, scope, "curve_to_level_set_p50_in_edges"), 0.15);
  EXPECT_LT(row_value(here, scope, "curve_from_level_set_p99_in_edges"), 0.35);
  EXPECT_NEAR(row_value(moved, scope, "curve_to_level_set_p50_in_edges") * edge_mm, shift_mm, 0.3 * shift_mm);
  EXPECT_NEAR(row_value(moved, scope, "curve_from_level_set_p50_in_edges") * edge_mm, shift_mm, 0.3 * shift_mm);
}

}  // namespace
