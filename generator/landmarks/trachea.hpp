// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the trachea as a chain of round discs of air.
#pragma once
#include <optional>

#include "generator/landmarks/thorax.hpp"

namespace heartgen::landmarks {

/// A point on the centre line of the trachea; nothing where no chain of discs is long and central enough.
std::optional<Vec3> find_trachea(const Volume<float>& hu, const Spine& spine);

}  // namespace heartgen::landmarks
