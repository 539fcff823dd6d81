// SPDX-License-Identifier: GPL-3.0-or-later
// Coronary arteries of the phantom: they run 2.6 mm above the muscle, in the grooves between the chambers.
#include <cmath>

#include "datasets/phantom/heart_shapes.hpp"
#include "model/mathematics.hpp"

namespace heartgen::phantom {
namespace {

constexpr double clearance_mm = 2.6;
constexpr double pi = 3.14159265358979323846;

/// Walks outwards from `from` until the point is `clearance_mm` outside the heart for good.
Vec3 lift(const HeartShapes& heart, const Vec3& from, const Vec3& direction, double farthest_mm) {
  double last = 0;
  for (int step = 0; 0.5 * step < farthest_mm; ++step) {
    const double r = 0.5 * step;
    const HeartField f = heart_field(heart, from + r * direction);
    if (std::min({f.outer, f.aorta - 1.8, f.pulmonary - 1.8}) < clearance_mm) last = r;
  }
  return from + (last + 0.5) * direction;
}

/// A course around a valve of the atrium, in the groove between atrium and ventricle.
std::vector<CurvePoint> around_valve(const HeartShapes& heart, const Valve& valve, const Vec3& start, double turn_deg) {
  const Vec3 n = valve.plane.normal, d = start - valve.plane.point;
  const Vec3 u = normalized(d - dot(d, n) * n), v = cross(n, u);
  std::vector<CurvePoint> course;
  for (int step = 0; step <= 8; ++step) {
    const double angle = turn_deg * step / 8 * pi / 180;
    const Vec3 direction = math::cos(angle) * u + math::sin(angle) * v;
    course.push_back({lift(heart, valve.plane.point, direction, 45 * heart.scale), 1.7 - 0.05 * step});
  }
  return course;
}

/// A course from base to apex in the groove where the right ventricle meets the left one.
std::vector<CurvePoint> along_groove(const HeartShapes& heart, double from_deg, double to_deg) {
  std::vector<CurvePoint> course;
  const double length = heart.lv_outer_mm.z;
  for (int level = 0; level < 9; ++level) {
    const double height = 0.22 - 0.12 * level;
    const Vec3 middle = heart.center + height * length * heart.local[2];
    for (int step = 0; step <= 50; ++step) {
      const double angle = (from_deg + 0.02 * step * (to_deg - from_deg)) * pi / 180;
      const Vec3 direction = math::cos(angle) * heart.local[0] + math::sin(angle) * heart.local[1];
      const double shell = heart.lv_outer_mm.x * std::sqrt(1 - height * height) + clearance_mm;
      if (heart_field(heart, middle + shell * direction).rv_outer > clearance_mm) continue;
      course.push_back({lift(heart, middle, direction, 60 * heart.scale), 1.5 - 0.4 * (0.22 - height)});
      break;
    }
  }
  return course;
}

void lay(Tube& tube, const std::vector<CurvePoint>& course) {
  const auto curve = smooth_curve(course, 4);
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) tube.add(curve[i], curve[i + 1]);
}

}  // namespace

void add_coronaries(HeartShapes& heart) {
  const Vec3 root = heart.aortic.plane.point + 11 * heart.scale * heart.aortic.plane.normal;
  const auto ostium = [&](const Vec3& template_direction) {
    return CurvePoint{root + 14 * heart.scale * normalized(transposed(heart.axes) * template_direction), 1.8};
  };
  const CurvePoint left = ostium({0.95, -0.2, 0.1}), right = ostium({-0.5, -0.85, 0.1});
  auto descending = along_groove(heart, 150, 20), circumflex = around_valve(heart, heart.mitral, left.at, 150);
  auto right_course = around_valve(heart, heart.tricuspid, right.at, 170);
  descending.insert(descending.begin(), left);
  circumflex.insert(circumflex.begin(), left);
  right_course.insert(right_course.begin(), right);
  const auto posterior = along_groove(heart, 220, 340);
  for (const auto& course : {descending, posterior, circumflex, right_course}) lay(heart.coronaries, course);
  heart.coronaries.finish(4);
}

}  // namespace heartgen::phantom
