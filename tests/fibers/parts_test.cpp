// SPDX-License-Identifier: GPL-3.0-or-later
// The pieces of the fibre stages against closed forms.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>

#include "datasets/phantom/phantom.hpp"
#include "generator/adapters/ceres_pose.hpp"
#include "generator/adapters/itk_registration.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "generator/atlas/atlas.hpp"
#include "generator/atlas/atlas_image.hpp"
#include "generator/fibers/frame.hpp"
#include "generator/fibers/inpaint.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "generator/image/resample.hpp"
#include "generator/ventricles/coordinates.hpp"
#include "generator/ventricles/trabeculae.hpp"
#include "model/axis_tensor.hpp"
#include "model/error.hpp"
#include "support/data.hpp"
#include "support/model_heart.hpp"
#include "support/places.hpp"

namespace heartgen {
namespace {

using ventricles::Part;

Grid cube(std::int64_t n, double spacing_mm) {
  Grid grid;
  grid.size = {n, n, n};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  return grid;
}

Vec3 at(const Grid& grid, std::int64_t i, std::int64_t j, std::int64_t k) {
  return lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
}

TEST(AxisTensor, LeadingAxisOfADyadIsTheAxis) {
  for (int n = 0; n < 50; ++n) {
    const Vec3 f = normalized({std::sin(1.7 * n), std::cos(2.3 * n), std::sin(0.9 * n + 1)});
    EXPECT_LT(testing::axis_angle_deg(f, leading_axis(axis_tensor(f))), 1e-6);
  }
  EXPECT_EQ(leading_axis(AxisTensor{}), Vec3{});
}

AxisTensor tensor_of(const std::array<Vec3, 3>& axes, const Vec3& values) {
  return values.x * axis_tensor(axes[0]) + values.y * axis_tensor(axes[1]) + values.z * axis_tensor(axes[2]);
}

TEST(AxisTensor, LeadingAxisIsThatOfTheLargestEigenvalueHoweverNearTheNextOneIs) {
  int n = 0;
  for (const double scale : {1e-9, 1.0, 1e7})
    for (const Vec3& values :
         {Vec3{1, 0, 0}, Vec3{1, 1e-7, -1e-7}, Vec3{1, 0.5, 0.2}, Vec3{1, 0.74, 0}, Vec3{1, 0.76, 0}, Vec3{1, 0.9, 0.9},
          Vec3{1, 0.999, 0}, Vec3{0.1, -0.3, -0.4}, Vec3{3, 2.99999, 2.99998}}) {
      ++n;
      const Vec3 a = normalized({std::sin(1.7 * n), std::cos(2.3 * n), std::sin(0.9 * n + 1)});
      const Vec3 b = normalized(cross(a, {std::cos(0.4 * n), 0.3, 1})), c = cross(a, b);
      const auto t = tensor_of({a, b, c}, scale * values);
      const Vec3 axis = leading_axis(t);
      const double gap = (values.x - values.y) / values.x;
      EXPECT_NEAR(norm(axis), 1, 1e-14);
      EXPECT_LT(norm(cross(axis, a)), 1e-14 / gap) << scale << " " << values.x << " " << values.y;
      EXPECT_LT(norm(cross(axis, leading_axis_by_rotations(t))), 1e-14 / gap);
    }
  EXPECT_EQ(leading_axis(axis_tensor({0, -2, 0})), (Vec3{0, 1, 0}));
  EXPECT_EQ(leading_axis({{-1, -2, -3, 0.1, 0.2, 0.3}}), Vec3{});
  EXPECT_NEAR(norm(leading_axis({{1, 1, 1, 0, 0, 0}})), 1, 1e-14);
}

TEST(MaterialAxes, AreOrthonormalEvenWhereTheWallRunsAlongTheFiber) {
  for (const Vec3& wall : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{1, 1e-9, 0}, Vec3{}}) {
    const auto axes = fibers::material_axes({2, 0, 0}, wall);
    EXPECT_NEAR(norm(axes.fiber), 1, 1e-12);
    EXPECT_NEAR(norm(axes.sheet), 1, 1e-12);
    EXPECT_NEAR(dot(axes.fiber, axes.sheet), 0, 1e-12);
    EXPECT_NEAR(norm(axes.sheet_normal - cross(axes.fiber, axes.sheet)), 0, 1e-12);
  }
}

TEST(DistanceMap, EqualsTheSlowMinimum) {
  Mask mask(cube(12, 1.5));
  for (std::size_t v = 0; v < mask.voxels.size(); v += 97) mask.voxels[v] = 1;
  const auto distance = image::distance_to(mask);
  for (std::int64_t k = 0; k < 12; ++k)
    for (std::int64_t j = 0; j < 12; ++j)
      for (std::int64_t i = 0; i < 12; ++i) {
        double least = 1e9;
        for (std::int64_t v = 0; v < mask.grid.voxel_count(); ++v)
          if (mask.voxels[static_cast<std::size_t>(v)])
            least = std::min(least, norm(at(mask.grid, i, j, k) - at(mask.grid, v % 12, v / 12 % 12, v / 144)));
        ASSERT_NEAR(distance(i, j, k), least, 1e-4);
      }
}

TEST(DistanceMap, IsExactWhetherTheMaskIsNearOrFar) {
  // Lines of which all, some and none lie near the mask; distances of up to 60 voxels.
  Mask mask(cube(47, 1));
  for (std::int64_t k = 0; k < 47; ++k)
    for (std::int64_t j = 0; j < 47; ++j)
      for (std::int64_t i = 0; i < 47; ++i)
        mask(i, j, k) = (i * i + 2 * j * j + k * k < 500 || (i > 40 && j > 40)) && (i + j * k) % 7 != 0;
  const auto distance = image::distance_to(mask);
  std::vector<Vec3> inside;
  for (std::int64_t v = 0; v < mask.grid.voxel_count(); ++v)
    if (mask.voxels[static_cast<std::size_t>(v)]) inside.push_back(at(mask.grid, v % 47, v / 47 % 47, v / (47 * 47)));
  for (std::int64_t v = 0; v < mask.grid.voxel_count(); v += 53) {
    const Vec3 p = at(mask.grid, v % 47, v / 47 % 47, v / (47 * 47));
    double least = 1e9;
    for (const Vec3& q : inside) least = std::min(least, dot(p - q, p - q));
    ASSERT_EQ(distance.voxels[static_cast<std::size_t>(v)], std::sqrt(static_cast<float>(least))) << v;
  }
}

/// A spherical shell, radii 14 and 26 mm, as a left ventricle.
ventricles::Ventricles shell() {
  ventricles::Ventricles result;
  result.parts = Volume<std::uint8_t>(cube(56, 1.1));
  result.frame.base_point_mm = {30, 30, 30};
  result.frame.base_normal = result.frame.long_axis = {0, 0, -1};
  result.frame.rv_side = {1, 0, 0};
  for (std::int64_t k = 0; k < 56; ++k)
    for (std::int64_t j = 0; j < 56; ++j)
      for (std::int64_t i = 0; i < 56; ++i) {
        const double r = norm(at(result.parts.grid, i, j, k) - Vec3{30, 30, 30});
        result.parts(i, j, k) = tag(r < 14 ? Part::lv_cavity : r < 26 ? Part::lv_wall : Part::outside);
      }
  return result;
}

TEST(WallCoordinates, DepthOfASphericalShellIsItsShareOfTheRadius) {
  const auto ventricles = shell();
  const auto coordinates = wall_coordinates(ventricles, Part::lv_wall);
  double sum = 0, worst_normal = 0, count = 0;
  for (std::int64_t k = 0; k < 56; ++k)
    for (std::int64_t j = 0; j < 56; ++j)
      for (std::int64_t i = 0; i < 56; ++i) {
        if (coordinates.known(i, j, k) != 1) continue;
        const Vec3 r = at(ventricles.parts.grid, i, j, k) - Vec3{30, 30, 30};
        const auto point = wall_point(coordinates, ventricles.frame, at(ventricles.parts.grid, i, j, k));
        ASSERT_TRUE(point);
        sum += std::abs(point->depth - (norm(r) - 14) / 12);
        worst_normal = std::max(worst_normal, norm(point->normal - normalized(r)));
        ASSERT_NEAR(dot(point->longitudinal, point->normal), 0, 1e-9);
        ++count;
      }
  EXPECT_LT(sum / count, 0.012);
  EXPECT_LT(worst_normal, 0.2);
}

/// A right wall of 4 mm over a cavity with flat roofs that meet in a right angle at x = 30, z = 30.
ventricles::Ventricles roof() {
  ventricles::Ventricles result;
  result.parts = Volume<std::uint8_t>(cube(56, 1.1));
  result.frame.long_axis = {0, 1, 0};
  result.frame.rv_side = {1, 0, 0};
  for (std::int64_t v = 0; v < result.parts.grid.voxel_count(); ++v) {
    const Vec3 p = image::voxel_center(result.parts.grid, v);
    const double above_mm = (p.z - 30 + std::abs(p.x - 30)) / std::sqrt(2);
    result.parts.voxels[static_cast<std::size_t>(v)] = tag(above_mm < 0   ? Part::rv_cavity
                                                           : above_mm < 4 ? Part::rv_wall
                                                                          : Part::outside);
  }
  return result;
}

TEST(WallCoordinates, AWallBendsAtItsEdgesAndNowhereElse) {
  const auto ventricles = roof();
  const auto wall = wall_coordinates(ventricles, Part::rv_wall);
  const auto bend_at = [&](double x_mm) {
    const Vec3 in_the_middle{x_mm, 30, 30 - std::abs(x_mm - 30) + 2 * std::sqrt(2)};
    const auto at = wall_point(wall, ventricles.frame, in_the_middle);
    return at ? at->bend : -1;
  };
  EXPECT_GT(bend_at(30), 0.4);  // of the sine of 45 degrees
  for (const double away_mm : {10.0, 14.0})
    for (const double x_mm : {30 - away_mm, 30 + away_mm}) {
      EXPECT_GE(bend_at(x_mm), 0) << x_mm;
      EXPECT_LT(bend_at(x_mm), 0.08) << x_mm;
    }
}

TEST(WallCoordinates, DepthGoesOnLinearlyJustOutsideTheWall) {
  const auto ventricles = shell();
  const auto coordinates = wall_coordinates(ventricles, Part::lv_wall);
  for (const Vec3& direction : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, normalized({1, 2, 2})}) {
    const auto inner = wall_point(coordinates, ventricles.frame, Vec3{30, 30, 30} + 14 * direction);
    const auto outer = wall_point(coordinates, ventricles.frame, Vec3{30, 30, 30} + 26 * direction);
    ASSERT_TRUE(inner && outer);
    EXPECT_LT(inner->depth, 0.06);
    EXPECT_GT(outer->depth, 0.94);
  }
}

