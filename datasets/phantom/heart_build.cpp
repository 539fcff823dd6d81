// SPDX-License-Identifier: GPL-3.0-or-later
// Where the parts of the template heart lie. All numbers are template millimetres (see HeartPose).
#include "datasets/phantom/heart_shapes.hpp"
#include "model/mathematics.hpp"

namespace heartgen::phantom {
namespace {

constexpr double reach = 16;
using Place = std::function<Vec3(const Vec3&)>;

struct TemplateFrame {
  Vec3 center{38, 0, 0};
  Vec3 to_septum, to_anterior, to_base;
  Vec3 operator()(const Vec3& l) const { return center + l.x * to_septum + l.y * to_anterior + l.z * to_base; }
};

/// The long axis points 45 degrees to the left and 30 degrees down; the septum faces right and forward.
TemplateFrame template_frame() {
  TemplateFrame frame;
  frame.to_base = normalized({-0.62, 0.60, 0.50});
  const Vec3 guess{-0.70, -0.70, -0.05};
  frame.to_septum = normalized(guess - dot(guess, frame.to_base) * frame.to_base);
  frame.to_anterior = cross(frame.to_base, frame.to_septum);
  return frame;
}

Tube make_tube(const std::vector<CurvePoint>& control, const Place& place, double scale, int pieces = 6,
               double tube_reach = reach) {
  std::vector<CurvePoint> mapped;
  mapped.reserve(control.size());
  for (const auto& point : control) mapped.push_back({place(point.at), point.radius * scale});
  return Tube(smooth_curve(mapped, pieces), tube_reach);
}

Vein make_vein(const std::vector<CurvePoint>& control, const Place& place, double scale, std::size_t cut_at) {
  Vein vein{make_tube(control, place, scale), {}};
  const auto& curve = vein.tube.curve();
  const std::size_t i = std::min(cut_at, curve.size() - 2);
  vein.cut = {curve[i].at, normalized(curve[i + 1].at - curve[i - 1].at)};
  return vein;
}

Plane end_of(const Tube& tube) {
  const auto& curve = tube.curve();
  const auto last = curve.size() - 1;
  return {curve[last].at, normalized(curve[last].at - curve[last - 2].at)};
}

void add_valves(HeartShapes& heart, const HeartPose& pose, const TemplateFrame& frame) {
  const auto valve = [&](const Vec3& at, const Vec3& normal, double radius) {
    return Valve{{pose(at), pose.rotation * normalized(normal)}, radius * pose.scale};
  };
  const Vec3 mitral_normal = frame.to_base - 0.14 * frame.to_anterior - 0.10 * frame.to_septum;
  heart.mitral = valve(frame({-10.5, -8, 27}), mitral_normal, 13);
  heart.aortic = valve({13.5, 6.3, 25.7}, {-0.45, -0.25, 0.86}, 10.5);
  heart.tricuspid = valve({-13, -11.5, -1}, {-0.80, 0.57, 0.12}, 15);
  heart.pulmonary = valve({27, -22, 46}, {0.25, 0.48, 0.84}, 11.5);
}

void add_ventricles(HeartShapes& heart, const TemplateFrame& frame, const Place& rigid) {
  const double k = heart.scale;
  const auto& s = heart.sizes;
  heart.lv_outer_mm = {s.lv_radius_mm + s.lv_wall_mm, s.lv_radius_mm + s.lv_wall_mm,
                       s.lv_length_mm + 0.75 * s.lv_wall_mm};
  heart.rv_center_local_mm = k * Vec3{27, -5, 3};
  heart.rv_radii_mm = k * Vec3{31 * s.rv_width, 39.5, 62};
  const Vec3 aortic{13.5, 6.3, 25.7}, aortic_axis = normalized({-0.45, -0.25, 0.86});
  heart.lv_outflow = make_tube({{frame({6, 7, 8}), 12},
                                {frame({10, 10, 19}), 11},
                                {aortic - 4 * aortic_axis, 10.5},
                                {aortic, 10.5},
                                {aortic + 5 * aortic_axis, 10.5}},
                               rigid, k, 4);
  const Vec3 valve{27, -22, 46}, valve_axis = normalized({0.25, 0.48, 0.84});
  heart.rv_outflow = make_tube({{frame({38, 8, 2}), 17},
                                {frame({37, 26, 8}), 15},
                                {valve - 7 * valve_axis, 11.5},
                                {valve, 11.5},
                                {valve + 5 * valve_axis, 11.5}},
                               rigid, k, 4);
}

/// Papillary muscles stand on the wall and point to their valve; sizes follow the cavity.
void add_papillary_muscles(HeartShapes& heart) {
  const double r = heart.sizes.lv_radius_mm, h = heart.sizes.lv_length_mm, k = heart.scale;
  const auto at = [&](double angle_deg, double radius, double height) {
    const double a = angle_deg * 3.14159265358979323846 / 180;
    return heart.center + transposed(heart.local) * Vec3{radius * math::cos(a), radius * math::sin(a), height};
  };
  for (const double angle : {150.0, 262.0}) {  // anterolateral, posteromedial
    const std::vector<CurvePoint> muscle = {{at(angle, 0.80 * r, -0.58 * h), 4.6 * k},
                                            {at(angle, 0.70 * r, -0.28 * h), 4.8 * k},
                                            {at(angle, 0.52 * r, 0.02 * h), 3.2 * k}};
    for (std::size_t i = 0; i + 1 < muscle.size(); ++i) heart.lv_papillary.add(muscle[i], muscle[i + 1]);
  }
  heart.lv_papillary.finish(reach);
  const auto rv_at = [&](const Vec3& unit) {
    const Vec3& c = heart.rv_radii_mm;
    return heart.center +
           transposed(heart.local) * (heart.rv_center_local_mm + Vec3{unit.x * c.x, unit.y * c.y, unit.z * c.z});
  };
  const CurvePoint base{rv_at({0.80, -0.30, -0.50}), 4 * k}, tip{rv_at({0.62, -0.30, -0.02}), 2.6 * k};
  heart.rv_papillary.add(base, tip);
  const CurvePoint inferior{rv_at({0.42, -0.84, -0.32}), 3.6 * k}, inferior_tip{rv_at({0.48, -0.55, 0.02}), 2.4 * k};
  heart.rv_papillary.add(inferior, inferior_tip);
  // The moderator band runs from the septum to the foot of the anterior papillary muscle.
  heart.rv_papillary.add({rv_at({0.02, 0.10, -0.22}), 2.2 * k}, {rv_at({0.78, -0.28, -0.45}), 2.2 * k});
  heart.rv_papillary.finish(reach);
}

void add_atria(HeartShapes& heart, const HeartPose& pose, const Place& place) {
  const double k = heart.scale;
  heart.la_center_mm = pose({10, 42, 19});
  heart.la_radii_mm = k * Vec3{29, 19, 23};
  heart.ra_center_mm = pose({-24, 7, 6});
  heart.ra_radii_mm = k * Vec3{21, 25, 31};
  heart.la_veins = {
      make_vein({{{-6, 42, 27}, 8}, {{-19, 38, 31}, 7}, {{-33, 33, 36}, 6.5}, {{-46, 30, 42}, 6}}, place, k, 11),
      make_vein({{{-6, 48, 14}, 8}, {{-20, 53, 12}, 7}, {{-34, 59, 9}, 6.5}, {{-46, 64, 5}, 6}}, place, k, 11),
      make_vein({{{24, 40, 28}, 8}, {{36, 37, 36}, 7}, {{46, 35, 41}, 6.5}, {{58, 34, 48}, 6}}, place, k, 9),
      make_vein({{{24, 48, 14}, 8}, {{38, 52, 12}, 7}, {{50, 57, 10}, 6.5}, {{62, 62, 6}, 6}}, place, k, 9)};
  heart.ra_veins = {
      make_vein({{{-24, 8, 24}, 10}, {{-25, 8, 40}, 9.5}, {{-26, 8, 58}, 9.5}, {{-27, 8, 80}, 9.5}, {{-28, 6, 104}, 9}},
                place, k, 9),
      make_vein({{{-22, 16, -12}, 11},
                 {{-21, 22, -28}, 11},
                 {{-20, 26, -46}, 11},
                 {{-18, 30, -75}, 11},
                 {{-17, 36, -110}, 11},
                 {{-15, 36, -160}, 10.5}},
                place, k, 7)};
  heart.la_appendage =
      make_tube({{{28, 36, 32}, 9}, {{40, 22, 38}, 8}, {{47, 8, 40}, 6.5}, {{52, -4, 36}, 5}}, pose, k);
  heart.ra_appendage = make_tube({{{-18, -6, 22}, 11}, {{-13, -18, 33}, 9}, {{-6, -25, 39}, 6.5}}, pose, k);
}

/// Root with its sinuses, ascending aorta, arch and descending aorta.
std::vector<CurvePoint> aorta_course() {
  const Vec3 aortic{13.5, 6.3, 25.7}, axis = normalized({-0.45, -0.25, 0.86});
  return {{aortic - 4 * axis, 10.5}, {aortic, 10.5},      {aortic + 10 * axis, 15}, {aortic + 21 * axis, 13},
          {{-2, -3, 58}, 14.5},      {{-4, -1, 80}, 15},  {{3, 7, 101}, 14.5},      {{15, 24, 113}, 13.5},
          {{26, 46, 112}, 12.5},     {{31, 66, 99}, 12},  {{31, 75, 80}, 11.5},     {{30, 77, 40}, 11.5},
          {{29, 76, 0}, 11.2},       {{26, 72, -40}, 11}, {{20, 62, -80}, 10.5},    {{12, 48, -120}, 10},
          {{8, 38, -165}, 9.5},      {{6, 36, -220}, 9}};
}

void add_arteries(HeartShapes& heart, const Place& place) {
  const double k = heart.scale;
  heart.aorta = make_tube(aorta_course(), place, k);
  const Vec3 valve{27, -22, 46}, trunk = normalized({0.25, 0.48, 0.84});
  heart.pulmonary_trunk = make_tube({{valve - 4 * trunk, 11.5},
                                     {valve, 11.5},
                                     {valve + 8 * trunk, 13.5},
                                     {{31, -7, 66}, 13},
                                     {{30, 8, 76}, 13},
                                     {{32, 22, 81}, 11.5},
                                     {{38, 36, 82}, 10.5},
                                     {{50, 47, 78}, 9.5},
                                     {{62, 52, 70}, 8.5}},
                                    place, k);
  heart.right_pulmonary = make_tube({{{30, 8, 74}, 11},
                                     {{20, 21, 71}, 10.5},
                                     {{4, 29, 69}, 10.5},
                                     {{-15, 32, 67}, 10.5},
                                     {{-32, 34, 64}, 9.5},
                                     {{-48, 38, 58}, 8.5}},
                                    place, k);
  heart.left_pulmonary_end = end_of(heart.pulmonary_trunk);
  heart.right_pulmonary_end = end_of(heart.right_pulmonary);
}

}  // namespace

HeartShapes make_heart_shapes(const HeartPose& pose, const HeartSizes& sizes, const Place& place) {
  HeartShapes heart;
  const auto frame = template_frame();
  heart.middle = pose({15, 0, 5});
  heart.bound_mm = 100 * pose.scale + 16;
  heart.sizes = sizes;
  heart.scale = pose.scale;
  heart.center = pose(frame.center);
  heart.local = {{pose.rotation * frame.to_septum, pose.rotation * frame.to_anterior, pose.rotation * frame.to_base}};
  heart.axes = transposed(pose.rotation);
  add_valves(heart, pose, frame);
  add_ventricles(heart, frame, pose);
  add_papillary_muscles(heart);
  add_atria(heart, pose, place);
  add_arteries(heart, place);
  add_coronaries(heart);
  return heart;
}

}  // namespace heartgen::phantom
