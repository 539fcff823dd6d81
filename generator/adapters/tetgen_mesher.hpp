// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Constrained Delaunay refinement between given surfaces: TetGen hidden behind plain data. The surfaces stay as they
/// are, triangle for triangle; only nodes inside the materials are added. Si, ACM Transactions on Mathematical
/// Software 41 (2015). TetGen is under the AGPL and runs in a program of its own, heartgen-tetgen, that
/// generator/tetgen_helper makes: what is asked of it and what it answers are the two structs below, in files.
#pragma once
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "model/labelled_cells.hpp"
#include "model/tet_mesh.hpp"
#include "model/vec.hpp"
#include "model/volume.hpp"

namespace heartgen::adapters {

/// A point strictly inside a piece of a material.
struct MaterialSeed {
  Vec3 point_mm;
  std::int32_t label = 0;  ///< positive
};

/// Triangles that meet in common edges and nodes only, and bound every piece of every material.
struct SurfaceComplex {
  std::vector<Vec3> nodes_mm;       ///< each is used by a face
  std::vector<Face> faces;          ///< each once, in any direction
  std::vector<MaterialSeed> seeds;  ///< one in each piece; pieces without one stay empty
};

struct FillSettings {
  double radius_edge_ratio = 1.4;  ///< greatest circumradius over shortest edge of a cell away from the surfaces
  double min_angle_deg = 16;       ///< dihedral angle that refinement asks for; it stops at the surfaces
  double volume_share = 0.2;       ///< greatest volume of a cell, as a share of the cube of the wanted edge
};

/// What heartgen-tetgen is asked.
struct FillTask {
  SurfaceComplex surfaces;
  Volume<float> edges_mm;  ///< wanted edge lengths, positive, on a grid in the frame of the surfaces
  FillSettings settings;
};

/// What it answers.
struct FillAnswer {
  std::string problem;  ///< why there are no cells; empty where all went well
  std::vector<Vec3> nodes_mm;
  std::vector<Cell> cells;  ///< in either sense
  std::vector<std::int32_t> label;
};

inline auto members(SurfaceComplex& s) { return std::tie(s.nodes_mm, s.faces, s.seeds); }
inline auto members(FillTask& t) { return std::tie(t.surfaces, t.edges_mm, t.settings); }
inline auto members(FillAnswer& a) { return std::tie(a.problem, a.nodes_mm, a.cells, a.label); }

/// heartgen-tetgen beside this program or library, or else on the PATH. Throws UserError where it is in neither place.
std::filesystem::path find_tetgen();

/// The cells of all pieces with a seed. The first nodes are those of `surfaces`, in their order. The same input gives
/// the same bits. Throws UserError where the surfaces cross or touch, TetGen gives up, or its program is missing or of
/// another version.
LabelledCells fill_surfaces(const FillTask& task, const std::filesystem::path& program = find_tetgen());

}  // namespace heartgen::adapters
