// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Delaunay refinement of an implicit domain of several materials: CGAL's Mesh_3 hidden behind plain data. Sequential
/// and (but for comparisons) without its optimisers, whose end depends on time limits: the same input gives the same
/// bits. Rineau and Yvinec 2008; protecting balls: Cheng, Dey and Shewchuk 2012.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "model/labelled_cells.hpp"
#include "model/vec.hpp"

namespace heartgen::adapters {

/// A ball around a point of a curve that the mesh must follow. Balls of neighbouring points overlap; none holds the
/// centre of another.
struct CurveBall {
  Vec3 center_mm;
  double radius_mm = 0;
};

/// Where each material is, and how finely to mesh it. Surfaces are where `label_at` changes.
struct ImplicitDomain {
  std::function<int(const Vec3&)> label_at;    ///< 0 outside, else a positive label; must be 0 outside the box
  std::function<double(const Vec3&)> edge_mm;  ///< wanted edge length, positive and slowly varying
  Vec3 box_min_mm, box_max_mm;
  std::vector<Vec3> surface_points_mm;  ///< first vertices; every component of every surface needs some
  std::vector<CurveBall> curve_balls;   ///< protect curves: centres become vertices that are never moved
};

struct DelaunaySettings {
  double surface_distance = 0.125;  ///< greatest distance of a face's centre to its surface, as a share of the edge
  double facet_angle_deg = 25;      ///< least angle of a surface triangle; termination is certain up to 30
  double radius_edge_ratio = 2;     ///< greatest circumradius over shortest edge of a cell
  double precision_mm = 1e-3;       ///< of vertices on surfaces
  /// For comparisons only: above 0, CGAL's perturbation and exudation follow, each for so many seconds at most. The
  /// result then depends on the clock.
  double optimise_seconds = 0;
};

/// The Delaunay cells of all vertices.
LabelledCells mesh_implicit(const ImplicitDomain& domain, const DelaunaySettings& settings);

}  // namespace heartgen::adapters
