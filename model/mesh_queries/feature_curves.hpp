// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The curves that a mesh holds: edges at which labelled faces of two or more surfaces meet. There three regions meet
/// (the rim of a valve's orifice), or two parts of the outside (the rim of a vessel's end, the edge of a cut).
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/mesh_queries/mesh_edges.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::mesh_queries {

struct FeatureCurve {
  std::vector<std::int32_t> surfaces;  ///< tags of those that meet, ascending, two at least
  std::vector<NodePair> edges;         ///< ascending
};

/// Every edge of every curve once; the curves in the order of their surfaces.
std::vector<FeatureCurve> feature_curves(const TetMesh& mesh);

/// "lv_endocardium+la_endocardium+mitral_orifice".
std::string curve_name(const FeatureCurve& curve);

}  // namespace heartgen::mesh_queries
