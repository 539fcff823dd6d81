// SPDX-License-Identifier: GPL-3.0-or-later
// Rule-based fibres against closed forms on shells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generator/fibers/atrial_rule.hpp"
#include "generator/fibers/ventricle_rule.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"
#include "model/mesh_queries/mesh_laplace.hpp"
#include "support/model_heart.hpp"

namespace heartgen::fibers {
namespace {

using std::numbers::pi;

/// Part of a spherical shell around the z axis, from its lower pole up to an angle; its node numbers know where they
/// are.
struct Shell {
  double inner_mm = 20, outer_mm = 30, opening = pi / 2;  ///< the opening's angle from the lower pole
  int layers = 6, rings = 20, sectors = 40;

  std::int32_t node(int layer, int ring, int sector) const {
    const int per_layer = 1 + rings * sectors;
    return layer * per_layer + (ring == 0 ? 0 : 1 + (ring - 1) * sectors + sector % sectors);
  }
  Vec3 position(int layer, int ring, int sector) const {
    const double r = inner_mm + (outer_mm - inner_mm) * layer / layers, t = opening * ring / rings;
    const double p = 2 * pi * sector / sectors;
    return r * Vec3{std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), -std::cos(t)};
  }
};

void add_cell(TetMesh& mesh, Cell cell, Region region) {
  const double volume = cell_volume_mm3(mesh, cell);
  if (std::abs(volume) < 1e-9) return;
  if (volume < 0) std::swap(cell[2], cell[3]);
  mesh.cells.push_back(cell);
  mesh.region.push_back(tag(region));
}

void add_brick(TetMesh& mesh, const std::array<std::int32_t, 8>& corner, Region region) {
  constexpr std::array<std::array<std::size_t, 4>, 6> split{
      {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
  for (const auto& t : split) add_cell(mesh, {corner[t[0]], corner[t[1]], corner[t[2]], corner[t[3]]}, region);
}

/// Faces that one cell alone has, named by `surface_at` their corners' middle; 0: not kept.
template <class SurfaceAt>
void add_faces(TetMesh& mesh, const SurfaceAt& surface_at) {
  std::vector<Face> all;
  for (const Cell& c : mesh.cells)
    for (std::size_t out = 0; out < 4; ++out) {
      Face f{c[(out + 1) % 4], c[(out + 2) % 4], c[(out + 3) % 4]};
      std::sort(f.begin(), f.end());
      all.push_back(f);
    }
  std::sort(all.begin(), all.end());
  for (std::size_t f = 0; f < all.size(); ++f) {
    if ((f > 0 && all[f - 1] == all[f]) || (f + 1 < all.size() && all[f + 1] == all[f])) continue;
    Vec3 middle;
    for (const auto n : all[f]) middle += mesh.nodes_mm[static_cast<std::size_t>(n)] / 3;
    if (const auto surface = surface_at(middle)) {
      mesh.faces.push_back(all[f]);
      mesh.surface.push_back(surface);
    }
  }
}

/// The shell with named surfaces and the rim of one valve at its opening.
TetMesh mesh_of(const Shell& shell, Region region, const char* endocardium, const char* rim) {
  TetMesh mesh;
  for (int l = 0; l <= shell.layers; ++l) {
    mesh.nodes_mm.push_back(shell.position(l, 0, 0));
    for (int r = 1; r <= shell.rings; ++r)
      for (int s = 0; s < shell.sectors; ++s) mesh.nodes_mm.push_back(shell.position(l, r, s));
  }
  for (int l = 0; l < shell.layers; ++l)
    for (int r = 0; r < shell.rings; ++r)
      for (int s = 0; s < shell.sectors; ++s) {
        std::array<std::int32_t, 8> corner;
        for (int c = 0; c < 8; ++c)
          corner[static_cast<std::size_t>(c)] = shell.node(l + (c & 1), r + ((c >> 1) & 1), s + (c >> 2));
        add_brick(mesh, corner, region);
      }
  const double middle = 0.5 * (shell.inner_mm + shell.outer_mm);
  add_faces(mesh, [&](const Vec3& p) {
    const double from_pole = std::atan2(std::hypot(p.x, p.y), -p.z);
    if (from_pole > shell.opening * (1 - 0.1 / shell.rings)) return 0;
    return *surface_from_name(norm(p) < middle ? endocardium : "epicardium");
  });
  Rim curve{rim, 0, {}};
  for (int l = 0; l <= shell.layers; ++l)
    for (int s = 0; s < shell.sectors; ++s) curve.nodes.push_back(shell.node(l, shell.rings, s));
  std::sort(curve.nodes.begin(), curve.nodes.end());
  mesh.rims.push_back(curve);
  return mesh;
}

ventricles::HeartFrame frame_with_apex_below() {
  ventricles::HeartFrame frame;
  frame.base_normal = frame.long_axis = {0, 0, -1};
  frame.rv_side = {-1, 0, 0};
  return frame;
}

TEST(MeshLaplace, OnASphericalShellTheSolutionIsOneOverTheRadius) {
  const Shell shell;
  const TetMesh mesh = mesh_of(shell, Region::lv_myocardium, "lv_endocardium", "mitral_orifice_rim");
  std::vector<std::int32_t> cells(mesh.cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = static_cast<std::int32_t>(c);
  const auto matrix = mesh_queries::make_stiffness(mesh, cells);
  mesh_queries::FixedValues fixed;
  for (const auto n : matrix.nodes) {
    const double r = norm(mesh.nodes_mm[static_cast<std::size_t>(n)]);
    fixed.push_back(r < 20.01 ? 1 : r > 29.99 ? 0 : std::nan(""));
  }
  const auto solution = mesh_queries::solve_laplace(matrix, fixed);
  for (std::size_t n = 0; n < solution.size(); ++n) {
    const double r = norm(mesh.nodes_mm[static_cast<std::size_t>(matrix.nodes[n])]);
    ASSERT_NEAR(solution[n], (1 / r - 1.0 / 30) / (1.0 / 20 - 1.0 / 30), 0.01);
  }
  for (std::size_t n = 0; n < solution.size(); ++n) {  // and it solves the equations
    if (!std::isnan(fixed[n])) continue;
    double sum = 0, diagonal = 0;
    for (auto e = matrix.start[n]; e < matrix.start[n + 1]; ++e) {
      const auto column = static_cast<std::size_t>(matrix.column[e]);
      sum += matrix.value[e] * solution[column];
      if (column == n) diagonal = matrix.value[e];
    }
    ASSERT_LT(std::abs(sum) / diagonal, 1e-5);
  }
}

TEST(VentricleRule, HelixOnASphericalShellFollowsTheClosedForm) {
  const Shell shell;
  const TetMesh mesh = mesh_of(shell, Region::lv_myocardium, "lv_endocardium", "mitral_orifice_rim");
  const RuleSettings settings;
  const auto field = ventricle_rule(mesh, frame_with_apex_below(), settings);
  ASSERT_EQ(field.nodes.size(), mesh.nodes_mm.size());
  double sum = 0, worst = 0, count = 0;
  for (std::size_t n = 0; n < field.nodes.size(); ++n) {
    const Vec3 p = mesh.nodes_mm[static_cast<std::size_t>(field.nodes[n])], normal = normalized(p);
    if (std::atan2(std::hypot(p.x, p.y), -p.z) < 0.35) continue;  // at the apex nothing runs around
    const double endo = (1 / norm(p) - 1.0 / 30) / (1.0 / 20 - 1.0 / 30);
    const double helix = (endo * settings.lv_helix_endo_deg + (1 - endo) * settings.lv_helix_epi_deg) * pi / 180;
    const Vec3 up = normalized(Vec3{0, 0, 1} - normal.z * normal), around = cross(up, normal);
    const double error = testing::axis_angle_deg(field.axes[n].fiber, std::cos(helix) * around + std::sin(helix) * up);
    sum += error, worst = std::max(worst, error), ++count;
  }
  EXPECT_LT(sum / count, 1);
  EXPECT_LT(worst, 6);
}

TEST(VentricleRule, OutflowAnglesHoldAtTheArteryAndNumbersOfThreadsDoNotMatter) {
  TetMesh mesh = mesh_of({}, Region::lv_myocardium, "lv_endocardium", "mitral_orifice_rim");
  Rim aortic{"aortic_orifice_rim", 0, {}}, mitral{"mitral_orifice_rim", 0, {}};
  for (const auto n : mesh.rims[0].nodes)
    (mesh.nodes_mm[static_cast<std::size_t>(n)].x > 0 ? aortic : mitral).nodes.push_back(n);
  mesh.rims = {aortic, mitral};
  const auto field = ventricle_rule(mesh, frame_with_apex_below(), {});
  for (std::size_t n = 0; n < field.nodes.size(); ++n) {
    const Vec3 p = mesh.nodes_mm[static_cast<std::size_t>(field.nodes[n])];
    if (p.z < -1e-9 || p.x < 12 || std::abs(norm(p) - 30) > 0.1) continue;
    // Outside, fibres run around the artery's end.
    ASSERT_LT(testing::axis_angle_deg(field.axes[n].fiber, cross({0, 0, 1}, p)), 12) << p.x << " " << p.y;
  }
  const int before = parallel::thread_count();
  parallel::set_thread_count(before == 1 ? 3 : 1);
  const auto again = ventricle_rule(mesh, frame_with_apex_below(), {});
  parallel::set_thread_count(before);
  for (std::size_t n = 0; n < field.nodes.size(); ++n) ASSERT_EQ(field.axes[n].fiber, again.axes[n].fiber);
}

/// A wall between two ventricles: x from the left one's side to the right one's, epicardium at both ends of y.
TetMesh septum() {
  constexpr int nx = 8, ny = 24, nz = 30;
  TetMesh mesh;
  const auto node = [&](int i, int j, int k) { return (k * (ny + 1) + j) * (nx + 1) + i; };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) {
        const double y = 2.5 * (j - 12), deepest = 0.5 * std::abs(y);  // the lower end is pointed: an apex
        mesh.nodes_mm.push_back({1.25 * i, y, 2.0 * k + (1 - k / double{nz}) * deepest});
      }
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        std::array<std::int32_t, 8> corner;
        for (int c = 0; c < 8; ++c)
          corner[static_cast<std::size_t>(c)] = node(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2));
        add_brick(mesh, corner, Region::lv_myocardium);
      }
  add_faces(mesh, [](const Vec3& p) {
    if (p.z > 59.99) return 0;
    return *surface_from_name(p.x < 0.01 ? "lv_endocardium" : p.x > 9.99 ? "rv_endocardium" : "epicardium");
  });
  Rim rim{"mitral_orifice_rim", 0, {}};
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n)
    if (mesh.nodes_mm[n].z > 59.99) rim.nodes.push_back(static_cast<std::int32_t>(n));
  mesh.rims.push_back(rim);
  return mesh;
}

