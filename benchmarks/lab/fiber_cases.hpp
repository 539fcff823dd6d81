// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Hearts of known fibres that `heartgen-lab fiber-accuracy` carries an atlas to: phantoms and their labels, exact, cut
/// or uneven. Not collective; the same bits for any number of threads.
#pragma once
#include <string>

#include "datasets/phantom/phantom.hpp"
#include "model/volume.hpp"

namespace heartgen::lab {

struct FiberCase {
  std::string name;
  phantom::HeartModel model;
  LabelVolume labels;
  Landmarks landmarks;  ///< none where the labels are cut
};

/// region_at on a cube of 190 mm around the heart.
LabelVolume exact_labels(const phantom::HeartModel& model, const Landmarks& marks, const Vec3& spacing_mm);

/// The same with surfaces moved by a smooth random field of 0.4 mm (root mean square, each direction) that forgets
/// itself over 5 mm, as a segmentation's are: one field for what touches blood, another one for all other surfaces, so
/// that walls are uneven on either side. The same `seed` gives the same field.
LabelVolume uneven_labels(const phantom::HeartModel& model, const Landmarks& marks, const Vec3& spacing_mm,
                          std::uint64_t seed);

/// `name`: a phantom's variant ("3"); "thick" and "dilated" (left wall 14 and 7 mm); "cut" (labels end 12 mm below the
/// mitral valve) and "tilted" (they end in a plane tilted by 15 degrees); "uneven", with or without a variant
/// ("uneven3"). Throws UserError for other names.
FiberCase make_fiber_case(const std::string& name, const Vec3& spacing_mm);

/// Throws UserError for a name that make_fiber_case does not take.
void check_fiber_case(const std::string& name);

}  // namespace heartgen::lab
