// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How thick the compact wall is, as a field that changes slowly along the wall. Voxels' steps move a thin wall's
/// endocardium by a tenth of its thickness, and trabeculae hide it; both average out along the wall, where a depth
/// measured at each place from its own piece of endocardium keeps them.
/// Not collective; the same bits for any number of threads.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::ventricles {

/// Distance in mm from a point to the zero set of `surface`, negative inside: walks along the gradient, so only the
/// place of the zero set matters, not how far the values are from distances.
double distance_along_gradient(const LevelSet& surface, const Vec3& point_mm);

struct ThicknessSample {
  Vec3 point_mm;  ///< on the endocardium
  double thickness_mm = 0;
};

/// The distance to `outer` (negative inside) at the endocardium, the zero set of `cavity`, where it crosses an edge
/// between two voxels of `where`; means over cells of 1.2 mm, in the order of the cells.
std::vector<ThicknessSample> endocardial_thickness(const LevelSet& cavity, const LevelSet& outer, const Mask& where);

/// The wall between trabeculae, its thickness fitted from samples.
class CompactWall {
 public:
  /// At every third sample a linear fit over those within 8 mm. What is thicker than the fit by more than `ridge_mm` is
  /// a ridge and hardly counts, so that the fit follows the floor between the ridges; where samples are more uneven
  /// than that, ridges begin 1.5 of their standard deviations above it, measured on what lies below. Infinite: no
  /// ridges.
  CompactWall(const std::vector<ThicknessSample>& samples, double ridge_mm);
  ~CompactWall();
  CompactWall(const CompactWall&) = delete;
  CompactWall& operator=(const CompactWall&) = delete;

  struct Thickness {
    double mm = 0;
    Vec3 gradient;  ///< along the wall, mm per mm
  };
  /// Mean of the nearest fits; empty where there is none at all. May be called from several threads.
  std::optional<Thickness> at(const Vec3& point_mm) const;

 private:
  struct Index;
  std::unique_ptr<const Index> index_;
};

}  // namespace heartgen::ventricles
