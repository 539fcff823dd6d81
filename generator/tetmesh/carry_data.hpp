// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Values on nodes and cells of a mesh, carried to the mesh that it became.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "generator/tetmesh/improve_mesh.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::tetmesh {

/// Where a node lies in the given mesh: corners of a cell there with weights that add up to 1, the largest first.
/// A node that did not move has one weight of 1.
struct NodeSource {
  std::array<std::int32_t, 4> nodes{0, 0, 0, 0};
  std::array<double, 4> weights{1, 0, 0, 0};
};

/// For every node of the improved mesh. Places outside the given mesh take the nearest place inside.
std::vector<NodeSource> node_sources(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                                     const ImprovedMesh& improved);

/// For every cell of the improved mesh the given cell of the same region that holds its middle, or nearly.
std::vector<std::int32_t> cell_sources(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                                       const std::vector<std::int32_t>& region, const ImprovedMesh& improved);

/// Numbers that tell nodes or cells apart (all whole, all different) say nothing about others, and cannot be carried.
bool are_ids(const std::vector<double>& values);
/// Whole numbers that stand for something: a place gets that of its nearest corner, not a mixture.
bool are_codes(const std::vector<double>& values);

std::vector<double> carried(const std::vector<double>& values, const std::vector<NodeSource>& sources);
std::vector<Vec3> carried(const std::vector<Vec3>& values, const std::vector<NodeSource>& sources);
std::vector<Mat3> carried(const std::vector<Mat3>& values, const std::vector<NodeSource>& sources);
/// Axes, whose sign means nothing: turned to the side of the nearest corner's and mixed; as long as those of the
/// corners that have one are on average.
std::vector<Vec3> carried_axes(const std::vector<Vec3>& values, const std::vector<NodeSource>& sources);

/// Makes `second` and `third` orthogonal to `first` and to each other where they have a length; keeps their sides and
/// lengths.
void straighten(const std::vector<Vec3>& first, std::vector<Vec3>& second, std::vector<Vec3>& third);

}  // namespace heartgen::tetmesh
