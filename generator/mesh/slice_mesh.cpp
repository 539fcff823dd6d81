// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/slice_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "generator/distmesh/balance_curves.hpp"
#include "generator/distmesh/distmesh.hpp"
#include "generator/distmesh/improve_triangles.hpp"
#include "generator/image/distance.hpp"
#include "generator/mesh/domain.hpp"
#include "generator/tetmesh/feature.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"

namespace heartgen::mesh {
namespace {

enum class Tissue : std::int32_t { outside = 0, myocardium = 1, cavities = 2, lungs = 3, torso = 4 };
// From 101: some readers keep one table of numbers and names for all dimensions.
enum class Curve : std::int32_t { endocardium = 101, epicardium, vessel_wall, lung_surface, skin, fov_cut };

const std::map<std::int32_t, std::string> tissue_names{
    {1, "myocardium"}, {2, "heart_cavities"}, {3, "lungs"}, {4, "torso"}};
const std::map<std::int32_t, std::string> curve_names{{101, "endocardium"},  {102, "epicardium"}, {103, "vessel_wall"},
                                                      {104, "lung_surface"}, {105, "skin"},       {106, "fov_cut"}};

// A region of each tissue stands for it in the domain, so that its rules apply: blood, then walls, then the rest.
constexpr std::array stand_in{Region::none, Region::lv_myocardium, Region::lv_blood, Region::lung, Region::torso};

Tissue tissue_of(std::uint8_t label) {
  const auto region = static_cast<Region>(label);
  if (region == Region::none) return Tissue::outside;
  if (is_myocardium(region)) return Tissue::myocardium;
  if (is_blood(region)) return Tissue::cavities;
  return region == Region::lung ? Tissue::lungs : Tissue::torso;
}

Tissue tissue_of_stand_in(int label) {
  return static_cast<Tissue>(std::find(stand_in.begin(), stand_in.end(), static_cast<Region>(label)) -
                             stand_in.begin());
}

Curve curve_between(Tissue a, Tissue b) {
  const auto is_one = [&](Tissue t) { return a == t || b == t; };
  if (is_one(Tissue::myocardium)) return is_one(Tissue::cavities) ? Curve::endocardium : Curve::epicardium;
  if (is_one(Tissue::cavities)) return Curve::vessel_wall;
  return is_one(Tissue::lungs) ? Curve::lung_surface : Curve::skin;
}

void check_settings(const SliceSettings& s) {
  for (const auto& [name, value] : {std::pair{"edge", s.edge_mm},
                                    {"torso edge", s.torso_edge_mm},
                                    {"growth", s.growth},
                                    {"smoothing", s.smoothing_mm}})
    if (!(value > 0) || !std::isfinite(value))
      throw UserError(fmt::format("the {} is {}", name, value), "slice", "it must be a positive number");
  if (s.torso_edge_mm < s.edge_mm)
    throw UserError(fmt::format("the torso edge {} mm is below the edge {} mm", s.torso_edge_mm, s.edge_mm), "slice",
                    "the edge length grows away from the heart");
  if (s.iterations < 1) throw UserError("no iterations", "slice", "give at least 1");
}

LabelVolume four_tissues(const LabelVolume& labels, std::int64_t index) {
  if (index < 0 || index >= labels.grid.size[2])
    throw UserError(fmt::format("there is no slice {}", index), "slice",
                    fmt::format("the label map has slices 0 to {}", labels.grid.size[2] - 1));
  Grid grid = labels.grid;
  grid.size[2] = 1;
  grid.origin_mm = lps_from_index(labels.grid, {0, 0, static_cast<double>(index)});
  LabelVolume slice(grid);
  const auto* voxels = &labels(0, 0, index);
  for (std::size_t v = 0; v < slice.voxels.size(); ++v) {
    if (voxels[v] > tag(Region::torso))
      throw UserError(fmt::format("label {} is not a known region", voxels[v]), "label map",
                      "labels are the region tags 0 to 17");
    slice.voxels[v] = tag(stand_in[static_cast<std::size_t>(tissue_of(voxels[v]))]);
  }
  if (std::all_of(slice.voxels.begin(), slice.voxels.end(), [](auto v) { return v == 0; }))
    throw UserError(fmt::format("slice {} has no labelled pixel", index), "label map", "choose another slice");
  return slice;
}

Vec3 index_of(const Grid& grid, const Vec3& p) { return {p.x / grid.spacing_mm.x, p.y / grid.spacing_mm.y, 0}; }

Mask muscle_of(const LabelVolume& tissues) {
  Mask muscle(tissues.grid, 0);
  for (std::size_t v = 0; v < muscle.voxels.size(); ++v)
    muscle.voxels[v] = tissues.voxels[v] == tag(Region::lv_myocardium);
  return muscle;
}

// Grows with the distance from the muscle.
double whole_edge_mm(const SliceSettings& settings, float from_muscle_mm) {
  return std::min(settings.torso_edge_mm, settings.edge_mm + settings.growth * static_cast<double>(from_muscle_mm));
}

// Before the work: equilateral triangles of the wanted edges, and as many again at interfaces.
void refuse_too_many(const LabelVolume& tissues, const SliceSettings& settings) {
  constexpr double max_triangles = 2e7, at_interfaces = 2;
  const auto from_muscle = image::distance_to(muscle_of(tissues));
  const double pixel_mm2 = tissues.grid.spacing_mm.x * tissues.grid.spacing_mm.y;
  double triangles = 0;
  for (std::size_t v = 0; v < tissues.voxels.size(); ++v) {
    const double edge = whole_edge_mm(settings, from_muscle.voxels[v]);
    if (tissues.voxels[v] != 0) triangles += at_interfaces * pixel_mm2 / (0.25 * std::numbers::sqrt3 * edge * edge);
  }
  if (triangles > max_triangles)
    throw UserError(fmt::format("an edge of {} mm gives about {:.1g} triangles", settings.edge_mm, triangles), "slice",
                    fmt::format("give a longer edge: at most {:.0g} triangles are made", max_triangles));
}

/// Labels and wanted edges on a grid about as fine as the edges.
struct FineSlice {
  LabelVolume labels;
  Volume<float> edge_mm;  ///< positions along the grid's axes in mm, as in the materials
};

LabelVolume fine_labels(const MeshDomain& domain, double edge_mm) {
  constexpr std::int64_t max_samples = 6'000'000;
  const auto& coarse = domain.grid;
  std::int64_t factor = 1;
  const double pixel = std::min(coarse.spacing_mm.x, coarse.spacing_mm.y);
  while (pixel / static_cast<double>(factor) > edge_mm &&
         coarse.size[0] * coarse.size[1] * (factor + 1) * (factor + 1) <= max_samples)
    ++factor;
  const auto f = static_cast<double>(factor);
  Grid grid;
  grid.size = {coarse.size[0] * factor, coarse.size[1] * factor, 1};
  grid.spacing_mm = {coarse.spacing_mm.x / f, coarse.spacing_mm.y / f, 1};
  grid.origin_mm = {0.5 * (grid.spacing_mm.x - coarse.spacing_mm.x), 0.5 * (grid.spacing_mm.y - coarse.spacing_mm.y),
                    0};
  LabelVolume labels(grid);
  for (std::int64_t j = 0; j < grid.size[1]; ++j)
    for (std::int64_t i = 0; i < grid.size[0]; ++i)
      labels(i, j, 0) = region_at(
          domain, index_of(coarse, lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), 0})));
  return labels;
}

