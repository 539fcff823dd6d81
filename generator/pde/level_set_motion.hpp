// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The one equation behind geometric contours, geodesic contours and subjective surfaces (thesis 4.8, 4.11, 7.1):
///   φ_t = (curvature + edge_curvature h) κ |∇φ| + attraction ∇h·∇φ - balloon h |∇φ|,   κ = div(∇φ / |∇φ|),
/// with φ negative inside, so that a positive balloon grows. The curvature is taken on the faces of the voxels (3.12),
/// the advection upwind (7.2, 7.3), the balloon by Godunov's upwind gradient (8.6, 8.7). Steps are explicit; their
/// length keeps every new value within the range of its neighbours, so nothing oscillates. Homogeneous Neumann
/// conditions, or the border of the image held (Dirichlet). 2D (one slice) and 3D, any spacing, float32, the same bits
/// for any number of ranks and threads.
#pragma once
#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

struct MotionTerms {
  double curvature_mm = 0;       ///< everywhere; with a speed of 1 this is a length in mm
  double edge_curvature_mm = 0;  ///< times h
  double attraction_mm = 0;      ///< towards low h
  double balloon = 0;            ///< outward speed (mm per unit of time) where h = 1; negative: inwards
};

enum class Border { free, held };

/// A stable step (in units of time) for these terms and this h. @collective
double stable_step(const parallel::Slab<float>& h, const MotionTerms& terms, const parallel::Comm& comm);

/// Moves φ in place by `steps` steps; both slabs have a ghost slice, that of φ is filled on return. @collective
void move_level_sets(parallel::Slab<float>& phi, const parallel::Slab<float>& h, const MotionTerms& terms,
                     double time_step, int steps, Border border, const parallel::Comm& comm);

}  // namespace heartgen::pde
