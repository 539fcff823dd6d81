// SPDX-License-Identifier: GPL-3.0-or-later
#include "datasets/phantom/anatomy.hpp"

#include <fmt/format.h>

#include "datasets/phantom/body.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::phantom {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;

Mat3 rotation_about(int axis, double angle_deg) {
  const double c = math::cos(angle_deg * degree), s = math::sin(angle_deg * degree);
  Mat3 m;
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  m[a][a] = m[b][b] = c;
  m[a][b] = -s;
  m[b][a] = s;
  return m;
}

/// Everything that differs between patients; the defaults are variant 0.
struct Patient {
  HeartPose pose{Mat3{}, 1, {38, 0, 0}, {38, 0, 0}};
  HeartSizes sizes;
  Vec3 stretch{1, 1, 1};
  double left_hu = 420, right_hu = 300, fat_mm = 11;
};

Patient draw_patient(int variant) {
  Patient patient;
  if (variant == 0) return patient;
  const auto key = static_cast<std::uint64_t>(variant);
  std::uint64_t counter = 0;
  const auto draw = [&](double middle, double spread) { return middle + spread * random_symmetric(key, counter++); };
  auto& pose = patient.pose;
  for (int axis = 0; axis < 3; ++axis)
    pose.rotation = pose.rotation * rotation_about(axis, draw(0, axis == 2 ? 10 : 7));
  pose.scale = draw(1, 0.06);
  const double body = pose.scale * draw(1, 0.025);
  patient.stretch = {body * draw(1, 0.025), body * draw(1.01, 0.02), draw(1, 0.05)};
  const Vec3& s = patient.stretch;
  pose.to = Vec3{s.x * pose.from.x, s.y * pose.from.y, s.z * pose.from.z} + Vec3{draw(0, 4), draw(2, 2), draw(3, 4)};
  patient.sizes.lv_radius_mm = draw(24, 1.5);
  patient.sizes.lv_length_mm = draw(58, 2.5);
  patient.sizes.lv_wall_mm = draw(9.9, 0.9);
  patient.sizes.rv_wall_mm = draw(3.6, 0.4);
  patient.sizes.rv_width = draw(1, 0.08);
  patient.sizes.lv_ridge_mm = draw(1.5, 0.4);
  patient.left_hu = draw(400, 70);
  patient.right_hu = std::min(draw(230, 170), patient.left_hu - 20);
  patient.fat_mm = draw(12, 4);
  return patient;
}

void check_override(const std::optional<double>& value, const char* name, double least, double most) {
  if (value && !(*value >= least && *value <= most))
    throw UserError(fmt::format("{:g} is out of range", *value), name, fmt::format("give {:g} to {:g}", least, most));
}

void check_overrides(const HeartOverrides& overrides) {
  check_override(overrides.lv_wall_mm, "the phantom's left ventricular wall, mm", 5, 18);
  check_override(overrides.rv_wall_mm, "the phantom's right ventricular wall, mm", 2.5, 8);
  check_override(overrides.scale, "the size of the phantom's heart", 0.8, 1.25);
  for (int axis = 0; axis < 3 && overrides.rotation_deg; ++axis)
    check_override((*overrides.rotation_deg)[axis], "a rotation of the phantom's heart, degrees", -30, 30);
}

void apply_overrides(Patient& patient, const HeartOverrides& overrides) {
  check_overrides(overrides);
  if (overrides.scale) patient.pose.scale = *overrides.scale;
  for (int axis = 0; axis < 3 && overrides.rotation_deg; ++axis)
    patient.pose.rotation = rotation_about(axis, (*overrides.rotation_deg)[axis]) * patient.pose.rotation;
  auto& s = patient.sizes;
  s.lv_radius_mm *= patient.pose.scale;
  s.lv_length_mm *= patient.pose.scale;
  if (overrides.lv_wall_mm) s.lv_wall_mm = *overrides.lv_wall_mm;
  if (overrides.rv_wall_mm) s.rv_wall_mm = *overrides.rv_wall_mm;
}

std::array<float, tissue_count> grey_values(const Patient& patient) {
  std::array<float, tissue_count> hu{};
  const auto set = [&](Tissue tissue, double value) {
    hu[static_cast<std::size_t>(tissue)] = static_cast<float>(value);
  };
  set(Tissue::air, -1000);
  set(Tissue::lung, -850);
  set(Tissue::fat, -95);
  set(Tissue::muscle, 55);
  set(Tissue::myocardium, 110);
  set(Tissue::liver, 92);
  set(Tissue::cortical_bone, 700);
  set(Tissue::marrow, 230);
  set(Tissue::cartilage, 100);
  set(Tissue::left_blood, patient.left_hu);
  set(Tissue::right_blood, patient.right_hu);
  set(Tissue::upper_vein, 0.5 * patient.right_hu + 40);
  set(Tissue::vessel_wall, 60);
  set(Tissue::skin, 20);
  set(Tissue::spleen, 120);
  set(Tissue::fluid, 15);
  set(Tissue::la_blood, patient.left_hu);
  set(Tissue::arterial_blood, patient.left_hu);
  set(Tissue::ra_blood, patient.right_hu);
  set(Tissue::pulmonary_blood, patient.right_hu);
  set(Tissue::lower_vein, 0.5 * patient.right_hu + 40);
  set(Tissue::vertebra, 230);
  return hu;
}

