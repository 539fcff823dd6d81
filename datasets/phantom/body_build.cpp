// SPDX-License-Identifier: GPL-3.0-or-later
// Where the parts of the template thorax lie. All numbers are template millimetres.
#include "datasets/phantom/body.hpp"

namespace heartgen::phantom {
namespace {

using Control = std::vector<CurvePoint>;

/// Collects curves of one kind; their points are mapped into the patient.
struct CurveSet {
  const HeartPose& pose;
  const Vec3& stretch;
  Tube tube;

  void add(const Control& control, int pieces = 5) {
    Control mapped;
    for (const auto& c : control) mapped.push_back({place_in_patient(pose, stretch, c.at), c.radius});
    const auto curve = smooth_curve(mapped, pieces);
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) tube.add(curve[i], curve[i + 1]);
  }
  Tube finish(double reach_mm) {
    tube.finish(reach_mm);
    return std::move(tube);
  }
};

void set_outlines(BodyShapes& body) {
  body.skin_half_width = HeightTable({-260, -160, -60, 20, 90, 125, 160, 185, 205, 235, 300},
                                     {152, 155, 164, 168, 170, 176, 192, 170, 95, 62, 58});
  body.skin_front = HeightTable({-260, -150, -60, 0, 60, 110, 150, 185, 215, 300},
                                {-88, -92, -90, -88, -84, -74, -56, -34, -18, -14});
  body.skin_back = HeightTable({-260, -160, -80, 0, 60, 120, 170, 210, 240, 300},
                               {118, 126, 140, 150, 152, 148, 134, 118, 108, 104});
  body.cavity_half_width =
      HeightTable({-260, -140, -60, 0, 40, 80, 115, 140, 158, 172}, {122, 128, 136, 135, 128, 114, 92, 70, 46, 2});
  body.cavity_front =
      HeightTable({-260, -120, -50, 0, 50, 90, 120, 145, 165}, {-72, -72, -68, -60, -53, -44, -30, -8, 18});
  body.cavity_back =
      HeightTable({-260, -140, -80, 0, 60, 100, 130, 155, 170}, {88, 96, 108, 120, 122, 116, 104, 86, 66});
  body.spine_y = HeightTable({-260, -160, -80, 0, 50, 110, 160, 210, 300}, {52, 62, 78, 90, 92, 86, 74, 62, 52});
}

void add_airways(BodyShapes& body, CurveSet trunk, CurveSet branches) {
  trunk.add({{{-1, 26, 230}, 8.5}, {{-2, 34, 170}, 8.5}, {{-4, 42, 125}, 8.5}, {{-4, 49, 84}, 8.5}});
  trunk.add({{{-4, 49, 84}, 7.5}, {{-14, 52, 76}, 7}, {{-28, 55, 68}, 6.5}, {{-38, 56, 60}, 5.8}});
  trunk.add({{{-4, 49, 84}, 7.5}, {{8, 50, 75}, 6.5}, {{24, 51, 66}, 6.2}, {{42, 54, 58}, 5.4}});
  branches.add({{{-30, 55, 67}, 5}, {{-44, 52, 74}, 4.2}, {{-56, 48, 84}, 3.6}});
  branches.add({{{-56, 48, 84}, 3}, {{-62, 40, 100}, 2.6}, {{-66, 36, 116}, 2.2}});
  branches.add({{{-56, 48, 84}, 3}, {{-70, 60, 90}, 2.4}, {{-82, 70, 96}, 2}});
  branches.add({{{-38, 56, 60}, 5.2}, {{-46, 58, 46}, 4.6}, {{-56, 66, 24}, 3.6}});
  branches.add({{{-44, 57, 48}, 3.6}, {{-62, 40, 38}, 3}, {{-76, 22, 30}, 2.2}});
  branches.add({{{-56, 66, 24}, 3}, {{-66, 76, 4}, 2.4}, {{-74, 84, -14}, 2}});
  branches.add({{{-56, 66, 24}, 3}, {{-76, 64, 10}, 2.4}, {{-90, 56, 0}, 2}});
  branches.add({{{42, 54, 58}, 4.6}, {{54, 48, 68}, 4}, {{64, 42, 82}, 3.2}});
  branches.add({{{64, 42, 82}, 2.8}, {{70, 34, 100}, 2.4}, {{74, 32, 114}, 2}});
  branches.add({{{54, 48, 68}, 3}, {{72, 30, 66}, 2.6}, {{86, 14, 60}, 2}});
  branches.add({{{42, 54, 58}, 5}, {{52, 60, 40}, 4.4}, {{62, 70, 18}, 3.4}});
  branches.add({{{62, 70, 18}, 3}, {{72, 82, 0}, 2.4}, {{82, 90, -16}, 2}});
  branches.add({{{62, 70, 18}, 3}, {{84, 66, 6}, 2.4}, {{98, 58, -4}, 2}});
  body.airway = trunk.finish(10);
  body.airway_branches = branches.finish(6);
}

void add_neck_vessels(BodyShapes& body, CurveSet carotids, CurveSet branches, CurveSet veins) {
  branches.add({{{5, 10, 106}, 6.5}, {{-4, 14, 126}, 6.5}, {{-16, 20, 148}, 6.2}, {{-22, 24, 158}, 6}});
  branches.add({{{-22, 24, 158}, 4.8}, {{-44, 24, 168}, 4.6}, {{-80, 34, 160}, 4.4}, {{-120, 44, 150}, 4}});
  branches.add(
      {{{24, 42, 115}, 5.2}, {{29, 46, 140}, 5}, {{44, 40, 162}, 4.8}, {{80, 38, 160}, 4.4}, {{120, 44, 150}, 4}});
  carotids.add({{{-22, 24, 158}, 4}, {{-25, 28, 180}, 3.6}, {{-28, 30, 210}, 3.5}, {{-32, 32, 250}, 3.4}});
  carotids.add(
      {{{14, 22, 114}, 4}, {{17, 25, 132}, 3.8}, {{21, 29, 165}, 3.6}, {{27, 30, 210}, 3.5}, {{31, 32, 250}, 3.4}});
  veins.add(
      {{{-28, 6, 104}, 8}, {{-32, 8, 124}, 7.5}, {{-38, 16, 145}, 7}, {{-38, 26, 180}, 6.5}, {{-40, 32, 250}, 6}});
  veins.add({{{-28, 6, 106}, 7},
             {{-10, -8, 122}, 6.8},
             {{18, -4, 138}, 6.8},
             {{36, 10, 150}, 6.5},
             {{37, 26, 180}, 6},
             {{38, 32, 250}, 5.5}});
  veins.add({{{-27, 14, 84}, 4},
             {{-22, 40, 94}, 4},
             {{-12, 70, 88}, 3.6},
             {{-8, 74, 40}, 3.4},
             {{-7, 66, -60}, 3.2}});  // azygos
  body.carotids = carotids.finish(6);
  body.arch_branches = branches.finish(6);
  body.veins = veins.finish(6);
}

/// A tree of vessels that divides in two until it is thin; directions come from a counter, not from a generator's
/// state.
struct VesselTree {
  Tube& tube;
  std::uint64_t key;
  std::uint64_t counter = 0;

