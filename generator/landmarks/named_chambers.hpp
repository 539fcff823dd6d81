// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the names of the pieces of blood, carried to the borders that a finer grid shows.
#pragma once
#include <string>
#include <vector>

#include "generator/naming/naming.hpp"
#include "model/labels.hpp"

namespace heartgen::landmarks {

/// `blood` divided among lv_blood, rv_blood, la_blood, ra_blood, aorta and pulmonary_artery: a flood from what `named`
/// has well inside of each, so that borders fall on the constrictions, which the valves are. Venae cavae and other
/// vessels get 0.
LabelVolume named_chambers(const Mask& blood, const naming::Naming& named);

/// Blood by its name on another grid, whatever its grey value.
Mask named_blood(const Grid& grid, const naming::Naming& named);

/// The middle of the chambers' centres, LPS mm.
Vec3 middle_of_chambers(const naming::Naming& named);

/// Where two searches differ, a sentence each.
struct Disputes {
  std::vector<std::string> names;    ///< most of a part has another name
  std::vector<std::string> extents;  ///< the same chamber, but much more or less of it
  bool any() const { return !names.empty() || !extents.empty(); }
};
Disputes disputes(const LabelVolume& chambers, const naming::Naming& named);

}  // namespace heartgen::landmarks