void apply_grey_values(const GreyValues& grey, std::array<float, tissue_count>& hu) {
  const auto set = [&](const std::optional<double>& value, const char* name, std::initializer_list<Tissue> tissues) {
    check_override(value, name, -100, 2000);
    for (const Tissue tissue : tissues)
      if (value) hu[static_cast<std::size_t>(tissue)] = static_cast<float>(*value);
  };
  set(grey.lv, "the phantom's left blood, HU", {Tissue::left_blood, Tissue::la_blood, Tissue::arterial_blood});
  set(grey.la, "the phantom's left atrium, HU", {Tissue::la_blood});
  set(grey.aorta, "the phantom's aorta, HU", {Tissue::arterial_blood});
  set(grey.rv, "the phantom's right blood, HU", {Tissue::right_blood, Tissue::ra_blood, Tissue::pulmonary_blood});
  set(grey.ra, "the phantom's right atrium, HU", {Tissue::ra_blood});
  set(grey.pa, "the phantom's pulmonary artery, HU", {Tissue::pulmonary_blood});
  set(grey.svc, "the phantom's superior vena cava, HU", {Tissue::upper_vein});
  set(grey.ivc, "the phantom's inferior vena cava, HU", {Tissue::lower_vein});
  set(grey.jet, "the phantom's jet, HU", {Tissue::jet});
  set(grey.muscle, "the phantom's heart muscle, HU", {Tissue::myocardium});
  set(grey.vertebrae, "the phantom's vertebrae, HU", {Tissue::vertebra});
}

/// From the superior vena cava through the right atrium into the tricuspid valve, widening.
Tube make_jet(const HeartShapes& heart) {
  const double k = heart.scale, reach_mm = 16;
  const Vec3 inflow = heart.ra_veins[0].cut.point, valve = heart.tricuspid.plane.point;
  const Vec3 bend = 0.5 * (heart.ra_center_mm + inflow);
  return Tube(smooth_curve({{inflow, 8 * k}, {bend, 8.5 * k}, {0.5 * (bend + valve), 9.5 * k}, {valve, 11 * k}}),
              reach_mm);
}

/// A point of a ventricle's cavity: blood, papillary muscle, or the crevice between that and the wall, which is filled.
Sample cavity_sample(const HeartField& f, Region wall, Region blood, Tissue blood_tissue) {
  const bool nearer_papillary = f.papillary < -std::min(f.lv, f.rv);
  if (f.papillary < 0 || (f.crevice > 0 && nearer_papillary)) return {Region::papillary, Tissue::myocardium};
  if (f.crevice > 0) return {wall, Tissue::myocardium};
  return {blood, blood_tissue};
}

std::optional<Sample> blood_sample(const Anatomy& anatomy, const HeartField& f, const Vec3& p) {
  using enum Region;
  if (f.lv < 0) return cavity_sample(f, lv_myocardium, lv_blood, Tissue::left_blood);
  if (f.rv < 0)
    return cavity_sample(f, f.lv_outer < -f.free_wall ? lv_myocardium : rv_myocardium, rv_blood, Tissue::right_blood);
  if (f.aorta < 0) return Sample{aorta, Tissue::arterial_blood};
  if (f.la < 0) return Sample{la_blood, Tissue::la_blood};
  if (f.pulmonary < 0) return Sample{pulmonary_artery, Tissue::pulmonary_blood};
  if (f.ra < 0) return Sample{ra_blood, anatomy.jet && (*anatomy.jet)(p) < 0 ? Tissue::jet : Tissue::ra_blood};
  return std::nullopt;
}

/// Whether a point of the caval veins belongs to the upper one.
bool in_upper_vein(const HeartShapes& heart, const Vec3& p) {
  return heart.ra_veins[0].tube(p) < heart.ra_veins[1].tube(p);
}

