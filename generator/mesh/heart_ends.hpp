// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Where the great vessels of a heart end: planes across them, as surfaces of their own.
#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "generator/mesh/domain.hpp"
#include "generator/mesh/mesh_vessel.hpp"
#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"
#include "model/volume.hpp"

namespace heartgen::mesh {

struct HeartEnd {
  Region vessel = Region::none;
  std::int32_t surface = 0;  ///< its tag
  VesselEnd plane;
  VesselEnd own;  ///< the same in the grid's own frame, mm from voxel (0, 0, 0): a turned image has the same bits
};

/// Ends of aorta and pulmonary artery away from their ventricles, but for those at the border of the image. One that is
/// alone is called aorta_end or pulmonary_artery_end, several are numbered from the patient's left to the right.
std::vector<HeartEnd> find_heart_ends(const LabelVolume& labels);

/// Gives what of the arteries lies beyond their ends, their ragged or rounded tips, to the torso, or to nothing where
/// there is none: a label map then ends where its meshes do. Returns how much that was, by artery.
std::map<Region, double> cut_at_ends(LabelVolume& labels);  // ml

/// Of the pieces of vessels beyond their ends that are meshed and then given to the torso or dropped.
constexpr int artery_stub_label = 20;

/// Materials of the domain with a straight stub of the same section, of artery_stub_label, beyond each end, and nothing
/// of the vessel beyond that. All arguments must outlive the result.
tetmesh::Materials with_ends(const MeshDomain& domain, tetmesh::Materials materials, const std::vector<HeartEnd>& ends,
                             double stub_mm);

/// Moves the nodes between a vessel and its stub onto the plane of the end. Cells that this makes worse than the rest
/// of the mesh are mended around them; a node whose cells cannot be mended stays where it is.
void flatten_ends(tetmesh::Complex& complex, const tetmesh::Materials& materials, const MeshDomain& domain,
                  const std::vector<HeartEnd>& ends);

/// The end of `vessel` whose plane's centre a point is nearest to; nullptr where it has none.
const HeartEnd* nearest_end(const std::vector<HeartEnd>& ends, Region vessel, const Vec3& lps_mm);

}  // namespace heartgen::mesh
