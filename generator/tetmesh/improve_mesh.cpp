// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/improve_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/orient.hpp"
#include "generator/tetmesh/quality.hpp"
#include "generator/tetmesh/repair.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"
#include "model/mesh_queries/face_tree.hpp"

namespace heartgen::tetmesh {
namespace {

/// A face between two labels (0: the outside), ascending nodes, normal from the smaller label to the larger.
struct SurfaceFace {
  Face nodes;
  LabelBits labels;
  Vec3 normal;
};

std::vector<SurfaceFace> surface_faces(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells,
                                       const std::vector<std::uint8_t>& label) {
  std::vector<std::pair<Face, std::int32_t>> halves;
  halves.reserve(4 * cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i) {
      Face face{cells[c][(i + 1) % 4], cells[c][(i + 2) % 4], cells[c][(i + 3) % 4]};
      std::sort(face.begin(), face.end());
      halves.emplace_back(face, static_cast<std::int32_t>(c));
    }
  std::sort(halves.begin(), halves.end());
  std::vector<SurfaceFace> faces;
  for (std::size_t h = 0; h < halves.size();) {
    std::size_t end = h;
    while (end < halves.size() && halves[end].first == halves[h].first) ++end;
    if (end - h > 2)
      throw UserError(fmt::format("the face of nodes {}, {}, {} has {} cells", halves[h].first[0], halves[h].first[1],
                                  halves[h].first[2], end - h),
                      "mesh", "a face lies between two cells at most: remove repeated cells");
    const int one = label[static_cast<std::size_t>(halves[h].second)];
    const int other = end - h == 2 ? label[static_cast<std::size_t>(halves[h + 1].second)] : 0;
    if (one != other) {
      const auto at = [&](std::size_t i) { return nodes[static_cast<std::size_t>(halves[h].first[i])]; };
      const auto inner = halves[one < other ? h : end - 1].second;  // a cell of the smaller label, or at the outside
      Vec3 middle;
      for (const auto n : cells[static_cast<std::size_t>(inner)]) middle += 0.25 * nodes[static_cast<std::size_t>(n)];
      Vec3 normal = normalized(cross(at(1) - at(0), at(2) - at(0)));
      if (dot(normal, middle - at(0)) > 0) normal = -normal;
      faces.push_back({halves[h].first, bit_of(one) | bit_of(other), normal});
    }
    h = end;
  }
  return faces;
}

/// Nodes that must stay although surfaces may slide: on sharp edges, where more than two labels meet, and where the
/// surface is not one sheet.
std::vector<std::uint8_t> feature_nodes(std::size_t node_count, const std::vector<SurfaceFace>& faces,
                                        double feature_deg) {
  std::vector<std::uint8_t> stays(node_count, 0);
  std::vector<std::pair<std::pair<std::int32_t, std::int32_t>, std::size_t>> edges;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i)
      edges.push_back({std::minmax(faces[f].nodes[i], faces[f].nodes[(i + 1) % 3]), f});
  std::sort(edges.begin(), edges.end());
  const double min_cosine = math::cos(feature_deg * std::numbers::pi / 180);
  for (std::size_t e = 0; e < edges.size();) {
    std::size_t end = e;
    while (end < edges.size() && edges[end].first == edges[e].first) ++end;
    const auto& one = faces[edges[e].second];
    const auto& other = faces[edges[end - 1].second];
    if (end - e != 2 || one.labels != other.labels || dot(one.normal, other.normal) < min_cosine)
      stays[static_cast<std::size_t>(edges[e].first.first)] = stays[static_cast<std::size_t>(edges[e].first.second)] =
          1;
    e = end;
  }
  return stays;
}

/// Nodes where the surface bends by more than `max_mm` over one edge stay too: a flat face instead would cut that off.
void freeze_bends(const std::vector<Vec3>& nodes, const std::vector<SurfaceFace>& faces, double max_mm,
                  std::vector<std::uint8_t>& stays) {
  std::vector<std::pair<std::int32_t, std::size_t>> corners;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const auto n : faces[f].nodes) corners.emplace_back(n, f);
  std::sort(corners.begin(), corners.end());
  for (std::size_t c = 0; c < corners.size();) {
    std::size_t end = c;
    while (end < corners.size() && corners[end].first == corners[c].first) ++end;
    const auto n = static_cast<std::size_t>(corners[c].first);
    for (auto i = c; i < end && stays[n] == 0; ++i)
      for (auto j = c; j < end; ++j)
        for (const auto m : faces[corners[j].second].nodes)
          if (std::abs(dot(faces[corners[i].second].normal, nodes[static_cast<std::size_t>(m)] - nodes[n])) > max_mm)
            stays[n] = 1;
    c = end;
  }
}

/// The given surfaces, one tree for each pair of labels.
struct Surfaces {
  std::map<LabelBits, mesh_queries::FaceTree> trees;
  std::map<LabelBits, std::vector<Vec3>> normals;

