// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/pictures.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cstring>
#include <set>

#include "model/error.hpp"
#include "support/synthetic_heart.hpp"
#include "validation/boundary_faces.hpp"
#include "validation/heart_frame.hpp"
#include "validation/report/canvas.hpp"
#include "validation/report/palette.hpp"
#include "validation/report/streamlines.hpp"

namespace heartgen::report {
namespace {

using heartgen::testing::synthetic_ct;
using heartgen::testing::synthetic_labels;
using heartgen::testing::synthetic_myocardium;

/// Decoded with libpng's own reader.
report::Canvas decoded(const report::PngBytes& bytes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) << image.message;
  image.format = PNG_FORMAT_RGB;
  report::Canvas canvas(static_cast<int>(image.width), static_cast<int>(image.height), report::Rgb{});
  static_assert(sizeof(report::Rgb) == 3);
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, canvas.pixels.data(), 0, nullptr)) << image.message;
  return canvas;
}

report::Rgb pixel(const report::Canvas& canvas, double share_x, double share_y) {
  return canvas.pixels[canvas.at(static_cast<int>(share_x * canvas.width), static_cast<int>(share_y * canvas.height))];
}

/// One bright voxel block on dark ground, off the middle along all three axes.
CtVolume marked_ct(const Vec3& mark_lps) {
  Grid grid;
  grid.size = {40, 50, 60};
  grid.spacing_mm = {1, 1, 1};
  CtVolume ct(grid, -1000);
  for (std::int64_t k = 0; k < 60; ++k)
    for (std::int64_t j = 0; j < 50; ++j)
      for (std::int64_t i = 0; i < 40; ++i)
        if (norm(Vec3{double(i), double(j), double(k)} - mark_lps) < 5) ct(i, j, k) = 1000;
  return ct;
}

TEST(SlicePicture, HasTheAskedSizeAndSquarePixels) {
  Grid grid;
  grid.size = {40, 50, 20};
  grid.spacing_mm = {1, 1, 3};
  const CtVolume ct(grid, 0);
  report::SliceOptions options;
  options.width_px = 200;
  const report::Canvas axial = decoded(report::slice_picture(&ct, nullptr, report::SlicePlane::axial, 10, options));
  EXPECT_EQ(axial.width, 200);
  EXPECT_EQ(axial.height, 250);
  const report::Canvas coronal = decoded(report::slice_picture(&ct, nullptr, report::SlicePlane::coronal, 10, options));
  EXPECT_EQ(coronal.height, 300);  // 20 slices of 3 mm over 40 mm
}

TEST(SlicePicture, ShowsThePatientsLeftOnTheRightAndHeadUp) {
  const CtVolume ct = marked_ct({30, 10, 50});  // left, front, up
  const report::Canvas axial = decoded(report::slice_picture(&ct, nullptr, report::SlicePlane::axial, 50));
  EXPECT_GT(pixel(axial, 30.5 / 40, 10.5 / 50).r, 200);
  EXPECT_LT(pixel(axial, 10.5 / 40, 10.5 / 50).r, 50);
  const report::Canvas coronal = decoded(report::slice_picture(&ct, nullptr, report::SlicePlane::coronal, 10));
  EXPECT_GT(pixel(coronal, 30.5 / 40, 9.5 / 60).r, 200);
  const report::Canvas sagittal = decoded(report::slice_picture(&ct, nullptr, report::SlicePlane::sagittal, 30));
  EXPECT_GT(pixel(sagittal, 10.5 / 50, 9.5 / 60).r, 200);
}

TEST(SlicePicture, IsTheSameForAFlippedGrid) {
  const CtVolume ct = marked_ct({30, 10, 50});
  report::SliceOptions options;
  options.width_px = 160;
  CtVolume flipped(ct.grid);
  flipped.grid.direction[1] = {0, -1, 0};
  flipped.grid.origin_mm.y = 49;
  for (std::int64_t k = 0; k < 60; ++k)
    for (std::int64_t j = 0; j < 50; ++j)
      for (std::int64_t i = 0; i < 40; ++i) flipped(i, j, k) = ct(i, 49 - j, k);
  EXPECT_EQ(report::slice_picture(&ct, nullptr, report::SlicePlane::axial, 50, options),
            report::slice_picture(&flipped, nullptr, report::SlicePlane::axial, 50, options));
  EXPECT_EQ(report::slice_picture(&ct, nullptr, report::SlicePlane::coronal, 10, options),
            report::slice_picture(&flipped, nullptr, report::SlicePlane::coronal, 39, options));
}

TEST(SlicePicture, OutlinesFollowTheRegions) {
  const LabelVolume labels = synthetic_labels(2.5);
  const CtVolume ct(labels.grid, -1000);
  report::SliceOptions options;
  options.legend = false;
  const report::Canvas canvas = decoded(report::slice_picture(&ct, &labels, report::SlicePlane::axial, 20, options));
  std::set<std::size_t> outlined;
  for (std::size_t region : {1u, 2u, 6u, 7u})
    for (const report::Rgb p : canvas.pixels)
      if (p == report::region_color(static_cast<std::int32_t>(region))) outlined.insert(region);
  EXPECT_EQ(outlined.size(), 4u);
  EXPECT_LT(pixel(canvas, 0.06, 0.2).r, 30);  // nothing is drawn outside
}

