// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How far automatic landmarks can be trusted: the two limits of their confidence.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "generator/landmarks/landmarks.hpp"

namespace heartgen::landmarks {

/// `sound`: go on. `uncertain`: go on and say so. `doubtful`: what was found may not be a heart.
enum class Trust : std::uint8_t { sound, uncertain, doubtful };

constexpr std::array<std::string_view, 3> trust_names = {"sound", "uncertain", "doubtful"};

// Measured on phantoms, spoiled scans and public scans by `heartgen-lab bench confidence`; docs/confidence.md has the
// table.
constexpr double min_confidence = 0.5;        ///< below: doubtful
constexpr double min_sound_confidence = 0.7;  ///< below: uncertain

// What is left of the confidence where something is missing.
constexpr double missing_keeps = 0.3;       ///< a pool or a valve
constexpr double missing_half_keeps = 0.2;  ///< the right heart

/// The confidence without what is held against pools and valves that were not found but are given by hand.
double confidence_beside(const FoundLandmarks& found, const Landmarks& given);

Trust trust_in(double confidence);

}  // namespace heartgen::landmarks
