// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: where the right heart's valves usually lie beside those of the left heart; and the tricuspid
/// valve where streaks hide the blood's shape, from that and the groove between atrium and ventricle.
#pragma once
#include "generator/landmarks/long_axis.hpp"
#include "generator/landmarks/valve_patch.hpp"

namespace heartgen::landmarks {

/// Where the tricuspid valve usually lies: to the right of the line from mitral to aortic valve, the aortic root
/// wedged between the two, nearer to the apex by some millimetres, and turned to the right of the long axis.
ValvePatch usual_tricuspid(const ValvePatch& mitral, const ValvePatch& aortic, const LongAxis& axis);

/// Centre of the pulmonary valve in usual hearts: in front and to the left of the aortic valve.
Vec3 usual_pulmonary_mm(const ValvePatch& mitral, const ValvePatch& aortic, const LongAxis& axis);

/// Moves `usual` to the narrowest place nearby between the fat of the groove and the walls of the left heart. Neither
/// bright nor dark streaks count: all tissue does that is no fat, no usual wall, and not the left heart. Nothing where
/// no such tissue is near.
std::optional<ValvePatch> narrowest_tricuspid(const LabelVolume& chambers, const Volume<float>& hu, double muscle_hu,
                                              const ValvePatch& usual);

}  // namespace heartgen::landmarks
