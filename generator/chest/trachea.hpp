// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The trachea as a chain of round discs of air.
#pragma once
#include <optional>

#include "generator/chest/thorax.hpp"

namespace heartgen::chest {

/// A point on the centre line of the trachea; nothing where no chain of discs is long and central enough.
std::optional<Vec3> find_trachea(const Volume<float>& hu, const Spine& spine);

}  // namespace heartgen::chest
