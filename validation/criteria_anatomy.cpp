// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/criteria_tables.hpp"

namespace heartgen::validation {
namespace {

// Published adults, any phase of the beat. Beyond `warn_*` a heart is unusual; beyond `fail_*` none of that size lives.
constexpr const char* volumes =
    "Healthy adults from women at end systole to men at end diastole, two standard deviations wide (Petersen 2017, UK "
    "Biobank: left ventricle 49 +- 11 to 166 +- 32 ml, right 55 +- 15 to 182 +- 36 ml). Beyond 2.5 deviations "
    "below, none is expected; failing hearts grow threefold.";
constexpr const char* atria =
    "Healthy adults have atria of at most 62 +- 17 to 93 +- 27 ml (Petersen 2017, UK Biobank) and empty them by half; "
    "in atrial fibrillation they grow fivefold.";
constexpr const char* walls =
    "Healthy left ventricles weigh 70 +- 13 to 103 +- 21 g without their trabeculae (Petersen 2017, UK Biobank), right "
    "ones about a third; hypertrophic hearts grow threefold.";
constexpr const char* lv_thickness =
    "Left ventricular walls thicker than 15 mm are hypertrophic (Elliott 2014, ESC guideline), and 30 mm is massive; "
    "infarcts thin them to 5.5 mm and less (Shah 2013).";
constexpr const char* rv_thickness = "Right ventricular walls thicker than 5 mm are hypertrophic (Rudski 2010).";
constexpr const char* aortic = "Aortic annuli are 2.3 +- 0.2 to 2.6 +- 0.3 cm wide (Lang 2015): 4 to 5 cm2.";
constexpr const char* mitral =
    "Mitral annuli open to 3.8 +- 0.7 cm2 per m2 of body surface in echocardiography (Ormiston 1981), to 4.7 +- 0.6 in "
    "CT (Naoum 2016): 7 to 9 cm2.";
constexpr const char* tricuspid = "Tricuspid annuli open to 11.3 +- 1.8 cm2 (Tei 1982), dilated ones to twice that.";
constexpr const char* pulmonary =
    "Pulmonary valves open to 4.3 +- 1.0 cm2 in women and 4.9 +- 1.3 in men, post mortem (Westaby 1984).";

}  // namespace

std::vector<Criterion> anatomy_criteria() {
  std::vector<Criterion> rows;
  const auto add = [&](const char* group, const char* scope, const char* metric, Bounds bounds, const char* reason) {
    rows.push_back({group, Where::anywhere, scope, metric, bounds, reason});
  };
  add("labels", "lv_blood", "volume", between(21, 27, 230, 600), volumes);
  add("labels", "rv_blood", "volume", between(17, 25, 255, 600), volumes);
  add("labels", "la_blood", "volume", between(10, 20, 150, 500), atria);
  add("labels", "ra_blood", "volume", between(10, 20, 180, 600), atria);
  add("labels", "lv_myocardium", "volume", between(30, 42, 250, 500), walls);
  add("labels", "rv_myocardium", "volume", between(8, 15, 120, 250), walls);
  add("labels", "*", "volume", told(), "It depends on how much of the structure the image shows.");
  add("labels", "lv_myocardium", "wall_thickness_median", between(2, 4, 18, 35), lv_thickness);
  add("labels", "rv_myocardium", "wall_thickness_median", between(0.7, 1.5, 7, 15), rv_thickness);
  add("labels", "*", "wall_thickness_*", told(), "The median is judged; single places of a label map are steps.");
  for (const char* region : {"lv_blood", "rv_blood", "la_blood", "ra_blood", "lv_myocardium"})
    add("labels", region, "largest_component", {0.9, 0.98, {}, {}}, "A chamber and its wall are one piece.");
  add("labels", "*", "components", told(), "The share of the largest is judged where a structure is one piece.");
  add("labels", "*", "largest_component", told(), "This structure may be in several pieces.");
  add("anatomy", "aortic_orifice", "area", between(1, 2, 9, 20), aortic);
  add("anatomy", "mitral_orifice", "area", between(1.5, 4, 18, 35), mitral);
  add("anatomy", "tricuspid_orifice", "area", between(1.5, 4, 25, 45), tricuspid);
  add("anatomy", "pulmonary_orifice", "area", between(1, 2, 14, 25), pulmonary);
  add("anatomy", "*", "missing", warn_above(0), "A ventricle without an outlet is a closed bag.");
  for (const char* defect : {"open_edges", "non_manifold_edges", "non_manifold_vertices", "turned_edges"})
    add("cavities", "*", defect, zero(), "The volume inside of a surface needs one that is closed and has two sides.");
  add("cavities", "*", "cap_nodes_off_rims", zero(),
      "A cap moves with the wall: other nodes than the rim's have nothing that moves them.");
  add("cavities", "*", "volume", at_least(0), "Normals look out of the blood.");
  add("cavities", "*", "volume_difference", between(-2, -0.5, 0.5, 2),
      "Caps span orifices that are nearly flat: more than 0.5 % of a chamber is more than edges of 1.5 mm make of it.");
  add("cavities", "*", "caps", told(), "A chamber has as many openings as the image shows.");
  for (const char* metric : {"conducting_faces", "conducting_nodes"})
    add("insulation", "*", metric, zero(),
        "The fibrous skeleton parts atria and ventricles: a wave passes the bundle of His alone.");
  add("insulation", "*", "*", told(), "The recipe says whether atria and ventricles are parted.");
  add("regions", "*", "tagged_difference", {-10.0, -2.0, 2.0, 10.0},
      "Cells that count for a region keep its volume, unless it is smaller than a few of them.");
  add("regions", "*", "outside_walls", warn_above(0.5), "Most of the region lies outside the heart's walls.");
  add("regions", "*", "*", told(), "The region is as large as the user has drawn it.");
  return rows;
}

}  // namespace heartgen::validation
