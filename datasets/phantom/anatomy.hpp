// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The analytic anatomy of the phantom: a thorax with a four-chamber heart, as signed distances composed by min and
/// max. Everything is evaluated at a point in LPS mm, so that grids and meshes of any resolution can be compared with
/// it. The functions are pure and safe to call from several threads.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "model/labels.hpp"
#include "model/landmarks.hpp"
#include "model/vec.hpp"

namespace heartgen::phantom {

struct Anatomy;  ///< the shapes themselves, see body.hpp

/// What a point consists of; decides the grey value, where Region decides the label.
enum class Tissue : std::uint8_t {
  air,
  lung,
  fat,
  muscle,
  myocardium,
  liver,
  cortical_bone,
  marrow,
  cartilage,
  left_blood,   ///< of the left ventricle
  right_blood,  ///< of the right ventricle
  upper_vein,   ///< superior vena cava and what flows into it
  vessel_wall,
  skin,
  spleen,
  fluid,
  la_blood,  ///< and the pulmonary veins
  arterial_blood,
  ra_blood,
  pulmonary_blood,  ///< of the pulmonary artery and its branches
  lower_vein,
  jet,       ///< of unmixed contrast, in the right atrium
  vertebra,  ///< spongy bone of the spine
};
constexpr int tissue_count = 23;

/// Shape overrides of the phantom; the defaults of a variant apply where a field is empty.
struct HeartOverrides {
  std::optional<double> lv_wall_mm;  ///< thickness of the compact left ventricular wall at the equator, 5 to 18
  std::optional<double> rv_wall_mm;  ///< thickness of the right ventricular free wall, 2.5 to 8
  std::optional<double> scale;       ///< size of the heart, 0.8 to 1.25
  /// Turns the variant's heart about its middle: by x about the patient's x axis, then y, then z; each -30 to 30
  /// degrees.
  std::optional<Vec3> rotation_deg;
};

/// Grey values, HU; those of the variant where a field is empty.
struct GreyValues {
  std::optional<double> lv, la, aorta;  ///< and the arteries; with lv alone, la and aorta follow it
  std::optional<double> rv, ra, pa;     ///< with rv alone, ra and pa follow it
  std::optional<double> svc, ivc;       ///< the caval veins
  std::optional<double> jet;            ///< a jet of contrast through the right atrium; empty: none
  std::optional<double> muscle;         ///< of the heart
  std::optional<double> vertebrae;      ///< their spongy bone
};

/// Of a scan without contrast agent.
GreyValues grey_without_contrast();

/// Reads "lv=350", "svc=900", ...: a part's name and HU. Throws UserError for what it does not know.
void set_grey(GreyValues& grey, const std::string& assignment);

struct HeartModel {
  int variant = 0;
  std::shared_ptr<const Anatomy> anatomy;  ///< immutable, shared by copies
};

/// The model of a variant (0 = the default; any integer >= 0). Throws UserError for negative variants, and for
/// overrides and grey values out of range.
HeartModel make_heart_model(int variant = 0, const HeartOverrides& overrides = {}, const GreyValues& grey = {});

Region region_at(const HeartModel& model, const Vec3& lps_mm);
Tissue tissue_at(const HeartModel& model, const Vec3& lps_mm);

/// Transmural depth in the wall of the nearest ventricle: 0 at the endocardium, 1 at the epicardium (for the septum:
/// at the right ventricular side). The surfaces are those of the wall without trabeculae, outflow tracts included.
/// Clamped to [0, 1]; NaN farther than 6 mm from ventricular muscle, and in the fibrous plates at the valves.
double depth_at(const HeartModel& model, const Vec3& lps_mm);

/// Helix angles of the phantom's walls, linear in depth.
enum class HelixField {
  uniform,   ///< from +60 deg (endocardium) to -60 deg (epicardium) everywhere
  regional,  ///< both ends change by up to 35 deg around the ventricle and from apex to base
};

/// Unit fibre direction (an axis: its sign carries no meaning) in ventricular muscle and papillary muscles; papillary
/// muscles along their own axis. Defined up to 6 mm off the muscle, so that nodes of a slightly displaced mesh can be
/// compared; the zero vector beyond, and in the fibrous plates at the valves, which labels count as muscle but which
/// have no helix.
Vec3 fiber_at(const HeartModel& model, const Vec3& lps_mm, HelixField field = HelixField::uniform);

/// What fiber_at takes the muscle at a point for: lv_myocardium, rv_myocardium, papillary, or none where it has no
/// fibre.
Region muscle_of_fiber_at(const HeartModel& model, const Vec3& lps_mm);

/// Unit vector of the left ventricle's long axis from apex to base.
Vec3 long_axis(const HeartModel& model);

/// How much brighter the right heart's blood is than the heart's muscle, HU; negative where it is darker.
double right_heart_contrast_hu(const HeartModel& model);

/// Seeds in every pool and organ, the four valve discs, the epicardial apex.
Landmarks landmarks_of(const HeartModel& model);

}  // namespace heartgen::phantom
