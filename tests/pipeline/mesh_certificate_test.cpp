// SPDX-License-Identifier: GPL-3.0-or-later
// The certificate of a bundle's meshes where no mesh fills the whole label map.
#include "generator/pipeline/mesh_certificate.hpp"

#include <gtest/gtest.h>

#include "generator/mesh/mesh_heart.hpp"
#include "mesh/shapes.hpp"

namespace heartgen::pipeline {
namespace {

/// Blood of two chambers in the walls of two: the walls meet around the blood, the blood within the walls.
Region two_chambers(const Vec3& p) {
  const double distance_mm = norm(p);
  if (distance_mm > 14) return Region::none;
  const bool is_atrium = p.z > 0.13;
  if (distance_mm > 9) return is_atrium ? Region::la_wall : p.x > 3.2 ? Region::rv_myocardium : Region::lv_myocardium;
  return is_atrium ? Region::la_blood : Region::lv_blood;
}

TEST(MeshCertificate, CurvesOfAPartOfTheHeartAreFoundInItsLabels) {
  const auto labels = testing::label_cube(34, 1, two_chambers);
  MeshSettings settings;
  settings.heart_edge_mm = settings.blood_edge_mm = 2;
  settings.meshes = {"myocardium", "chambers"};
  const auto meshes = mesh::mesh_heart(labels, settings);
  ASSERT_TRUE(meshes.contains("myocardium") && meshes.contains("chambers") && !meshes.contains("torso"));
  validation::FacesOfMeshes faces;
  for (const auto& [name, mesh] : meshes) faces[name] = validation::mesh_faces(mesh);
  const auto rows = pipeline::joined(pipeline::mesh_certificate(meshes, faces, labels, settings, {}));
  EXPECT_EQ(testing::failed_rows(rows), "");
  for (const char* scope : {"myocardium/epicardium+atrioventricular_junction",
                            "myocardium/lv_endocardium+la_endocardium+atrioventricular_junction",
                            "chambers/lv_endocardium+la_endocardium+mitral_orifice"}) {
    EXPECT_LT(testing::row_value(rows, scope, "curve_to_level_set_p50_in_edges"), 0.15) << scope;
    EXPECT_LT(testing::row_value(rows, scope, "curve_from_level_set_p50_in_edges"), 0.2) << scope;
  }
}

}  // namespace
}  // namespace heartgen::pipeline
