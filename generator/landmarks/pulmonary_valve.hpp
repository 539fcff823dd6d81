// Private to this folder: the pulmonary valve, which no constriction marks.
#pragma once
#include "generator/landmarks/valve_patch.hpp"

namespace heart::landmarks {

/// Walks from the pulmonary artery upstream into the ventricle's outflow tract and puts the valve where the fat
/// around the artery gives way to the muscle around the outflow tract. `start` is where the two pools were parted.
ValvePatch find_pulmonary_valve(const LabelVolume& chambers, const Volume<float>& smooth, const ValvePatch& start);

}  // namespace heart::landmarks
