// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the right heart's blood divided into ventricle, atrium and pulmonary artery.
#pragma once
#include "generator/landmarks/long_axis.hpp"

namespace heartgen::landmarks {

/// `chambers` holds the whole right heart as rv_blood; on return it holds rv_blood, ra_blood and pulmonary_artery.
/// Streaks of undiluted contrast are closed first. Markers are placed in the left ventricle's frame,
/// a flood divides the rest at its constrictions. Returns whether there were streaks.
bool split_right_heart(LabelVolume& chambers, const Volume<float>& smooth, const LongAxis& axis);

/// Keeps the largest piece of each chamber, of the aorta every piece of 5 ml and more, and of the pulmonary artery the
/// one beside the right ventricle: the neck's tissue, as grey as a faint vena cava, can be larger.
void keep_main_pieces(LabelVolume& chambers);

}  // namespace heartgen::landmarks