TEST(VentricleRule, InTheSeptumTheTwoVentriclesAnglesAreJoined) {
  const TetMesh mesh = septum();
  const RuleSettings settings;
  const auto field = ventricle_rule(mesh, frame_with_apex_below(), settings);
  for (std::size_t n = 0; n < field.nodes.size(); ++n) {
    const Vec3 p = mesh.nodes_mm[static_cast<std::size_t>(field.nodes[n])];
    if (std::abs(p.y) > 4 || p.z < 30 || p.z > 56) continue;
    const double share = p.x / 10;  // of the right endocardium, whose angle counts the other way from the left
    const double helix = ((1 - share) * settings.lv_helix_endo_deg - share * settings.rv_helix_endo_deg) * pi / 180;
    ASSERT_LT(testing::axis_angle_deg(field.axes[n].fiber, {0, std::cos(helix), std::sin(helix)}), 8)
        << p.x << " " << p.y << " " << p.z;
  }
}

TEST(AtrialRule, FibersLieInTheWallAndCircleTheValve) {
  const Shell shell{25, 27, 0.85 * pi, 2, 40, 48};
  TetMesh mesh = mesh_of(shell, Region::la_wall, "la_endocardium", "mitral_orifice_rim");
  for (Vec3& p : mesh.nodes_mm) p.z = -p.z;  // the valve below, as in a heart
  const auto field = atrial_rule(mesh, true, {});
  ASSERT_EQ(field.nodes.size(), mesh.nodes_mm.size());
  for (std::size_t n = 0; n < field.nodes.size(); ++n) {
    const Vec3 p = mesh.nodes_mm[static_cast<std::size_t>(field.nodes[n])];
    ASSERT_NEAR(norm(field.axes[n].fiber), 1, 1e-9);
    ASSERT_NEAR(dot(field.axes[n].fiber, field.axes[n].transmural), 0, 1e-9);
    const double from_pole = std::atan2(std::hypot(p.x, p.y), p.z);
    if (from_pole > shell.opening - 0.1) continue;  // the shell's own rim
    ASSERT_LT(std::abs(dot(field.axes[n].fiber, normalized(p))), 0.1);
    const double limit_deg = from_pole > shell.opening - 0.2 ? 20 : 90;  // near the valve around it
    ASSERT_LE(testing::axis_angle_deg(field.axes[n].fiber, cross({0, 0, 1}, p)), limit_deg);
  }
}

TEST(AtrialRule, AMeshWithoutAtriumHasNoField) {
  const TetMesh mesh = mesh_of({}, Region::lv_myocardium, "lv_endocardium", "mitral_orifice_rim");
  EXPECT_TRUE(atrial_rule(mesh, true, {}).nodes.empty());
}

}  // namespace
}  // namespace heartgen::fibers
