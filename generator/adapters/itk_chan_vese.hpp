// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// ITK's dense level set filter for Chan and Vese's model: the peer of our sweeps in the benchmarks.
#pragma once
#include "model/volume.hpp"

namespace heartgen::adapters {

/// `iterations` steps from a ball in the middle of the image; the level set at the end.
Volume<float> itk_dense_chan_vese(const Volume<float>& image, int iterations);

}  // namespace heartgen::adapters
