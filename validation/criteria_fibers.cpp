// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "validation/criteria_tables.hpp"

namespace heartgen::validation {

std::vector<Criterion> fiber_criteria(const ValidationSettings& settings) {
  std::vector<Criterion> rows;
  const auto add = [&](const char* scope, const char* metric, Bounds bounds, std::string reason) {
    rows.push_back({"fibers", Where::anywhere, scope, metric, bounds, std::move(reason)});
  };
  constexpr const char* complete = "Every node and cell of muscle needs a fibre.";
  constexpr const char* random_axes = "Neighbours of random axes differ by 57 degrees; those of hearts by a few.";
  constexpr const char* helix =
      "Human and canine left ventricles turn from about +60 degrees inside to -60 outside (Streeter 1969, Lombaert "
      "2012); beyond these bounds a field is wrong, not unusual.";
  add("*", "missing_*", zero(), complete);
  add("*", "nodes_without_source", zero(), complete);
  add("*", "orthonormality_error_*", at_most(1e-6), "Solvers take the three axes as an orthonormal frame.");
  add("*", "inpainted_fraction", {{}, {}, 0.3, settings.maximum_inpainted_fraction},
      "Where the atlas does not reach, fibres are a guess; the recipe bounds the share.");
  add("*", "jacobian_min", at_least(settings.minimum_jacobian), "A warp that folds turns fibres inside out.");
  add("*", "affine_misfit_rms", {{}, {}, 4.0, 15.0}, "The warp starts from a fit that must be a heart on a heart.");
  add("*", "wall_overlap_dice", {0.3, 0.6, {}, {}}, "Warped atlas and patient must share their walls.");
  add("*", "second_method_difference_mean", {{}, {}, 5.0, 25.0},
      "Where two ways of carrying the atlas differ by more than 5 degrees on average, true errors were 11 to 24.");
  add("*", "neighbour_jump_p50", {{}, {}, 25.0, 40.0}, random_axes);
  add("*", "cell_jump_p50", {{}, {}, 25.0, 40.0}, random_axes);
  add("*", "rule_difference_mean", {{}, {}, 42.0, 50.0},
      "Measured hearts differ from rule-based fibres by 10 to 25 degrees (Lombaert 2012); random axes by 57.");
  add("lv_myocardium", "helix_endocardium_median", between(10, 25, 85, 95), helix);
  add("lv_myocardium", "helix_epicardium_median", between(-95, -85, -10, 0), helix);
  add("rv_myocardium", "helix_fall", {0.0, 10.0, {}, {}},
      "The right ventricle's helix falls from inside to outside too; a rising one is mirrored.");
  add("*", "helix_*", told(), "Published ranges of this depth are wide.");
  for (const char* metric : {"neighbour_*", "turn_per_wall_*", "septum_junction_*", "edge_p50"})
    add("*", metric, told(), "How fast fibres turn depends on the wall's thickness and on the edges.");
  add("*", "atlas_helix_*", told(), "It is the atlas's own.");
  add("*", "rule_difference_*", told(), "The mean is judged.");
  add("*", "second_method_*", told(), "The mean is judged.");
  add("*", "distance_to_main_mesh_max", told(), "Fibres are taken from the main mesh at this distance at most.");
  add("*", "axis_error_*", told(), "It is measured against fibres that the user gave.");
  return rows;
}

std::vector<Criterion> fit_criteria() {
  std::vector<Criterion> rows;
  const auto add = [&](const char* group, const char* scope, const char* metric, Bounds bounds, const char* reason) {
    rows.push_back({group, Where::anywhere, scope, metric, bounds, reason});
  };
  constexpr const char* on_edge =
      "A surface that lies this far from the strongest edge of the image at half of its places is not that surface.";
  add("fit", "lv_endocardium", "edge_distance_median", between(-3, -1, 1, 3), on_edge);
  add("fit", "rv_endocardium", "edge_distance_median", {-4.0, -2.0, 2.0, 4.0}, on_edge);
  add("fit", "*", "edge_distance_*", told(),
      "Where walls are thin the strongest edge within 5 mm may be that of their other side.");
  add("fit", "*", "edge_found", told(), "How much of a surface has an edge depends on the contrast.");
  add("fit", "*", "*", told(), "It is measured against labels that the user gave.");
  add("pose", "*", "heart_outside_body", {{}, {}, 0.001, 0.02}, "The heart must lie in the torso that it is put in.");
  add("pose", "*", "heart_in_bone", {{}, {}, 0.02, 0.1}, "The heart must not lie in another patient's ribs.");
  add("pose", "*", "*", told(), "How well two patients' marks agree depends on the patients.");
  return rows;
}

}  // namespace heartgen::validation
