// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fibre atlases in the exchange format of CMISS and OpenCMISS-Zinc: NAME.exnode with the values at nodes, NAME.exelem
/// with the elements, each plain or gzipped. Read are hexahedra with linear Lagrange and cubic Hermite bases along each
/// axis, coordinates that are prolate spheroidal or Cartesian, and an anatomical field of fibre angles.
#pragma once
#include <string>

#include "generator/atlas/atlas.hpp"

namespace heartgen::atlas {

/// Whether a path ends in .exnode or .exelem, perhaps with .gz behind.
bool is_exnode_path(const std::string& path);

/// `path` names either file; the other one lies beside it. Elements become tetrahedra of about 2 mm: cells of about a
/// tenth of an element. The fibre direction is xi1's, turned by the fibre angle towards xi2 in the plane of both, then
/// by the imbrication angle out of it (Nielsen, Le Grice, Smaill and Hunter, Am. J. Physiol. 260, 1991).
/// Throws UserError: files missing, cut short, or of another kind, naming file and line.
FiberAtlas read_exnode_atlas(const std::string& path);

}  // namespace heartgen::atlas
