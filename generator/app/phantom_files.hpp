// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The analytic data set as the files that a build reads.
#pragma once
#include <filesystem>

#include "datasets/phantom/phantom.hpp"

namespace heartgen::app {

/// CT, atlas, landmarks, carotid, another patient's torso, the truth of all, and `recipe.toml`, which builds them.
/// Files of these names are written over.
void write_phantom(const std::filesystem::path& folder, const phantom::PhantomSettings& settings);

}  // namespace heartgen::app
