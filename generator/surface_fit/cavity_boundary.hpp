// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What lies around a place that is worked on apart from the rest: what is made of it must not pass through that.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "generator/tetmesh/box.hpp"
#include "generator/tetmesh/cavity.hpp"
#include "generator/tetmesh/complex.hpp"

namespace heartgen::surface_fit {

/// The outer faces of the whole around a place: what is made of it must not pass through them.
struct CavityBoundary {
  tetmesh::Box reach;  // where they are known
  std::vector<Vec3> nodes_mm;
  std::vector<Face> faces;  // node n of the part as -1 - n
};

/// Faces in the order of their lowest points, so that those around a place are found without looking at all.
struct FacesByHeight {
  std::vector<Face> faces;
  std::vector<double> low_z_mm;
  double tallest_mm = 0;

  std::span<const Face> between(double low_mm, double high_mm) const {
    const auto first = std::ranges::lower_bound(low_z_mm, low_mm - tallest_mm) - low_z_mm.begin();
    const auto last = std::ranges::upper_bound(low_z_mm, high_mm) - low_z_mm.begin();
    return std::span(faces).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first));
  }
};

FacesByHeight by_height(const tetmesh::Complex& complex, const std::vector<Face>& faces);

/// How far what is made of a place may reach: one width of the lattice beyond where its nodes are.
tetmesh::Box reach_of(const tetmesh::Cavity& place);

CavityBoundary faces_around(const tetmesh::Complex& whole, const FacesByHeight& outer, const tetmesh::Cavity& place);

/// Whether what was made of a place lies where all that it could pass through is known.
bool is_within_reach(const tetmesh::Complex& part, const CavityBoundary& around);

/// Pairs of outer faces, of a part and of what is around it, that pass through each other.
std::size_t count_meeting(const tetmesh::Complex& part, const CavityBoundary& around);

}  // namespace heartgen::surface_fit
