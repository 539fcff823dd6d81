#include "generator/app/fiber_accuracy_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "datasets/phantom/phantom.hpp"
#include "generator/atlas/resample.hpp"
#include "generator/fibers/hearts.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heart::app {
namespace {

using Json = nlohmann::json;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

struct Patient {
  std::string name;
  datasets::HeartModel model;
  LabelVolume labels;
  Landmarks landmarks;
};

Vec3 center_of(const Grid& grid, std::size_t v) { return atlas::voxel_center(grid, static_cast<std::int64_t>(v)); }

/// region_at on a cube around the heart.
LabelVolume exact_labels(const datasets::HeartModel& model, const Landmarks& marks, double spacing_mm) {
  constexpr double half_mm = 95;
  const Vec3 middle = 0.5 * (marks.seeds_mm.at("lv_blood") + marks.seeds_mm.at("rv_blood"));
  Grid grid;
  const auto count = static_cast<std::int64_t>(2 * half_mm / spacing_mm);
  grid.size = {count, count, count};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  grid.origin_mm = middle - Vec3{half_mm, half_mm, half_mm};
  LabelVolume labels(grid);
  parallel::parallel_for(0, grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v)
      labels.voxels[v] = tag(datasets::region_at(model, center_of(grid, v)));
  });
  return labels;
}

/// Ventricles alone, up to a plane `below_mm` under the mitral valve and tilted against the long axis: what other
/// people's segmentations look like.
void cut_labels(Patient& patient, double below_mm, double tilt_deg) {
  const Vec3 up = datasets::long_axis(patient.model);
  const Vec3 side = normalized(cross(up, Vec3{0, 0, 1}));
  const double tilt = tilt_deg * std::numbers::pi / 180;
  const Vec3 normal = std::cos(tilt) * up + std::sin(tilt) * side;
  const Vec3 point = patient.landmarks.valves.at("mitral").center_mm - below_mm * up;
  for (std::size_t v = 0; v < patient.labels.voxels.size(); ++v) {
    auto& label = patient.labels.voxels[v];
    const auto region = static_cast<Region>(label);
    const bool ventricle = region == Region::lv_myocardium || region == Region::rv_myocardium ||
                           region == Region::papillary || region == Region::lv_blood || region == Region::rv_blood;
    if (!ventricle || dot(center_of(patient.labels.grid, v) - point, normal) > 0) label = 0;
  }
  patient.landmarks = {};
}

Patient make_patient(const std::string& name, double spacing_mm) {
  constexpr double flat_cut_mm = 6;  // below the valves' plates
  Patient patient;
  patient.name = name;
  int variant = 1;
  datasets::HeartOverrides overrides;
  if (name == "thick") {
    overrides.lv_wall_mm = 14;
  } else if (name == "dilated") {
    overrides.lv_wall_mm = 7;
  } else if (name != "cut" && name != "tilted") {
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), variant);
    if (error != std::errc{} || end != name.data() + name.size())
      throw UserError(fmt::format("\"{}\" is no phantom", name), "--cases",
                      "give variants and the words thick, dilated, cut, tilted");
  }
  patient.model = datasets::make_heart_model(variant, overrides);
  patient.landmarks = datasets::landmarks_of(patient.model);
  patient.labels = exact_labels(patient.model, patient.landmarks, spacing_mm);
  if (name == "cut") cut_labels(patient, 12, 0);
  if (name == "tilted") cut_labels(patient, flat_cut_mm, 15);
  return patient;
}

atlas::AtlasImage phantom_atlas(double spacing_mm) {
  const auto model = datasets::make_heart_model();
  const auto marks = datasets::landmarks_of(model);
  const auto labels = exact_labels(model, marks, spacing_mm);
  Volume<Vec3> fiber(labels.grid);
  parallel::parallel_for(0, labels.grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v)
      if (labels.voxels[v] == tag(Region::lv_myocardium) || labels.voxels[v] == tag(Region::rv_myocardium))
        fiber.voxels[v] = datasets::fiber_at(model, center_of(labels.grid, v));
  });
  return atlas::image_of_labels(labels, fiber, marks, spacing_mm);
}

atlas::AtlasImage atlas_image(const std::string& name, double spacing_mm) {
  if (name == "phantom") return phantom_atlas(spacing_mm);
  if (name != "stand-in") return atlas::image_of_atlas(atlas::read_fiber_atlas(name), spacing_mm);
  const auto mesh = datasets::make_standin_atlas();
  return atlas::image_of_atlas(atlas::make_fiber_atlas(name, mesh.nodes_mm, mesh.cells, mesh.node_fibers.fiber),
                               spacing_mm);
}

/// The voxels of both walls where the phantom has fibres.
struct KnownAxes {
  std::vector<Vec3> points_mm, axis;
  std::vector<std::uint8_t> left;
};

