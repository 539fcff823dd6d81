// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The fibre certificate: what can be measured on a myocardium mesh with fibres alone (so that `validate` can repeat
/// it on any bundle), plus the figures of the registration where they are known.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/depth_samples.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"
#include "model/report.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::validation {

/// Figures that only the build knows; a re-validation takes them from the bundle's metrics, or leaves them out.
struct RegistrationFigures {
  std::optional<double> min_jacobian{};
  std::optional<double> affine_rms_mm{};
  std::optional<double> atlas_overlap{};    ///< Dice of the walls
  std::optional<double> second_mean_deg{};  ///< angles to the axes that the second best method carries
  std::optional<double> second_p95_deg{};
  std::optional<double> atlas_turn_p99_deg_per_mm{};  ///< of the atlas's own axes along the edges of its cells
  DepthSamples atlas_lv{}, atlas_rv{};                ///< helix angles of the atlas itself; empty where not known
  DepthSamples carried_lv{}, carried_rv{};            ///< measured in the same way where they were carried to
  DepthSamples there_lv{}, there_rv{};                ///< the atlas's own at the places that these were carried from
  /// 99th percentile of the angle between neighbouring axes over their distance in units of the wall's thickness, off
  /// the junction of the ventricles; and per mm at the atlas's junction.
  std::optional<double> atlas_turn_p99_deg_per_wall{}, carried_turn_p99_deg_per_wall{};
  std::optional<double> atlas_junction_turn_p99_deg_per_mm{};
  std::optional<double> atlas_jump_p99_deg{}, atlas_edge_p50_mm{};  ///< of the edges that its turns are of
};

/// Helix angle against wall depth: the angle between the fibre's projection on the wall's tangent plane and the
/// circumferential direction; positive where the fibre climbs to the base while turning counter-clockwise seen from
/// there (a right-handed helix, as at a normal endocardium).
struct HelixProfile {
  std::vector<double> depth;       ///< bin centres, 0 endocardium to 1 epicardium
  std::vector<double> median_deg;  ///< NaN where a bin is empty
  std::vector<double> p10_deg;
  std::vector<double> p90_deg;
};

/// `ventricle` is lv_myocardium or rv_myocardium. Depth is the solution of Laplace's equation on the mesh between the
/// endocardial faces and the other faces of the region. Empty when the mesh lacks the faces, the region or the fibres.
HelixProfile helix_profile(const TetMesh& myocardium, Region ventricle, int bins = 10);

/// The same of samples; empty where there are none.
HelixProfile helix_profile(const DepthSamples& samples, int bins = 10);

/// Rows of group "fibers". `myocardium` carries node_fibers, cell_fibers and fiber_source.
Report check_fibers(const TetMesh& myocardium, const RegistrationFigures& figures, const ValidationSettings& settings);

/// What a reader of these rows should know where neighbours differ by more than the atlas's: the mesh does not resolve
/// how fibres turn through its walls. Empty otherwise, and where nothing of the atlas is known.
std::string remark_on_jumps(const Report& rows);

}  // namespace heartgen::validation
