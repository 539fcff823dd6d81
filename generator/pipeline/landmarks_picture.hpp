// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the search for landmarks found, to be judged at a glance.
#pragma once
#include <cstdint>
#include <vector>

#include "generator/landmarks/search.hpp"
#include "model/volume.hpp"

namespace heartgen::pipeline {

/// A PNG of an axial, a coronal and a sagittal slice through the middle of the seeds, side by side: outlines of the
/// chambers, the seeds as crosses, the valves as lines where their discs cut the slice.
std::vector<std::uint8_t> landmarks_picture(const CtVolume& ct, const landmarks::SearchResult& result);

}  // namespace heartgen::pipeline
