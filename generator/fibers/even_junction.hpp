// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The ventricles' fibres where their walls meet. Between two walls' axes that stand nearly at right angles to one
/// another the mean of their dyads flips within an edge; relaxed as unit axes they turn over the whole width in which
/// the walls are blended. Not collective; the same bits for any number of threads.
#pragma once
#include <cstdint>
#include <vector>

#include "generator/fibers/inpaint.hpp"
#include "model/axis_tensor.hpp"

namespace heartgen::fibers {

/// Harmonic map to axes: the dyads of elements with blended[e] != 0 become those of the leading axis of their own and
/// their neighbours' mean, weighted by the inverse square of the distance, in `iterations` Jacobi sweeps. The others
/// hold; zero tensors do not count and stay.
void relax_axes(const NeighborGraph& graph, const std::vector<std::uint8_t>& blended, int iterations,
                std::vector<AxisTensor>& axes);

/// Relaxes the axes where two walls meet: from the last node that is one wall's own to the first of the other's they
/// turn over 5 mm, edges to those nodes counted, so that they turn no more steeply where edges are short.
/// `from_junction_mm`: per element, infinite where only one wall is.
void turn_evenly(const NeighborGraph& graph, const std::vector<double>& from_junction_mm,
                 std::vector<AxisTensor>& axes);

}  // namespace heartgen::fibers