Mask beside_interfaces(const LabelVolume& labels) {
  Mask mask(labels.grid, 0);
  const auto& size = labels.grid.size;
  for (std::int64_t j = 0; j < size[1]; ++j)
    for (std::int64_t i = 0; i < size[0]; ++i) {
      if (i + 1 < size[0] && labels(i, j, 0) != labels(i + 1, j, 0)) mask(i, j, 0) = mask(i + 1, j, 0) = 1;
      if (j + 1 < size[1] && labels(i, j, 0) != labels(i, j + 1, 0)) mask(i, j, 0) = mask(i, j + 1, 0) = 1;
    }
  return mask;
}

constexpr double interface_growth = 0.25;  // of the edge per mm of distance from an interface, until it is whole

// Parts of a tissue in which no disc of the radius fits get the edge `edge_mm`, and it grows from there. The discs'
// centres are the places farther than the radius from every interface. Corners of thick parts are spared by the factor.
void lower_in_thin_parts(Volume<float>& edges, const Volume<float>& from_interface, double radius_mm, double edge_mm) {
  constexpr double beyond_corners = 2;
  Mask centers(edges.grid, 0), thin(edges.grid, 0);
  for (std::size_t v = 0; v < centers.voxels.size(); ++v)
    centers.voxels[v] = static_cast<double>(from_interface.voxels[v]) >= radius_mm;
  const auto from_centers = image::distance_to(centers);
  for (std::size_t v = 0; v < thin.voxels.size(); ++v)
    thin.voxels[v] = static_cast<double>(from_centers.voxels[v]) > beyond_corners * radius_mm;
  const auto from_thin = image::distance_to(thin);
  for (std::size_t v = 0; v < thin.voxels.size(); ++v) {
    const double edge = edge_mm + interface_growth * static_cast<double>(from_thin.voxels[v]);
    edges.voxels[v] = std::min(edges.voxels[v], static_cast<float>(edge));
  }
}

