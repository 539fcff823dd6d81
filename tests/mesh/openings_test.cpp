// SPDX-License-Identifier: GPL-3.0-or-later
// What physics needs of a heart's mesh: flat ends of vessels, closed cavities, atria that do not conduct into
// ventricles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "generator/mesh/fill_loop.hpp"
#include "generator/mesh/insulation.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "mesh/shapes.hpp"
#include "model/error.hpp"
#include "validation/cavity_checks.hpp"
#include "validation/insulation_checks.hpp"
#include "validation/mesh_checks.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

MeshSettings coarse() {
  MeshSettings s;
  s.heart_edge_mm = 2.5;
  s.blood_edge_mm = 4;
  s.torso_edge_mm = 8;
  return s;
}

// The aorta leaves the left ventricle along an axis that no axis of the grid is near, and is cut across it.
const Vec3 aorta_axis = normalized({1, 0.2, -0.8});
constexpr double voxel_mm = 1.25;
constexpr double aorta_radius = 5, aorta_length = 29;
const double aorta_start =
    std::sqrt(14.0 * 14 - aorta_radius * aorta_radius);  // its orifice in the ball's face is flat

bool is_in_aorta(const Vec3& p) {
  const double along = dot(p, aorta_axis);
  return along > aorta_start && along < aorta_length && norm(p - along * aorta_axis) < aorta_radius;
}

// Left atrium above left ventricle, a shell of wall around both, the right ventricle beside them, a torso around all.
Region openings_heart(const Vec3& p) {
  const double left = norm(p), right = norm(p - Vec3{-22, 0, -6});
  if (is_in_aorta(p)) return Region::aorta;
  if (left < 14) return p.z < 0 ? Region::lv_blood : Region::la_blood;
  if (left < 18) return p.z < 0 ? Region::lv_myocardium : Region::la_wall;
  if (right < 7) return Region::rv_blood;
  if (right < 10) return Region::rv_myocardium;
  return std::hypot(p.x, p.y) < 33 ? Region::torso : Region::none;
}

LabelVolume openings_labels(bool with_torso) {
  auto labels = label_cube(56, voxel_mm, openings_heart);
  return with_torso ? labels : mesh::heart_only(labels);
}

class Openings : public ::testing::TestWithParam<bool> {
 protected:
  static void SetUpTestSuite() {
    for (const bool with_torso : {false, true}) {
      auto settings = coarse();
      settings.meshes = {"myocardium", "chambers"};
      if (with_torso) settings.meshes.emplace_back("torso");
      meshes[with_torso] = new std::map<std::string, TetMesh>(mesh::mesh_heart(openings_labels(with_torso), settings));
    }
  }
  static void TearDownTestSuite() {
    for (auto* one : meshes) delete one;
  }
  const std::map<std::string, TetMesh>& all() const { return *meshes[GetParam()]; }
  static inline std::array<std::map<std::string, TetMesh>*, 2> meshes{};
};

TEST_P(Openings, MeshesAreValidAndTheirAnglesGood) {
  for (const auto& [name, mesh] : all()) {
    const auto report = validation::check_mesh(name, mesh, ValidationSettings{});
    EXPECT_TRUE(all_passed(report)) << failed_rows(report);
    EXPECT_GE(row_value(report, name, "dihedral_min"), 30) << name;
    EXPECT_LE(row_value(report, name, "dihedral_max"), 143) << name;
  }
}

