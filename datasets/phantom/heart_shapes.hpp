// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The four chambers, their walls, valves and great vessels of the phantom as signed distances in patient mm.
/// Sizes come from adult averages: left ventricle 48 mm across and 84 mm long inside, 10 mm thick; mitral orifice 26
/// mm, aortic 21 mm, tricuspid 31 mm, pulmonary 23 mm wide.
#pragma once
#include <functional>
#include <vector>

#include "datasets/phantom/shapes.hpp"
#include "model/landmarks.hpp"

namespace heartgen::phantom {

/// Where the heart lies: template point q goes to `to + scale * rotation * (q - from)`. The template frame is LPS mm
/// with x = 0 in the mid-sagittal plane and the centre of the left ventricle at (38, 0, 0).
struct HeartPose {
  Mat3 rotation;
  double scale = 1;
  Vec3 from, to;
  Vec3 operator()(const Vec3& q) const { return to + scale * (rotation * (q - from)); }
};

struct HeartSizes {
  double lv_radius_mm = 24, lv_length_mm = 58;  ///< semi-axes of the cavity (its base is cut off)
  double lv_wall_mm = 10, rv_wall_mm = 3.6, atrial_wall_mm = 2;
  double rv_width = 1;                        ///< factor on the right ventricle's reach away from the septum
  double lv_ridge_mm = 1.5, rv_ridge_mm = 2;  ///< depth of the trabeculae
};

struct Valve {
  Plane plane;  ///< normal out of the ventricle
  double radius_mm = 0;
};

/// A vein that belongs to an atrium up to a plane across its axis (the normal points away from the atrium).
struct Vein {
  Tube tube;
  Plane cut;
};

struct HeartShapes {
  HeartSizes sizes;  ///< in patient mm (already scaled)
  Vec3 center;       ///< of the left ventricular ellipsoid
  Mat3 local;        ///< rows: towards the septum, towards the anterior wall, from apex to base
  Mat3 axes;         ///< rows: the template's x, y, z in the patient (for the atria)
  double scale = 1;
  Vec3 middle;          ///< centre of a sphere around the chambers and 16 mm more
  double bound_mm = 0;  ///< its radius
  Valve mitral, aortic, tricuspid, pulmonary;
  Vec3 lv_outer_mm, rv_center_local_mm, rv_radii_mm;  ///< rv_center in local coordinates
  Vec3 la_center_mm, la_radii_mm, ra_center_mm, ra_radii_mm;
  Tube lv_outflow, rv_outflow, lv_papillary, rv_papillary;
  Tube la_appendage, ra_appendage;
  std::vector<Vein> la_veins, ra_veins;
  Tube coronaries;  ///< in the grooves of the epicardial fat
  Tube aorta, pulmonary_trunk, right_pulmonary;
  Plane left_pulmonary_end, right_pulmonary_end;  ///< hilum: beyond, the artery belongs to the lung
};

/// Distances to everything at one point, mm, negative inside. Pools never overlap and keep about 3 mm from each other
/// except at the discs of the valves.
struct HeartField {
  double lv, rv, la, ra, aorta, pulmonary;  ///< blood
  double lv_outer, rv_outer;                ///< outer surface of the ventricular muscle
  double papillary;                         ///< left and right papillary muscles and the moderator band
  double free_wall;                         ///< right ventricular cavity before the left ventricle is taken out
  double crevice;                           ///< positive in the narrow gap between a papillary muscle and the wall
  double outer;                             ///< outer surface of the whole heart without the great vessels
  double left_vein, right_vein;             ///< pulmonary veins and venae cavae beyond their atrium
};

/// Builds the heart; `place` maps template points of the great vessels, which are bent towards the fixed thorax.
HeartShapes make_heart_shapes(const HeartPose& pose, const HeartSizes& sizes,
                              const std::function<Vec3(const Vec3&)>& place);

/// Lays the coronary arteries into the grooves of a finished heart.
void add_coronaries(HeartShapes& heart);

HeartField heart_field(const HeartShapes& heart, const Vec3& p);

/// Endocardium and epicardium of a ventricle's wall as smooth surfaces, mm: outflow tracts belong to the cavity;
/// trabeculae, papillary muscles and the planes of the valves are left out. The wall is where inner > 0 > outer.
struct WallSurfaces {
  double inner, outer;
  double trabeculae;  ///< they reach this far into the cavity at this height, 0 near the valves
};
WallSurfaces lv_wall_surfaces(const HeartShapes& heart, const Vec3& p);
WallSurfaces rv_wall_surfaces(const HeartShapes& heart, const Vec3& p);

}  // namespace heartgen::phantom
