// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/contour_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "model/labels.hpp"
#include "model/mathematics.hpp"
#include "model/mesh_queries/face_tree.hpp"
#include "validation/criteria.hpp"
#include "validation/quantiles.hpp"

namespace heartgen::validation {
namespace {

struct OrientedFace {
  Vec3 center_mm, outward;
};

using Keyed = std::pair<Face, std::pair<std::int32_t, double>>;  ///< sorted nodes; region, side of the cell's apex

double apex_side(const TetMesh& mesh, const Face& key, std::int32_t apex) {
  const auto at = [&](std::int32_t n) { return mesh.nodes_mm[static_cast<std::size_t>(n)]; };
  const Vec3 normal = cross(at(key[1]) - at(key[0]), at(key[2]) - at(key[0]));
  return dot(normal, at(apex) - at(key[0])) > 0 ? 1 : -1;
}

/// Cells' faces that are among the labelled ones, sorted by key.
std::vector<Keyed> labelled_halves(const TetMesh& mesh) {
  std::vector<Face> wanted;
  std::vector<std::uint8_t> on_face(mesh.nodes_mm.size(), 0);
  for (Face f : mesh.faces) {
    std::sort(f.begin(), f.end());
    wanted.push_back(f);
    for (const auto n : f) on_face[static_cast<std::size_t>(n)] = 1;
  }
  std::sort(wanted.begin(), wanted.end());
  std::vector<Keyed> halves;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t apex = 0; apex < 4; ++apex) {
      Face key{};
      std::size_t k = 0;
      for (std::size_t i = 0; i < 4; ++i)
        if (i != apex) key[k++] = mesh.cells[c][i];
      const auto marked = [&](std::int32_t n) { return on_face[static_cast<std::size_t>(n)] != 0; };
      if (!std::all_of(key.begin(), key.end(), marked)) continue;
      std::sort(key.begin(), key.end());
      if (!std::binary_search(wanted.begin(), wanted.end(), key)) continue;
      halves.push_back({key, {mesh.region[c], apex_side(mesh, key, mesh.cells[c][apex])}});
    }
  std::sort(halves.begin(), halves.end());
  return halves;
}

/// Outward is away from the only cell, or from the smaller to the larger region tag at an interface.
OrientedFace orient(const TetMesh& mesh, Face key, const std::vector<Keyed>& halves) {
  std::sort(key.begin(), key.end());
  const auto at = [&](std::int32_t n) { return mesh.nodes_mm[static_cast<std::size_t>(n)]; };
  OrientedFace face;
  face.center_mm = (at(key[0]) + at(key[1]) + at(key[2])) / 3;
  const Vec3 normal = normalized(cross(at(key[1]) - at(key[0]), at(key[2]) - at(key[0])));
  // The first half of a pair has the smaller region tag: its apex lies inside.
  const auto half = std::lower_bound(halves.begin(), halves.end(), Keyed{key, {INT32_MIN, -2}});
  const double inside = half != halves.end() && half->first == key ? half->second.second : -1;
  face.outward = -inside * normal;
  return face;
}

/// How far along its normal, inwards and outwards, a step in grey can be a face's own: half the way to the nearest face
/// of another surface on that side, since beyond it the step is that surface's.
struct Reach {
  double inwards_mm, outwards_mm;
};

Reach reach_of(const OrientedFace& face, const mesh_queries::FaceTree& tree, const TetMesh& mesh, std::int32_t surface,
               double reach_mm) {
  Reach reach{reach_mm, reach_mm};
  const auto other = mesh_queries::nearest_face(tree, face.center_mm, 2 * reach_mm, [&](std::int32_t f) {
    return mesh.surface[static_cast<std::size_t>(f)] != surface;
  });
  if (other.face < 0) return reach;
  auto& side_mm = dot(other.point_mm - face.center_mm, face.outward) > 0 ? reach.outwards_mm : reach.inwards_mm;
  side_mm = std::min(side_mm, other.distance_mm / 2);
  return reach;
}

/// Position along the normal (mm, positive outside) of the steepest grey step within reach, or nothing where all are
/// weak. A step is a place where the slope has a maximum: what still rises where the reach ends is another's.
std::optional<double> strongest_edge(const CtVolume& ct, const OrientedFace& face, const Reach& reach,
                                     const ContourFitSettings& s) {
  const int half = std::max(1, static_cast<int>(std::lround(s.reach_mm / s.step_mm)));
  std::vector<double> grey, slope;
  for (int i = -half - 2; i <= half + 2; ++i)
    grey.push_back(sample_linear(ct, index_from_lps(ct.grid, face.center_mm + (i * s.step_mm) * face.outward)));
  for (std::size_t i = 1; i + 1 < grey.size(); ++i)
    slope.push_back(std::abs(grey[i + 1] - grey[i - 1]) / (2 * s.step_mm));
  const auto slope_at = [&](int i) { return slope[static_cast<std::size_t>(half + 1 + i)]; };
  // Of equally steep places the one nearest to the surface: the list is scanned from the middle outwards.
  std::optional<int> best;
  for (int off = 0; off <= half; ++off)
    for (const int i : {-off, off}) {
      if (-i * s.step_mm > reach.inwards_mm || i * s.step_mm > reach.outwards_mm) continue;
      if (slope_at(i) < slope_at(i - 1) || slope_at(i) < slope_at(i + 1)) continue;
      if (!best || slope_at(i) > slope_at(*best) * (1 + 1e-12)) best = i;
    }
  if (!best || slope_at(*best) < s.minimum_edge_hu_per_mm) return std::nullopt;
  double shift = 0;
  const double before = slope_at(*best - 1), after = slope_at(*best + 1);
  const double bend = before - 2 * slope_at(*best) + after;
  if (bend < 0) shift = std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
  return (*best + shift) * s.step_mm;
}

bool inside_image(const Grid& grid, const Vec3& p) {
  const Vec3 index = index_from_lps(grid, p);
  for (int a = 0; a < 3; ++a)
    if (index[a] < 1 || index[a] > static_cast<double>(grid.size[static_cast<std::size_t>(a)]) - 2) return false;
  return true;
}

void add_rows(Report& report, const std::string& scope, const std::vector<double>& distance_mm, std::size_t tried,
              double voxel_mm) {
  const auto add = [&](const std::string& metric, double value, const std::string& unit) {
    report.push_back({"fit", scope, metric, value, unit, {}, {}});
  };
  add("edge_found", tried ? static_cast<double>(distance_mm.size()) / static_cast<double>(tried) : 0, "1");
  if (distance_mm.empty()) return;
  std::vector<double> absolute;
  absolute.reserve(distance_mm.size());
  for (const double d : distance_mm) absolute.push_back(std::abs(d));
  const std::pair<std::string, double> figures[] = {{"edge_distance_median", quantile(distance_mm, 0.5)},
                                                    {"edge_distance_p95", quantile(absolute, 0.95)},
                                                    {"edge_distance_max", quantile(absolute, 1)}};
  for (const auto& [metric, value] : figures) {
    add(metric, value, "mm");
    add(metric + "_voxels", value / voxel_mm, "voxel");
  }
}

}  // namespace

