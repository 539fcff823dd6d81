// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Carrying fibres as vectors (thesis 9.2, equation 9.4): the atlas's axis at the registered position, multiplied by
/// the Jacobian of the map from atlas to patient.
#pragma once
#include <vector>

#include "generator/atlas/register.hpp"
#include "model/axis_tensor.hpp"

namespace heartgen::fibers {

/// One dyad per point; the zero tensor where the warped atlas has no wall: these are to be inpainted.
std::vector<AxisTensor> push_forward(const ventricles::AtlasImage& image, const atlas::Registration& registration,
                                     const std::vector<Vec3>& patient_mm);

}  // namespace heartgen::fibers