// Half the width of a part is two edges at least (a disc of that radius has twelve sides), and one where that asks for
// edges below a pixel.
void resolve_thin_parts(FineSlice& fine, const Volume<float>& from_interface, double pixel_mm, double torso_edge_mm) {
  const double half_sample = 0.5 * std::min(fine.labels.grid.spacing_mm.x, fine.labels.grid.spacing_mm.y);
  const double finest = 0.5 * pixel_mm;
  double edge = 0.5 * torso_edge_mm;
  while (edge > finest) {
    const double edges_in_half_width = edge > pixel_mm ? 2 : 1;
    const double radius = std::max(edges_in_half_width * edge - half_sample, half_sample);
    edge /= 2;
    lower_in_thin_parts(fine.edge_mm, from_interface, radius, std::max(edge, finest));
  }
}

// Thesis 8.3.1: grows continuously with the distance from the muscle, and is halved towards every interface.
FineSlice fine_slice(const MeshDomain& domain, const SliceSettings& settings) {
  FineSlice fine{fine_labels(domain, settings.edge_mm), {}};
  const Grid& grid = fine.labels.grid;
  const auto from_muscle = image::distance_to(muscle_of(fine.labels));
  const auto from_interface = image::distance_to(beside_interfaces(fine.labels));
  fine.edge_mm = Volume<float>(grid);
  for (std::size_t v = 0; v < fine.edge_mm.voxels.size(); ++v) {
    const double whole = whole_edge_mm(settings, from_muscle.voxels[v]);
    const double beside = 0.5 * whole + interface_growth * static_cast<double>(from_interface.voxels[v]);
    fine.edge_mm.voxels[v] = static_cast<float>(std::min(whole, beside));
  }
  resolve_thin_parts(fine, from_interface, std::min(domain.grid.spacing_mm.x, domain.grid.spacing_mm.y),
                     settings.torso_edge_mm);
  return fine;
}

