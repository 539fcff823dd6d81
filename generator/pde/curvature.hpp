// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Motion by mean curvature of all level sets of an image: u_t = |∇u| div(∇u / |∇u|), with the curvature in flux form
/// on the faces of the voxels (thesis 3.12). The explicit step of a voxel is cut back where it would leave the range of
/// its neighbours; Smereka's semi-explicit form (thesis 3.14) is as stable, but moves contours at half their speed at
/// usual time steps. |∇u| is the root of the mean square of the slopes on both sides of a voxel: with central slopes,
/// zero there, a peak one voxel wide would never sink. A ridge one voxel wide whose top is exactly level stays, as
/// straight level sets do. Homogeneous Neumann conditions, any spacing.
#pragma once
#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

struct CurvatureSettings {
  int iterations = 10;
  double time_step = 0.1;  ///< in units of the smallest squared spacing; accurate up to 1/8, stable for any
};

/// In place; the slab has one ghost slice at least. Throws UserError for a time step <= 0 or a negative number of
/// iterations. @collective
void curvature_motion(parallel::Slab<float>& image, const CurvatureSettings& settings, const parallel::Comm& comm);

/// The same with a pull back to the image `g`: u_t = |∇u| (div(∇u / |∇u|) + lambda (g - u)), lambda per mm and grey
/// value (thesis 3.15). `g` is the image at the start. @collective
void curvature_motion_with_fidelity(parallel::Slab<float>& image, const CurvatureSettings& settings, double lambda,
                                    const parallel::Comm& comm);

}  // namespace heartgen::pde
