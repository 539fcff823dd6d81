// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Distances between the surfaces of a mesh's regions and those of a map of labels, both ways.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"
#include "validation/mesh_topology.hpp"

namespace heartgen::validation {

/// Region tag at a place (LPS mm), 0 outside everything: a label map between its voxels. Called from several threads.
using LabelAt = std::function<int(const Vec3& lps_mm)>;

/// How hard the nearest change of region is looked for, in local edges.
struct SurfaceSearch {
  double enough_edges = 0.05;  ///< a change this near along the normal is the nearest
  double step_edges = 0.025;   ///< steps in all other directions
};

struct SurfaceSample {
  std::array<std::int32_t, 2> region;  ///< on both sides; equal: the sample does not count
  double distance_mm = 0;
  double edge_mm = 1;  ///< mean edge of the nearest face
};

struct SurfaceDistances {
  std::vector<SurfaceSample> from_mesh;  ///< from faces and their nodes to where the region changes
  std::vector<SurfaceSample> to_mesh;    ///< from where it changes between voxels to the nearest face of that region
};

/// `from_mesh`: along the face's normal or, where that leads farther than `enough_edges`, along the one of many
/// directions in which it is nearest; what is farther than three edges counts as three. At most 60,000 samples each
/// way, evenly taken. Pieces of `labels` of less than `crumb_ml[label]` take no part, and strands and layers thinner
/// than an edge none in `to_mesh`. `labels` has the values of `label_at` at voxels; `faces` from mesh_faces.
SurfaceDistances surface_distances(const TetMesh& mesh, const std::vector<MeshFace>& faces, const LabelVolume& labels,
                                   const LabelAt& label_at, const std::array<double, 256>& crumb_ml,
                                   const SurfaceSearch& search = {});

/// Rows NAME_p50, _p99, _max (mm) and _p99_in_edges, _max_in_edges over the samples at one region (0: at any).
void add_distance_rows(const std::string& scope, const std::string& name, const std::vector<SurfaceSample>& samples,
                       std::int32_t region, Report& report);

}  // namespace heartgen::validation
