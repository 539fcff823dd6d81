#include "generator/mesh/solid.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "mesh/shapes.hpp"

namespace {

using namespace heart;
using namespace heart::testing;

constexpr double middle_mm = 15, half_wall_mm = 0.75, voxel_mm = 1.2;

// A wall that is 1.5 mm thin, with blood in it, of voxels of 1.2 mm.
LabelVolume thin_ball() {
  return label_cube(40, voxel_mm, [](const Vec3& p) {
    const double radius = norm(p - Vec3{0.2, 0.1, -0.3});
    return radius < middle_mm - half_wall_mm   ? Region::lv_blood
           : radius < middle_mm + half_wall_mm ? Region::lv_myocardium
                                               : Region::none;
  });
}

LevelSet thin_wall() { return mesh::solid_level_set(mesh::make_domain(thin_ball(), 0.8), is_myocardium, 0.5, 0.8, 1); }

TEST(Solid, ThinWallKeepsBothItsSurfaces) {
  const auto solid = thin_wall();
  const Vec3 center = index_from_lps(solid.grid, {0.2, 0.1, -0.3});
  double volume = 0;
  for (const float value : solid.voxels) volume += value < 0 ? solid.grid.voxel_volume_mm3() : 0;
  const double area = 4 * std::numbers::pi * middle_mm * middle_mm;
  EXPECT_NEAR(volume, 2 * half_wall_mm * area, 0.08 * 2 * half_wall_mm * area);
  int holes = 0;
  for (int i = 0; i < 400; ++i) {  // along a spiral over the sphere
    const double z = -1 + (i + 0.5) / 200, turn = 2.4 * i, r = std::sqrt(1 - z * z);
    const Vec3 way{r * std::cos(turn), r * std::sin(turn), z};
    const auto& s = solid.grid.spacing_mm;
    const auto at = [&](double radius) {
      return sample_linear(solid, center + Vec3{radius * way.x / s.x, radius * way.y / s.y, radius * way.z / s.z});
    };
    holes += at(middle_mm) >= 0;
    EXPECT_GT(at(middle_mm - 2), 0);
    EXPECT_GT(at(middle_mm + 2), 0);
  }
  EXPECT_EQ(holes, 0);
}

TEST(Solid, MaterialsAreTheLevelSet) {
  const auto solid = thin_wall();
  const auto materials = mesh::materials_of(solid, 1, 0.5);
  const auto& s = solid.grid.spacing_mm;
  for (int i = 0; i < 500; ++i) {
    const Vec3 share{std::fmod(0.618 * i, 1.0), std::fmod(0.755 * i, 1.0), std::fmod(0.569 * i, 1.0)};
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = materials.box_min_mm[axis] + share[axis] * (materials.box_max_mm[axis] - materials.box_min_mm[axis]);
    const auto value = [&](const Vec3& q) { return sample_linear(solid, {q.x / s.x, q.y / s.y, q.z / s.z}); };
    EXPECT_EQ(materials.label_at(p), value(p) < 0 ? 1 : 0);
    EXPECT_NEAR(materials.edge_mm(p), 1 + 0.5 * std::max(0.0, std::abs(value(p)) - 1), 1e-9);
    std::array<lattice::Equation, 1> equation;
    ASSERT_EQ(materials.equations_at(3, p, equation), 1);
    EXPECT_NEAR(equation[0].value, value(p), 1e-9);
    for (int axis = 0; axis < 3; ++axis) {  // inside a cube of voxels the gradient is the difference quotient
      constexpr double step = 1e-4;
      Vec3 up = p, down = p;
      up[axis] += step;
      down[axis] -= step;
      const double place = p[axis] / s[axis];
      const bool is_near_face = std::abs(place - std::round(place)) < 2 * step / s[axis];
      const bool is_beyond =
          place < 0 || place > static_cast<double>(solid.grid.size[static_cast<std::size_t>(axis)] - 1);
      if (!is_near_face && !is_beyond) {
        EXPECT_NEAR(equation[0].gradient[axis], (value(up) - value(down)) / (2 * step), 1e-4);
      }
    }
  }
}

TEST(Solid, RimsAreRoundAndThinFinsGo) {
  // A plate that thins out to nothing: its edge is taken off where it is thinner than asked.
  const auto labels = label_cube(40, 1, [](const Vec3& p) {
    const bool inside = std::abs(p.x) < 12 && std::abs(p.y) < 12 && std::abs(p.z) < 0.25 * (p.x + 12);
    return inside ? Region::lv_myocardium : Region::none;
  });
  const auto solid = mesh::solid_level_set(mesh::make_domain(labels, 0.8), is_myocardium, 0.5, 0.8, 2);
  const auto at = [&](const Vec3& p) { return sample_linear(solid, index_from_lps(solid.grid, p)); };
  EXPECT_GT(at({-11.5, 0, 0}), 0) << "0.25 mm thick";
  EXPECT_LT(at({-4, 0, 0}), 0) << "4 mm thick";
  EXPECT_NEAR(at({4, 0, 4}), 0, 0.3);
}

}  // namespace