TEST_P(Openings, TheAortaEndsInAFlatSurfaceWithARim) {
  for (const auto& [name, mesh] : all()) {
    if (name == "myocardium") continue;
    const auto end = *surface_from_name("aorta_end");
    double area = 0, highest = -1e9, lowest = 1e9;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      if (mesh.surface[f] != end) continue;
      const auto p = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(mesh.faces[f][i])]; };
      const Vec3 normal = cross(p(1) - p(0), p(2) - p(0)) / 2;
      area += norm(normal);
      EXPECT_GT(dot(normalized(normal), aorta_axis), 0.98) << name;
      for (std::size_t i = 0; i < 3; ++i) {
        highest = std::max(highest, dot(p(i), aorta_axis));
        lowest = std::min(lowest, dot(p(i), aorta_axis));
      }
    }
    const double exact = std::numbers::pi * aorta_radius * aorta_radius;
    EXPECT_NEAR(area, exact, 0.12 * exact) << name;
    EXPECT_LT(highest, aorta_length) << name;
    EXPECT_GT(highest, aorta_length - 1.5 * voxel_mm) << name << ": where the section is whole for the last time";
    EXPECT_LT(highest - lowest, 2 * aorta_radius * 0.2) << name;  // its plane is a few degrees off
    const auto rim =
        std::find_if(mesh.rims.begin(), mesh.rims.end(), [](const Rim& r) { return r.name == "aorta_end_rim"; });
    ASSERT_NE(rim, mesh.rims.end()) << name;
    for (const auto n : rim->nodes) {
      const Vec3& p = mesh.nodes_mm[static_cast<std::size_t>(n)];
      EXPECT_NEAR(norm(p - dot(p, aorta_axis) * aorta_axis), aorta_radius, 0.8) << name;
    }
  }
}

/// The plane is that of the mesh itself, through three nodes of the rim far from each other.
TEST_P(Openings, TheEndLiesInOnePlane) {
  const TetMesh& mesh = all().at("chambers");
  std::set<std::int32_t> nodes;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (mesh.surface[f] == *surface_from_name("aorta_end")) nodes.insert(mesh.faces[f].begin(), mesh.faces[f].end());
  ASSERT_GT(nodes.size(), 6U);
  Vec3 normal, center;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.surface[f] != *surface_from_name("aorta_end")) continue;
    const auto p = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(mesh.faces[f][i])]; };
    normal += cross(p(1) - p(0), p(2) - p(0));
  }
  for (const auto n : nodes) center += mesh.nodes_mm[static_cast<std::size_t>(n)] / static_cast<double>(nodes.size());
  for (const auto n : nodes)
    EXPECT_NEAR(dot(mesh.nodes_mm[static_cast<std::size_t>(n)] - center, normalized(normal)), 0, 0.02);
}

TEST_P(Openings, CavitiesAreClosedByCapsOnTheirRims) {
  const TetMesh& walls = all().at("myocardium");
  std::map<std::string, std::set<std::string>> caps;
  for (const auto& cavity : walls.cavities) {
    ASSERT_EQ(cavity.faces.size(), cavity.surface.size());
    auto& names = caps[cavity.name];
    for (const auto tag : cavity.surface)
      if (is_cap(tag)) names.insert(surface_name(tag));
  }
  using Names = std::set<std::string>;
  EXPECT_EQ(caps, (std::map<std::string, Names>{{"lv_cavity", {"aortic_orifice_cap", "mitral_orifice_cap"}},
                                                {"rv_cavity", {}},
                                                {"la_cavity", {"mitral_orifice_cap"}}}));
  const auto report = validation::check_cavities(all());
  for (const char* cavity : {"myocardium/lv_cavity", "myocardium/rv_cavity", "myocardium/la_cavity"}) {
    for (const char* defect :
         {"open_edges", "non_manifold_edges", "non_manifold_vertices", "turned_edges", "cap_nodes_off_rims"})
      EXPECT_EQ(row_value(report, cavity, defect), 0) << cavity << " " << defect;
  }
  // Of a heart this small, orifices are a large part: 0.5 % of its blood would be 0.04 mm between caps and orifices.
  constexpr double max_gap_mm = 0.1, mitral_mm2 = std::numbers::pi * 14 * 14,
                   aortic_mm2 = std::numbers::pi * aorta_radius * aorta_radius;
  const double blood_mm3 = 1000 * row_value(report, "myocardium/lv_cavity", "volume");
  EXPECT_LT(std::abs(row_value(report, "myocardium/lv_cavity", "volume_difference")) / 100 * blood_mm3,
            max_gap_mm * (mitral_mm2 + aortic_mm2));
  EXPECT_GT(row_value(report, "myocardium/lv_cavity", "volume"), 0);
}

TEST_P(Openings, TheMitralCapIsTheSameFromBothSides) {
  std::map<std::string, std::set<Face>> triangles;
  for (const auto& cavity : all().at("myocardium").cavities)
    for (std::size_t f = 0; f < cavity.faces.size(); ++f)
      if (surface_name(cavity.surface[f]) == "mitral_orifice_cap") {
        Face face = cavity.faces[f];
        std::sort(face.begin(), face.end());
        triangles[cavity.name].insert(face);
      }
  EXPECT_GT(triangles["lv_cavity"].size(), 10U);
  EXPECT_EQ(triangles["lv_cavity"], triangles["la_cavity"]);
}

