// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Labels whose names were exchanged between left and right, or between the great vessels.
#pragma once
#include <string>

#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::labels {

/// Throws UserError, naming `path`, where regions touch as they do in nobody: the left ventricle's wall around other
/// blood than its own, or inside of it; the septum at the right atrium; each atrium, or each great vessel, at the other
/// side's ventricle; and where what is called left has the thinner wall and lies on the right. Regions that are
/// missing, or that lie apart, say nothing.
void refuse_exchanged_regions(const LabelVolume& labels, const std::string& path);

}  // namespace heartgen::labels
