// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the inner loops of the semi-explicit level set flow, one image row at a time.
///
/// The curvature term is a sum over the six faces of a voxel, c (u_neighbour - u), with the face coefficients of
/// thesis (3.11): c = mu / |∇u| on the face, the derivative across it taken over the face and those along it central,
/// at the face's lower voxel. A face's coefficient is kept until the voxel above it needs it: along x in a row buffer,
/// along y in one row, along z in one plane of a tile. Neighbours that do not exist count as equal and their faces as
/// closed.
#pragma once
#include <cstdint>

#include "generator/pde/row_kernels.hpp"

namespace heartgen::pde {

/// The constants of a sweep, in units of the smallest spacing (w: axis weights; 0 along an axis with one voxel).
struct FlowConstants {
  AxisWeights across;   ///< w², for squared differences over a face
  AxisWeights along;    ///< w² / 4, for squared differences over two voxels
  AxisWeights tension;  ///< mu w²
  float time_step;
  LinearForce force;  ///< of the image's grey value, positive where the voxel belongs above
  float bound =
      1e6f;  ///< voxels that the level set stays within: where the sides are decided it would grow without end
};

/// A row of the level set with its neighbours, and the masks of the same voxels (null: the domain has them all).
/// u.u and `in` have a voxel more at both ends, which repeats the end.
struct FlowRow {
  StencilRow u;
  const std::uint8_t *in = nullptr, *in_below_j = nullptr, *in_above_j = nullptr, *in_below_k = nullptr,
                     *in_above_k = nullptr;
};

/// Coefficients of the upper faces of a row; x has an element before the first one, which stays 0.
struct FaceRow {
  float *x, *y, *z;
  float* speed;  ///< time_step |∇u| at the voxels
};

/// Fills `faces`. `open_y`, `open_z` are 0 where the row has no upper neighbour, else 1.
void flow_faces(const FlowRow& row, const FlowConstants& constants, float open_y, float open_z, const FaceRow& faces);

/// out = (u + speed (Σ c u_neighbour + force)) / (1 + speed Σ c), kept within ± bound; voxels outside the domain keep
/// their values. `below_y`, `below_z` are the coefficients of the lower faces.
void flow_update(const FlowRow& row, const FlowConstants& constants, const float* image, const FaceRow& faces,
                 const float* below_y, const float* below_z);

}  // namespace heartgen::pde
