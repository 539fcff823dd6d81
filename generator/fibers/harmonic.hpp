// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Harmonic functions on the walls of chambers, the coordinates of rule-based fibres.
/// Not collective; the same bits for any number of threads.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "model/labels.hpp"
#include "model/mesh_queries/mesh_laplace.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::fibers {

/// The cells of some regions of a mesh, with their matrix.
struct Wall {
  const TetMesh* mesh;
  mesh_queries::Stiffness matrix;
  std::vector<std::int32_t> row;  ///< per node of the mesh: its row, or -1

  const Vec3& at(std::int32_t r) const {
    return mesh->nodes_mm[static_cast<std::size_t>(matrix.nodes[static_cast<std::size_t>(r)])];
  }
};

/// Rows of a wall, ascending.
using Rows = std::vector<std::int32_t>;

Wall make_wall(const TetMesh& mesh, const std::vector<Region>& regions);

/// Rows of the nodes of all faces with one of the named surfaces.
Rows rows_on(const Wall& wall, const std::vector<std::string_view>& surfaces);

/// Rows of a valve's rim and of the nodes where the wall ends within 6 mm of it (against an atrium or a great artery).
Rows rows_of_valve(const Wall& wall, const std::string& valve);

/// Rows among `among` of the share (0 to 1) that lies farthest along a direction.
Rows farthest_rows(const Wall& wall, const Rows& among, const Vec3& direction, double share);

Rows all_rows(const Wall& wall);
Rows joined(const Rows& a, const Rows& b);
Vec3 middle_of(const Wall& wall, const Rows& rows);

/// Rows that hold a value.
struct Held {
  double value;
  const Rows& rows;
};

/// What a harmonic function is and how it rises, per row.
struct Harmonic {
  std::vector<double> value;
  std::vector<Vec3> slope;  ///< per mm
};

/// One function per list; a row that several entries hold keeps the value of the first.
std::vector<Harmonic> harmonics(const Wall& wall, const std::vector<std::vector<Held>>& held);

}  // namespace heartgen::fibers
