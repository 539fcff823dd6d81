// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The room's blood in some hundred pieces, each small enough to belong to one part of the heart.
#pragma once
#include <vector>

#include "generator/image/basins.hpp"
#include "generator/naming/walls.hpp"

namespace heartgen::naming {

struct Pieces {
  Volume<std::int32_t> label;  ///< 0 outside, 1..N
  std::vector<double> level;   ///< per label: the threshold it comes from, share of the contrast; [0] unused
};

/// Basins of the depth below the blood's surface and below the walls, threshold by threshold, brighter ones first.
Pieces cut_into_pieces(const Scene& scene, const Levels& levels, const Walls& walls);

/// Without small pieces at the rim of the room.
void drop_rim(const Scene& scene, Pieces& pieces);

/// Joins basins of one grey value with hardly a neck between them; crumbs join their widest neighbour or go. Numbers
/// the rest anew.
void join_basins(image::Basins& basins, const Volume<float>& hu, double tolerance_hu);

/// What an opening of a large piece leaves over becomes a piece: a trunk that leaves a chamber without a neck is no
/// basin of its own.
void cut_off_trunks(image::Basins& basins);

}  // namespace heartgen::naming