  Surfaces(const std::vector<Vec3>& nodes, const std::vector<SurfaceFace>& faces) {
    std::map<LabelBits, std::vector<Face>> lists;
    for (const auto& face : faces) {
      lists[face.labels].push_back(face.nodes);
      normals[face.labels].push_back(face.normal);
    }
    for (const auto& [labels, list] : lists) trees[labels] = mesh_queries::make_face_tree(nodes, list);
  }
  /// The nearest place of the surface between two labels as the zero of a linear function.
  int equation(LabelBits labels, const Vec3& point, std::span<Equation> equations) const {
    const auto tree = trees.find(labels);
    if (tree == trees.end() || equations.empty()) return 0;
    constexpr double anywhere_mm = 1e9, on_it_mm = 1e-9;
    const auto nearest = mesh_queries::nearest_face(tree->second, point, anywhere_mm);
    const Vec3 way = point - nearest.point_mm;
    const bool is_on = nearest.distance_mm < on_it_mm;
    equations[0].value = is_on ? 0 : nearest.distance_mm;
    equations[0].gradient =
        is_on ? normals.at(labels)[static_cast<std::size_t>(nearest.face)] : way / nearest.distance_mm;
    return 1;
  }
  double distance_mm(LabelBits labels, const Vec3& point) const {
    std::array<Equation, 1> equation_here;
    return equation(labels, point, equation_here) == 0 ? 1e9 : equation_here[0].value;
  }
};

/// Both ways, at nodes, middles of edges and middles of faces.
double distance_between(const std::vector<Vec3>& old_nodes, const std::vector<SurfaceFace>& old_faces,
                        const std::vector<Vec3>& new_nodes, const std::vector<SurfaceFace>& new_faces) {
  double farthest = 0;
  const auto look = [&](const auto& nodes, const auto& faces, const Surfaces& other) {
    for (const auto& face : faces) {
      std::array<Vec3, 3> p;
      for (std::size_t i = 0; i < 3; ++i) p[i] = nodes[static_cast<std::size_t>(face.nodes[i])];
      for (std::size_t i = 0; i < 3; ++i) {
        farthest = std::max(farthest, other.distance_mm(face.labels, p[i]));
        farthest = std::max(farthest, other.distance_mm(face.labels, 0.5 * (p[i] + p[(i + 1) % 3])));
      }
      farthest = std::max(farthest, other.distance_mm(face.labels, (p[0] + p[1] + p[2]) / 3));
    }
  };
  look(new_nodes, new_faces, Surfaces(old_nodes, old_faces));
  look(old_nodes, old_faces, Surfaces(new_nodes, new_faces));
  return farthest;
}

std::vector<float> mean_edges(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells) {
  std::vector<double> sum(nodes.size(), 0), count(nodes.size(), 0);
  for (const auto& cell : cells)
    for (const auto a : cell)
      for (const auto b : cell) {
        if (a == b) continue;
        const auto at = static_cast<std::size_t>(a);
        sum[at] += norm(nodes[static_cast<std::size_t>(b)] - nodes[at]);
        count[at] += 1;
      }
  std::vector<float> result(nodes.size(), 1);
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (count[n] > 0) result[n] = static_cast<float>(sum[n] / count[n]);
  return result;
}

/// Labels 1, 2, ... for the regions, ascending.
struct RegionLabels {
  std::vector<std::int32_t> regions;
  std::vector<std::uint8_t> label;
};

RegionLabels label_regions(std::size_t cells, const std::vector<std::int32_t>& region) {
  RegionLabels result;
  result.label.assign(cells, 1);
  result.regions = region;
  std::sort(result.regions.begin(), result.regions.end());
  result.regions.erase(std::unique(result.regions.begin(), result.regions.end()), result.regions.end());
  if (result.regions.size() >= first_side)
    throw UserError(fmt::format("there are {} regions", result.regions.size()), "mesh",
                    fmt::format("at most {} can be improved together", first_side - 1));
  for (std::size_t c = 0; c < region.size(); ++c)
    result.label[c] = static_cast<std::uint8_t>(
        1 + (std::lower_bound(result.regions.begin(), result.regions.end(), region[c]) - result.regions.begin()));
  return result;
}

void check(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells, const ImproveSettings& s) {
  if (!(s.goal_deg >= 1 && s.goal_deg <= 40))
    throw UserError(fmt::format("{} degrees", s.goal_deg), "--goal-deg", "choose 1 to 40");
  if (!(s.slide_mm >= 0) || !(s.feature_deg > 0) || s.budget < 0)
    throw UserError("must not be negative", "--slide, --feature-deg, --budget", "give positive numbers");
  for (const auto& cell : cells)
    for (const auto n : cell)
      if (n < 0 || static_cast<std::size_t>(n) >= nodes.size())
        throw UserError(fmt::format("a cell names node {}, but there are {}", n, nodes.size()), "mesh",
                        "write the mesh again");
}

