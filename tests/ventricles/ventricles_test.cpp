// SPDX-License-Identifier: GPL-3.0-or-later
// The ventricles of a label map: which mirror image they are, and how their walls go on where they are cut.
#include "generator/ventricles/ventricles.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/phantom/phantom.hpp"
#include "generator/atlas/pose.hpp"
#include "generator/fibers/registered_pair.hpp"
#include "generator/image/resample.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/ventricles/base_extrapolation.hpp"
#include "generator/ventricles/coordinates.hpp"
#include "generator/ventricles/openings.hpp"
#include "generator/ventricles/quadratic_continuation.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heartgen {
namespace {

using ventricles::Part;

/// The phantom's heart as labels.
struct LabelledHeart {
  phantom::HeartModel model;
  Landmarks landmarks;
  LabelVolume labels;
};

LabelledHeart labelled_heart(int variant, double spacing_mm) {
  constexpr double half_mm = 95;
  LabelledHeart heart{phantom::make_heart_model(variant), {}, {}};
  heart.landmarks = phantom::landmarks_of(heart.model);
  const Vec3 middle = 0.5 * (heart.landmarks.seeds_mm.at("lv_blood") + heart.landmarks.seeds_mm.at("rv_blood"));
  Grid grid;
  const auto count = static_cast<std::int64_t>(2 * half_mm / spacing_mm);
  grid.size = {count, count, count};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  grid.origin_mm = middle - Vec3{half_mm, half_mm, half_mm};
  heart.labels = LabelVolume(grid);
  parallel::parallel_for(0, grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t v = begin; v < end; ++v)
      heart.labels.voxels[static_cast<std::size_t>(v)] =
          tag(phantom::region_at(heart.model, image::voxel_center(grid, v)));
  });
  return heart;
}

LabelVolume mirrored(const LabelVolume& labels) {
  LabelVolume result(labels.grid);
  const auto& n = labels.grid.size;
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
      for (std::int64_t i = 0; i < n[0]; ++i) result(i, j, k) = labels(n[0] - 1 - i, j, k);
  return result;
}

TEST(HeartHandedness, TellsAMirroredHeartWhateverItsPose) {
  for (const int variant : {0, 3}) {
    const auto heart = labelled_heart(variant, 3);
    const auto plain = ventricles::ventricles_of_labels(heart.labels, {}, 3);
    const auto flipped_labels = mirrored(heart.labels);
    const auto flipped = ventricles::ventricles_of_labels(flipped_labels, {}, 3);
    const auto right = heart_handedness(heart.labels, {}, plain.frame);
    const auto wrong = heart_handedness(flipped_labels, {}, flipped.frame);
    ASSERT_TRUE(right && wrong);
    EXPECT_GT(*right, 0.6);
    EXPECT_LT(*wrong, -0.6);
  }
}

// As in a cardiac CT whose septum and outflow tract outweigh the apex: its axis pointed to the base, and a heart that
// points the wrong way looks mirrored.
TEST(VentricularFrame, PointsToTheApexWhereverMostOfTheWallIs) {
  constexpr double heavy_mm = 28;
  auto heart = labelled_heart(0, 3);
  const auto plain = ventricles::ventricles_of_labels(heart.labels, heart.landmarks, 3).frame;
  const Vec3 valve = heart.landmarks.valves.at("aortic").center_mm;
  for (std::int64_t v = 0; v < heart.labels.grid.voxel_count(); ++v) {
    auto& label = heart.labels.voxels[static_cast<std::size_t>(v)];
    const bool is_outside_heart = !is_blood(static_cast<Region>(label)) && !is_myocardium(static_cast<Region>(label));
    if (is_outside_heart && norm(image::voxel_center(heart.labels.grid, v) - valve) < heavy_mm)
      label = tag(Region::lv_myocardium);
  }
  const auto heavy = ventricles::ventricles_of_labels(heart.labels, heart.landmarks, 3).frame;
  EXPECT_GT(dot(plain.long_axis, heart.landmarks.lv_apex_mm.value() - valve), 0);
  EXPECT_GT(dot(heavy.long_axis, plain.long_axis), 0.9);
}

