// SPDX-License-Identifier: GPL-3.0-or-later
// The fibre road from end to end on analytic ventricles with a known field.
#include "generator/fibers/map_fibers.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "datasets/phantom/phantom.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/mesh_queries/mesh_edges.hpp"
#include "support/model_heart.hpp"

namespace heartgen::fibers {
namespace {

using testing::axis_angle_deg;
using testing::ModelHeart;

FiberSettings quick_settings() {
  FiberSettings settings;
  settings.grid_mm = 3;
  settings.depth_grid_mm = 1.8;
  settings.demons_iterations = {20, 10};
  return settings;
}

/// The stand-in atlas after x -> matrix * x + offset.
FiberAtlas moved_atlas(const Mat3& matrix, const Vec3& offset) {
  const auto mesh = phantom::make_standin_atlas();
  std::vector<Vec3> points, fibers;
  for (const Vec3& x : mesh.nodes_mm) points.push_back(matrix * x + offset);
  for (const Vec3& f : mesh.node_fibers.fiber) fibers.push_back(matrix * f);
  return atlas::make_fiber_atlas("stand-in", points, mesh.cells, fibers);
}

FiberAtlas plain_atlas() { return moved_atlas({}, {}); }

/// The patient: a heart with thicker walls than the atlas's, in a body's pose (apex to the left, front and below).
ModelHeart patient_heart() {
  ModelHeart heart;
  heart.wall_mm = 12;
  heart.pose.rotation = testing::rotation_about(normalized({1, 0.4, 0}), -50) * testing::rotation_about({0, 0, 1}, -30);
  heart.pose.offset_mm = {30, -40, 100};
  return heart;
}

struct Patient {
  ModelHeart heart = patient_heart();
  LabelVolume labels = testing::labels_of(heart, 2.4);
  TetMesh mesh = testing::voxel_mesh(labels);
};

const Patient& patient() {
  static const Patient value;
  return value;
}

const FiberResult& plain_result() {
  static const FiberResult value = map_fibers(patient().mesh, patient().labels, {}, plain_atlas(), quick_settings());
  return value;
}

double mean_error_deg(const FiberResult& result, Region region) {
  double sum = 0, count = 0;
  for (std::size_t n = 0; n < patient().mesh.nodes_mm.size(); ++n) {
    const Vec3& x = patient().mesh.nodes_mm[n];
    if (testing::region_of(patient().heart, x) != region) continue;
    sum += axis_angle_deg(result.node.fiber[n], testing::fiber_of(patient().heart, x));
    ++count;
  }
  return sum / count;
}

double mean_difference_deg(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += axis_angle_deg(a[n], b[n]);
  return sum / static_cast<double>(a.size());
}

TEST(CarryFibers, KnownFieldIsFoundOnAThickerHeartInAnotherPose) {
  const auto& result = plain_result();
  // Voxels of 2 to 3 mm here; the phantom's end-to-end test holds the accuracy at real resolutions.
  EXPECT_LT(mean_error_deg(result, Region::lv_myocardium), 6);
  EXPECT_LT(mean_error_deg(result, Region::rv_myocardium), 11);
  EXPECT_GT(result.min_jacobian, 0);
  EXPECT_GT(result.atlas_overlap, 0.8);
  EXPECT_LT(result.affine_rms_mm, 2);
}

TEST(CarryFibers, EveryNodeAndCellHasAnOrthonormalFrameAndASource) {
  const auto& result = plain_result();
  const auto check = [](const FiberField& field, std::size_t count) {
    ASSERT_EQ(field.fiber.size(), count);
    for (std::size_t n = 0; n < count; ++n) {
      ASSERT_NEAR(norm(field.fiber[n]), 1, 1e-9);
      ASSERT_NEAR(norm(field.sheet[n]), 1, 1e-9);
      ASSERT_NEAR(dot(field.fiber[n], field.sheet[n]), 0, 1e-9);
      ASSERT_NEAR(norm(field.sheet_normal[n] - cross(field.fiber[n], field.sheet[n])), 0, 1e-9);
    }
  };
  check(result.node, patient().mesh.nodes_mm.size());
  check(result.cell, patient().mesh.cells.size());
  for (const auto source : result.source) ASSERT_NE(source, static_cast<std::uint8_t>(FiberSource::none));
}

TEST(CarryFibers, TheAtlassOwnJumpsAreThoseAlongItsOwnEdges) {
  const auto atlas = plain_atlas();
  std::vector<double> jumps, lengths;
  for (const auto& [a, b] : mesh_queries::edges_of_cells(atlas.cells, atlas.points_mm.size())) {
    const auto m = static_cast<std::size_t>(a), n = static_cast<std::size_t>(b);
    jumps.push_back(axis_angle_deg(atlas.fiber[m], atlas.fiber[n]));
    lengths.push_back(norm(atlas.points_mm[m] - atlas.points_mm[n]));
  }
  const auto share_below = [](const std::vector<double>& values, double limit) {
    return static_cast<double>(std::ranges::count_if(values, [&](double v) { return v < limit; })) /
           static_cast<double>(values.size());
  };
  const auto& figures = plain_result().figures;
  EXPECT_NEAR(share_below(jumps, figures.jump_p99_deg), 0.99, 1e-3);
  EXPECT_NEAR(share_below(lengths, figures.edge_p50_mm), 0.5, 1e-3);
}

TEST(CarryFibers, NeitherSignsOfTheAtlasNorTheNumberOfThreadsChangeABit) {
  auto flipped = plain_atlas();
  for (std::size_t n = 0; n < flipped.fiber.size(); n += 3) flipped.fiber[n] = -flipped.fiber[n];
  const int before = parallel::thread_count();
  parallel::set_thread_count(before == 1 ? 3 : 1);
  const auto result = map_fibers(patient().mesh, patient().labels, {}, flipped, quick_settings());
  parallel::set_thread_count(before);
  EXPECT_EQ(result.min_jacobian, plain_result().min_jacobian);
  EXPECT_EQ(result.node.fiber, plain_result().node.fiber);
  EXPECT_EQ(result.cell.sheet, plain_result().cell.sheet);
}

TEST(CarryFibers, PoseSizeAndUnitOfTheAtlasDoNotMatter) {
  Mat3 matrix = testing::rotation_about(normalized({1, -2, 0.5}), 40);
  for (auto& row : matrix.rows) row *= 0.8e-3;  // four fifths of the size, in metres
  const auto turned = moved_atlas(matrix, {0.01, 0.2, -0.035});
  EXPECT_EQ(turned.unit_in_mm, 1000);
  const auto result = map_fibers(patient().mesh, patient().labels, {}, turned, quick_settings());
  // The same image but for voxels whose centres rounding puts on the other side of a surface.
  EXPECT_LT(mean_difference_deg(result.node.fiber, plain_result().node.fiber), 0.3);
  for (const Region wall : {Region::lv_myocardium, Region::rv_myocardium})
    EXPECT_NEAR(mean_error_deg(result, wall), mean_error_deg(plain_result(), wall), 0.3);
}

TEST(CarryFibers, PushedVectorsAreInpaintedWhereTheAtlasDoesNotReach) {
  auto settings = quick_settings();
  settings.method = "jacobian";
  const auto result = map_fibers(patient().mesh, patient().labels, {}, plain_atlas(), settings);
  EXPECT_LT(mean_error_deg(result, Region::lv_myocardium), 12);
  const auto inpainted =
      std::count(result.source.begin(), result.source.end(), static_cast<std::uint8_t>(FiberSource::inpainted));
  EXPECT_GT(inpainted, 0);
  EXPECT_LT(static_cast<double>(inpainted), 0.5 * static_cast<double>(result.source.size()));
  for (const Vec3& f : result.node.fiber) ASSERT_NEAR(norm(f), 1, 1e-9);
}

TEST(CarryFibers, AMirroredAtlasIsRefused) {
  EXPECT_THROW(map_fibers(patient().mesh, patient().labels, {},
                          moved_atlas({{Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}}, {}), quick_settings()),
               UserError);
}

TEST(CarryFibers, MissingVentricleAndUnknownMethodAreUserErrors) {
  auto labels = patient().labels;
  for (auto& v : labels.voxels)
    if (v == tag(Region::rv_blood)) v = 0;
  EXPECT_THROW(map_fibers(patient().mesh, labels, {}, plain_atlas(), quick_settings()), UserError);
  auto settings = quick_settings();
  settings.method = "jacobi";
  EXPECT_THROW(map_fibers(patient().mesh, patient().labels, {}, plain_atlas(), settings), UserError);
}

}  // namespace
}  // namespace heartgen::fibers
