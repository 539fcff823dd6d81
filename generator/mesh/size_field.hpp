// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The wanted edge length everywhere: fine in the walls of the heart, growing with the distance from them.
#pragma once
#include <span>

#include "generator/mesh/domain.hpp"
#include "generator/mesh/label_repair.hpp"
#include "model/recipe.hpp"

namespace heartgen::mesh {

/// Edge lengths (mm) on a coarse grid over the label map (a sample every 1 to 1.5 heart_edge_mm): at each sample the
/// region's own edge, lowered so that it grows by at most settings.growth per mm away from finer places. Sample it
/// trilinearly at LPS positions with `edge_at`.
/// Where one of the `resolved` regions is thinner than its edge, the edge is halved until it fits, down to a quarter of
/// the torso's and to heart_edge_mm; around such places the mesher grades as it must. A mesher that refines by the
/// distance to surfaces does all that itself.
/// Where a wall of the heart is so thin that fewer than settings.wall_layers edges of heart_edge_mm would cross it, its
/// edges are heart_edge_mm / 2; never less: a wall that tapers out would ask for any number of cells.
/// Where `own_edges_mm` (one per voxel of the domain, or none) is positive it stands for the region's edge.
/// Throws UserError where wall_layers or own edges take more cells than a mesh may have.
Volume<float> size_field(const MeshDomain& domain, const MeshSettings& settings, const LabelSet& resolved = {},
                         std::span<const float> own_edges_mm = {});

/// All regions but what only fills the space between others.
LabelSet regions_with_shape();

/// The finest edges that thin parts of the body may get.
double finest_body_edge_mm(const MeshSettings& settings);

constexpr int max_wall_layers = 4;

double edge_at(const Volume<float>& sizes, const Vec3& lps_mm);

}  // namespace heartgen::mesh
