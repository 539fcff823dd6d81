// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Classical subjective surfaces (thesis 4.3.4, 7.1; Sarti, Malladi and Sethian 2000): the geodesic flow of all level
/// sets of φ at once,  φ_t = |∇φ| div(h ∇φ / |∇φ|),  φ = 0 on the border of the image, from φ0 = 1 / (1 + D), D the
/// distance (mm) to points inside the object. Edges become cliffs, which bridge the gaps between them; everything
/// else becomes flat. The object is what lies above half the height of the plateau at the points. φ is high inside.
/// 2D (one slice) and 3D, any spacing, the same bits for any number of ranks and threads.
#pragma once
#include <span>
#include <vector>

#include "generator/parallel/slab.hpp"
#include "generator/pde/edge_function.hpp"
#include "model/volume.hpp"

namespace heartgen::pde {

struct SubjectiveSettings {
  int max_iterations = 20000;  ///< explicit steps; their length is chosen
  double tolerance = 5e-3;     ///< steady when φ changes less, summed over the image and relative to the object's own
                               ///< sum, while a free circle of ten voxels' radius would vanish
};

struct SubjectiveResult {
  parallel::Slab<float> surface;  ///< φ, high inside; one ghost slice, filled
  double plateau = 0;             ///< φ at the points (the lowest of them)
  double time = 0;
  int iterations = 0;
  bool steady = false;
};

/// φ0 = 1 / (1 + D), zero on the border of the image. Throws UserError without points or for one outside the image.
Volume<float> point_of_view(const Grid& grid, std::span<const Vec3> points_mm);

/// Runs from any start (`point_of_view`, or 1 / (1 + D) for another set); its border values are held. @collective
SubjectiveResult subjective_surface(const parallel::Slab<float>& start, const parallel::Slab<float>& h,
                                    std::span<const Vec3> points_mm, const SubjectiveSettings& settings,
                                    const parallel::Comm& comm);

struct SubjectiveVolume {
  Volume<float> surface;  ///< on the root only
  double plateau = 0, time = 0;
  int iterations = 0;
  bool steady = false;
};

/// The same for a whole image on the root, the edge function included. @collective
SubjectiveVolume subjective_surface(const Volume<float>& image_on_root, std::span<const Vec3> points_mm,
                                    const EdgeSettings& edges, const SubjectiveSettings& settings,
                                    const parallel::Comm& comm);

/// The object: the voxels above `share` of the plateau that are connected to the points. On the root.
Mask object_of(const SubjectiveVolume& result, std::span<const Vec3> points_mm, double share = 0.5);

}  // namespace heartgen::pde