  Vec3 random_direction() {
    Vec3 d{random_symmetric(key, counter), random_symmetric(key, counter + 1), random_symmetric(key, counter + 2)};
    counter += 3;
    return normalized(d);
  }
  void grow(const Vec3& from, const Vec3& direction, double radius, int generations) {
    const double length = 5.5 + 4.2 * radius;
    const Vec3 to = from + length * direction;
    tube.add({from, radius}, {to, 0.9 * radius});
    if (generations == 0) return;
    Vec3 side = random_direction();
    side = normalized(side - dot(side, direction) * direction);
    const double share = 0.72 + 0.1 * random_symmetric(key, counter++);
    grow(to, normalized(direction + 0.45 * side), radius * 0.86, generations - 1);
    grow(to, normalized(direction - 0.75 * side), radius * share, generations - 1);
  }
};

void add_lung_trees(BodyShapes& body, const HeartPose& pose, const Vec3& stretch, const HeartShapes& heart) {
  const auto sprout = [&](Tube& tube, const Vec3& from, double radius, const Vec3& towards, std::uint64_t key) {
    const Vec3 goal = place_in_patient(pose, stretch, towards);
    VesselTree{tube, key}.grow(from, normalized(goal - from), radius, 9);
  };
  const std::vector<Vec3> right_goals = {{-75, 20, 130}, {-105, 70, 90},  {-115, 10, 60}, {-105, 20, 20},
                                         {-95, 90, -30}, {-110, 50, -20}, {-70, 105, 10}};
  std::uint64_t key = 1000;
  const Vec3 right_hilum = heart.right_pulmonary_end.point, left_hilum = heart.left_pulmonary_end.point;
  for (const auto& goal : right_goals) {
    sprout(body.lung_arteries, right_hilum, 4.3, goal, key++);
    sprout(body.lung_arteries, left_hilum, 4.3, {3 - goal.x, goal.y, goal.z}, key++);
  }
  const std::vector<std::vector<Vec3>> vein_goals = {{{-75, -10, 110}, {-115, 0, 40}, {-100, -25, 10}},
                                                     {{-90, 90, -40}, {-115, 60, 0}, {-80, 105, 40}},
                                                     {{80, -5, 110}, {115, 0, 60}, {112, -20, 25}},
                                                     {{95, 90, -40}, {118, 60, 0}, {85, 105, 40}}};
  for (std::size_t vein = 0; vein < vein_goals.size(); ++vein)
    for (const auto& goal : vein_goals[vein])
      sprout(body.lung_veins, heart.la_veins[vein].tube.curve().back().at, 4, goal, key++);
  body.lung_arteries.finish(2);
  body.lung_veins.finish(2);
}

void add_bones_of_the_shoulder(BodyShapes& body, CurveSet clavicles, CurveSet limbs) {
  clavicles.add({{{-16, -38, 118}, 8}, {{-45, -36, 132}, 6.5}, {{-90, -4, 146}, 6}, {{-135, 22, 154}, 6.5}});
  clavicles.add({{{16, -38, 118}, 8}, {{45, -36, 132}, 6.5}, {{90, -4, 146}, 6}, {{135, 22, 154}, 6.5}});
  limbs.add({{{-152, 40, 146}, 21}, {{-166, 36, 180}, 12}, {{-178, 24, 260}, 11}});
  limbs.add({{{152, 40, 146}, 21}, {{166, 36, 180}, 12}, {{178, 24, 260}, 11}});
  body.clavicles = clavicles.finish(8);
  body.limbs = limbs.finish(24);
}

}  // namespace

Vec3 place_in_patient(const HeartPose& pose, const Vec3& stretch, const Vec3& q) {
  const Vec3 fixed{stretch.x * q.x, stretch.y * q.y, stretch.z * q.z};
  const double weight = smooth_step(175, 75, norm(q - pose.from));
  return weight * pose(q) + (1 - weight) * fixed;
}

BodyShapes make_body_shapes(const HeartPose& pose, const Vec3& stretch, const HeartShapes& heart) {
  BodyShapes body;
  body.stretch = stretch;
  set_outlines(body);
  const CurveSet curves{pose, stretch, {}};
  add_airways(body, curves, curves);
  CurveSet esophagus = curves;
  esophagus.add({{{2, 44, 230}, 6},
                 {{3, 56, 150}, 6.5},
                 {{6, 66, 100}, 7},
                 {{5, 68, 60}, 7},
                 {{6, 69, 10}, 7},
                 {{12, 58, -40}, 7.5},
                 {{30, 40, -75}, 9}});
  body.esophagus = esophagus.finish(10);
  add_neck_vessels(body, curves, curves, curves);
  add_lung_trees(body, pose, stretch, heart);
  add_bones_of_the_shoulder(body, curves, curves);
  return body;
}

}  // namespace heartgen::phantom
