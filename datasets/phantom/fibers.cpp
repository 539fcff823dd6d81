// SPDX-License-Identifier: GPL-3.0-or-later
// Analytic fibres of the phantom's ventricles.
#include <limits>

#include "datasets/phantom/anatomy.hpp"
#include "datasets/phantom/body.hpp"
#include "model/mathematics.hpp"

namespace heartgen::phantom {
namespace {

constexpr double off_muscle_mm = 6;
constexpr double endocardial_helix_deg = 60;
constexpr double helix_around_deg = 20, helix_along_deg = 15;  // how far the regional field departs from the uniform

enum class Wall { none, left, right, papillary };

WallSurfaces surfaces(const HeartShapes& heart, Wall wall, const Vec3& p) {
  return wall == Wall::right ? rv_wall_surfaces(heart, p) : lv_wall_surfaces(heart, p);
}

double raw_depth(const HeartShapes& heart, Wall wall, const Vec3& p) {
  const WallSurfaces at = surfaces(heart, wall, p);
  return at.inner / (at.inner - at.outer);
}

Wall nearest_wall(const HeartField& f) {
  if (f.papillary < 0 && std::min(f.lv, f.rv) < 0) return Wall::papillary;
  if (f.lv_outer < 0 && f.lv > -off_muscle_mm) return Wall::left;
  const double left = std::max(f.lv_outer, -f.lv), right = std::max(f.rv_outer, -f.rv);
  if (std::min(left, right) > off_muscle_mm) return Wall::none;
  return left <= right ? Wall::left : Wall::right;
}

/// Whether a point that is not blood lies deeper in the smooth cavity than its trabeculae reach: in the plates that
/// carry the valves, or between the right cavity and the aortic root. These are fibrous; no rule for muscle applies.
bool is_fibrous(const HeartShapes& heart, const HeartField& f, Wall wall, const Vec3& p) {
  constexpr double room = 1.5;  // for the roundings at the trabeculae's feet
  if (wall != Wall::left && wall != Wall::right) return false;
  const WallSurfaces at = surfaces(heart, wall, p);
  return (wall == Wall::left ? f.lv : f.rv) > 0 && at.inner < -room * at.trabeculae;
}

Wall wall_at(const HeartShapes& heart, const HeartField& f, const Vec3& p) {
  const Wall wall = nearest_wall(f);
  return is_fibrous(heart, f, wall, p) ? Wall::none : wall;
}

Vec3 depth_gradient(const HeartShapes& heart, Wall wall, const Vec3& p) {
  constexpr double h = 0.2;
  Vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 step;
    step[axis] = h;
    g[axis] = raw_depth(heart, wall, p + step) - raw_depth(heart, wall, p - step);
  }
  return normalized(g);
}

/// Where a point lies in its ventricle, each coordinate about -1 to 1: along the rows of HeartShapes::local, in units
/// of the ventricle's half axes. The same in hearts of all sizes.
Vec3 place_in_ventricle(const HeartShapes& heart, Wall wall, const Vec3& p) {
  const Vec3 center = wall == Wall::right ? heart.rv_center_local_mm : Vec3{};
  const Vec3& half_axes = wall == Wall::right ? heart.rv_radii_mm : heart.lv_outer_mm;
  const Vec3 d = heart.local * (p - heart.center) - center;
  return {d.x / half_axes.x, d.y / half_axes.y, d.z / half_axes.z};
}

double helix_deg(const HeartShapes& heart, Wall wall, const Vec3& p, double depth, HelixField field) {
  double inside = endocardial_helix_deg, outside = -endocardial_helix_deg;
  if (field == HelixField::regional) {
    const Vec3 place = place_in_ventricle(heart, wall, p);
    inside += helix_around_deg * place.x - helix_along_deg * place.z;
    outside += helix_around_deg * place.y + helix_along_deg * place.z;
  }
  return inside + depth * (outside - inside);
}

/// Direction of the nearest straight piece of the papillary muscles.
Vec3 papillary_axis(const HeartShapes& heart, const HeartField& f, const Vec3& p) {
  return (f.lv < 0 ? heart.lv_papillary : heart.rv_papillary).nearest_direction(p);
}

}  // namespace

double depth_at(const HeartModel& model, const Vec3& lps_mm) {
  const auto& heart = model.anatomy->heart;
  const Wall wall = wall_at(heart, heart_field(heart, lps_mm), lps_mm);
  if (wall == Wall::none) return std::numeric_limits<double>::quiet_NaN();
  if (wall == Wall::papillary) return 0;
  return std::clamp(raw_depth(heart, wall, lps_mm), 0.0, 1.0);
}

Region muscle_of_fiber_at(const HeartModel& model, const Vec3& lps_mm) {
  const auto& heart = model.anatomy->heart;
  switch (wall_at(heart, heart_field(heart, lps_mm), lps_mm)) {
    case Wall::left:
      return Region::lv_myocardium;
    case Wall::right:
      return Region::rv_myocardium;
    case Wall::papillary:
      return Region::papillary;
    case Wall::none:
      break;
  }
  return Region::none;
}

Vec3 fiber_at(const HeartModel& model, const Vec3& lps_mm, HelixField helix_field) {
  const auto& heart = model.anatomy->heart;
  const HeartField field = heart_field(heart, lps_mm);
  const Wall wall = wall_at(heart, field, lps_mm);
  if (wall == Wall::none) return {};
  if (wall == Wall::papillary) return papillary_axis(heart, field, lps_mm);
  const Vec3 across = depth_gradient(heart, wall, lps_mm), axis = heart.local[2];
  Vec3 along = axis - dot(axis, across) * across;
  // At the very apex the long axis runs across the wall; any direction in the wall will do.
  if (norm(along) < 1e-6) along = heart.local[0] - dot(heart.local[0], across) * across;
  along = normalized(along);
  const Vec3 around = cross(along, across);
  const double depth = std::clamp(raw_depth(heart, wall, lps_mm), 0.0, 1.0);
  const double helix = helix_deg(heart, wall, lps_mm, depth, helix_field) * 3.14159265358979323846 / 180;
  return normalized(math::cos(helix) * around + math::sin(helix) * along);
}

}  // namespace heartgen::phantom