TEST(HeartHandedness, AMirroredPatientIsRefusedByName) {
  const auto heart = labelled_heart(0, 3);
  const auto fiber_at = [&](const Vec3& p) { return phantom::fiber_at(heart.model, p); };
  FiberSettings settings;
  settings.grid_mm = settings.depth_grid_mm = 3;
  try {
    fibers::register_pair(mirrored(heart.labels), {},
                          ventricles::image_of_labels(heart.labels, fiber_at, heart.landmarks, 3), "phantom", settings);
    FAIL() << "a mirrored heart was accepted";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("the heart is mirrored"), std::string::npos) << error.what();
  }
}

/// Mean error of a wall's depth within `reach_mm` below a plane.
double depth_error_below(const LabelledHeart& heart, Part part, const Vec3& point, const Vec3& normal,
                         double reach_mm) {
  const auto ventricles = ventricles::ventricles_of_labels(heart.labels, {}, heart.labels.grid.spacing_mm.x);
  const auto wall = wall_coordinates(ventricles, part);
  const auto region = part == Part::lv_wall ? Region::lv_myocardium : Region::rv_myocardium;
  double sum = 0, count = 0;
  for (std::size_t v = 0; v < heart.labels.voxels.size(); ++v) {
    if (heart.labels.voxels[v] != tag(region)) continue;
    const Vec3 p = image::voxel_center(heart.labels.grid, static_cast<std::int64_t>(v));
    if (dot(point - p, normal) > reach_mm) continue;
    const double known = phantom::depth_at(heart.model, p);
    const auto at = wall_point(wall, ventricles.frame, p);
    if (std::isnan(known) || !at) continue;
    sum += std::abs(at->depth - known);
    ++count;
  }
  EXPECT_GT(count, 1000);
  return sum / count;
}

/// Mean error, with its sign, of the right wall's depth where labels are `label_mm` coarse.
double right_depth_bias(int variant, double label_mm) {
  const auto heart = labelled_heart(variant, label_mm);
  const auto ventricles = ventricles::ventricles_of_labels(heart.labels, heart.landmarks, 1);
  const auto wall = wall_coordinates(ventricles, Part::rv_wall);
  double sum = 0, count = 0;
  for (std::size_t v = 0; v < heart.labels.voxels.size(); ++v) {
    if (heart.labels.voxels[v] != tag(Region::rv_myocardium)) continue;
    const Vec3 p = image::voxel_center(heart.labels.grid, static_cast<std::int64_t>(v));
    const double known = phantom::depth_at(heart.model, p);
    const auto at = wall_point(wall, ventricles.frame, p);
    if (std::isnan(known) || !at) continue;
    sum += at->depth - known;
    ++count;
  }
  EXPECT_GT(count, 1000);
  return sum / count;
}

TEST(WallCoordinates, CoarseLabelsDoNotFillTheFloorBetweenRidges) {
  EXPECT_LT(right_depth_bias(1, 1.7), 0.033);  // 0.028; smoothed as coarsely as the labels are 0.037
}

TEST(CutVentricles, WallsGoOnAcrossACutThatIsNotSquareToTheAxis) {
  auto heart = labelled_heart(1, 2);
  const Vec3 up = phantom::long_axis(heart.model), side = normalized(cross(up, Vec3{0, 0, 1}));
  const Vec3 point = heart.landmarks.valves.at("mitral").center_mm - 8 * up;
  const Vec3 normal = std::cos(0.26) * up + std::sin(0.26) * side;
  for (std::size_t v = 0; v < heart.labels.voxels.size(); ++v) {
    auto& label = heart.labels.voxels[v];
    const bool ventricle = label == tag(Region::lv_myocardium) || label == tag(Region::rv_myocardium) ||
                           label == tag(Region::lv_blood) || label == tag(Region::rv_blood) ||
                           label == tag(Region::papillary);
    const Vec3 p = image::voxel_center(heart.labels.grid, static_cast<std::int64_t>(v));
    if (!ventricle || dot(p - point, normal) > 0) label = 0;
  }
  EXPECT_LT(depth_error_below(heart, Part::lv_wall, point, normal, 12), 0.06);
  // The right wall also ends at both of its valves, which lie below this cut and beyond which nothing is labelled.
  EXPECT_LT(depth_error_below(heart, Part::rv_wall, point, normal, 30), 0.08);
}

