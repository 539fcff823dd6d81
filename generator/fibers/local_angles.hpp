// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Carrying fibres as angles: the atlas's axes, written in its wall's own directions (circumferential, longitudinal,
/// normal), are looked up at a corresponding place and the same wall depth, and rebuilt in the directions of the
/// patient's wall. So neither the stretching of a warp nor a different wall thickness turns a fibre.
#pragma once
#include <array>
#include <vector>

#include "generator/ventricles/coordinates.hpp"
#include "model/axis_tensor.hpp"

namespace heartgen::fibers {

/// Where a point lies in a wall, scaled so that a distance of 1 means "as near as a neighbour should be": three numbers
/// of its place, then its depth, then how much the wall bends there, then three of where it faces. Where a wall bends
/// sharply its directions and its depth are the least certain, and hearts do not bend at the same places: what was
/// measured in a bend tells of bends. And a place is known to a few mm, along which a bend turns by tens of degrees: of
/// the places around, the one where the wall faces the same way is the likelier one.
using WallFeature = std::array<double, 8>;

/// By place: position in the atlas's frame (in units of 2.5 mm), depth (0.06), bend (0.06) and `atlas_normal` (0.07),
/// the wall's normal in that frame.
WallFeature place_feature(const Vec3& atlas_mm, double depth, double bend, const Vec3& atlas_normal);
Vec3 place_of(const WallFeature& place);  ///< atlas_mm of a place_feature

/// By coordinates: height along the long axis as a share of the heart's length (0.05), the angle around `center_mm`
/// (0.15 rad), depth (0.06), bend (0.06) and `normal` in the heart's frame (0.07); comparable between hearts without a
/// registration.
WallFeature coordinate_feature(const ventricles::HeartFrame& frame, const Vec3& center_mm, const Vec3& point_mm,
                               double depth, double bend, const Vec3& normal);

/// The known axes of one ventricle of the atlas.
struct AngleSamples {
  std::vector<WallFeature> feature;
  std::vector<AxisTensor> tensor;  ///< dyad of the axis in (circumferential, longitudinal, normal)
};

/// How much a wall's shape counts in what is looked up, as a share of how much it does between hearts of one shape.
struct ShapeShares {
  double bend = 1, facing = 1;
};
WallFeature weighed(WallFeature feature, const ShapeShares& shares);
void weigh_shape(const ShapeShares& shares, AngleSamples& samples);

/// Medians of how far bends and normals (about radians) of the features differ from those of the samples that are
/// nearest by place and depth alone. Both by place. Neither may be empty.
struct ShapeDifference {
  double bend = 0, facing = 0;
};
ShapeDifference shape_difference(const AngleSamples& samples, const std::vector<WallFeature>& features);

/// Shares by which what differs so between two hearts counts in units of most of that difference, where that is more
/// than it counts in otherwise (then 1).
ShapeShares shares_of(const ShapeDifference& difference);

/// The sample nearest to each feature. `samples` must not be empty.
std::vector<std::size_t> nearest_samples(const AngleSamples& samples, const std::vector<WallFeature>& features);

/// The samples around a feature as a linear function of it.
struct AngleFit {
  WallFeature feature{};
  AxisTensor tensor;                            ///< there, in (circumferential, longitudinal, normal)
  std::array<std::array<float, 6>, 7> slope{};  ///< of the tensor's entries by place (3), depth and normal (3)
};

/// Linear regression of the samples' tensors on the 96 nearest features, by place, depth and normal, in which samples
/// that the others contradict count less; a feature farther from all samples is looked up at their border, at its own
/// depth, and does not change with its place. `samples` must not be empty. The same bits for any number of threads.
std::vector<AngleFit> fit_local_angles(const AngleSamples& samples, const std::vector<WallFeature>& features);

/// The tensor at a feature amid those of some fits, of which there must be one at least: of third order where it is
/// their mean, as at a cell's centroid between its nodes.
AxisTensor between_fits(const std::vector<const AngleFit*>& fits, const WallFeature& feature);

/// Dyad in the patient's frame of the axis that leads `local`, a tensor in the wall's own directions.
AxisTensor in_patient_frame(const AxisTensor& local, const ventricles::WallPoint& at);

}  // namespace heartgen::fibers
