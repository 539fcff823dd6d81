// SPDX-License-Identifier: GPL-3.0-or-later
#include "datasets/phantom/heart_shapes.hpp"

#include "model/mathematics.hpp"

namespace heartgen::phantom {
namespace {

constexpr double reach = 16;           // mm; distances of tubes are exact up to here
constexpr double vessel_gap_mm = 3.2;  // least tissue between two pools
constexpr double plate_mm = 2;         // half the thickness of the fibrous plate that carries the valves
constexpr double lv_outflow_blend_mm = 5, rv_outflow_blend_mm = 8;  // roundings of the template's outflow tracts
constexpr double mitral_channel_mm = 9,
                 tricuspid_channel_mm = 10;  // how far the valves' channels reach into the ventricles
constexpr double junction_mm = 3;            // rounding where the ventricles' walls meet

/// A short cylinder on one side of a valve (side = +1: away from the ventricle), a little wider away from the disc.
double valve_channel(const Valve& valve, const Vec3& p, int side, double length_mm) {
  const Vec3 d = p - valve.plane.point;
  const double along = dot(d, valve.plane.normal), outward = side * along;
  const double radial = std::sqrt(std::max(dot(d, d) - along * along, 0.0));
  const double across = radial - valve.radius_mm - 0.25 * std::clamp(outward, 0.0, length_mm);
  return std::max({across, -outward, outward - length_mm});
}

bool near(const Valve& valve, const Vec3& p, double mm) {
  const Vec3 d = p - valve.plane.point;
  return dot(d, d) < mm * mm;
}

/// Height of the ridges at height z above the middle of a cavity: none near the valves.
double ridge_fade(double z, double length_mm) { return smooth_step(0.3 * length_mm, -0.25 * length_mm, z); }

/// Muscle ridges along the long axis: 0 in the grooves, 1 on the crests; fading towards the base.
double ridges(const Vec3& l, double count, double length_mm) {
  const double angle = math::atan2(l.y, l.x);
  const double twist =
      1.3 * math::sin(l.z / (0.16 * length_mm)) + 0.8 * math::sin(2 * angle + l.z / (0.11 * length_mm));
  const double wave = 0.5 + 0.5 * math::cos(count * angle + twist);
  const double room =
      smooth_step(4, 15, std::sqrt(l.x * l.x + l.y * l.y));  // no ridges where they would crowd together
  return wave * wave * room * ridge_fade(l.z, length_mm);
}

double lv_inner_smooth(const HeartShapes& heart, const Vec3& p) {
  const auto& s = heart.sizes;
  return ellipsoid(heart.local * (p - heart.center), {s.lv_radius_mm, s.lv_radius_mm, s.lv_length_mm});
}

double lv_outer_smooth(const HeartShapes& heart, const Vec3& p) {
  return ellipsoid(heart.local * (p - heart.center), heart.lv_outer_mm);
}

}  // namespace

WallSurfaces lv_wall_surfaces(const HeartShapes& heart, const Vec3& p) {
  const double height = dot(heart.local[2], p - heart.center), outflow = heart.lv_outflow(p);
  const double inflow = valve_channel(heart.mitral, p, -1, mitral_channel_mm * heart.scale);
  const double cavity = smooth_min(lv_inner_smooth(heart, p), outflow, lv_outflow_blend_mm * heart.scale);
  return {std::min(cavity, inflow), std::min(lv_outer_smooth(heart, p), outflow - vessel_gap_mm),
          heart.sizes.lv_ridge_mm * ridge_fade(height, heart.sizes.lv_length_mm)};
}

WallSurfaces rv_wall_surfaces(const HeartShapes& heart, const Vec3& p) {
  const Vec3 from_center = heart.local * (p - heart.center) - heart.rv_center_local_mm;
  const double body = ellipsoid(from_center, heart.rv_radii_mm);
  const double inflow = valve_channel(heart.tricuspid, p, -1, tricuspid_channel_mm * heart.scale);
  const double cavity = std::min(smooth_min(body, heart.rv_outflow(p), rv_outflow_blend_mm * heart.scale), inflow);
  const double inner = smooth_max(cavity, -lv_outer_smooth(heart, p), junction_mm);
  return {inner, inner - heart.sizes.rv_wall_mm,
          heart.sizes.rv_ridge_mm * ridge_fade(from_center.z, heart.rv_radii_mm.z)};
}

namespace {

double lv_blood(const HeartShapes& heart, const Vec3& p, double outflow) {
  double cavity = lv_inner_smooth(heart, p);
  if (cavity > -2 * heart.sizes.lv_ridge_mm && cavity < 2)
    cavity += heart.sizes.lv_ridge_mm * ridges(heart.local * (p - heart.center), 13, heart.sizes.lv_length_mm);
  cavity = std::max(cavity, heart.mitral.plane(p) + plate_mm);
  double blood = smooth_min(cavity, outflow, lv_outflow_blend_mm * heart.scale);
  if (near(heart.aortic, p, 25)) blood = std::max(blood, heart.aortic.plane(p));
  return std::min(blood, valve_channel(heart.mitral, p, -1, mitral_channel_mm * heart.scale));
}

/// The right cavity before the left ventricle is taken out: with trabeculae, and without (for the outer surface).
struct RightCavity {
  double rough, smooth;
};

RightCavity rv_cavity(const HeartShapes& heart, const Vec3& p, double aorta, double la) {
  const Vec3 from_center = heart.local * (p - heart.center) - heart.rv_center_local_mm;
  const double body = ellipsoid(from_center, heart.rv_radii_mm), outflow = heart.rv_outflow(p);
  const double base = heart.tricuspid.plane(p) + heart.sizes.rv_wall_mm - plate_mm;
  const double inflow = valve_channel(heart.tricuspid, p, -1, tricuspid_channel_mm * heart.scale);
  const double keep_out = std::max(vessel_gap_mm - aorta, vessel_gap_mm + 1 - la);
  const bool at_wall = body > -2 * heart.sizes.rv_ridge_mm && body < 2;
  const double ridge = at_wall ? heart.sizes.rv_ridge_mm * ridges(from_center, 19, heart.rv_radii_mm.z) : 0;
  const auto close = [&](double cavity) {
    double blood = smooth_min(std::max(cavity, base), outflow, rv_outflow_blend_mm * heart.scale);
    if (near(heart.pulmonary, p, 28)) blood = std::max(blood, heart.pulmonary.plane(p));
    return std::max(std::min(blood, inflow), keep_out);
  };
  return {close(body + ridge), close(body)};
}

/// Takes the left ventricle out of the right cavity and rounds the pocket where free wall and septum meet. What fills
/// the pocket goes to the nearer of the two walls.
void join_ventricles(const RightCavity& right, double lv_shell, HeartField& f) {
  const double cavity = right.rough;
  f.free_wall = cavity;
  f.rv = smooth_max(cavity, -lv_shell, junction_mm);
  if (f.rv > 0 && cavity < 0 && lv_shell > 0 && -lv_shell > cavity) f.lv_outer = std::min(f.lv_outer, -f.rv);
}

double la_blood(const HeartShapes& heart, const Vec3& p, double lv_outer, double keep_out) {
  double blood = ellipsoid(heart.axes * (p - heart.la_center_mm), heart.la_radii_mm);
  blood = smooth_min(blood, heart.la_appendage(p), 4);
  for (const auto& vein : heart.la_veins) blood = smooth_min(blood, std::max(vein.tube(p), vein.cut(p)), 4);
  blood = std::max({blood, plate_mm - heart.mitral.plane(p), -lv_outer});
  blood = std::min(blood, valve_channel(heart.mitral, p, 1, 10 * heart.scale));
  return std::max(blood, keep_out);
}

double ra_blood(const HeartShapes& heart, const Vec3& p, double muscle, double keep_out) {
  double blood = ellipsoid(heart.axes * (p - heart.ra_center_mm), heart.ra_radii_mm);
  blood = smooth_min(blood, heart.ra_appendage(p), 4);
  for (const auto& vein : heart.ra_veins) blood = smooth_min(blood, std::max(vein.tube(p), vein.cut(p)), 4);
  blood = std::max({blood, plate_mm - heart.tricuspid.plane(p), -muscle});
  blood = std::min(blood, valve_channel(heart.tricuspid, p, 1, 10 * heart.scale));
  return std::max(blood, keep_out);
}

double aorta_blood(const HeartShapes& heart, const Vec3& p) {
  const double aorta = heart.aorta(p);
  return near(heart.aortic, p, 26) ? std::max(aorta, -heart.aortic.plane(p)) : aorta;
}

double pulmonary_blood(const HeartShapes& heart, const Vec3& p, double aorta) {
  double left = heart.pulmonary_trunk(p);
  if (near(heart.pulmonary, p, 28)) left = std::max(left, -heart.pulmonary.plane(p));
  left = std::max(left, heart.left_pulmonary_end(p));
  const double right = std::max(heart.right_pulmonary(p), heart.right_pulmonary_end(p));
  return std::max(smooth_min(left, right, 3), vessel_gap_mm - aorta);
}

/// The part of the veins that no longer belongs to the atrium.
double beyond_cut(const std::vector<Vein>& veins, const Vec3& p) {
  double distance = reach;
  for (const auto& vein : veins) distance = std::min(distance, std::max(vein.tube(p), -vein.cut(p)));
  return distance;
}

void add_chambers(const HeartShapes& heart, const Vec3& p, HeartField& f) {
  const double outflow = heart.lv_outflow(p), lv_shell = lv_outer_smooth(heart, p);
  f.lv = lv_blood(heart, p, outflow);
  f.lv_outer = std::min(std::max(lv_shell, heart.mitral.plane(p) - plate_mm),
                        std::max(outflow - vessel_gap_mm, heart.aortic.plane(p) - 0.5));
  const double arteries = std::max({vessel_gap_mm - f.aorta, vessel_gap_mm - f.pulmonary,
                                    near(heart.aortic, p, 40) ? vessel_gap_mm - outflow : -reach});
  f.la = la_blood(heart, p, f.lv_outer, arteries);
  const RightCavity right = rv_cavity(heart, p, f.aorta, f.la);
  join_ventricles(right, std::min(lv_shell, f.lv_outer), f);
  const double shell = smooth_max(right.smooth, -lv_shell, junction_mm) - heart.sizes.rv_wall_mm;
  f.rv_outer = std::max(shell, heart.tricuspid.plane(p) - plate_mm);
  if (near(heart.pulmonary, p, 28)) f.rv_outer = std::max(f.rv_outer, heart.pulmonary.plane(p) - 0.5);
  f.ra = ra_blood(heart, p, std::min(f.lv_outer, f.rv_outer), std::max(arteries, vessel_gap_mm - f.la));
  f.papillary = std::min(heart.lv_papillary(p), heart.rv_papillary(p));
  f.crevice = smooth_max(std::min(f.lv, f.rv), -f.papillary, 3);
  f.outer = std::min({f.lv_outer, f.rv_outer, f.la - heart.sizes.atrial_wall_mm, f.ra - heart.sizes.atrial_wall_mm});
}

}  // namespace

HeartField heart_field(const HeartShapes& heart, const Vec3& p) {
  HeartField f;
  f.aorta = aorta_blood(heart, p);
  f.pulmonary = pulmonary_blood(heart, p, f.aorta);
  const double keep_out = vessel_gap_mm - std::min(f.aorta, f.pulmonary);
  f.left_vein = std::max(beyond_cut(heart.la_veins, p), keep_out);
  f.right_vein = std::max(beyond_cut(heart.ra_veins, p), keep_out);
  const Vec3 d = p - heart.middle;
  if (dot(d, d) < heart.bound_mm * heart.bound_mm) {
    add_chambers(heart, p, f);
  } else {
    f.lv = f.rv = f.la = f.ra = f.lv_outer = f.rv_outer = f.papillary = f.outer = f.free_wall = reach;
    f.crevice = -reach;
  }
  return f;
}

}  // namespace heartgen::phantom