std::optional<Sample> heart_sample(const Anatomy& anatomy, const HeartField& f, const Vec3& p) {
  using enum Region;
  const HeartShapes& heart = anatomy.heart;
  if (auto blood = blood_sample(anatomy, f, p)) return blood;
  if (f.lv_outer < 0) return Sample{lv_myocardium, Tissue::myocardium};
  if (f.rv_outer < 0) return Sample{rv_myocardium, Tissue::myocardium};
  if (f.left_vein < 0) return Sample{torso, Tissue::la_blood};
  if (f.right_vein < 0) return Sample{torso, in_upper_vein(heart, p) ? Tissue::upper_vein : Tissue::lower_vein};
  if (f.la < heart.sizes.atrial_wall_mm) return Sample{la_wall, Tissue::myocardium};
  if (f.ra < heart.sizes.atrial_wall_mm) return Sample{ra_wall, Tissue::myocardium};
  if (std::min(f.aorta, f.pulmonary) < 1.8) return Sample{torso, Tissue::vessel_wall};
  if (std::min(f.left_vein, f.right_vein) < 1) return Sample{torso, Tissue::vessel_wall};
  return std::nullopt;
}

}  // namespace

Sample sample_at(const Anatomy& anatomy, const Vec3& p) {
  const double skin = skin_distance(anatomy.body, p);
  if (skin > 0) return {};
  const HeartField field = heart_field(anatomy.heart, p);
  if (auto sample = heart_sample(anatomy, field, p)) return *sample;
  return body_sample(anatomy.body, anatomy.heart, field, p, skin);
}

HeartModel make_heart_model(int variant, const HeartOverrides& overrides, const GreyValues& grey) {
  if (variant < 0) throw UserError("the variant must not be negative", "phantom", "give 0 or more");
  Patient patient = draw_patient(variant);
  apply_overrides(patient, overrides);
  auto anatomy = std::make_shared<Anatomy>();
  anatomy->pose = patient.pose;
  anatomy->heart = make_heart_shapes(patient.pose, patient.sizes,
                                     [&](const Vec3& q) { return place_in_patient(patient.pose, patient.stretch, q); });
  anatomy->body = make_body_shapes(patient.pose, patient.stretch, anatomy->heart);
  anatomy->body.fat_mm = patient.fat_mm;
  anatomy->hu = grey_values(patient);
  apply_grey_values(grey, anatomy->hu);
  if (grey.jet) anatomy->jet = make_jet(anatomy->heart);
  return {variant, std::move(anatomy)};
}

Region region_at(const HeartModel& model, const Vec3& lps_mm) { return sample_at(*model.anatomy, lps_mm).region; }
Tissue tissue_at(const HeartModel& model, const Vec3& lps_mm) { return sample_at(*model.anatomy, lps_mm).tissue; }

Vec3 long_axis(const HeartModel& model) { return model.anatomy->heart.local[2]; }

double right_heart_contrast_hu(const HeartModel& model) {
  const auto grey = [&](Tissue tissue) { return model.anatomy->hu[static_cast<std::size_t>(tissue)]; };
  return static_cast<double>(grey(Tissue::right_blood) - grey(Tissue::myocardium));
}

Landmarks landmarks_of(const HeartModel& model) {
  const auto& anatomy = *model.anatomy;
  const auto& heart = anatomy.heart;
  const auto local = [&](const Vec3& l) { return heart.center + transposed(heart.local) * l; };
  const auto middle = [](const Tube& tube, double share) {
    return tube.curve()[static_cast<std::size_t>(share * static_cast<double>(tube.curve().size() - 1))].at;
  };
  const auto place = [&](const Vec3& q) { return place_in_patient(anatomy.pose, anatomy.body.stretch, q); };
  Landmarks marks;
  auto& seeds = marks.seeds_mm;
  seeds["lv_blood"] = local({0, 0, 0.2 * heart.sizes.lv_length_mm});
  const double rv_far = heart.rv_center_local_mm.x + heart.rv_radii_mm.x;
  seeds["rv_blood"] = local({0.5 * (heart.lv_outer_mm.x + rv_far), heart.rv_center_local_mm.y, 6});
  seeds["la_blood"] = heart.la_center_mm;
  seeds["ra_blood"] = heart.ra_center_mm;
  seeds["aorta"] = middle(heart.aorta, 0.24);
  seeds["pulmonary_artery"] = middle(heart.pulmonary_trunk, 0.42);
  seeds["trachea"] = place({-3.5, 41, 128});
  seeds["carotid"] = place({18, 26.2, 140});
  const Vec3& s = anatomy.body.stretch;
  seeds["liver"] = {s.x * -70, s.y * 10, s.z * -70};
  seeds["lung"] = {s.x * -95, s.y * 30, s.z * 60};
  const auto valve = [](const Valve& v) { return ValvePlane{v.plane.point, v.plane.normal, v.radius_mm}; };
  marks.valves = {{"mitral", valve(heart.mitral)},
                  {"aortic", valve(heart.aortic)},
                  {"tricuspid", valve(heart.tricuspid)},
                  {"pulmonary", valve(heart.pulmonary)}};
  marks.lv_apex_mm = local({0, 0, -heart.lv_outer_mm.z});
  return marks;
}

}  // namespace heartgen::phantom
