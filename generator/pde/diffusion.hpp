// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Denoising by diffusion: the heat equation (thesis 3.1) and Perona-Malik (3.2; Perona and Malik 1990).
/// Explicit steps in flux form on voxel faces, homogeneous Neumann conditions at the border of the image, any spacing.
/// The time step is in units of the smallest squared spacing and stable up to 1/6 (of the heat equation, with
/// conductivity 1); the mean grey value is kept. float32, the same bits for any number of ranks and threads.
#pragma once
#include "generator/parallel/slab.hpp"
#include "model/recipe.hpp"

namespace heartgen::pde {

struct HeatSettings {
  int iterations = 5;
  double time_step = 0.12;  ///< in units of the smallest squared spacing, at most 1/6
};

/// In place; the slab has one ghost slice at least, its ghosts are filled on return. Throws UserError for a time step
/// outside (0, 1/6] or a negative number of iterations. @collective
void heat(parallel::Slab<float>& image, const HeatSettings& settings, const parallel::Comm& comm);

/// Throws UserError for a time step outside (0, 1/6], negative iterations and an edge that is not positive.
void check_settings(const DenoiseSettings& settings);

/// Conductivity 1 / (1 + (d / edge_hu)^2) on the face between two voxels whose grey values differ by d: noise
/// diffuses, steps above edge_hu stay. d is a difference of neighbours, not a gradient, because the height of a step
/// and of noise do not depend on the spacing. In place, as above. @collective
void perona_malik(parallel::Slab<float>& image, const DenoiseSettings& settings, const parallel::Comm& comm);

/// The same for a whole image on the root; the result is empty elsewhere. @collective
Volume<float> heat(const Volume<float>& image_on_root, const HeatSettings& settings, const parallel::Comm& comm);
Volume<float> perona_malik(const Volume<float>& image_on_root, const DenoiseSettings& settings,
                           const parallel::Comm& comm);

}  // namespace heartgen::pde
