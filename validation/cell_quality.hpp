// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Shape measures of tetrahedra and of the faces between them.
#pragma once
#include <array>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::validation {

struct CellQuality {
  double volume_mm3 = 0;                 ///< signed
  std::array<double, 6> dihedral_deg{};  ///< on the edges 01 02 03 12 13 23; 0 and 180 for flat cells
  double min_dihedral_deg = 0;
  double max_dihedral_deg = 0;
  double radius_ratio = 0;     ///< 3 × inradius / circumradius: 1 for a regular cell, 0 for a flat one
  double scaled_jacobian = 0;  ///< least over the corners of sqrt(2) det / (product of edges); negative if inverted
  double shortest_mm = 0;
  double longest_mm = 0;
  double edge_sum_mm = 0;
};

CellQuality cell_quality(const std::array<Vec3, 4>& corners_mm);
std::vector<CellQuality> cell_qualities(const TetMesh& mesh);

/// Finite volumes, by the definitions of OpenFOAM's checkMesh: the line between the centres of the two cells against
/// their common face.
struct FaceQuality {
  double non_orthogonality_deg = 0;  ///< angle between that line and the face's normal
  double skewness = 0;  ///< from where it meets the face's plane to the face's centre, over the face's reach that way
};

FaceQuality face_quality(const std::array<Vec3, 3>& face_mm, const Vec3& center_mm, const Vec3& other_center_mm);

/// The same of a face without a second cell: the line runs along the normal.
double boundary_skewness(const std::array<Vec3, 3>& face_mm, const Vec3& center_mm);

}  // namespace heartgen::validation
