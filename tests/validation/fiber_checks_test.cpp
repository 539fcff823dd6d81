// SPDX-License-Identifier: GPL-3.0-or-later
// The fibre certificate on a thick cylinder with known depth and known fibres.
#include "validation/fiber_checks.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "validation/wall_depth.hpp"

namespace heartgen::validation {
namespace {

constexpr double inner_mm = 20, outer_mm = 30, length_mm = 120;
constexpr int around_count = 48, along_count = 20, layers = 6;
const double pi = std::acos(-1.0);

std::int32_t node_id(int i, int j, int k) {
  return static_cast<std::int32_t>(((i % around_count) * (along_count + 1) + j) * (layers + 1) + k);
}

double laplace_depth(const Vec3& x) {
  return std::log(std::hypot(x.x, x.y) / inner_mm) / std::log(outer_mm / inner_mm);
}

/// Helix +60 to -60 degrees in Laplace's depth; the base is at +z.
Vec3 known_fiber(const Vec3& x) {
  const Vec3 n = normalized({x.x, x.y, 0}), around = cross({0, 0, 1}, n);
  const double helix = (60 - 120 * laplace_depth(x)) * pi / 180;
  return std::cos(helix) * around + Vec3{0, 0, std::sin(helix)};
}

void add_face_pair(TetMesh& mesh, std::array<std::int32_t, 4> q, const char* surface) {
  for (const Face& face : {Face{q[0], q[1], q[3]}, Face{q[0], q[3], q[2]}}) {
    mesh.faces.push_back(face);
    mesh.surface.push_back(*surface_from_name(surface));
  }
}

FiberField frames_of(const std::vector<Vec3>& points) {
  FiberField field;
  for (const Vec3& x : points) {
    field.fiber.push_back(known_fiber(x));
    field.sheet.push_back(normalized({x.x, x.y, 0}));
    field.sheet_normal.push_back(cross(field.fiber.back(), field.sheet.back()));
  }
  return field;
}

/// A left ventricle like a pipe: inside endocardium, outside epicardium, open ends without a label.
TetMesh pipe() {
  constexpr std::array<std::array<int, 4>, 6> split{
      {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
  TetMesh mesh;
  for (int i = 0; i < around_count; ++i)
    for (int j = 0; j <= along_count; ++j)
      for (int k = 0; k <= layers; ++k) {
        const double angle = 2 * pi * i / around_count, r = inner_mm + (outer_mm - inner_mm) * k / layers;
        mesh.nodes_mm.push_back({r * std::cos(angle), r * std::sin(angle), length_mm * j / along_count});
      }
  std::vector<Vec3> centers;
  for (int i = 0; i < around_count; ++i)
    for (int j = 0; j < along_count; ++j)
      for (int k = 0; k < layers; ++k) {
        std::array<std::int32_t, 8> corner;
        for (int c = 0; c < 8; ++c)
          corner[static_cast<std::size_t>(c)] = node_id(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2));
        for (const auto& t : split) {
          Cell cell;
          Vec3 sum;
          for (std::size_t v = 0; v < 4; ++v) {
            cell[v] = corner[static_cast<std::size_t>(t[v])];
            sum += mesh.nodes_mm[static_cast<std::size_t>(cell[v])];
          }
          if (cell_volume_mm3(mesh, cell) < 0) std::swap(cell[2], cell[3]);
          mesh.cells.push_back(cell);
          mesh.region.push_back(tag(Region::lv_myocardium));
          centers.push_back(0.25 * sum);
        }
        if (k == 0) add_face_pair(mesh, {corner[0], corner[1], corner[2], corner[3]}, "lv_endocardium");
        if (k == layers - 1) add_face_pair(mesh, {corner[4], corner[5], corner[6], corner[7]}, "epicardium");
      }
  mesh.node_fibers = frames_of(mesh.nodes_mm);
  mesh.cell_fibers = frames_of(centers);
  mesh.fiber_source.assign(mesh.nodes_mm.size(), static_cast<std::uint8_t>(FiberSource::atlas));
  return mesh;
}

const ReportRow& find(const Report& report, const std::string& scope, const std::string& metric) {
  for (const auto& row : report)
    if (row.scope == scope && row.metric.rfind(metric, 0) == 0) return row;
  throw std::runtime_error("no row " + scope + "/" + metric);
}

TEST(WallDepth, OfAThickPipeIsTheLogarithmOfTheRadius) {
  const auto mesh = pipe();
  const auto wall = wall_depth(mesh, Region::lv_myocardium);
  ASSERT_EQ(wall.cells.size(), mesh.cells.size());
  for (std::size_t w = 0; w < wall.cells.size(); ++w) {
    Vec3 center;
    for (const auto n : mesh.cells[w]) center += 0.25 * mesh.nodes_mm[static_cast<std::size_t>(n)];
    ASSERT_NEAR(wall.depth[w], laplace_depth(center), 0.01);
    ASSERT_GT(dot(wall.normal[w], normalized({center.x, center.y, 0})), 0.98);
  }
  EXPECT_TRUE(wall_depth(mesh, Region::rv_myocardium).cells.empty());
}

TEST(HelixProfile, FollowsTheKnownHelix) {
  const auto profile = helix_profile(pipe(), Region::lv_myocardium, 6);
  ASSERT_EQ(profile.depth.size(), 6U);
  for (std::size_t b = 0; b < 6; ++b) {
    EXPECT_NEAR(profile.median_deg[b], 60 - 120 * profile.depth[b], 4);
    EXPECT_LE(profile.p10_deg[b], profile.median_deg[b]);
    EXPECT_GE(profile.p90_deg[b], profile.median_deg[b]);
  }
  EXPECT_TRUE(helix_profile(pipe(), Region::rv_myocardium).depth.empty());
}

TEST(CheckFibers, PassesAGoodFieldWhateverItsSigns) {
  auto mesh = pipe();
  const auto plain = check_fibers(mesh, {0.2, 1.1, 0.9}, {});
  EXPECT_TRUE(all_passed(plain));
  for (std::size_t n = 0; n < mesh.node_fibers.fiber.size(); n += 2) {
    mesh.node_fibers.fiber[n] = -mesh.node_fibers.fiber[n];
    mesh.node_fibers.sheet_normal[n] = -mesh.node_fibers.sheet_normal[n];
  }
  const auto flipped = check_fibers(mesh, {0.2, 1.1, 0.9}, {});
  ASSERT_EQ(plain.size(), flipped.size());
  for (std::size_t r = 0; r < plain.size(); ++r) EXPECT_DOUBLE_EQ(plain[r].value, flipped[r].value) << plain[r].metric;
  EXPECT_NEAR(find(plain, "lv_myocardium", "helix_endocardium_median").value, 48, 5);
  EXPECT_NEAR(find(plain, "lv_myocardium", "helix_epicardium_median").value, -48, 5);
}

TEST(CheckFibers, FindsMissingSkewAndUnsourcedFibers) {
  auto mesh = pipe();
  mesh.node_fibers.fiber[5] = {};
  mesh.cell_fibers.sheet[7] = mesh.cell_fibers.fiber[7];
  mesh.fiber_source[3] = 0;
  const auto report = check_fibers(mesh, {}, {});
  EXPECT_EQ(find(report, "myocardium", "missing_nodes").value, 1);
  EXPECT_FALSE(find(report, "myocardium", "missing_nodes").passed());
  EXPECT_FALSE(find(report, "myocardium", "orthonormality_error_cells").passed());
  EXPECT_EQ(find(report, "myocardium", "nodes_without_source").value, 1);
}

TEST(CheckFibers, JudgesTheInpaintedShareAndTheJacobian) {
  auto mesh = pipe();
  for (std::size_t n = 0; n < mesh.fiber_source.size(); n += 4)
    mesh.fiber_source[n] = static_cast<std::uint8_t>(FiberSource::inpainted);
  ValidationSettings settings;
  settings.maximum_inpainted_fraction = 0.2;
  const auto report = check_fibers(mesh, {-0.1, {}, {}}, settings);
  EXPECT_NEAR(find(report, "ventricles", "inpainted_fraction").value, 0.25, 0.01);
  EXPECT_FALSE(find(report, "ventricles", "inpainted_fraction").passed());
  EXPECT_FALSE(find(report, "registration", "jacobian_min").passed());
}

TEST(CheckFibers, AMeshWithoutFibersFailsWithoutCrashing) {
  auto mesh = pipe();
  mesh.node_fibers = {};
  mesh.cell_fibers = {};
  mesh.fiber_source.clear();
  EXPECT_FALSE(all_passed(check_fibers(mesh, {}, {})));
}

TEST(CheckFibers, TellsTheDistanceToTheRuleOverTheCellsThatHaveOne) {
  auto mesh = pipe();
  mesh.rule_difference_deg.assign(mesh.cells.size(), 12);
  for (std::size_t c = 0; c < mesh.cells.size(); c += 2) mesh.rule_difference_deg[c] = -1;
  const auto report = check_fibers(mesh, {}, {});
  EXPECT_NEAR(find(report, "lv_myocardium", "rule_difference_mean").value, 12, 1e-6);
  EXPECT_NEAR(find(report, "lv_myocardium", "rule_difference_p95").value, 12, 1e-6);
}

TEST(CheckFibers, ABreakWhereTheVentriclesMeetShows) {
  auto mesh = pipe();
  const auto low = [&](const Cell& cell) { return mesh.nodes_mm[static_cast<std::size_t>(cell[0])].z < 60; };
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (low(mesh.cells[c])) mesh.region[c] = tag(Region::rv_myocardium);
  const double whole = find(check_fibers(mesh, {}, {}), "septum_junction", "neighbour_jump_p99").value;
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n)
    if (mesh.nodes_mm[n].z < 59) mesh.node_fibers.fiber[n] = mesh.node_fibers.sheet_normal[n];
  const auto broken = check_fibers(mesh, {}, {});
  EXPECT_LT(whole, 25);
  EXPECT_GT(find(broken, "septum_junction", "neighbour_jump_p99").value, 60);
}

TEST(CheckFibers, JumpsStandBesideTheAtlassOwnWithTheLengthsOfBothMeshesEdges) {
  RegistrationFigures figures;
  figures.atlas_jump_p99_deg = 58;
  figures.atlas_edge_p50_mm = 2.5;
  const auto report = check_fibers(pipe(), figures, {});
  EXPECT_EQ(find(report, "atlas", "neighbour_jump_p99").value, 58);
  EXPECT_EQ(find(report, "atlas", "edge_p50").value, 2.5);
  // Of the seven kinds of edges of a pipe's split blocks three are shorter and three longer than those along it.
  EXPECT_NEAR(find(report, "ventricles", "edge_p50").value, length_mm / along_count, 1e-9);
  for (const auto& row : check_fibers(pipe(), {}, {})) EXPECT_NE(row.scope, "atlas") << row.metric;
}

TEST(CheckFibers, AMeshTooCoarseForItsFibersIsToldWithARemedy) {
  RegistrationFigures figures;
  const double own_deg = find(check_fibers(pipe(), {}, {}), "ventricles", "neighbour_jump_p99").value;
  figures.atlas_edge_p50_mm = 2.5;
  figures.atlas_jump_p99_deg = own_deg + 1;
  EXPECT_EQ(remark_on_jumps(check_fibers(pipe(), figures, {})), "");
  figures.atlas_jump_p99_deg = own_deg - 1;
  EXPECT_NE(remark_on_jumps(check_fibers(pipe(), figures, {})).find("edges of 6.0 mm"), std::string::npos);
  EXPECT_EQ(remark_on_jumps(check_fibers(pipe(), {}, {})), "");
}

TEST(CheckFibers, HelixNearTheSurfacesIsComparedWithTheAtlas) {
  RegistrationFigures figures;
  for (int n = 0; n <= 200; ++n) {
    const float depth = static_cast<float>(n) / 200;
    figures.atlas_lv.depth.push_back(depth);
    figures.atlas_lv.helix_deg.push_back(70 - 140 * depth);
    figures.carried_lv.depth.push_back(depth);
    figures.carried_lv.helix_deg.push_back(66 - 140 * depth);
    figures.there_lv.depth.push_back(depth);
    figures.there_lv.helix_deg.push_back(65 - 140 * depth);
  }
  const auto report = check_fibers(pipe(), figures, {});
  EXPECT_NEAR(find(report, "lv_myocardium", "atlas_helix_endocardium").value, 70 - 140 * 0.125, 1);
  EXPECT_NEAR(find(report, "lv_myocardium", "helix_endocardium_off_atlas").value, 4, 0.1);
  EXPECT_NEAR(find(report, "lv_myocardium", "helix_epicardium_off_atlas").value, 4, 0.1);
  EXPECT_NEAR(find(report, "lv_myocardium", "helix_epicardium_off_atlas_at_same_places").value, 1, 0.1);
  const auto profile = helix_profile(figures.atlas_lv);
  ASSERT_EQ(profile.depth.size(), 10U);
  EXPECT_NEAR(profile.median_deg.front(), 70 - 140 * 0.05, 1);
}

TEST(CheckFibers, AMirroredHelixFails) {
  auto mesh = pipe();
  for (auto* field : {&mesh.node_fibers, &mesh.cell_fibers})
    for (Vec3& f : field->fiber) f.z = -f.z;
  EXPECT_FALSE(find(check_fibers(mesh, {}, {}), "lv_myocardium", "helix_endocardium_median").passed());
}

}  // namespace
}  // namespace heartgen::validation
