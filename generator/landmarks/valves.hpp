// Private to this folder: the planes of the four valves.
#pragma once
#include <map>
#include <string>

#include "generator/landmarks/valve_patch.hpp"

namespace heart::landmarks {

/// Valves by name (mitral, aortic, tricuspid, pulmonary), as far as their two pools touch. `smooth` is the image on
/// the chambers' grid. `streaks`: the right heart is eaten away by streaks, its tightest place is no valve. The border
/// between the right heart's pools moves to the planes that are found.
std::map<std::string, ValvePatch> find_valves(LabelVolume& chambers, const Volume<float>& smooth, bool streaks);

}  // namespace heart::landmarks