bool same(const TetMesh& a, const TetMesh& b) {
  for (std::size_t c = 0; c < a.cavities.size(); ++c)
    if (a.cavities[c].faces != b.cavities[c].faces) return false;
  for (std::size_t r = 0; r < a.rims.size(); ++r)
    if (a.rims[r].nodes != b.rims[r].nodes) return false;
  return a.nodes_mm == b.nodes_mm && a.cells == b.cells && a.region == b.region && a.faces == b.faces &&
         a.surface == b.surface && a.parent_node == b.parent_node;
}

TEST_P(Openings, ALayerInsulatesAndComesOffAgain) {
  auto meshes_now = all();
  const auto before = validation::check_insulation(meshes_now, false);
  EXPECT_GT(row_value(before, "myocardium", "shared_faces"), 50);
  for (auto& [name, mesh] : meshes_now) {
    if (name == "chambers") continue;
    mesh::add_annuli(mesh);
    const auto report = validation::check_mesh(name, mesh, ValidationSettings{});
    EXPECT_TRUE(all_passed(report)) << failed_rows(report);
    EXPECT_GT(surface_counts(mesh)["annulus_border"], 50) << name;
    EXPECT_EQ(surface_counts(mesh)["atrioventricular_junction"],
              surface_counts(all().at(name))["atrioventricular_junction"]);
  }
  const auto after = validation::check_insulation(meshes_now, true);
  for (const auto& [name, mesh] : meshes_now) {
    if (name == "chambers") continue;
    EXPECT_EQ(row_value(after, name, "conducting_faces"), 0);
    EXPECT_EQ(row_value(after, name, "conducting_nodes"), 0);
    EXPECT_GT(row_value(after, name, "annulus_cells"), 50);
    TetMesh back = mesh;
    mesh::take_out_annuli(back);
    EXPECT_TRUE(same(back, all().at(name))) << name;
  }
}

/// Between two regions faces look out of the lower one, out of the mesh elsewhere.
TEST_P(Openings, FacesOfAnnuliLookOutOfTheLowerRegion) {
  for (const auto& [name, whole] : all()) {
    if (name == "chambers") continue;
    TetMesh mesh = whole;
    mesh::add_annuli(mesh);
    std::map<Face, std::int32_t> outward;  // region of the cell that a face, from its smallest node, looks out of
    constexpr std::size_t corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    const auto from_smallest = [](Face face) {
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
      return face;
    };
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      for (const auto& k : corners)
        outward[from_smallest({mesh.cells[c][k[0]], mesh.cells[c][k[1]], mesh.cells[c][k[2]]})] = mesh.region[c];
    for (const auto& face : mesh.faces) {
      const auto own = outward.find(from_smallest(face)),
                 other = outward.find(from_smallest({face[0], face[2], face[1]}));
      ASSERT_NE(own, outward.end()) << name;
      if (other != outward.end()) {
        EXPECT_LT(own->second, other->second) << name;
      }
    }
  }
}

TEST_P(Openings, SplitNodesInsulateAndAreJoinedAgain) {
  const TetMesh& whole = all().at("myocardium");
  TetMesh mesh = whole;
  mesh.fiber_source.assign(mesh.nodes_mm.size(), 1);
  mesh::split_nodes(mesh);
  EXPECT_GT(mesh.nodes_mm.size(), whole.nodes_mm.size() + 30);
  EXPECT_EQ(mesh.fiber_source.size(), mesh.nodes_mm.size());
  EXPECT_EQ(mesh.cells.size(), whole.cells.size());
  const auto report = validation::check_insulation({{"myocardium", mesh}}, true);
  EXPECT_EQ(row_value(report, "myocardium", "conducting_faces"), 0);
  EXPECT_EQ(row_value(report, "myocardium", "conducting_nodes"), 0);
  EXPECT_EQ(surface_counts(mesh)["atrioventricular_junction"],
            2 * surface_counts(whole).at("atrioventricular_junction"));
  const auto rows = validation::check_mesh("mesh", mesh, ValidationSettings{});
  for (const char* defect : {"boundary_faces_missing", "interface_faces_missing", "faces_without_cells",
                             "faces_repeated", "orphan_nodes", "inverted_cells", "boundary_open_edges"})
    EXPECT_EQ(row_value(rows, "mesh", defect), 0) << defect;
  const auto cavities = validation::check_cavities({{"myocardium", mesh}});
  for (const char* cavity : {"myocardium/lv_cavity", "myocardium/la_cavity"})
    EXPECT_EQ(row_value(cavities, cavity, "open_edges"), 0) << cavity;
  mesh::merge_split_nodes(mesh);
  mesh.fiber_source.clear();
  EXPECT_TRUE(same(mesh, whole));
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutTorso, Openings, ::testing::Bool());

