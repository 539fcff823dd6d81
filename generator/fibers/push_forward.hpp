// Carrying fibres as vectors (thesis 9.2, equation 9.4): the atlas's axis at the registered position, multiplied by
// the Jacobian of the map from atlas to patient.
#pragma once
#include <vector>

#include "generator/atlas/axis_tensor.hpp"
#include "generator/atlas/register.hpp"

namespace heart::fibers {

/// One dyad per point; the zero tensor where the warped atlas has no wall: these are to be inpainted.
std::vector<atlas::AxisTensor> push_forward(const atlas::AtlasImage& image, const atlas::Registration& registration,
                                            const std::vector<Vec3>& patient_mm);

}  // namespace heart::fibers
