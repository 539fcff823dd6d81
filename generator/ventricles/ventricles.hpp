// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The two ventricles as a label image with an anatomical frame: the common language of patient and atlas.
/// Not collective; the same bits for any number of threads.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "model/landmarks.hpp"
#include "model/volume.hpp"

namespace heartgen::ventricles {

/// What a voxel is to the fibre stages.
enum class Part : std::uint8_t {
  outside = 0,
  lv_wall = 1,
  rv_wall = 2,
  lv_cavity = 3,
  rv_cavity = 4,
  other = 5,  ///< what lies beyond a valve: a wall that meets it ends there as at a cut, at neither of its surfaces
};

constexpr std::uint8_t tag(Part part) { return static_cast<std::uint8_t>(part); }
inline bool is(std::uint8_t voxel, Part part) { return voxel == tag(part); }
inline bool is_wall(std::uint8_t voxel) { return is(voxel, Part::lv_wall) || is(voxel, Part::rv_wall); }

/// Position and directions of a heart, in the frame of its label image.
struct HeartFrame {
  Vec3 base_point_mm;    ///< where the long axis meets the base plane
  Vec3 base_normal;      ///< unit, from base to apex
  Vec3 long_axis;        ///< unit, of the left ventricle, from base to apex
  Vec3 rv_side;          ///< unit, perpendicular to the long axis, to the right ventricle
  double length_mm = 0;  ///< from base_point_mm to the apex along the long axis
};

struct Plane {
  Vec3 point_mm, normal;  ///< unit, to the apex
};

/// How much of each voxel's surroundings the labels give to some parts, 0 to 1: where surfaces run between two voxels.
/// Empty where only the parts are known.
struct PartShares {
  Volume<float> lv_cavity, rv_cavity;
  Volume<float> left;  ///< wall and cavity of the left ventricle
  Volume<float> both;  ///< walls and cavities of both
};

struct Ventricles {
  Volume<std::uint8_t> parts;  ///< tags of Part; isotropic, identity direction; goes on above the base, so that walls
                               ///< end there neither at an endocardium nor at an epicardium
  PartShares shares;           ///< of the labels, before anything was made up
  HeartFrame frame;
  Mask trabeculae;  ///< 1 where a voxel of a cavity is a ridge of its wall; empty where labels are too coarse for them
  Volume<std::uint8_t> beyond;  ///< lv_cavity or rv_cavity where blood beyond a valve goes on through its orifice, else
                                ///< outside; empty where no valves are known
  std::optional<Plane> cut;     ///< where labels end though the heart goes on; the parts above are made up
  double label_spacing_mm = 0;  ///< of the labels that the parts come from: how coarse their steps are; 0: as the parts
  std::array<Vec3, 3> label_steps_mm{};  ///< from a voxel of those labels to its next along each axis; zero: unknown
};

inline double depth_below_base_mm(const HeartFrame& frame, const Vec3& point_mm) {
  return dot(point_mm - frame.base_point_mm, frame.base_normal);
}

/// How far below a plane, to the apex.
inline double depth_below_mm(const Plane& plane, const Vec3& point_mm) {
  return dot(point_mm - plane.point_mm, plane.normal);
}

inline Plane base_plane(const Ventricles& ventricles) {
  return {ventricles.frame.base_point_mm, ventricles.frame.base_normal};
}

/// The parts with everything above any of the planes, and beyond valves, taken away.
Volume<std::uint8_t> cut_at(const Ventricles& ventricles, const std::vector<Plane>& planes);

/// The same at the base plane and at the cut, if there is one.
Volume<std::uint8_t> cut_at_base(const Ventricles& ventricles);

/// Ventricles of a label map (tags of labels.hpp) resampled to `spacing_mm`. Papillary muscles count as cavity. The
/// base plane passes through the mitral valve (landmarks, else where lv_blood meets la_blood, else the upper end of
/// lv_blood). Throws UserError when the wall or the blood of a ventricle is missing.
Ventricles ventricles_of_labels(const LabelVolume& labels, const Landmarks& landmarks, double spacing_mm);

/// Which of the two mirror images a heart is, from itself alone, whatever the image's header says: the right ventricle
/// runs from the tricuspid to the pulmonary valve with the apex below and the left ventricle behind it, so the
/// direction between the two lies along rv_side × long_axis. 1: as in nearly everybody; -1: mirrored; empty where a
/// valve is neither a landmark nor found where the labels meet.
std::optional<double> heart_handedness(const LabelVolume& labels, const Landmarks& landmarks, const HeartFrame& frame);

/// An atlas on a grid, in a frame of its own: the base at the top (+z), the apex below.
struct AtlasImage {
  Ventricles ventricles;
  Volume<Vec3> fiber;  ///< unit axis per wall voxel below the base; zero elsewhere
  Mask mixed;          ///< 1 where the file itself mixes both ventricles' axes; empty where it nowhere does
};

/// An atlas given by its labels (tags of labels.hpp, chambers included) and its axis at any place, zero where unknown;
/// called from several threads. Treated like a patient. Throws UserError when a ventricle is missing.
AtlasImage image_of_labels(const LabelVolume& labels, const std::function<Vec3(const Vec3& lps_mm)>& fiber_at,
                           const Landmarks& landmarks, double spacing_mm);

/// Long axis, base point, RV side and length from the parts below the plane (base_point, base_normal).
/// Slices' centroids of the left ventricle, only those clear of a tilted base, iterated.
HeartFrame heart_frame(const Volume<std::uint8_t>& parts, const Vec3& base_point_mm, const Vec3& base_normal);

}  // namespace heartgen::ventricles
