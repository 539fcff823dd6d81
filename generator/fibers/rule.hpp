// Fibres by rule for what a ventricular atlas does not have: papillary muscles run along themselves; atrial walls are
// crossed by bundles that circle the chamber, parallel to the valve.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "model/landmarks.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heart::fibers {

struct RuleAxis {
  Vec3 fiber;       ///< unit
  Vec3 transmural;  ///< unit
};

/// Per entry of `nodes`: fiber = the direction in which papillary muscle within 6 mm extends most. `long_axis` stands
/// in where it extends equally in two directions. transmural points away from the muscle's local centre line.
std::vector<RuleAxis> papillary_axes(const TetMesh& mesh, const std::vector<std::int32_t>& nodes,
                                     const Vec3& long_axis);

/// Per point: fiber = transmural × (valve to roof). transmural is the gradient of the distance to the chamber's blood;
/// the valve is the landmark, or else where the chamber's blood meets the ventricle's. `left` chooses the chamber.
std::vector<RuleAxis> atrial_axes(const LabelVolume& labels, const Landmarks& landmarks, bool left,
                                  const std::vector<Vec3>& points_mm);

}  // namespace heart::fibers
