// SPDX-License-Identifier: GPL-3.0-or-later
// DistMesh and the repair of triangles in the plane, on materials with known areas.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "generator/distmesh/distmesh.hpp"
#include "generator/distmesh/improve_triangles.hpp"
#include "generator/tetmesh/feature.hpp"
#include "model/error.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::distmesh;
using tetmesh::Equation;

/// A level set with its gradient: negative inside.
using Field = std::function<Equation(const Vec3&)>;

Field disc(double x, double y, double radius) {
  return [=](const Vec3& p) {
    const double dx = p.x - x, dy = p.y - y, r = std::hypot(dx, dy);
    return Equation{r - radius, {dx / r, dy / r, 0}};
  };
}
Field left_of(double x) {
  return [=](const Vec3& p) { return Equation{p.x - x, {1, 0, 0}}; };
}

/// Label i + 1 inside fields[i] and outside all fields before it; 0 elsewhere.
Materials nested(const std::vector<Field>& fields, double half_mm, std::function<double(const Vec3&)> edge_mm) {
  Materials m;
  m.box_min_mm = {-half_mm, -half_mm, -unbounded_mm};
  m.box_max_mm = {half_mm, half_mm, unbounded_mm};
  m.edge_mm = std::move(edge_mm);
  m.label_at = [fields](const Vec3& p) {
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (fields[i](p).value < 0) return static_cast<int>(i) + 1;
    return 0;
  };
  // The label that comes first meets the others on its own level set.
  m.equations_at = [fields](LabelBits labels, const Vec3& p, std::span<Equation> equations) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < fields.size() && count < equations.size(); ++i) {
      const LabelBits bit = bit_of(static_cast<int>(i) + 1);
      if ((labels & bit) == 0 || labels == bit) continue;
      equations[count++] = fields[i](p);
      labels &= ~bit;
    }
    return static_cast<int>(count);
  };
  return m;
}

Materials nested(const std::vector<Field>& fields, double half_mm, double edge_mm) {
  return nested(fields, half_mm, [=](const Vec3&) { return edge_mm; });
}

struct Meshed {
  Triangles mesh;
  std::int64_t crossing = 0, below_goal = 0;
};

Meshed mesh_of(const Materials& m, double min_edge, TrussSettings settings = default_settings(Dimension::two)) {
  const auto truss = relax(m, Dimension::two, min_edge, settings);
  Meshed result{triangles_of(truss), truss.crossing, 0};
  result.below_goal = improve_triangles(result.mesh, m, {});
  return result;
}

double area_of(const Triangles& mesh, int label) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.corners.size(); ++t) {
    const auto& c = mesh.corners[t];
    const Vec3 u = mesh.at(c[1]) - mesh.at(c[0]), v = mesh.at(c[2]) - mesh.at(c[0]);
    if (mesh.label[t] == label) sum += 0.5 * (u.x * v.y - u.y * v.x);
  }
  return sum;
}

std::pair<double, double> angle_range(const Triangles& mesh) {
  std::pair<double, double> range{180, 0};
  for (const auto& c : mesh.corners)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 a = mesh.at(c[i]), u = mesh.at(c[(i + 1) % 3]) - a, v = mesh.at(c[(i + 2) % 3]) - a;
      const double angle = std::atan2(u.x * v.y - u.y * v.x, dot(u, v)) * 180 / std::numbers::pi;
      range = {std::min(range.first, angle), std::max(range.second, angle)};
    }
  return range;
}

/// Edges with more than two triangles, and nodes whose triangles do not hang together by edges.
int defects(const Triangles& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& c : mesh.corners)
    for (std::size_t i = 0; i < 3; ++i) ++edges[std::minmax(c[i], c[(i + 1) % 3])];
  std::map<std::int32_t, int> hull_edges;
  int bad = 0;
  for (const auto& [edge, count] : edges) {
    bad += count > 2;
    if (count == 1) {
      ++hull_edges[edge.first];
      ++hull_edges[edge.second];
    }
  }
  for (const auto& [node, count] : hull_edges) bad += count != 2;
  return bad;
}