TEST(Insulation, AnUnknownKindIsRefused) {
  auto settings = coarse();
  settings.insulation = "wall";
  EXPECT_THROW(mesh::check_settings(settings), UserError);
}

// ---- loops ----

std::vector<std::int32_t> numbered(std::int32_t n) {
  std::vector<std::int32_t> loop;
  for (std::int32_t i = 0; i < n; ++i) loop.push_back(i);
  return loop;
}

bool nothing_taken(std::int32_t /*a*/, std::int32_t /*b*/) { return false; }

double area_of(const std::vector<Vec3>& points, const std::vector<Face>& faces) {
  Vec3 area;
  for (const auto& f : faces) {
    const auto p = [&](std::size_t i) { return points[static_cast<std::size_t>(f[i])]; };
    area += cross(p(1) - p(0), p(2) - p(0)) / 2;
  }
  return norm(area);
}

double sum_of_areas(const std::vector<Vec3>& points, const std::vector<Face>& faces) {
  double area = 0;
  for (const auto& f : faces) area += area_of(points, {f});
  return area;
}

/// A star: many ways to fill it cover its outside too.
TEST(FillLoop, AFlatLoopIsCoveredOnceWhateverItsShape) {
  std::vector<Vec3> points;
  constexpr int count = 24;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count, r = i % 2 == 0 ? 10 : 5;
    points.push_back({r * std::cos(angle), r * std::sin(angle), 3});
  }
  const auto faces = mesh::fill_loop(points, numbered(count), nothing_taken);
  EXPECT_EQ(faces.size(), static_cast<std::size_t>(count - 2));
  double exact = 0;
  for (int i = 0; i < count; ++i) {
    const Vec3 &a = points[static_cast<std::size_t>(i)], &b = points[static_cast<std::size_t>((i + 1) % count)];
    exact += (a.x * b.y - a.y * b.x) / 2;
  }
  EXPECT_NEAR(sum_of_areas(points, faces), exact, 1e-9);
  EXPECT_NEAR(area_of(points, faces), exact, 1e-9) << "all triangles look to the same side";
}

TEST(FillLoop, ALoopReadBackwardsHasTheSameTrianglesTurned) {
  std::vector<Vec3> points;
  for (int i = 0; i < 17; ++i)
    points.push_back({10 * std::cos(0.37 * i), 10 * std::sin(0.37 * i), 2 * std::sin(0.74 * i)});
  auto loop = numbered(17);
  std::rotate(loop.begin(), loop.begin() + 5, loop.end());
  auto backwards = loop;
  std::reverse(backwards.begin(), backwards.end());
  const auto ascending = [](std::vector<Face> faces, bool turn) {
    for (auto& face : faces) {
      if (turn) std::swap(face[1], face[2]);
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    }
    std::sort(faces.begin(), faces.end());
    return faces;
  };
  EXPECT_EQ(ascending(mesh::fill_loop(points, loop, nothing_taken), false),
            ascending(mesh::fill_loop(points, backwards, nothing_taken), true));
}

TEST(FillLoop, EdgesThatAreTakenAreLeftOut) {
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const auto& [a, b] : {std::pair{0, 2}, std::pair{1, 3}}) {
    const auto faces = mesh::fill_loop(square, numbered(4),
                                       [&, a = a, b = b](std::int32_t i, std::int32_t j) { return i == a && j == b; });
    for (const auto& face : faces)
      EXPECT_FALSE(std::count(face.begin(), face.end(), a) && std::count(face.begin(), face.end(), b));
  }
}

}  // namespace
