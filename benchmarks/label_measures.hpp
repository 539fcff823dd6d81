// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the benchmarks of label maps measure on their meshes.
#pragma once
#include <array>
#include <functional>

#include "benchmarks/measure.hpp"
#include "generator/mesh/domain.hpp"
#include "generator/mesh/lattice_cells.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::benchmarks {

/// What the mesher took, step by step, and the angles; `bounds` are the remarks on the least and the greatest.
void add_quality(Table& table, const char* bench, const TetMesh& mesh, const mesh::LatticeReport& report,
                 const std::array<const char*, 2>& bounds);

using LabelAt = std::function<int(const Vec3& lps_mm)>;

/// As the certificate measures them: of faces' centres and nodes to where the region changes. The sides of the image
/// end the mesh.
void add_found_distances(Table& table, const char* bench, const TetMesh& mesh, const LabelVolume& labels,
                         const LabelAt& label_at);

using Volumes = std::array<double, 256>;  ///< mm3, by region tag

/// Of the regions of `label_at` on a grid: of voxels beside others, so many small ones whose centres lie in a region.
Volumes volumes_of(const Grid& grid, const LabelAt& label_at);

/// Cells and volume of each region, next to its level set's.
void add_regions(Table& table, const char* bench, const TetMesh& mesh, const Volumes& level_set);

}  // namespace heartgen::benchmarks