void expect_good(const Meshed& meshed) {
  EXPECT_EQ(meshed.crossing, 0);
  EXPECT_EQ(meshed.below_goal, 0);
  EXPECT_EQ(defects(meshed.mesh), 0);
  const auto [least, greatest] = angle_range(meshed.mesh);
  EXPECT_GE(least, 30);
  EXPECT_LE(greatest, 120);
}

// The polygon inscribed in a circle of radius r with sides h has about pi r^2 (1 - h^2 / (6 r^2)).
void expect_area(double area, double exact, double radius, double edge) {
  EXPECT_NEAR(area, exact, exact * edge * edge / (radius * radius));
}

TEST(DistMeshPlane, DiscHasItsAreaAndWantedEdges) {
  const auto made = mesh_of(nested({disc(0.3, -0.2, 10)}, 14, 0.8), 0.8);
  expect_good(made);
  expect_area(area_of(made.mesh, 1), 100 * std::numbers::pi, 10, 0.8);
  // Equilateral triangles of the wanted edge would be so many.
  const double ideal = 100 * std::numbers::pi / (0.8 * 0.8 * std::sqrt(3.0) / 4);
  EXPECT_NEAR(static_cast<double>(made.mesh.corners.size()), ideal, 0.15 * ideal);
}

TEST(DistMeshPlane, AnnulusKeepsItsHole) {
  // The hole is a material of its own that is left out: label 0 inside the inner disc.
  auto m = nested({disc(0, 0, 4), disc(0, 0, 10)}, 14, 0.7);
  const auto with_hole = m.label_at;
  m.label_at = [with_hole](const Vec3& p) { return with_hole(p) == 2 ? 2 : 0; };
  m.equations_at = [](LabelBits, const Vec3& p, std::span<Equation> equations) {
    equations[0] = std::hypot(p.x, p.y) < 7 ? disc(0, 0, 4)(p) : disc(0, 0, 10)(p);
    return 1;
  };
  const auto made = mesh_of(m, 0.7);
  expect_good(made);
  expect_area(area_of(made.mesh, 2), 84 * std::numbers::pi, 4, 0.7);
}

TEST(DistMeshPlane, TwoHalvesInADiscMeetOnTheirLine) {
  const auto m = nested({left_of(0.37), disc(0, 0, 10)}, 14, 0.8);
  auto halves = m;
  halves.label_at = [&m](const Vec3& p) {
    const bool inside = disc(0, 0, 10)(p).value < 0;
    return inside ? (p.x < 0.37 ? 1 : 2) : 0;
  };
  halves.equations_at = [](LabelBits labels, const Vec3& p, std::span<Equation> equations) {
    std::size_t count = 0;
    if ((labels & 1U) != 0) equations[count++] = disc(0, 0, 10)(p);
    if ((labels & 6U) == 6U) equations[count++] = left_of(0.37)(p);
    return static_cast<int>(count);
  };
  const auto made = mesh_of(halves, 0.8);
  expect_good(made);
  const double segment = 100 * std::acos(0.037) - 0.37 * std::sqrt(100 - 0.37 * 0.37);
  expect_area(area_of(made.mesh, 2), segment, 10, 0.8);
  expect_area(area_of(made.mesh, 1), 100 * std::numbers::pi - segment, 10, 0.8);
  int on_line = 0;
  for (std::size_t n = 0; n < made.mesh.nodes_mm.size(); ++n) {
    if ((made.mesh.touches[n] & 6U) != 6U) continue;
    ++on_line;
    EXPECT_NEAR(made.mesh.nodes_mm[n].x, 0.37, 0.13 * 0.8);
  }
  EXPECT_GE(on_line, 20);
}

TEST(DistMeshPlane, ASideOfTheBoxIsFlatAndItsCornersAreNodes) {
  const auto made = mesh_of(nested({disc(0, 0, 40)}, 5, 0.7), 0.7);
  expect_good(made);
  EXPECT_NEAR(area_of(made.mesh, 1), 100, 1e-9);
}

