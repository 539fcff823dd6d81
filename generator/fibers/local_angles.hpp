// Carrying fibres as angles: the atlas's axes, written in its wall's own directions (circumferential, longitudinal,
// normal), are looked up at the registered position *and* the same wall depth, and rebuilt in the directions of the
// patient's wall. So neither the stretching of the warp nor a different wall thickness turns a fibre.
#pragma once
#include <array>
#include <vector>

#include "generator/atlas/axis_tensor.hpp"
#include "generator/atlas/coordinates.hpp"

namespace heart::fibers {

/// The known axes of one ventricle of the atlas.
struct AngleSamples {
  std::vector<Vec3> position_mm;          ///< in the atlas's frame
  std::vector<double> depth;              ///< 0 to 1
  std::vector<atlas::AxisTensor> tensor;  ///< dyad of the axis in (circumferential, longitudinal, normal)
};

/// Of the wall's voxels below the base; the right ventricle's without those within 6 mm of the left wall.
AngleSamples angle_samples(const atlas::AtlasImage& image, atlas::Part wall);

/// A point of the patient's wall.
struct AngleQuery {
  Vec3 atlas_mm;        ///< where it lies in the atlas
  atlas::WallPoint at;  ///< its depth and directions in the patient
};

/// Dyad of a unit axis per query, in the patient's frame: linear regression of the samples' tensors on the 24 nearest
/// in (position / 5 mm, depth / 0.04). `samples` must not be empty.
std::vector<atlas::AxisTensor> carry_local_angles(const AngleSamples& samples, const std::vector<AngleQuery>& queries);

}  // namespace heart::fibers