Complex make_complex(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells,
                     const std::vector<std::uint8_t>& label, const std::vector<SurfaceFace>& faces) {
  Complex complex;
  complex.nodes_mm = nodes;
  complex.cells = cells;
  complex.label = label;
  complex.spacing_mm = mean_edges(nodes, cells);
  complex.touches.assign(nodes.size(), 0);
  for (const auto& face : faces)
    if ((face.labels & bit_of(0)) != 0)
      for (const auto n : face.nodes) complex.touches[static_cast<std::size_t>(n)] = hull_bit;
  derive_touches(complex);
  connect(complex);
  return complex;
}

/// The nodes in use in their order, and what the cells are then.
ImprovedMesh collect(const Complex& complex, const std::vector<std::int32_t>& regions, std::size_t old_nodes) {
  ImprovedMesh mesh;
  std::vector<std::int32_t> id(complex.nodes_mm.size(), -1);
  for (std::size_t c = 0; c < complex.cells.size(); ++c) {
    if (complex.cells[c][0] < 0) continue;
    mesh.cells.push_back(complex.cells[c]);
    mesh.region.push_back(regions.empty() ? 1 : regions[complex.label[c] - 1U]);
    for (const auto n : complex.cells[c]) id[static_cast<std::size_t>(n)] = 0;
  }
  for (std::size_t n = 0; n < id.size(); ++n) {
    if (id[n] < 0) continue;
    id[n] = static_cast<std::int32_t>(mesh.nodes_mm.size());
    mesh.nodes_mm.push_back(complex.nodes_mm[n]);
    mesh.old_node.push_back(n < old_nodes ? static_cast<std::int32_t>(n) : -1);
  }
  for (auto& cell : mesh.cells)
    for (auto& n : cell) n = id[static_cast<std::size_t>(n)];
  return mesh;
}

ImprovedMesh improve_with(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells, const RegionLabels& labels,
                          const std::vector<SurfaceFace>& faces, const ImproveSettings& settings) {
  auto complex = make_complex(nodes, cells, labels.label, faces);
  complex.frozen.assign(nodes.size(), 0);
  if (settings.slide_mm > 0) {
    complex.frozen = feature_nodes(nodes.size(), faces, settings.feature_deg);
    freeze_bends(nodes, faces, settings.slide_mm, complex.frozen);
  } else {
    for (const auto& face : faces)
      for (const auto n : face.nodes) complex.frozen[static_cast<std::size_t>(n)] = 1;
  }
  const Surfaces surfaces(nodes, faces);
  Materials materials;
  materials.equations_at = [&](LabelBits bits, const Vec3& point, std::span<Equation> equations) {
    return surfaces.equation(bits, point, equations);
  };
  const double widest = *std::max_element(complex.spacing_mm.begin(), complex.spacing_mm.end());
  RepairSettings repair;
  repair.goal = math::sin(settings.goal_deg * std::numbers::pi / 180);
  repair.least = 0.96 * repair.goal;
  repair.sweeps = 16;
  repair.tolerance = 0;
  repair.middle = settings.slide_mm / widest;
  repair.may_relabel = false;
  repair.budget = settings.budget;
  const auto below = tetmesh::repair(complex, materials, repair);
  auto mesh = collect(complex, labels.regions, nodes.size());
  mesh.cells_below_goal = below;
  return mesh;
}

double worst(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells) {
  double least = 9;
  for (const auto& c : cells) {
    const auto at = [&](std::size_t i) { return nodes[static_cast<std::size_t>(c[i])]; };
    least = std::min(least, cell_quality(at(0), at(1), at(2), at(3)));
  }
  return least;
}

}  // namespace

ImprovedMesh improve_mesh(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& given,
                          const std::vector<std::int32_t>& region, const ImproveSettings& settings) {
  check(nodes_mm, given, settings);
  if (given.empty()) return {};
  const auto cells = oriented_cells(nodes_mm, given);
  const auto labels = label_regions(cells.size(), region);
  const auto faces = surface_faces(nodes_mm, cells, labels.label);
  auto mesh = improve_with(nodes_mm, cells, labels, faces, settings);
  if (settings.slide_mm > 0) {
    std::vector<std::uint8_t> new_label = label_regions(mesh.cells.size(), mesh.region).label;
    const auto new_faces = surface_faces(mesh.nodes_mm, mesh.cells, new_label);
    mesh.drift_mm = distance_between(nodes_mm, faces, mesh.nodes_mm, new_faces);
    mesh.is_fixed = false;
    if (mesh.drift_mm > settings.slide_mm) {
      ImproveSettings fixed = settings;
      fixed.slide_mm = 0;
      mesh = improve_with(nodes_mm, cells, labels, faces, fixed);
    }
  }
  if (worst(mesh.nodes_mm, mesh.cells) >= worst(nodes_mm, cells)) return mesh;
  ImprovedMesh same;
  same.nodes_mm = nodes_mm;
  same.cells = cells;
  same.region = region.empty() ? std::vector<std::int32_t>(cells.size(), 1) : region;
  same.old_node.resize(nodes_mm.size());
  std::iota(same.old_node.begin(), same.old_node.end(), 0);
  same.cells_below_goal = mesh.cells_below_goal;
  return same;
}

}  // namespace heartgen::tetmesh