Grid millimetre_grid(const Index3& size) {
  Grid grid;
  grid.size = size;
  return grid;
}

/// A tube with a wall of 5 mm along `along`, cut at a plane and continued along `axis`: how many voxels up to a
/// height above the plane and clear of the tube's surfaces are something else than the tube would be, of how many of
/// its wall.
struct ContinuedTube {
  std::int64_t wrong = 0, walls = 0;
};

ContinuedTube continued_tube(const Vec3& along, const Vec3& axis, const Vec3& normal, double up_to_mm) {
  Volume<std::uint8_t> parts(millimetre_grid({40, 40, 40}));
  const Vec3 middle{20, 20, 20};
  const auto radius = [&](const Vec3& p) { return norm(cross(p - middle, along)); };
  const auto part_at = [&](const Vec3& p) {
    return tag(radius(p) < 6 ? Part::lv_cavity : radius(p) < 11 ? Part::lv_wall : Part::outside);
  };
  const ventricles::Plane plane{middle, normal};
  const auto center = [&](std::size_t v) { return image::voxel_center(parts.grid, static_cast<std::int64_t>(v)); };
  for (std::size_t v = 0; v < parts.voxels.size(); ++v)
    if (depth_below_mm(plane, center(v)) >= 0) parts.voxels[v] = part_at(center(v));
  extrapolate_above_base(parts, plane, axis);
  ContinuedTube tube;
  for (std::size_t v = 0; v < parts.voxels.size(); ++v) {
    const Vec3 p = center(v);
    const double height = -depth_below_mm(plane, p);
    if (height < 0 || height > up_to_mm) continue;
    tube.walls += parts.voxels[v] == tag(Part::lv_wall);
    if (std::abs(radius(p) - 6) > 1.5 && std::abs(radius(p) - 11) > 1.5) tube.wrong += parts.voxels[v] != part_at(p);
  }
  return tube;
}

TEST(CutVentricles, StraightWallsGoStraightThroughTheCut) {
  const Vec3 axis = normalized({0.3, 0, -1});
  const auto tube = continued_tube(axis, axis, normalized({-0.2, 0.1, -1}), 8);
  EXPECT_GT(tube.walls, 1000);
  EXPECT_EQ(tube.wrong, 0);
}

TEST(CutVentricles, LeaningWallsGoOnLeaning) {
  const auto tube = continued_tube(normalized({0.7, 0.1, -1}), {0, 0, -1}, normalized({-0.1, 0.1, -1}),
                                   6);  // higher up walls straighten
  EXPECT_GT(tube.walls, 1000);
  EXPECT_LT(tube.wrong, 0.03 * static_cast<double>(tube.walls));  // 0.16 if they went on along the axis
}

TEST(CutVentricles, AreComparedWithTheAtlasAsFarUpAsBothAreKnown) {
  ventricles::Ventricles patient, whole;
  patient.parts = Volume<std::uint8_t>(millimetre_grid({4, 4, 60}), tag(Part::lv_wall));
  whole.parts = patient.parts;
  const Vec3 down{0, 0, -1};
  patient.frame.base_point_mm = {0, 0, 20}, patient.frame.base_normal = down;
  whole.frame.base_point_mm = {0, 0, 25}, whole.frame.base_normal = down;
  const AffineMap map{{{Vec3{0.5, 0, 0}, Vec3{0, 0.5, 0}, Vec3{0, 0, 0.5}}}, {0, 0, 2}};
  const auto top = [](const Volume<std::uint8_t>& parts) {
    std::int64_t k = 0;
    while (k < parts.grid.size[2] && is(parts(1, 1, k), Part::lv_wall)) ++k;
    return k - 1;
  };
  const auto with_bases = atlas::common_parts(patient, whole, map);
  EXPECT_EQ(top(with_bases.patient), 20);
  EXPECT_EQ(top(with_bases.atlas), 25);
  // What the patient's frame takes for the base is no end of a heart that is cut: at 40 the cut ends it, 22 in the
  // atlas.
  patient.cut = ventricles::Plane{{0, 0, 40}, down};
  const auto at_cut = atlas::common_parts(patient, whole, map);
  EXPECT_EQ(top(at_cut.patient), 40);
  EXPECT_EQ(top(at_cut.atlas), 22);
  // The atlas's end at 25 lies at 46 in the patient.
  patient.cut = ventricles::Plane{{0, 0, 55}, down};
  const auto at_atlas_end = atlas::common_parts(patient, whole, map);
  EXPECT_EQ(top(at_atlas_end.patient), 46);
  EXPECT_EQ(top(at_atlas_end.atlas), 25);
}