TEST(SlicePicture, RefusesASliceOutside) {
  const CtVolume ct = marked_ct({0, 0, 0});
  EXPECT_THROW(report::slice_picture(&ct, nullptr, report::SlicePlane::axial, 60), UserError);
  EXPECT_THROW(report::slice_picture(nullptr, nullptr, report::SlicePlane::axial, 0), UserError);
}

TEST(BoundaryFaces, CloseEveryRegionAndPointOut) {
  const TetMesh mesh = heartgen::testing::two_region_mesh(3);
  const auto boundary = validation::boundary_faces(mesh, validation::mesh_faces(mesh),
                                                   std::vector<std::uint8_t>(mesh.cells.size(), 1), true);
  std::array<double, 2> volume{};  // by the divergence theorem
  for (std::size_t f = 0; f < boundary.faces.size(); ++f) {
    const auto at = [&](std::size_t k) { return mesh.nodes_mm[static_cast<std::size_t>(boundary.faces[f][k])]; };
    const bool first = mesh.region[static_cast<std::size_t>(boundary.cell[f])] == mesh.region.front();
    volume[first ? 0 : 1] += dot(at(0), cross(at(1), at(2))) / 6;
  }
  EXPECT_NEAR(volume[0], 3 * 1.1 * 3 * 3 * 0.9, 1e-9);
  EXPECT_NEAR(volume[1], 3 * 1.1 * 3 * 3 * 0.9, 1e-9);
}

TEST(HelixAngle, IsKnownOnTheSyntheticField) {
  const TetMesh mesh = synthetic_myocardium(synthetic_labels(2.5));
  const auto angles = report::helix_angle_per_node(mesh);
  double worst = 0, compared = 0;
  for (std::size_t n = 0; n < angles.size(); ++n) {
    const Vec3& p = mesh.nodes_mm[n];
    // The left ventricle's free wall at mid height, away from voxel steps at the surfaces and from the junctions.
    const double inner = heartgen::testing::ellipsoid(p, {0, 0, 20}, {20, 20, 50});
    const double outer = heartgen::testing::ellipsoid(p, {0, 0, 20}, {30, 30, 60});
    if (p.x < 12 || p.z < 0 || p.z > 15 || inner < 1.12 || outer > 0.92) continue;
    const double depth = (inner - 1) / ((inner - 1) + (1 - outer));
    worst = std::max(worst, std::abs(angles[n] - (60 - 120 * depth)));
    ++compared;
  }
  EXPECT_GT(compared, 50);
  EXPECT_LT(worst, 16);  // stairs of 2.5 mm tilt the normals, and the long axis by a few degrees
}

TEST(HeartFrame, FindsTheAxisAndTheRightSide) {
  const validation::HeartFrame frame = validation::heart_frame(synthetic_myocardium(synthetic_labels(2.5)));
  EXPECT_GT(frame.axis.z, 0.98);
  EXPECT_LT(frame.to_right.x, -0.8);
  EXPECT_NEAR(dot(frame.axis, frame.to_right), 0, 1e-12);
}

TEST(Streamlines, FollowCirclesWhateverTheSigns) {
  TetMesh mesh = heartgen::testing::two_region_mesh(12);
  const Vec3 center{1.0 / 3 + 13.2, -7.25 + 6, 0};
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    const Vec3 d = mesh.nodes_mm[n] - center;
    const Vec3 around = normalized(Vec3{-d.y, d.x, 0});
    mesh.node_fibers.fiber[n] = n % 3 == 0 ? -around : around;
  }
  const std::vector<double> helix(mesh.nodes_mm.size(), 0);
  std::vector<std::int32_t> seeds;
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    const Vec3 d = mesh.nodes_mm[n] - center;
    if (std::abs(std::hypot(d.x, d.y) - 4.5) < 0.3 && d.z > 2) seeds.push_back(static_cast<std::int32_t>(n));
  }
  const auto lines = report::trace_fibers(mesh, seeds, helix, {0.5, 14});
  ASSERT_GT(lines.size(), 10u);
  for (const auto& line : lines) {
    EXPECT_GE(line.points_mm.size(), 25u);
    ASSERT_EQ(line.points_mm.size(), line.helix_deg.size());
    const auto radius = [&](const Vec3& p) { return std::hypot(p.x - center.x, p.y - center.y); };
    for (const Vec3& p : line.points_mm) EXPECT_NEAR(radius(p), radius(line.points_mm.front()), 0.35);
  }
}

TEST(Charts, HistogramBarsAddUpToEverything) {
  const std::string svg = report::histogram_svg({"a<b", {10, 10, 10, 50}}, 0, 100, 10, "mm");
  EXPECT_NE(svg.find("a&lt;b"), std::string::npos);
  EXPECT_EQ(svg.find("a<b"), std::string::npos);
  std::size_t bars = 0;
  for (auto at = svg.find("class=\"bar\""); at != std::string::npos; at = svg.find("class=\"bar\"", at + 1)) ++bars;
  EXPECT_EQ(bars, 2u);
  EXPECT_NE(svg.find("75%"), std::string::npos);  // the taller bar
}

TEST(Charts, ProfileSkipsEmptyBins) {
  const double none = std::nan("");
  const std::string svg =
      report::helix_profile_svg({{"LV", {0.25, 0.5, 0.75}, {60, none, -60}, {50, none, -70}, {70, none, -50}}});
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(svg.find("class=\"line s0\""), std::string::npos);
}

}  // namespace
}  // namespace heartgen::report
