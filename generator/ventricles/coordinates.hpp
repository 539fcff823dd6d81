// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Wall depth and local directions of a ventricle's wall. Depth is L0 / (L0 + L1): L0, L1 the distances to endocardium
/// and epicardium (Potse et al., IEEE TBME 53, 2006), taken from surfaces that are smooth below the voxel and as smooth
/// as uneven labels ask for (regularized_surface.hpp); its gradient is the wall's normal. Laplace's solution, taken as
/// a depth, is biased where walls are thick and curved; lengths of its paths are not, but they follow the voxels'
/// steps. Only one surface is measured at each place, most often the epicardium, which is smooth; the other one lies a
/// thickness of the compact wall off it, and that thickness changes slowly along the wall (compact_wall.hpp). The
/// endocardium is where the wall meets its own cavity; the epicardium is its other surface: for the left ventricle also
/// the septum's right side; for the right ventricle the outside only (nothing flows where it meets the left wall). Near
/// atria and vessels, where valves bend the surfaces, they are continued from below. Not collective; the same bits for
/// any number of threads.
#pragma once
#include <optional>

#include "generator/ventricles/ventricles.hpp"

namespace heartgen::ventricles {

struct WallCoordinates {
  Mask known;                  ///< 1 in the wall, 2 a few voxels around it (continued linearly), else 0
  Volume<float> depth;         ///< 0 at the endocardium to 1 at the epicardium; beyond [0, 1] outside the wall
  Volume<float> thickness_mm;  ///< L0 + L1
  Volume<Vec3> normal;         ///< unit, from the endocardium to the epicardium
  Volume<float> bend;  ///< how much the wall bends there: the sine of the angle that its normals within a few mm
                       ///< stand off their mean, 0 where they are parallel
};

/// `wall` is Part::lv_wall or Part::rv_wall.
WallCoordinates wall_coordinates(const Ventricles& ventricles, Part wall);

/// Coordinates at a point. The directions are unit and orthogonal; `longitudinal` points to the apex and
/// circumferential = longitudinal × normal in world coordinates, whatever the heart's orientation.
struct WallPoint {
  double depth = 0;  ///< clamped to [0, 1]
  double thickness_mm = 0;
  double bend = 0;  ///< see WallCoordinates
  Vec3 normal, longitudinal, circumferential;
};

/// Empty where the point is too far from the wall.
std::optional<WallPoint> wall_point(const WallCoordinates& coordinates, const HeartFrame& frame, const Vec3& point_mm);

/// Angle in degrees, in (-90, 90], of an axis above the circumferential direction in the wall's tangent plane;
/// positive for a right-handed helix.
double helix_angle_deg(const WallPoint& at, const Vec3& axis);

}  // namespace heartgen::ventricles