Report check_contour_fit(const TetMesh& mesh, const CtVolume& ct, const ContourFitSettings& settings) {
  std::map<std::int32_t, std::vector<std::size_t>> faces_of;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) faces_of[mesh.surface[f]].push_back(f);
  const auto halves = labelled_halves(mesh);
  const auto tree = mesh_queries::make_face_tree(mesh.nodes_mm, mesh.faces);
  const double voxel_mm = math::cbrt(ct.grid.voxel_volume_mm3());
  Report report;
  for (const auto& [surface, faces] : faces_of) {
    const std::size_t stride =
        std::max<std::size_t>(1, faces.size() / std::max<std::size_t>(1, settings.samples_per_surface));
    std::vector<double> distances;
    std::size_t tried = 0;
    for (std::size_t i = 0; i < faces.size(); i += stride) {
      const OrientedFace face = orient(mesh, mesh.faces[faces[i]], halves);
      if (!inside_image(ct.grid, face.center_mm)) continue;
      ++tried;
      const Reach reach = reach_of(face, tree, mesh, surface, settings.reach_mm);
      if (const auto d = strongest_edge(ct, face, reach, settings)) distances.push_back(*d);
    }
    add_rows(report, surface_name(surface), distances, tried, voxel_mm);
  }
  return judged(std::move(report), {});
}

}  // namespace heartgen::validation
