// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The edge detector of deformable contours (thesis 4.3.2, 4.6): h = 1 / (1 + (|∇(G_sigma * g)| / edge)²), 1 where the
/// image is flat and near 0 on edges. The Gaussian is the heat equation run for the time sigma² / 2, as in the thesis,
/// with homogeneous Neumann conditions. 2D (one slice) and 3D, any spacing, the same bits for any ranks and threads.
#pragma once
#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

struct EdgeSettings {
  double smoothing_mm = 1;  ///< sigma of the Gaussian; 0: none
  double edge_per_mm = 50;  ///< slope (grey values per mm) at which h is 1/2; c of thesis 4.6 is 1 / edge²
};

/// h on the image's slab, ghosts filled. Throws UserError for a negative smoothing or an edge that is not positive.
/// @collective
parallel::Slab<float> edge_function(const parallel::Slab<float>& image, const EdgeSettings& settings,
                                    const parallel::Comm& comm);

/// A slope that parts edges from the rest where nothing is known of the image: a tenth of the slope of a step from its
/// darkest to its brightest hundredth, blurred by the smoothing (by half a voxel at least). Root only.
double default_edge_per_mm(const Volume<float>& image, double smoothing_mm);

}  // namespace heartgen::pde
