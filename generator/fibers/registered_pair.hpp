// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A patient's ventricles and an atlas's, aligned, and fibre axes carried from one to the other at any points.
/// Serial per rank (threads inside); the same bits for any number of threads. Not collective.
#pragma once
#include <string>
#include <vector>

#include "generator/atlas/register.hpp"
#include "generator/fibers/local_angles.hpp"
#include "model/fiber_atlas.hpp"
#include "model/landmarks.hpp"
#include "model/recipe.hpp"

namespace heartgen::fibers {

/// One value per ventricle.
template <class T>
struct Both {
  T lv, rv;
};

/// Everything that carrying needs.
struct RegisteredPair {
  ventricles::Ventricles patient;
  ventricles::AtlasImage atlas;
  atlas::Registration registration;
  Both<AngleSamples> by_place, by_coordinates;
  Both<std::vector<double>> atlas_depth, atlas_thickness_mm;  ///< per sample: where in its wall, and how thick that is
  Both<ventricles::WallCoordinates> patient_walls;
  Both<ShapeShares> shape_shares;     ///< by which by_place and by_coordinates are weighed
  Both<Vec3> patient_centers_mm;      ///< what angles go around: the long axis, the right cavity
  Volume<float> left_of_junction_mm;  ///< of the patient
};

/// Throws UserError for a mirrored image: it looks like a heart everywhere, and would get fibres of the wrong hand.
void refuse_mirrored_patient(const LabelVolume& labels, const Landmarks& landmarks,
                             const ventricles::HeartFrame& frame);

/// Distance in mm to where the walls meet, positive in the left ventricle's; between voxels, where the labels' shares
/// have the walls' surfaces.
Volume<float> left_of_junction(const ventricles::Ventricles& ventricles);

/// `labels`: tags of labels.hpp. Throws UserError where a ventricle is missing, where the atlas has no fibres in one,
/// is mirrored (by its helix) or cannot be aligned, and where the patient is mirrored (by the heart's own shape).
/// `atlas_name` is for the messages. The second form makes the atlas's image, too, beside the patient's ventricles.
RegisteredPair register_pair(const LabelVolume& labels, const Landmarks& landmarks, ventricles::AtlasImage atlas,
                             const std::string& atlas_name, const FiberSettings& settings);
RegisteredPair register_pair(const LabelVolume& labels, const Landmarks& landmarks, const FiberAtlas& atlas,
                             const FiberSettings& settings);

/// What the walls are at a list of points.
struct PointWalls {
  std::vector<double> left_share;   ///< of the left ventricle in the field: 0 or 1 but within 0.15 mm of the junction
  std::vector<std::uint8_t> known;  ///< 0: too far from both walls
  std::vector<ventricles::WallPoint> lv, rv;
  std::vector<double> from_junction_mm;  ///< distance to where the walls meet; infinite where a point is of one alone
  const ventricles::WallPoint& main(std::size_t n) const { return left_share[n] >= 0.5 ? lv[n] : rv[n]; }
};
PointWalls point_walls(const RegisteredPair& hearts, const std::vector<Vec3>& points_mm,
                       const std::vector<std::uint8_t>& wanted);

/// Position in the atlas's frame of each point.
std::vector<Vec3> atlas_positions(const RegisteredPair& hearts, const std::vector<Vec3>& points_mm);

/// What a point of the patient's wall is looked up by in by_place: `atlas_mm`: its position in the atlas's frame.
WallFeature feature_in_atlas(const RegisteredPair& hearts, bool left, const Vec3& atlas_mm,
                             const ventricles::WallPoint& at);

/// What was fitted to the atlas at those of some points where one wall has a share.
struct WallFits {
  std::vector<std::int32_t> of_point;  ///< numbers of fits; -1 where there is none
  std::vector<AngleFit> fits;
};

struct FittedAxes {
  std::vector<AxisTensor> axes;  ///< dyads; zero where nothing could be carried
  Both<WallFits> fits;           ///< what they came from; empty for "jacobian"
};

/// `method`: "local_angles", "coordinates" or "jacobian".
FittedAxes carried_axes(const RegisteredPair& hearts, const PointWalls& walls, const std::vector<Vec3>& points_mm,
                        const std::vector<Vec3>& atlas_mm, const std::string& method);

/// What a point of the patient's wall is looked up by: its feature in by_coordinates or, otherwise, in by_place.
WallFeature feature_of(const RegisteredPair& hearts, bool left, const std::string& method, const Vec3& point_mm,
                       const Vec3& atlas_mm, const ventricles::WallPoint& at);

}  // namespace heartgen::fibers
