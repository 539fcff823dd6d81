// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What to mesh of a vessel: its lumen, and beyond each open end a short straight stub of the same section, which is
/// meshed and then dropped: the cut is an interface, whatever the shape of the tip behind it.
#pragma once
#include <span>
#include <vector>

#include "generator/mesh/domain.hpp"
#include "generator/mesh/mesh_vessel.hpp"
#include "generator/tetmesh/complex.hpp"

namespace heartgen::mesh {

struct VesselDomain {
  MeshDomain lumen;  ///< one region: the vessel
  Region vessel = Region::none;
  std::vector<VesselEnd> ends;
  LevelSet distance_mm;     ///< to the lumen's surface, on the same grid; negative inside
  double edge_mm = 1;       ///< away from the wall
  double wall_edge_mm = 1;  ///< at the wall
  double stub_mm = 0;       ///< length of the stubs
};

constexpr int lumen_label = 1;
constexpr int stub_label = 2;  ///< of every stub; `stub_label + e` where stubs are told apart

bool in_lumen(const VesselDomain& domain, const Vec3& lps_mm);

/// Number of the end whose cut a point is nearest to.
std::size_t nearest_end(const VesselDomain& domain, const Vec3& lps_mm);

/// The end behind whose cut a point lies, in its stub or in what is cut off there; -1: none.
int end_beyond(const VesselDomain& domain, const Vec3& lps_mm);

/// 0, lumen_label, or stub_label + the number of the end.
int vessel_label_at(const VesselDomain& domain, const Vec3& lps_mm);

/// Wanted edge length: wall_edge_mm at the wall, growing to edge_mm inside (the boundary layer of thesis 8.3.3), and
/// without bound outside.
double vessel_edge_at(const VesselDomain& domain, const Vec3& lps_mm);

/// The box (LPS, mm) around lumen and stubs, along the axes of LPS.
struct VesselBox {
  Vec3 low_mm, high_mm;
};
VesselBox box_of(const VesselDomain& domain);

/// The domain as materials lumen_label and stub_label, in mm along the axes of the grid. It must outlive the result.
tetmesh::Materials materials_of(const VesselDomain& domain);

/// Gives every cell at a cut the label of its side, and moves the nodes of the cuts onto their planes and freezes them
/// there, where this flattens no cell; a repair has to follow. Returns how many stay off by more than a thousandth of
/// an edge.
std::int64_t flatten_cuts(tetmesh::Complex& complex, const VesselDomain& domain);

}  // namespace heartgen::mesh
