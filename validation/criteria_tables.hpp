// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the criteria by what they speak of.
#pragma once
#include <vector>

#include "validation/criteria.hpp"

namespace heartgen::validation {

std::vector<Criterion> mesh_criteria(const ValidationSettings& settings);   ///< geometry, topology, labelled faces
std::vector<Criterion> label_criteria(const ValidationSettings& settings);  ///< a mesh against its label map
std::vector<Criterion> anatomy_criteria();                                  ///< sizes of an adult's heart
std::vector<Criterion> fiber_criteria(const ValidationSettings& settings);
std::vector<Criterion> fit_criteria();  ///< image, reference labels, pose in another torso

// How the tables spell bounds.
inline Bounds told() { return {}; }
inline Bounds zero() { return {{}, {}, {}, 0.0}; }
inline Bounds at_least(double fail) { return {fail, {}, {}, {}}; }
inline Bounds at_most(double fail) { return {{}, {}, {}, fail}; }
inline Bounds warn_above(double warn) { return {{}, {}, warn, {}}; }
inline Bounds warn_below(double warn) { return {{}, warn, {}, {}}; }
inline Bounds between(double fail_below, double warn_below, double warn_above, double fail_above) {
  return {fail_below, warn_below, warn_above, fail_above};
}

}  // namespace heartgen::validation
