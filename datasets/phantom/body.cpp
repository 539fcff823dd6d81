// SPDX-License-Identifier: GPL-3.0-or-later
#include "datasets/phantom/body.hpp"

#include <cmath>
#include <optional>

#include "model/mathematics.hpp"

namespace heartgen::phantom {
namespace {

double length2d(double a, double b) { return std::sqrt(a * a + b * b); }

/// First-order distance (mm) to an outline of exponent 2.5 with the given half width and front and back.
double outline(double half_width, double front, double back, const Vec3& t) {
  const double half_depth = 0.5 * (back - front);
  const double a = std::abs(t.x) / half_width, b = std::abs(t.y - front - half_depth) / half_depth;
  const double f = math::pow(a * a * std::sqrt(a) + b * b * std::sqrt(b), 0.4);
  if (f < 1e-6) return -std::min(half_width, half_depth);
  const double u = a / f, v = b / f;
  return (f - 1) / length2d(u * std::sqrt(u) / half_width, v * std::sqrt(v) / half_depth);
}

/// What every layer of the body needs to know about a point.
struct Place {
  Vec3 t;        ///< template thorax coordinates
  double depth;  ///< below the skin
  double wall;   ///< outside the chest cavity, negative inside
  double spine_y;
  double diaphragm;  ///< height of the diaphragm here
  double turn;       ///< 0 at the back, 1 at the front, along the wall
};

/// Two domes and the flat centre that carries the heart.
double diaphragm_height(double x, double y) {
  const auto dome = [&](double cx, double cy, double rx, double ry, double top) {
    const double r2 = (x - cx) * (x - cx) / (rx * rx) + (y - cy) * (y - cy) / (ry * ry);
    return top - 60 * r2 * std::sqrt(r2) - 14 * r2;
  };
  const double right = dome(-66, 12, 74, 92, -14), left = dome(76, 22, 66, 90, -38),
               center = dome(18, -12, 84, 78, -28);
  return smooth_max(smooth_max(right, left, 14), center, 14);
}

Place locate(const BodyShapes& body, const Vec3& p, double skin) {
  Place at;
  const Vec3& s = body.stretch;
  at.t = {p.x / s.x, p.y / s.y, p.z / s.z};
  at.depth = -skin;
  const double z = at.t.z;
  at.spine_y = body.spine_y(z);
  const double front = body.cavity_front(z), back = body.cavity_back(z);
  const double gutter = 0.95 * (at.t.y - (at.spine_y + 11 + 0.32 * std::abs(at.t.x)));
  at.wall = z > 172 ? 40 : smooth_max(outline(body.cavity_half_width(z), front, back, at.t), gutter, 8);
  at.diaphragm = diaphragm_height(at.t.x, at.t.y);
  at.turn = 1 - math::atan2(std::abs(at.t.x), 0.5 * (front + back) - at.t.y) / 3.14159265358979323846;
  return at;
}

constexpr Sample torso(Tissue tissue) { return {Region::torso, tissue}; }
Sample bone(double depth_mm, double shell_mm = 1.4, Tissue spongy = Tissue::marrow) {
  return {Region::bone, depth_mm < shell_mm ? Tissue::cortical_bone : spongy};
}

double periodic(double x, double period) { return x - period * std::floor(x / period + 0.5); }

std::optional<Sample> vertebral_arch(const Place& at, double dy, double level) {
  const double x = std::abs(at.t.x), around = length2d(x, dy - 23);
  if (around < 4.5) return torso(Tissue::muscle);  // the cord
  if (around < 8.5) return torso(Tissue::fluid);
  if (around < 12.5 && std::abs(level) < 9) return bone(std::min(around - 8.5, 12.5 - around), 1.2, Tissue::vertebra);
  const double bar = std::max(round_cone({x, dy, 0}, {10, 20, 0}, {35, 28, 0}, 5, 4), std::abs(level - 3) - 5);
  if (bar < 0) return bone(-bar, 1.2, Tissue::vertebra);
  const double slanted = std::abs(periodic(at.t.z + 0.8 * (dy - 33), 25)) - 6.5;
  const double process = std::max({x - 2.8, slanted, dy - 46, 30 - dy});
  if (process < 0) return bone(-process, 1.0, Tissue::vertebra);
  return std::nullopt;
}

std::optional<Sample> spine_sample(const Place& at) {
  const double dy = at.t.y - at.spine_y;
  if (std::abs(at.t.x) > 42 || dy < -20 || dy > 50) return std::nullopt;
  const double level = periodic(at.t.z, 25);
  const double waist = 1 - 0.07 * math::cos(level * 0.3);
  const double in_body = (1 - length2d(at.t.x / (18.5 * waist), dy / (15 * waist))) * 15;
  if (in_body > 0) {
    const double end_plate = 9.3 - std::abs(level);
    return end_plate < 0 ? torso(Tissue::cartilage) : bone(std::min(in_body, end_plate), 1.1, Tissue::vertebra);
  }
  return vertebral_arch(at, dy, level);
}

/// Ribs fall from the spine to the side and rise as cartilage to the sternum.
std::optional<Sample> rib_sample(const Place& at) {
  if (at.wall < 0.5 || at.wall > 12.5 || at.t.z > 150 || at.t.z < -165) return std::nullopt;
  const double course = std::min(at.turn / 0.74, 1.0);
  double drop = 66 * math::sin(course * 1.5707963) * smooth_step(172, 122, at.t.z);
  if (at.turn > 0.74) drop -= 26 * smooth_step(0.74, 0.97, at.turn);
  const double height = at.t.z + drop - 10;
  const double across = 0.8 * periodic(height, 25);
  const double number = std::floor(height / 25 + 0.5);
  if (number < -6 && at.turn > 0.45) return std::nullopt;
  if (number < -3 && at.turn > 0.80) return std::nullopt;
  const double d = length2d((at.wall - 6) / 4, across / 6.4) - 1;
  if (d > 0 || std::abs(at.t.x) < 13) return std::nullopt;
  if (at.turn > 0.78) return torso(Tissue::cartilage);
  return bone(-d * 4.6, 1.5);
}

std::optional<Sample> sternum_sample(const BodyShapes& body, const Place& at) {
  const double z = at.t.z;
  const double half = 13 + 3 * smooth_step(20, -10, z) + 12 * smooth_step(78, 100, z) - 9 * smooth_step(-30, -48, z);
  const double middle = body.cavity_front(z) - 8;
  // A plate with rounded edges: 10 mm thick, hollowed a little at the level of each pair of ribs.
  const double thick = 5 - 0.5 * math::cos(z * 0.25), edge = 3.5;
  const double across = std::max(std::abs(at.t.x) - half + edge, 0.0);
  const double deep = std::max(std::abs(at.t.y - middle) - thick + edge, 0.0);
  const double d = std::max({length2d(across, deep) - edge, -52 - z, z - 116});
  if (d < 0) return bone(std::min({-d, half - std::abs(at.t.x), thick - std::abs(at.t.y - middle)}), 1.2);
  return std::nullopt;
}

/// Distances to the bones of the shoulder girdle.
struct Shoulder {
  double clavicle = 30, limb = 30, scapula = 30;
};

Shoulder shoulder_at(const BodyShapes& body, const Place& at, const Vec3& p) {
  Shoulder shoulder;
  if (at.t.z < -5) return shoulder;
  shoulder.clavicle = body.clavicles(p);
  shoulder.limb = body.limbs(p);
  const Vec3 m{std::abs(at.t.x), at.t.y, at.t.z};
  if (m.x < 55 || m.y < 20 || m.z > 185) return shoulder;
  const double blade = thick_triangle(m, {98, 118, 12}, {74, 122, 128}, {136, 62, 138}, 2.4);
  const double ridge = round_cone(m, {76, 128, 118}, {140, 84, 158}, 3.5, 6);
  const double socket = norm(m - Vec3{136, 60, 140}) - 13;
  shoulder.scapula = std::min({blade, ridge, socket});
  return shoulder;
}

/// The bones, and the muscles that wrap them.
std::optional<Sample> shoulder_sample(const BodyShapes& body, const Place& at, const Vec3& p) {
  const Shoulder s = shoulder_at(body, at, p);
  if (s.clavicle < 0) return bone(-s.clavicle, 1.8);
  if (s.limb < 0) return bone(-s.limb, 3);
  if (s.scapula < 0) return bone(-s.scapula, 1.3);
  const double wave = 2 * math::sin(at.t.z / 11 + at.t.x / 19) + 2 * math::sin(at.t.y / 9);
  const double muscle = std::min({s.clavicle - 6, s.limb - 15 - wave, s.scapula - 11 - wave});
  if (muscle < 0 && at.depth > 6 && at.wall > 11) return torso(Tissue::muscle);
  return std::nullopt;
}

/// Muscle and fat outside the ribs.
Sample soft_wall(const BodyShapes& body, const Place& at) {
  const double x = std::abs(at.t.x), z = at.t.z;
  const double fat = body.fat_mm * (0.8 + 0.35 * smooth_step(40, -80, z));
  if (at.depth < fat) return torso(Tissue::fat);
  if (at.wall < 1.2) return torso(Tissue::fat);
  if (at.wall < 9.6) return torso(at.wall > 8.4 && at.turn < 0.7 ? Tissue::fat : Tissue::muscle);
  const bool beside_spine = x < 52 && at.t.y > at.spine_y + 8;
  if (beside_spine)
    return torso(length2d(x - 26, at.t.y - at.spine_y - 40) > 23.5 && x > 6 ? Tissue::fat : Tissue::muscle);
  // Planes of fat between the muscles, bent so that they do not run parallel to the ribs.
  const double bend = 5 * math::sin(x / 17 + 0.05 * z) + 4 * math::sin(at.t.y / 13 - 0.04 * z) + 0.18 * z;
  if (z > 165) return torso(std::abs(periodic(at.depth + bend, 19)) < 1.2 ? Tissue::fat : Tissue::muscle);
  const double pectoral =
      15 * smooth_step(0.58, 0.68, at.turn) * smooth_step(0.96, 0.88, at.turn) * smooth_step(-30, 30, z);
  const double side = 9 * smooth_step(0.66, 0.55, at.turn) * smooth_step(0.2, 0.3, at.turn);
  const double back = 8 * smooth_step(0.34, 0.26, at.turn) + 20 * smooth_step(100, 150, z);
  const double muscle = std::max({pectoral, side, back});
  if (at.wall < 11 || at.wall > 11 + muscle) return torso(Tissue::fat);
  return torso(std::abs(periodic(at.wall + bend, 17)) < 1.0 && at.wall > 15 ? Tissue::fat : Tissue::muscle);
}

Sample wall_sample(const BodyShapes& body, const Place& at, const Vec3& p) {
  if (auto s = sternum_sample(body, at)) return *s;
  if (auto s = rib_sample(at)) return *s;
  if (auto s = shoulder_sample(body, at, p)) return *s;
  return soft_wall(body, at);
}

/// The right lobe fills the dome; the left lobe tapers towards the stomach; the lower edge rises to the left.
bool in_liver(const Place& at) {
  const Vec3& t = at.t;
  const double left_end = t.x - 66 + 0.55 * std::max(t.y + 10, 0.0) + 0.3 * std::max(-60 - t.z, 0.0);
  const double lower = -(t.z + 120 - 0.62 * t.x - 0.12 * (t.y - 20)) * 0.8;
  const double hilum = 16 - norm(Vec3{t.x + 6, 0.8 * (t.y - 30), t.z + 128});
  const double shape = smooth_max(smooth_max(left_end, lower, 22), hilum, 10);
  return shape < 0 && at.wall < -4 && length2d(t.x, t.y - at.spine_y) > 26;
}

Sample abdomen_sample(const Place& at) {
  const Vec3& t = at.t;
  const double below = at.diaphragm - t.z;
  if (below < 2.6 || at.wall > -2.6) return torso(Tissue::muscle);
  if (in_liver(at)) return {Region::liver, Tissue::liver};
  const double stomach = ellipsoid(t - Vec3{62, -2, -92}, {36, 44, 42});
  if (stomach < 0 && at.wall < -5) {
    if (stomach > -4 || below < 7) return torso(Tissue::muscle);
    return torso(t.y < -14 ? Tissue::air : Tissue::fluid);
  }
  if (ellipsoid(t - Vec3{92, 68, -88}, {28, 38, 44}) < 0 && at.wall < -4) return torso(Tissue::spleen);
  if (ellipsoid(Vec3{std::abs(t.x) - 58, t.y - 72, t.z + 178}, {27, 29, 55}) < 0) return torso(Tissue::spleen);
  const double psoas = length2d(std::abs(t.x) - 24, t.y - at.spine_y - 4) - 12;
  return torso(psoas < 0 && t.z < -120 ? Tissue::muscle : Tissue::fat);
}

/// The fat between the lungs: around the heart, the vessels and the airways, and in front of and behind them.
double mediastinum(const BodyShapes& body, const HeartField& f, const Place& at, const Vec3& p, double airway) {
  const Vec3& t = at.t;
  const double pericardial = 2.5 + 5 * smooth_step(10, -50, t.y) * smooth_step(40, -20, t.z);
  double m = smooth_min(f.outer - pericardial, f.aorta - 3.5, 9);
  m = smooth_min(m, f.pulmonary - 2.5, 7);
  m = smooth_min(m, airway - 3, 7);
  m = smooth_min(m, body.esophagus(p) - 2.5, 7);
  m = smooth_min(m, std::min({body.veins(p), body.arch_branches(p), body.carotids(p)}) - 2.5, 5);
  const double spine = length2d(t.x / 21, (t.y - at.spine_y) / 18) * 18 - 18;
  m = smooth_min(m, std::max(spine, -8.0), 7);
  const double retrosternal = 20 * smooth_step(-34, -54, t.y) * smooth_step(45, 5, t.z);
  const double half = 2.5 + 0.1 * std::max(-t.y, 0.0) + 14 * smooth_step(110, 160, t.z) + retrosternal;
  const double septum = std::max(std::abs(t.x - 4 - 0.5 * retrosternal) - half, t.y - at.spine_y);
  return smooth_min(m, septum, 9);
}

Sample lung_sample(const BodyShapes& body, const Vec3& p) {
  if (body.lung_arteries(p) < 0) return {Region::lung, Tissue::pulmonary_blood};
  if (body.lung_veins(p) < 0) return {Region::lung, Tissue::la_blood};
  return {Region::lung, Tissue::lung};
}

std::optional<Sample> tube_sample(const BodyShapes& body, const Vec3& p, double trunk, double branches) {
  if (std::min(trunk, branches) < 0) return Sample{Region::trachea, Tissue::air};
  if (body.carotids(p) < 0) return Sample{Region::carotid, Tissue::arterial_blood};
  if (body.arch_branches(p) < 0) return torso(Tissue::arterial_blood);
  if (body.veins(p) < 0) return torso(Tissue::upper_vein);
  if (trunk < 1.5 || branches < 1.1) return torso(Tissue::vessel_wall);
  if (std::min(body.carotids(p), body.arch_branches(p)) < 1) return torso(Tissue::vessel_wall);
  const double esophagus = body.esophagus(p);
  if (esophagus < 0) return torso(esophagus < -5.2 && p.z > 20 ? Tissue::air : Tissue::muscle);
  return std::nullopt;
}

}  // namespace

double skin_distance(const BodyShapes& body, const Vec3& p) {
  const Vec3 t{p.x / body.stretch.x, p.y / body.stretch.y, p.z / body.stretch.z};
  const double furrow = 6 * math::exp(-t.x * t.x / 260) * smooth_step(60, 110, t.y);  // between the muscles of the back
  return outline(body.skin_half_width(t.z), body.skin_front(t.z), body.skin_back(t.z), t) + furrow;
}

Sample body_sample(const BodyShapes& body, const HeartShapes& heart, const HeartField& f, const Vec3& p, double skin) {
  if (skin > -1.7) return torso(Tissue::skin);
  const Place at = locate(body, p, skin);
  const double gap = 3 - std::min({f.aorta, f.pulmonary, f.la, f.ra});  // keeps the airways off the blood
  const double trunk = std::max(body.airway(p), gap), branches = std::max(body.airway_branches(p), gap);
  if (auto s = tube_sample(body, p, trunk, branches)) return *s;
  if (f.outer < 4.5 && heart.coronaries(p) < 0) return torso(Tissue::arterial_blood);
  if (f.outer < 2.5) return torso(Tissue::fat);
  if (auto s = spine_sample(at)) return *s;
  if (at.wall > -0.8) return wall_sample(body, at, p);
  if (at.t.z < at.diaphragm) return abdomen_sample(at);
  if (mediastinum(body, f, at, p, trunk) < 0) return torso(Tissue::fat);
  return lung_sample(body, p);
}

}  // namespace heartgen::phantom
