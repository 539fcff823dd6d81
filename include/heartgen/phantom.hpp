// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// An analytic thorax with its CT, labels, landmarks and fibres: data for trying things out. Not collective.
#pragma once
#include <filesystem>

#include "datasets/phantom/phantom.hpp"

namespace heartgen {

using phantom::make_phantom;
using phantom::Phantom;
using phantom::PhantomSettings;

/// As `heartgen phantom`: CT, atlas, landmarks, carotid, another patient's torso, the truth of all, and `recipe.toml`,
/// which builds them. Files that this function wrote before are written over; throws UserError for others of their
/// names.
void write_phantom(const std::filesystem::path& folder, const PhantomSettings& settings);

}  // namespace heartgen
