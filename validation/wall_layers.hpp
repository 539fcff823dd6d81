// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How many layers of cells lie between the two sides of a wall of the heart.
#pragma once
#include <cstdint>
#include <map>

#include "model/tet_mesh.hpp"

namespace heartgen::validation {

/// Layers at the places of one wall's endocardium, by area.
struct WallLayers {
  double area_mm2 = 0;
  double p5 = 0, median = 0;  ///< layers
  double below_two = 0;       ///< share of the area where a single layer of cells joins the sides
};

/// For each wall of the mesh (region tag) from the labelled faces: the layers at a node of its endocardium are the
/// least number of edges, through cells of walls, to a node on the other side: the epicardium, or the blood of the
/// other side of the heart. Papillary muscles do not count; nor do nodes on both sides, and places from which no other
/// side is reached. Atrium and ventricle of one side are one side: the wall's end at a valve is not a thin wall.
std::map<std::int32_t, WallLayers> wall_layers(const TetMesh& mesh);

}  // namespace heartgen::validation
