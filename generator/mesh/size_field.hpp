// The wanted edge length everywhere: fine in the walls of the heart, growing with the distance from them.
#pragma once
#include "generator/mesh/domain.hpp"
#include "model/recipe.hpp"

namespace heart::mesh {

/// Edge lengths (mm) on a coarse grid over the label map (about one sample per heart_edge_mm): at each sample the
/// region's own edge, lowered so that it grows by at most settings.growth per mm away from finer places. Sample it
/// trilinearly at LPS positions with `edge_at`.
Volume<float> size_field(const MeshDomain& domain, const MeshSettings& settings);

double edge_at(const Volume<float>& sizes, const Vec3& lps_mm);

}  // namespace heart::mesh