/// A wide cavity under a lid with a hole, from which a tube leads to the side (+x) and ends open.
Part chamber_with_two_orifices(const Vec3& p) {
  const double radius = std::hypot(p.x - 35, p.y - 35), tube = std::hypot(p.y - 35, p.z - 25);
  if (p.z < 8 || p.z > 44) return Part::outside;
  if (radius < 20 && p.z > 12 && p.z < 40) return Part::rv_cavity;
  if (tube < 8 && p.x > 35 && p.x < 70) return Part::rv_cavity;
  if (radius < 9 && p.z >= 40) return Part::rv_cavity;
  if (radius < 24 || (tube < 11 && p.x > 35 && p.x < 70)) return Part::rv_wall;
  return Part::outside;
}

TEST(CutVentricles, OrificesBelowTheCutAreFoundWhereBloodMeetsNothing) {
  Volume<std::uint8_t> parts(millimetre_grid({90, 70, 60}));
  for (std::size_t v = 0; v < parts.voxels.size(); ++v)
    parts.voxels[v] = tag(chamber_with_two_orifices(image::voxel_center(parts.grid, static_cast<std::int64_t>(v))));
  const auto before = parts;
  const auto beyond = ventricles::open_orifices(parts, {{35, 35, 55}, {0, 0, -1}});
  // Over the lid, also beside its hole, the wall ends; the inlet's blood does not go on.
  EXPECT_TRUE(is(parts(35, 35, 47), Part::other) && is(parts(51, 35, 47), Part::other));
  EXPECT_TRUE(is(beyond(35, 35, 47), Part::outside));
  // At the tube's end it ends as well, and the blood goes on no wider than the tube.
  EXPECT_TRUE(is(parts(74, 35, 25), Part::other) && is(beyond(74, 35, 25), Part::rv_cavity));
  EXPECT_TRUE(is(beyond(74, 35 + 10, 25), Part::outside));
  // Beside the chamber and the tube is its outer surface, as before, and no tissue has changed.
  EXPECT_TRUE(is(parts(35, 65, 25), Part::outside) && is(parts(65, 50, 25), Part::outside));
  for (std::size_t v = 0; v < parts.voxels.size(); ++v)
    if (!is(before.voxels[v], Part::outside)) {
      ASSERT_EQ(parts.voxels[v], before.voxels[v]);
    }
}

TEST(QuadraticContinuation, IsExactForPlanesAndHoldsTheCurvatureOfASphere) {
  constexpr double radius_mm = 30;
  ventricles::DistanceSamples samples;
  const auto plane = [](const Vec3& p) { return 2 * p.x - 0.5 * p.y + p.z - 7; };
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 0; ++j)
      for (int k = 14; k <= 20; ++k) {
        const Vec3 p{2.0 * i, 2.0 * j, 2.0 * k};
        samples.points_mm.push_back(p);
        samples.values.push_back({plane(p), norm(p) - radius_mm});
      }
  const ventricles::QuadraticContinuation continued(samples);
  const Vec3 beyond = 34.0 * normalized({0, 0.12, 1});  // 4 mm from the nearest sample, 4 mm above the sphere
  const auto fit = continued(beyond);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->value[0], plane(beyond), 1e-3);
  EXPECT_NEAR(norm(fit->gradient[0] - Vec3{2, -0.5, 1}), 0, 1e-3);
  EXPECT_NEAR(fit->value[1], 4, 0.7);
  EXPECT_GT(dot(normalized(fit->gradient[1]), normalized(beyond)), 0.98);
  EXPECT_FALSE(continued({500, 0, 0}));
}

}  // namespace
}  // namespace heartgen