TEST(Trabeculae, ANarrowRidgeBecomesCavityAndTheWallUnderItStays) {
  auto ventricles = shell();
  auto& parts = ventricles.parts;
  const auto smooth = parts;
  int ridge = 0, left = 0, wall = 0, lost = 0;
  for (std::size_t v = 0; v < parts.voxels.size(); ++v) {
    const Vec3 p = image::voxel_center(parts.grid, static_cast<std::int64_t>(v)) - Vec3{30, 30, 30};
    if (p.x > 0 && std::abs(p.y) < 3 && norm(p) > 11.5 && norm(p) < 14) parts.voxels[v] = tag(Part::lv_wall);
  }
  const auto ridged = parts;
  ventricles::give_trabeculae_to_cavity(parts, Part::lv_wall);
  for (std::size_t v = 0; v < parts.voxels.size(); ++v) {
    const bool is_left = is(parts.voxels[v], Part::lv_wall);
    if (is(smooth.voxels[v], Part::lv_wall)) {
      ++wall;
      lost += !is_left;
    } else if (is(ridged.voxels[v], Part::lv_wall)) {
      ++ridge;
      left += is_left;
    }
  }
  EXPECT_GT(ridge, 150);
  EXPECT_LT(left, 0.2 * ridge);
  EXPECT_LT(lost, 0.03 * wall);
}

