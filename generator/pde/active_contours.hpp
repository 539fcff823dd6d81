// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Active contours as level sets (thesis 4.2, 4.3), 2D (one slice) and 3D, any spacing; φ is negative inside, in mm.
/// - Geometric (4.3.2; Caselles et al. 1993, Malladi et al. 1995), not variational:
///     φ_t = h |∇φ| (curvature κ - balloon):
///   grows (or shrinks) where there is no edge. It passes no gap narrower than twice the curvature's weight: a front
///   that bulges through a gap of width w in the plane has a curvature of 2 / w. Thesis 4.8 does not multiply the
///   curvature by h; then edges do not hold against it, and a closed contour rests only where ∮ h = 2 pi curvature.
/// - Geodesic (4.3.3; Caselles et al. 1997, Kichenassamy et al. 1996), the descent of the length in the metric h:
///     φ_t = |∇φ| div(h ∇φ / |∇φ|) - balloon h |∇φ|:
///   edges attract, gaps are closed by the shortest bridge.
/// φ is made a distance again at regular intervals. Results have the same bits for any number of ranks and threads.
#pragma once
#include <span>

#include "generator/parallel/slab.hpp"
#include "generator/pde/edge_function.hpp"
#include "model/volume.hpp"

namespace heartgen::pde {

enum class ContourModel { geometric, geodesic };

struct ContourSettings {
  ContourModel model = ContourModel::geodesic;
  double curvature_mm = 1;          ///< weight of the curvature (geometric: epsilon of 4.8), against a balloon of 1
  double attraction_mm = 1;         ///< weight of ∇h·∇φ (geodesic only); equal to curvature_mm in 4.11
  double balloon = 0;               ///< outward speed where there is no edge; negative: inwards
  int max_iterations = 5000;        ///< explicit steps; their length is chosen
  double tolerance = 0.01;          ///< settled when a smaller share of the voxels beside the contour changes sides in
                                    ///< the time in which a free circle of ten voxels' radius moves by a voxel, and a
                                    ///< free balloon by two
  bool curvature_on_edges = false;  ///< geometric: the curvature acts at full strength on edges, as in thesis 4.8
};

enum class ContourEnd { settled, out_of_iterations, vanished, filled_the_image };
const char* name_of(ContourEnd end);

struct ContourResult {
  parallel::Slab<float> level_set;  ///< distance in mm near the contour, negative inside; one ghost slice, filled
  ContourEnd end = ContourEnd::out_of_iterations;
  int iterations = 0;
  double time = 0;  ///< steps times their length
};

/// Moves the contour `start` (negative inside; distances need not be exact) in the metric `h` of edge_function. Both
/// slabs have a ghost slice. Throws UserError for negative weights, for no motion at all, and for a start without
/// inside or outside. @collective
ContourResult evolve_contour(const parallel::Slab<float>& start, const parallel::Slab<float>& h,
                             const ContourSettings& settings, const parallel::Comm& comm);

/// Signed distance to the union of balls (discs in one slice) around points in LPS mm.
LevelSet balls(const Grid& grid, std::span<const Vec3> centers_mm, double radius_mm);

/// The voxels inside: 1 where φ < 0.
Mask inside_of(const LevelSet& level_set);

struct ContourVolume {
  LevelSet level_set;  ///< on the root only
  ContourEnd end = ContourEnd::out_of_iterations;
  int iterations = 0;
  double time = 0;
};

/// The same for whole volumes on the root (on one grid), the edge function included. @collective
ContourVolume evolve_contour(const Volume<float>& image_on_root, const LevelSet& start_on_root,
                             const EdgeSettings& edges, const ContourSettings& settings, const parallel::Comm& comm);

}  // namespace heartgen::pde