TEST(DistMeshPlane, EdgesFollowTheSizeField) {
  const auto edge = [](const Vec3& p) { return 0.25 + 0.15 * std::hypot(p.x, p.y); };
  const auto made = mesh_of(nested({disc(0, 0, 3), disc(0, 0, 12)}, 14, edge), 0.25);
  expect_good(made);
  std::map<int, std::pair<double, int>> ratio;  // by ring
  for (const auto& c : made.mesh.corners)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 a = made.mesh.at(c[i]), b = made.mesh.at(c[(i + 1) % 3]), middle = 0.5 * (a + b);
      auto& [sum, count] = ratio[static_cast<int>(std::hypot(middle.x, middle.y) / 3)];
      sum += norm(b - a) / edge(middle);
      ++count;
    }
  for (const auto& [ring, mean] : ratio) EXPECT_NEAR(mean.first / mean.second, 1, 0.2) << "ring " << ring;
}

TEST(DistMeshPlane, AGivenNodeStaysWhereItIs) {
  auto settings = default_settings(Dimension::two);
  settings.fixed_mm = {{1.234, 2.345, 0}, {10, 0, 0}};
  const auto made = mesh_of(nested({disc(0, 0, 10)}, 14, 0.9), 0.9, settings);
  expect_good(made);
  for (const auto& p : settings.fixed_mm)
    EXPECT_NE(std::find(made.mesh.nodes_mm.begin(), made.mesh.nodes_mm.end(), p), made.mesh.nodes_mm.end());
}

// A lens whose tips have an angle of 12 degrees: no triangle with good angles fits into them.
TEST(DistMeshPlane, TipsTooSharpForATriangleEndBluntly) {
  const double offset = 10 * std::cos(6 * std::numbers::pi / 180);
  const auto lower = disc(0, -offset, 10), upper = disc(0, offset, 10);
  auto m = nested({lower, disc(0, 0, 11)}, 14, 0.3);
  m.label_at = [=](const Vec3& p) {
    if (disc(0, 0, 11)(p).value > 0) return 0;
    return lower(p).value < 0 && upper(p).value < 0 ? 1 : 2;
  };
  m.equations_at = [=](LabelBits labels, const Vec3& p, std::span<Equation> equations) {
    if ((labels & 1U) != 0)
      equations[0] = disc(0, 0, 11)(p);
    else
      equations[0] = p.y > 0 ? lower(p) : upper(p);
    return 1;
  };
  const auto made = mesh_of(m, 0.3);
  EXPECT_EQ(made.below_goal, 0);
  EXPECT_GE(angle_range(made.mesh).first, 30);
  EXPECT_EQ(defects(made.mesh), 0);
}

TEST(DistMeshPlane, TheSameInputGivesTheSameBits) {
  const auto m = nested({disc(1, 0, 4), disc(0, 0, 10)}, 9, 0.8);
  const auto one = mesh_of(m, 0.8), other = mesh_of(m, 0.8);
  EXPECT_EQ(one.mesh.nodes_mm, other.mesh.nodes_mm);
  EXPECT_EQ(one.mesh.corners, other.mesh.corners);
  EXPECT_EQ(one.mesh.label, other.mesh.label);
}

TEST(DistMeshPlane, NothingToMeshIsRefused) {
  auto m = nested({disc(0, 0, 1)}, 5, 1);
  m.label_at = [](const Vec3&) { return 0; };
  EXPECT_THROW(relax(m, Dimension::two, 1, default_settings(Dimension::two)), UserError);
}

TEST(ImproveTriangles, NeverLowersTheLeastAngleAndKeepsTheArea) {
  const auto m = nested({disc(0, 0, 10)}, 14, 1);
  auto settings = default_settings(Dimension::two);
  settings.iterations = 2;  // a poor mesh
  auto mesh = triangles_of(relax(m, Dimension::two, 1, settings));
  const double before = area_of(mesh, 1);
  double worst = 9;
  for (std::size_t t = 0; t < mesh.corners.size(); ++t)
    worst = std::min(worst, quality(mesh, static_cast<std::int32_t>(t)));
  improve_triangles(mesh, m, {});
  for (std::size_t t = 0; t < mesh.corners.size(); ++t) EXPECT_GE(quality(mesh, static_cast<std::int32_t>(t)), worst);
  EXPECT_NEAR(area_of(mesh, 1), before, 0.01 * before);
}

}  // namespace