TEST(Trabeculae, AThickWallIsNotThinnedTowardsItsBase) {
  constexpr double inner_mm = 20, outer_mm = 34, orifice_mm = 26;
  Volume<std::uint8_t> parts(cube(80, 1));
  const Vec3 middle{39.3, 39.6, 0};
  std::int64_t walls = 0, left = 0;
  for (std::size_t v = 0; v < parts.voxels.size(); ++v) {
    const Vec3 p = image::voxel_center(parts.grid, static_cast<std::int64_t>(v)) - middle;
    const double radius = std::hypot(p.x, p.y);
    const bool below = p.z < 60;
    const Part part = !below              ? (radius < orifice_mm ? Part::other : Part::outside)
                      : radius < inner_mm ? Part::lv_cavity
                      : radius < outer_mm ? Part::lv_wall
                                          : Part::outside;
    parts.voxels[v] = tag(part);
    walls += part == Part::lv_wall;
  }
  ventricles::give_trabeculae_to_cavity(parts, Part::lv_wall);
  for (const auto v : parts.voxels) left += is(v, Part::lv_wall);
  EXPECT_GT(static_cast<double>(left), 0.99 * static_cast<double>(walls));  // voxels' steps take a few
}

TEST(HelixAngle, ARightHandedHelixIsPositive) {
  ventricles::WallPoint wall;  // on the +x side of a heart whose base is up
  wall.normal = {1, 0, 0};
  wall.longitudinal = {0, 0, -1};
  wall.circumferential = cross(wall.longitudinal, wall.normal);
  EXPECT_NEAR(helix_angle_deg(wall, normalized({0, 1, 1})), 45, 1e-9);
  EXPECT_NEAR(helix_angle_deg(wall, -normalized({0, 1, 1})), 45, 1e-9);
  EXPECT_NEAR(helix_angle_deg(wall, normalized({0, -1, 1})), -45, 1e-9);
}