tetmesh::Materials materials_of(const MeshDomain& domain, const FineSlice& fine) {
  const Grid& grid = domain.grid;
  tetmesh::Materials materials;
  materials.box_min_mm = {-0.5 * grid.spacing_mm.x, -0.5 * grid.spacing_mm.y, -distmesh::unbounded_mm};
  materials.box_max_mm = {(static_cast<double>(grid.size[0]) - 0.5) * grid.spacing_mm.x,
                          (static_cast<double>(grid.size[1]) - 0.5) * grid.spacing_mm.y, distmesh::unbounded_mm};
  materials.label_at = [&domain](const Vec3& p) { return region_at(domain, index_of(domain.grid, p)); };
  materials.edge_mm = [&fine](const Vec3& p) {
    return sample_linear(fine.edge_mm, index_from_lps(fine.edge_mm.grid, {p.x, p.y, 0}));
  };
  materials.equations_at = [&domain](tetmesh::LabelBits labels, const Vec3& p, std::span<tetmesh::Equation> equations) {
    std::array<SurfaceEquation, tetmesh::max_equations> found;
    const int count = equations_at(domain, labels, index_of(domain.grid, p), std::span(found).first(equations.size()));
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      equations[i] = {found[i].value, {found[i].gradient.x, found[i].gradient.y, 0}};
    return count;
  };
  return materials;
}

/// An edge between two tissues or at the end of the mesh.
struct Border {
  std::array<std::int32_t, 2> nodes;
  distmesh::LabelBits bits;  ///< of what meets there
};

std::vector<Border> borders_of(const distmesh::Triangles& mesh) {
  std::vector<Border> borders;
  for (std::size_t t = 0; t < mesh.corners.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = mesh.corners[t][i], b = mesh.corners[t][(i + 1) % 3];
      const auto both = distmesh::triangles_at(mesh, a, b);
      const auto other = both[0] == static_cast<std::int32_t>(t) ? both[1] : both[0];
      const int label = mesh.label[t];
      if (other < 0) {
        const auto sides = mesh.bits(a) & mesh.bits(b) & tetmesh::side_bits;
        borders.push_back({{a, b}, tetmesh::bit_of(label) | (sides != 0 ? sides : tetmesh::bit_of(0))});
      } else if (label < mesh.label_of(other)) {
        borders.push_back({{a, b}, tetmesh::bit_of(label) | tetmesh::bit_of(mesh.label_of(other))});
      }
    }
  return borders;
}

Curve curve_of(distmesh::LabelBits bits) {
  if ((bits & tetmesh::side_bits) != 0) return Curve::fov_cut;
  const int low = std::countr_zero(bits), high = std::countr_zero(bits & (bits - 1));
  return curve_between(tissue_of_stand_in(low), tissue_of_stand_in(high));
}

TriMesh collect(const distmesh::Triangles& mesh, const Grid& grid) {
  TriMesh result;
  for (const auto& p : mesh.nodes_mm) result.nodes_mm.push_back(lps_from_index(grid, index_of(grid, p)));
  result.triangles = mesh.corners;
  for (const auto label : mesh.label)
    result.region.push_back(static_cast<std::int32_t>(tissue_of_stand_in(static_cast<int>(label))));
  for (const auto& border : borders_of(mesh)) {
    result.edges.push_back(border.nodes);
    result.curve.push_back(static_cast<std::int32_t>(curve_of(border.bits)));
  }
  const auto keep_used = [](const auto& names, const auto& used) {
    auto kept = names;
    std::erase_if(kept, [&](const auto& name) { return std::ranges::count(used, name.first) == 0; });
    return kept;
  };
  result.region_names = keep_used(tissue_names, result.region);
  result.curve_names = keep_used(curve_names, result.curve);
  return result;
}

void measure_angles(const distmesh::Triangles& mesh, SliceReport& report) {
  constexpr double least = 28, greatest = 120;
  report.min_angle_deg = 180;
  for (const auto& corners : mesh.corners) {
    bool is_outside = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 a = mesh.at(corners[i]), u = mesh.at(corners[(i + 1) % 3]) - a, v = mesh.at(corners[(i + 2) % 3]) - a;
      const double angle = math::atan2(u.x * v.y - u.y * v.x, dot(u, v)) * 180 / std::numbers::pi;
      report.min_angle_deg = std::min(report.min_angle_deg, angle);
      report.greatest_angle_deg = std::max(report.greatest_angle_deg, angle);
      is_outside = is_outside || angle < least || angle > greatest;
    }
    report.outside_bounds += is_outside;
  }
}

