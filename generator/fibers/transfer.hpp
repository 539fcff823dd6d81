// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fibres from one mesh of a heart to another mesh of the same heart, in the same frame: finer, coarser, or anybody's.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::fibers {

struct TransferredFibers {
  FiberField node, cell;
  std::vector<std::uint8_t> source;  ///< FiberSource per node; empty where the given mesh has none
  double farthest_mm = 0;            ///< of a node from the given mesh; 0: all lie inside it
  std::int64_t beyond_nodes = 0;     ///< farther away than the reach: without axes (zero), of source none
};

/// Axes at the nodes and at the middles of the cells of another mesh. Those of the four corners of the cell of `from`
/// that holds the place, or of the cell behind the nearest place of its boundary, are added as dyads with barycentric
/// weights, so that their signs do not matter; frames are orthonormal again (frame.hpp), sheet_normal = fiber × sheet.
/// A cell whose middle is that of a cell of `from` with axes of its own takes these, so that a mesh that holds part of
/// `from` keeps its axes. The source is that of the corner with the largest weight. Of an axis that varies smoothly the
/// error falls with the square of the edge length of `from`. Places farther than reach_mm (> 0) from `from` get no
/// axes. Throws UserError when `from` lacks cells, fibres or sheets on nodes. Threads; the same bits for any number of
/// them. Not collective.
TransferredFibers transfer_fibers(const TetMesh& from, const std::vector<Vec3>& nodes_mm,
                                  const std::vector<Cell>& cells, double reach_mm);

/// The power of ten by which a mesh in another unit is to be scaled: where it is another power of ten in size, and
/// scaled so nearly all of its points lie within reach_mm (5 at most) of `from`. A small piece in mm does not: what it
/// is scaled to lies all over the heart's cavities and beyond. Empty: it may well be in mm.
std::optional<double> scale_onto(const TetMesh& from, const std::vector<Vec3>& points, double reach_mm);

}  // namespace heartgen::fibers