/// Neighbours by faces on an n³ lattice with spacing 1 mm.
fibers::NeighborGraph lattice(std::int64_t n) {
  fibers::NeighborGraph graph;
  const Grid g = cube(n, 1);
  graph.start.push_back(0);
  for (std::int64_t v = 0; v < g.voxel_count(); ++v) {
    const std::int64_t i = v % n, j = v / n % n, k = v / (n * n);
    for (const auto& [a, b, c] : {Index3{0, 0, -1}, {0, -1, 0}, {-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
      if (g.contains(i + a, j + b, k + c)) {
        graph.neighbor.push_back(static_cast<std::int32_t>(g.offset(i + a, j + b, k + c)));
        graph.distance_mm.push_back(1);
      }
    graph.start.push_back(static_cast<std::int64_t>(graph.neighbor.size()));
  }
  return graph;
}

TEST(Inpaint, AHoleInAConstantFieldIsFilledExactly) {
  constexpr std::int64_t n = 9;
  const AxisTensor constant = axis_tensor(normalized({1, -2, 0.5}));
  std::vector<AxisTensor> axes(n * n * n, constant);
  std::vector<std::uint8_t> missing(axes.size());
  for (std::int64_t k = 2; k < 9; ++k)
    for (std::int64_t j = 3; j < 7; ++j)
      for (std::int64_t i = 0; i < 6; ++i) {
        missing[static_cast<std::size_t>((k * n + j) * n + i)] = 1;
        axes[static_cast<std::size_t>((k * n + j) * n + i)] = axis_tensor({0, 0, 1});
      }
  EXPECT_EQ(fibers::inpaint_axes(lattice(n), 40, axes, missing), 7 * 4 * 6);
  for (const auto& a : axes)
    for (std::size_t c = 0; c < 6; ++c) ASSERT_NEAR(a.c[c], constant.c[c], 1e-12);
}

TEST(Inpaint, SignsDoNotMatterAndWhatNothingReachesStaysMissing) {
  fibers::NeighborGraph graph;  // 0 - 1 - 2   3
  graph.start = {0, 1, 3, 4, 4};
  graph.neighbor = {1, 0, 2, 1};
  graph.distance_mm = {1, 1, 1, 1};
  const Vec3 f = normalized({1, 1, 0});
  std::vector<AxisTensor> axes{axis_tensor(f), {}, axis_tensor(-f), {}};
  std::vector<std::uint8_t> missing{0, 1, 0, 1};
  EXPECT_EQ(fibers::inpaint_axes(graph, 10, axes, missing), 1);
  EXPECT_LT(testing::axis_angle_deg(leading_axis(axes[1]), f), 1e-6);
  EXPECT_EQ(missing[3], 1);
}

TEST(FitPose, FindsAKnownAffineMap) {
  Volume<float> target(cube(40, 2));
  for (std::int64_t k = 0; k < 40; ++k)
    for (std::int64_t j = 0; j < 40; ++j)
      for (std::int64_t i = 0; i < 40; ++i) {
        const Vec3 d = at(target.grid, i, j, k) - Vec3{40, 38, 41};
        target(i, j, k) = static_cast<float>(std::sqrt(d.x * d.x + 3 * d.y * d.y + 0.4 * d.z * d.z + d.x * d.y));
      }
  AffineMap truth;
  truth.matrix = {{Vec3{1.05, 0.1, 0}, Vec3{-0.08, 0.97, 0.03}, Vec3{0.02, 0, 1.02}}};
  truth.offset_mm = {1, -2, 1.5};
  std::vector<Vec3> points;
  std::vector<std::vector<float>> values(1);
  for (const double x : testing::steps(20, 60, 6))
    for (const double y : testing::steps(20, 60, 6))
      for (const double z : testing::steps(20, 60, 6)) {
        points.push_back({x, y, z});
        values[0].push_back(
            static_cast<float>(sample_linear(target, index_from_lps(target.grid, truth(points.back())))));
      }
  const auto fit = adapters::fit_pose({}, {40, 40, 40}, points, {&target}, values, adapters::PoseFreedom::affine);
  EXPECT_LT(fit.rms, 0.05);
  const auto back = inverse(fit.map);
  EXPECT_LT(norm(back(fit.map(Vec3{3, 4, 5})) - Vec3{3, 4, 5}), 1e-9);
  // On a processor with other caches: Eigen, inside Ceres too, would cut its sums elsewhere.
  Eigen::setCpuCacheSizes(4 << 10, 16 << 10, 64 << 10);
  const auto again = adapters::fit_pose({}, {40, 40, 40}, points, {&target}, values, adapters::PoseFreedom::affine);
  EXPECT_EQ(again.rms, fit.rms);
  for (int r = 0; r < 3; ++r) EXPECT_EQ(again.map.matrix[r], fit.map.matrix[r]);
}

TEST(Demons, MovesOneBallOntoAnotherWithoutFoldingAndWithTheSameBitsForAnyThreads) {
  const auto ball = [](const Vec3& center, double radius) {
    Volume<float> image(cube(24, 2));
    for (std::int64_t k = 0; k < 24; ++k)
      for (std::int64_t j = 0; j < 24; ++j)
        for (std::int64_t i = 0; i < 24; ++i)
          image(i, j, k) = norm(at(image.grid, i, j, k) - center) < radius ? 2.F : 0.F;
    return image;
  };
  const auto fixed = ball({22, 22, 22}, 12), moving = ball({26, 22, 20}, 14);
  adapters::DemonsSettings settings;
  settings.iterations = {30, 20};
  settings.threads = 1;
  const auto one = adapters::diffeomorphic_demons(fixed, moving, settings);
  settings.threads = 3;
  EXPECT_EQ(one.voxels, adapters::diffeomorphic_demons(fixed, moving, settings).voxels);
  // The left end of the fixed ball (x = 10) comes from the left end of the moving one (x = 12).
  const Vec3 moved = one(6, 11, 11);
  EXPECT_NEAR(moved.x, 1.5, 1.6);
  double misfit = 0, before = 0;
  for (std::int64_t k = 0; k < 24; ++k)
    for (std::int64_t j = 0; j < 24; ++j)
      for (std::int64_t i = 0; i < 24; ++i) {
        const Vec3 x = at(fixed.grid, i, j, k) + one(i, j, k);
        misfit += std::abs(sample_linear(moving, index_from_lps(moving.grid, x)) - fixed(i, j, k));
        before += std::abs(moving(i, j, k) - fixed(i, j, k));
      }
  EXPECT_LT(misfit, 0.35 * before);
}

TEST(FiberAtlas, NonsenseIsAUserError) {
  const std::vector<Vec3> points{{0, 0, 0}, {80, 0, 0}, {0, 80, 0}, {0, 0, 80}};
  const std::vector<Cell> cells{{0, 1, 2, 3}};
  const std::vector<Vec3> vectors(4, Vec3{0, 0, 2});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(atlas::make_fiber_atlas("a", points, cells, vectors));
  EXPECT_THROW(atlas::make_fiber_atlas("a", points, {}, vectors), UserError);
  EXPECT_THROW(atlas::make_fiber_atlas("a", points, cells, {}), UserError);
  EXPECT_THROW(atlas::make_fiber_atlas("a", points, cells, std::vector<Vec3>(4)), UserError);
  EXPECT_THROW(atlas::make_fiber_atlas("a", points, cells, std::vector<Vec3>(4, Vec3{nan, 0, 0})), UserError);
  EXPECT_THROW(atlas::make_fiber_atlas("a", points, {{0, 1, 2, 4}}, vectors), UserError);
  EXPECT_THROW(atlas::make_fiber_atlas("a", {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}}, cells, vectors), UserError);
}

TEST(FiberAtlas, CellVectorsBecomePointAxesAndCellsAreTurnedRound) {
  const std::vector<Vec3> points{{0, 0, 0}, {0.08, 0, 0}, {0, 0.08, 0}, {0, 0, 0.08}, {0.08, 0.08, 0.08}};
  const auto a = atlas::make_fiber_atlas("a", points, {{0, 2, 1, 3}, {1, 2, 3, 4}}, {{0, 0, 3}, {0, 0, -1}});
  EXPECT_EQ(a.unit_in_mm, 1000);
  EXPECT_NEAR(a.points_mm[1].x, 80, 1e-9);
  for (const Vec3& f : a.fiber) EXPECT_NEAR(std::abs(f.z), 1, 1e-12);
  for (const Cell& c : a.cells) {
    TetMesh mesh;
    mesh.nodes_mm = a.points_mm;
    EXPECT_GT(cell_volume_mm3(mesh, c), 0);
  }
}

TEST(FiberAtlas, IsReadFromALegacyVtkFile) {
  adapters::UnstructuredData data;
  data.points = {{0, 0, 0}, {80, 0, 0}, {0, 80, 0}, {0, 0, 80}};
  data.tets = {{0, 1, 2, 3}};
  data.point_vectors["direction"] = {{1, 0, 0}, {0, 2, 0}, {0, 0, -3}, {1, 1, 0}};
  const auto path = testing::scratch_folder("fiber_atlas") / "atlas.vtk";
  adapters::write_unstructured(path, data);
  const auto a = atlas::read_fiber_atlas(path.string());
  EXPECT_EQ(a.name, "atlas.vtk");
  EXPECT_NEAR(a.fiber[2].z, -1, 1e-9);
  data.point_vectors.clear();
  adapters::write_unstructured(path, data);
  EXPECT_THROW(atlas::read_fiber_atlas(path.string()), UserError);
}

/// Checks that the two ventricles of an atlas were told apart and have believable volumes; returns the helix angles
/// inside and outside of the left wall.
std::array<double, 2> survey(const ventricles::AtlasImage& image) {
  std::array<double, 6> ml{};
  for (const auto v : ventricles::cut_at_base(image.ventricles).voxels)
    ml[v] += image.ventricles.parts.grid.voxel_volume_mm3() / 1000;
  EXPECT_GT(ml[tag(Part::lv_wall)], 1.5 * ml[tag(Part::rv_wall)]);
  EXPECT_GT(ml[tag(Part::lv_cavity)], 10);
  EXPECT_GT(ml[tag(Part::rv_cavity)], 10);
  const auto wall = wall_coordinates(image.ventricles, Part::lv_wall);
  AxisTensor inside, outside;
  const Grid& g = image.fiber.grid;
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        const Vec3 f = image.fiber(i, j, k);
        if (wall.known(i, j, k) != 1 || norm(f) < 0.5) continue;
        const auto point = wall_point(wall, image.ventricles.frame, at(g, i, j, k));
        if (!point) continue;
        const AxisTensor local = axis_tensor({dot(f, point->circumferential), dot(f, point->longitudinal), 0});
        if (point->depth < 0.2) inside += local;
        if (point->depth > 0.8) outside += local;
      }
  const auto angle = [](const AxisTensor& t) {
    const Vec3 a = leading_axis(t);
    return std::atan2(a.x < 0 ? -a.y : a.y, std::abs(a.x)) * 180 / std::acos(-1.0);
  };
  return {angle(inside), angle(outside)};
}

TEST(AtlasImage, StandInAtlasHasTheHelixItWasMadeWith) {
  const auto mesh = phantom::make_standin_atlas();
  const auto a = atlas::make_fiber_atlas("stand-in", mesh.nodes_mm, mesh.cells, mesh.node_fibers.fiber);
  const auto [inside, outside] = survey(atlas::image_of_atlas(a, 1.5));
  EXPECT_NEAR(inside, 48, 8);
  EXPECT_NEAR(outside, -48, 8);
}

TEST(AtlasImage, AucklandVentriclesAreUnderstoodWithoutTheirOpenBase) {
  const std::string path = testing::real_data("auckland-heart/auckland_ventricles.vtk");
  if (path.empty()) GTEST_SKIP() << "no real data on this machine";
  const auto [inside, outside] = survey(atlas::image_of_atlas(atlas::read_fiber_atlas(path), 1.5));
  EXPECT_GT(inside, 35);
  EXPECT_LT(outside, -20);
}

TEST(AtlasImage, AMeshWithOneCavityIsAUserError) {
  testing::ModelHeart heart;
  heart.rv_wall_mm = 0;
  const auto mesh = testing::voxel_mesh(testing::labels_of(heart, 2.5));
  const auto a =
      atlas::make_fiber_atlas("one", mesh.nodes_mm, mesh.cells, std::vector<Vec3>(mesh.nodes_mm.size(), Vec3{1, 0, 0}));
  EXPECT_THROW(atlas::image_of_atlas(a, 1.5), UserError);
}

}  // namespace
}  // namespace heartgen