void measure_distances(const distmesh::Triangles& mesh, const tetmesh::Materials& materials, SliceReport& report) {
  std::vector<double> distances;
  for (const auto& [nodes, bits] : borders_of(mesh)) {
    const Vec3 a = mesh.at(nodes[0]), b = mesh.at(nodes[1]);
    for (const auto& p : {a, 0.5 * (a + b), b})
      distances.push_back(tetmesh::distance_to(tetmesh::feature_at(materials, bits, p)) / norm(b - a));
  }
  std::sort(distances.begin(), distances.end());
  if (distances.empty()) return;
  report.distance_p99 = distances[(distances.size() - 1) * 99 / 100];
  report.distance_max = distances.back();
}

void measure_areas(const distmesh::Triangles& mesh, const LabelVolume& fine, SliceReport& report) {
  const auto name_of = [](int label) { return tissue_names.at(static_cast<std::int32_t>(tissue_of_stand_in(label))); };
  for (std::size_t t = 0; t < mesh.corners.size(); ++t) {
    const auto& c = mesh.corners[t];
    const Vec3 u = mesh.at(c[1]) - mesh.at(c[0]), v = mesh.at(c[2]) - mesh.at(c[0]);
    report.area_mm2[name_of(mesh.label[t])] += 0.5 * (u.x * v.y - u.y * v.x);
  }
  for (const auto label : fine.voxels)
    if (label != 0) report.curve_area_mm2[name_of(label)] += fine.grid.spacing_mm.x * fine.grid.spacing_mm.y;
}

}  // namespace

std::int64_t slice_at_height(const Grid& grid, double z_mm) {
  const double first = grid.origin_mm.z;
  const double step = lps_from_index(grid, {0, 0, 1}).z - first;
  const double index = std::abs(step) > 0 ? (z_mm - first) / step : 0;
  const auto nearest = static_cast<std::int64_t>(std::llround(index));
  if (!std::isfinite(z_mm) || nearest < 0 || nearest >= grid.size[2])
    throw UserError(fmt::format("no slice at z = {} mm", z_mm), "slice --z",
                    fmt::format("the label map reaches from {:.1f} to {:.1f} mm", first,
                                first + step * static_cast<double>(grid.size[2] - 1)));
  return nearest;
}

TriMesh mesh_slice(const LabelVolume& labels, std::int64_t index, const SliceSettings& settings, SliceReport* report) {
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  check_settings(settings);
  const auto start = Clock::now();
  const auto tissues = four_tissues(labels, index);
  refuse_too_many(tissues, settings);
  const auto domain = make_domain(tissues, settings.smoothing_mm);
  const auto fine = fine_slice(domain, settings);
  const auto materials = materials_of(domain, fine);
  auto truss_settings = distmesh::default_settings(distmesh::Dimension::two);
  truss_settings.iterations = settings.iterations;
  const double min_edge = static_cast<double>(*std::ranges::min_element(fine.edge_mm.voxels));
  auto mesh = distmesh::triangles_of(distmesh::relax(materials, distmesh::Dimension::two, min_edge, truss_settings));
  const double truss_seconds = seconds_since(start);
  const distmesh::TriangleGoal goal;
  distmesh::improve_triangles(mesh, materials, goal);
  distmesh::balance_curves(mesh, materials, goal.angle_deg);
  if (report != nullptr) {
    *report = {};
    report->seconds_truss = truss_seconds;
    report->seconds_improve = seconds_since(start) - truss_seconds;
    measure_angles(mesh, *report);
    measure_distances(mesh, materials, *report);
    measure_areas(mesh, fine.labels, *report);
  }
  return collect(mesh, domain.grid);
}

}  // namespace heartgen::mesh