KnownAxes known_axes(const Patient& patient) {
  KnownAxes known;
  for (std::size_t v = 0; v < patient.labels.voxels.size(); ++v) {
    const bool left = patient.labels.voxels[v] == tag(Region::lv_myocardium);
    if (!left && patient.labels.voxels[v] != tag(Region::rv_myocardium)) continue;
    const Vec3 p = center_of(patient.labels.grid, v);
    const Vec3 axis = datasets::fiber_at(patient.model, p);
    if (norm(axis) < 0.5) continue;
    known.points_mm.push_back(p);
    known.axis.push_back(axis);
    known.left.push_back(left);
  }
  return known;
}

struct Errors {
  double mean_deg = 0, p95_deg = 0, cover = 0;
};

Errors errors_of(const KnownAxes& known, const std::vector<atlas::AxisTensor>& carried, bool left) {
  std::vector<double> angles_deg;
  double all = 0;
  for (std::size_t n = 0; n < carried.size(); ++n) {
    if ((known.left[n] != 0) != left) continue;
    ++all;
    if (trace(carried[n]) <= 0) continue;
    const double cosine = std::abs(dot(known.axis[n], atlas::leading_axis(carried[n])));
    angles_deg.push_back(std::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi);
  }
  if (angles_deg.empty()) return {};
  double sum = 0;
  for (const double a : angles_deg) sum += a;
  std::sort(angles_deg.begin(), angles_deg.end());
  const auto count = static_cast<double>(angles_deg.size());
  return {sum / count, angles_deg[(angles_deg.size() - 1) * 95 / 100], count / all};
}

Json row_of(const std::string& name, const std::string& method, const Errors& lv, const Errors& rv, double seconds) {
  return {
      {"case", name},         {"method", method},           {"lv_mean_deg", lv.mean_deg}, {"lv_p95_deg", lv.p95_deg},
      {"lv_cover", lv.cover}, {"rv_mean_deg", rv.mean_deg}, {"rv_p95_deg", rv.p95_deg},   {"rv_cover", rv.cover},
      {"seconds", seconds}};
}

void print_row(const Json& r) {
  const auto value = [&](const char* key) { return r[key].get<double>(); };
  fmt::print("{:10} {:13} {:6.2f} {:6.1f} {:6.0f}   {:6.2f} {:6.1f} {:6.0f}   {:6.1f}\n", r["case"].get<std::string>(),
             r["method"].get<std::string>(), value("lv_mean_deg"), value("lv_p95_deg"), 100 * value("lv_cover"),
             value("rv_mean_deg"), value("rv_p95_deg"), 100 * value("rv_cover"), value("seconds"));
  std::fflush(stdout);
}

void check_methods(const std::vector<std::string>& methods) {
  for (const auto& method : methods)
    if (method != "local_angles" && method != "coordinates" && method != "jacobian")
      throw UserError(fmt::format("unknown method \"{}\"", method), "--methods",
                      "use local_angles, coordinates, jacobian");
}

}  // namespace

int fiber_accuracy_command(const FiberAccuracyCommand& command) {
  check_methods(command.methods);
  if (!(command.spacing_mm >= 0.5 && command.spacing_mm <= 3))
    throw UserError("the spacing of the labels is out of range", "--spacing", "give 0.5 to 3 mm");
  FiberSettings settings;
  settings.depth_grid_mm = command.spacing_mm;  // as the labels are: what resampling costs is not measured here
  settings.grid_mm = std::max(settings.grid_mm, command.spacing_mm);
  const auto atlas = atlas_image(command.atlas, settings.depth_grid_mm);
  if (!command.json) fmt::print("axis error, degrees         LV mean    p95  cover  RV mean    p95  cover  seconds\n");
  Json rows = Json::array();
  for (const auto& name : command.cases) {
    const Patient patient = make_patient(name, command.spacing_mm);
    const KnownAxes known = known_axes(patient);
    const double start_s = now_s();
    const auto hearts = fibers::prepare_hearts(patient.labels, patient.landmarks, atlas, command.atlas, settings);
    const auto walls =
        fibers::point_walls(hearts, known.points_mm, std::vector<std::uint8_t>(known.points_mm.size(), 1));
    const auto atlas_mm = fibers::atlas_positions(hearts, known.points_mm);
    const double prepared_s = now_s() - start_s;
    for (const auto& method : command.methods) {
      const double method_s = now_s();
      const auto carried = fibers::carried_axes(hearts, walls, known.points_mm, atlas_mm, method);
      const double seconds = prepared_s + now_s() - method_s;
      rows.push_back(row_of(name, method, errors_of(known, carried, true), errors_of(known, carried, false), seconds));
      if (!command.json) print_row(rows.back());
    }
  }
  if (command.json) fmt::print("{}\n", rows.dump(2));
  return 0;
}

}  // namespace heart::app
