// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/mesh_checks.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"
#include "model/sort_unique.hpp"
#include "validation/cell_quality.hpp"
#include "validation/criteria.hpp"
#include "validation/mesh_topology.hpp"
#include "validation/self_intersection.hpp"
#include "validation/wall_layers.hpp"

namespace heartgen::validation {
namespace {

constexpr double degrees = 57.29577951308232;

/// Appends rows of one scope.
struct Rows {
  Report* report;
  std::string scope;
  void add(const char* metric, double value, const char* unit) const {
    report->push_back({"mesh", scope, metric, value, unit, {}, {}});
  }
  void count(const char* metric, std::int64_t value) const { add(metric, static_cast<double>(value), "count"); }
};

struct Facts {
  const TetMesh* mesh;
  const std::vector<MeshFace>& faces;
  std::vector<CellQuality> cells;
  std::vector<FaceQuality> face_quality;  // per face; on the boundary without an angle
};

std::int64_t invalid_ids(const TetMesh& mesh) {
  const auto valid = [&](std::int32_t n) { return n >= 0 && static_cast<std::size_t>(n) < mesh.nodes_mm.size(); };
  std::int64_t invalid = 0;
  for (const auto& cell : mesh.cells) invalid += !std::all_of(cell.begin(), cell.end(), valid);
  for (const auto& face : mesh.faces) invalid += !std::all_of(face.begin(), face.end(), valid);
  const auto difference = [](std::size_t a, std::size_t b) {
    return static_cast<std::int64_t>(std::max(a, b) - std::min(a, b));
  };
  return invalid + difference(mesh.region.size(), mesh.cells.size()) +
         difference(mesh.surface.size(), mesh.faces.size());
}

std::vector<FaceQuality> face_qualities(const TetMesh& mesh, const std::vector<MeshFace>& faces) {
  const auto node = [&](std::int32_t n) { return mesh.nodes_mm[static_cast<std::size_t>(n)]; };
  const auto center = [&](std::int32_t cell) {
    const auto& n = mesh.cells[static_cast<std::size_t>(cell)];
    return (node(n[0]) + node(n[1]) + node(n[2]) + node(n[3])) / 4;
  };
  std::vector<FaceQuality> result(faces.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(faces.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      const auto& face = faces[f];
      const std::array corners{node(face.nodes[0]), node(face.nodes[1]), node(face.nodes[2])};
      if (face.other < 0)
        result[f].skewness = boundary_skewness(corners, center(face.cell));
      else
        result[f] = face_quality(corners, center(face.cell), center(face.other));
    }
  });
  return result;
}

/// What asked for before, at smaller shares, is in place already: `placed` values.
double percentile(std::vector<double>& values, double share, std::ptrdiff_t& placed) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  if (at >= placed) std::nth_element(values.begin() + placed, values.begin() + at, values.end());
  placed = std::max(placed, at + 1);
  return values[static_cast<std::size_t>(at)];
}

/// Extremes and means over some cells.
struct CellSummary {
  std::int64_t cells = 0, inverted = 0;
  double volume = 0, min_volume = std::numeric_limits<double>::max();
  double min_dihedral = 180, max_dihedral = 0;
  double min_radius_ratio = 1, radius_ratio = 0, min_scaled_jacobian = 1, scaled_jacobian = 0;
  double shortest = std::numeric_limits<double>::max(), longest = 0, edges = 0;

  void take(const CellQuality& q) {
    ++cells;
    inverted += !(q.volume_mm3 > 0);
    volume += q.volume_mm3;
    min_volume = std::min(min_volume, q.volume_mm3);
    min_dihedral = std::min(min_dihedral, q.min_dihedral_deg);
    max_dihedral = std::max(max_dihedral, q.max_dihedral_deg);
    min_radius_ratio = std::min(min_radius_ratio, q.radius_ratio);
    radius_ratio += q.radius_ratio;
    min_scaled_jacobian = std::min(min_scaled_jacobian, q.scaled_jacobian);
    scaled_jacobian += q.scaled_jacobian;
    shortest = std::min(shortest, q.shortest_mm);
    longest = std::max(longest, q.longest_mm);
    edges += q.edge_sum_mm / 6;
  }
};

void add_shape_rows(const Rows& rows, const CellSummary& s) {
  const auto n = static_cast<double>(s.cells);
  rows.add("volume", s.volume / 1000, "ml");
  rows.add("cell_volume_min", s.min_volume, "mm3");
  rows.add("radius_ratio_min", s.min_radius_ratio, "1");
  rows.add("radius_ratio_mean", s.radius_ratio / n, "1");
  rows.add("scaled_jacobian_min", s.min_scaled_jacobian, "1");
  rows.add("scaled_jacobian_mean", s.scaled_jacobian / n, "1");
  rows.add("edge_min", s.shortest, "mm");
  rows.add("edge_mean", s.edges / n, "mm");
  rows.add("edge_max", s.longest, "mm");
}

void add_angle_rows(const Rows& rows, const CellSummary& s) {
  rows.add("dihedral_min", s.min_dihedral, "deg");
  rows.add("dihedral_max", s.max_dihedral, "deg");
}

void add_percentiles(const Rows& rows, const Facts& facts) {
  std::vector<double> angles;
  angles.reserve(6 * facts.cells.size());
  for (const auto& q : facts.cells) angles.insert(angles.end(), q.dihedral_deg.begin(), q.dihedral_deg.end());
  std::ptrdiff_t placed = 0;
  for (const auto& [metric, share] : {std::pair{"dihedral_p1", 0.01},
                                      {"dihedral_p5", 0.05},
                                      {"dihedral_p50", 0.5},
                                      {"dihedral_p95", 0.95},
                                      {"dihedral_p99", 0.99}})
    rows.add(metric, percentile(angles, share, placed), "deg");
}

/// Non-orthogonality and skewness of inner faces, as OpenFOAM's checkMesh sums them up.
struct FaceSummary {
  double cosine = 0, max_angle = 0, skewness = 0, max_skewness = 0, count = 0;

  void take(const FaceQuality& q) {
    cosine += math::cos(q.non_orthogonality_deg / degrees);
    max_angle = std::max(max_angle, q.non_orthogonality_deg);
    skewness += q.skewness;
    max_skewness = std::max(max_skewness, q.skewness);
    ++count;
  }
};

void add_finite_volume_rows(const Rows& rows, const FaceSummary& s) {
  if (s.count == 0) return;
  rows.add("non_orthogonality_mean", math::acos(std::min(s.cosine / s.count, 1.0)) * degrees, "deg");
  rows.add("non_orthogonality_max", s.max_angle, "deg");
  rows.add("skewness_mean", s.skewness / s.count, "1");
  rows.add("skewness_max", s.max_skewness, "1");
}

// The outer surface and the interfaces, as the cells have them.
std::int64_t self_intersections(const Facts& facts) {
  const auto& mesh = *facts.mesh;
  std::vector<Face> surfaces;
  for (const auto& face : facts.faces)
    if (face.other < 0 ||
        mesh.region[static_cast<std::size_t>(face.cell)] != mesh.region[static_cast<std::size_t>(face.other)])
      surfaces.push_back(face.nodes);
  return static_cast<std::int64_t>(intersecting_faces(mesh.nodes_mm, surfaces).size());
}

void add_validity(const Rows& rows, const Facts& facts, std::int64_t inverted) {
  const auto& mesh = *facts.mesh;
  rows.count("inverted_cells", inverted);
  rows.count("orphan_nodes", orphan_nodes(mesh));
  rows.count("duplicate_nodes", duplicate_nodes(mesh));
  rows.count("duplicate_cells", duplicate_cells(mesh));
  std::vector<Face> boundary;
  std::int64_t crowded = 0;
  for (const auto& face : facts.faces) {
    if (face.other < 0) boundary.push_back(face.nodes);
    crowded += face.cells > 2;
  }
  rows.count("faces_of_more_than_two_cells", crowded);
  rows.count("self_intersections", self_intersections(facts));
  const auto topology = surface_topology(boundary);
  rows.count("boundary_open_edges", topology.open_edges);
  rows.count("boundary_non_manifold_edges", topology.non_manifold_edges);
  rows.count("boundary_non_manifold_vertices", topology.non_manifold_vertices);
  rows.count("boundary_euler_characteristic", topology.euler_characteristic);
  const auto labels = check_face_labels(mesh, facts.faces);
  rows.count("boundary_faces_missing", labels.missing_boundary_faces);
  rows.count("interface_faces_missing", labels.missing_interface_faces);
  rows.count("faces_repeated", labels.repeated_faces);
  rows.count("faces_without_cells", labels.faces_without_cells);
  rows.count("faces_inside_regions", labels.faces_inside_regions);
  rows.count("faces_unlabelled", labels.unlabelled_faces);
}

/// Parts hang together through nodes. One of less than a twentieth of the volume floats.
void add_parts(const Rows& rows, const Facts& facts) {
  constexpr double floating_share = 0.05;
  const auto part = node_parts(*facts.mesh);
  std::map<std::int32_t, double> volumes;
  double all = 0;
  for (std::size_t c = 0; c < facts.cells.size(); ++c) {
    volumes[part[static_cast<std::size_t>(facts.mesh->cells[c][0])]] += facts.cells[c].volume_mm3;
    all += facts.cells[c].volume_mm3;
  }
  rows.count("parts", static_cast<std::int64_t>(volumes.size()));
  rows.count("floating_parts", std::count_if(volumes.begin(), volumes.end(),
                                             [&](const auto& entry) { return entry.second < floating_share * all; }));
}

/// Cells with all four nodes on one surface, of the cells with a face there.
void add_locked(const Rows& rows, const Facts& facts, const std::vector<std::size_t>& surface_faces) {
  const auto& mesh = *facts.mesh;
  std::vector<std::uint8_t> on_surface(mesh.nodes_mm.size());
  std::vector<std::int32_t> cells;
  for (const auto f : surface_faces) {
    for (const auto n : facts.faces[f].nodes) on_surface[static_cast<std::size_t>(n)] = 1;
    cells.push_back(facts.faces[f].cell);
    if (facts.faces[f].other >= 0) cells.push_back(facts.faces[f].other);
  }
  sort_unique(cells);
  const auto locked = std::count_if(cells.begin(), cells.end(), [&](std::int32_t c) {
    const auto& nodes = mesh.cells[static_cast<std::size_t>(c)];
    return std::all_of(nodes.begin(), nodes.end(), [&](auto n) { return on_surface[static_cast<std::size_t>(n)]; });
  });
  rows.count("locked_cells", locked);
  rows.add("locked_cell_share",
           static_cast<double>(locked) / static_cast<double>(std::max<std::size_t>(cells.size(), 1)), "1");
}

/// What add_region needs of one region, gathered over all of them in one pass.
struct RegionFacts {
  CellSummary cells;
  FaceSummary inner;
  std::vector<Face> boundary;
  std::int64_t components = 0;
};

std::map<std::int32_t, RegionFacts> facts_of_regions(const Facts& facts) {
  const auto& mesh = *facts.mesh;
  std::map<std::int32_t, RegionFacts> result;
  const auto region = [&](std::int32_t cell) { return mesh.region[static_cast<std::size_t>(cell)]; };
  const auto of = [&](std::int32_t tag) -> RegionFacts& { return result[tag]; };
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) of(mesh.region[c]).cells.take(facts.cells[c]);
  for (std::size_t f = 0; f < facts.faces.size(); ++f) {
    const auto& face = facts.faces[f];
    const auto here = region(face.cell);
    if (face.other >= 0 && region(face.other) == here) {
      of(here).inner.take(facts.face_quality[f]);
      continue;
    }
    of(here).boundary.push_back(face.nodes);
    if (face.other >= 0) of(region(face.other)).boundary.push_back(face.nodes);
  }
  for (const auto& [tag, count] : component_counts(mesh, facts.faces)) result[tag].components = count;
  return result;
}

void add_region(const Rows& rows, const RegionFacts& region) {
  rows.count("cells", region.cells.cells);
  rows.count("components", region.components);
  const auto topology = surface_topology(region.boundary);
  rows.count("boundary_open_edges", topology.open_edges);
  rows.count("boundary_non_manifold_edges", topology.non_manifold_edges);
  rows.count("boundary_non_manifold_vertices", topology.non_manifold_vertices);
  rows.count("boundary_euler_characteristic", topology.euler_characteristic);
  add_shape_rows(rows, region.cells);
  add_angle_rows(rows, region.cells);
  add_finite_volume_rows(rows, region.inner);
}

// A bad cell behind a good mean hides best on a surface: cells with a face there, on either side.
void add_surface(const Rows& rows, const Facts& facts, const std::vector<std::size_t>& surface_faces) {
  const auto& mesh = *facts.mesh;
  CellSummary summary;
  double area = 0;
  for (const auto f : surface_faces) {
    const auto& face = facts.faces[f];
    summary.take(facts.cells[static_cast<std::size_t>(face.cell)]);
    if (face.other >= 0) summary.take(facts.cells[static_cast<std::size_t>(face.other)]);
    const auto node = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(face.nodes[i])]; };
    area += norm(cross(node(1) - node(0), node(2) - node(0))) / 2;
  }
  rows.count("faces", static_cast<std::int64_t>(surface_faces.size()));
  rows.add("area", area / 100, "cm2");
  rows.add("scaled_jacobian_min", summary.min_scaled_jacobian, "1");
  add_locked(rows, facts, surface_faces);
  add_angle_rows(rows, summary);
  FaceSummary inner;
  for (std::size_t i = 0; i < surface_faces.size(); ++i) {
    const bool repeated = i > 0 && surface_faces[i] == surface_faces[i - 1];
    if (!repeated && facts.faces[surface_faces[i]].other >= 0) inner.take(facts.face_quality[surface_faces[i]]);
  }
  add_finite_volume_rows(rows, inner);
}

/// Share of the body's surface that is no skin but the end of the image.
void add_fov_share(const Rows& rows) {
  const auto area = [&](const char* surface) {
    const std::string scope = rows.scope + "/" + surface;
    const auto row = std::find_if(rows.report->begin(), rows.report->end(),
                                  [&](const ReportRow& r) { return r.scope == scope && r.metric == "area"; });
    return row == rows.report->end() ? 0.0 : row->value;
  };
  const double cut = area("fov_cut"), skin = area("skin");
  if (skin > 0) rows.add("fov_cut_share", cut / (cut + skin), "1");
}

// Ids in `facts.faces` of the listed faces, ascending, per surface tag.
std::vector<std::pair<std::int32_t, std::vector<std::size_t>>> faces_by_surface(const Facts& facts) {
  const auto& mesh = *facts.mesh;
  std::vector<std::pair<std::int32_t, std::size_t>> labelled;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    Face nodes = mesh.faces[f];
    std::sort(nodes.begin(), nodes.end());
    const auto place = std::lower_bound(facts.faces.begin(), facts.faces.end(), nodes,
                                        [](const MeshFace& a, const Face& b) { return a.nodes < b; });
    if (place != facts.faces.end() && place->nodes == nodes)
      labelled.emplace_back(mesh.surface[f], static_cast<std::size_t>(place - facts.faces.begin()));
  }
  std::sort(labelled.begin(), labelled.end());
  std::vector<std::pair<std::int32_t, std::vector<std::size_t>>> result;
  for (const auto& [surface, face] : labelled) {
    if (result.empty() || result.back().first != surface) result.push_back({surface, {}});
    result.back().second.push_back(face);
  }
  return result;
}

}  // namespace

Report check_mesh(const std::string& mesh_name, const TetMesh& mesh, const ValidationSettings& settings) {
  return check_mesh(mesh_name, mesh, mesh_faces(mesh), settings);
}

Report check_mesh(const std::string& mesh_name, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                  const ValidationSettings& settings) {
  Report report;
  const Rows rows{&report, mesh_name};
  rows.count("nodes", static_cast<std::int64_t>(mesh.nodes_mm.size()));
  rows.count("cells", static_cast<std::int64_t>(mesh.cells.size()));
  rows.count("faces", static_cast<std::int64_t>(mesh.faces.size()));
  const auto invalid = invalid_ids(mesh);
  rows.count("invalid_ids", invalid);
  if (invalid != 0 || mesh.cells.empty()) return judged(std::move(report), settings);

  const Facts facts{&mesh, faces, cell_qualities(mesh), face_qualities(mesh, faces)};
  CellSummary all;
  for (const auto& q : facts.cells) all.take(q);
  add_validity(rows, facts, all.inverted);
  rows.count("components", component_count(mesh, faces));
  add_parts(rows, facts);
  add_shape_rows(rows, all);
  add_angle_rows(rows, all);
  add_percentiles(rows, facts);
  FaceSummary inner;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (faces[f].other >= 0) inner.take(facts.face_quality[f]);
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (faces[f].other < 0) inner.max_skewness = std::max(inner.max_skewness, facts.face_quality[f].skewness);
  add_finite_volume_rows(rows, inner);
  for (const auto& [region, of_region] : facts_of_regions(facts))
    add_region({&report, mesh_name + "/" + region_name(region)}, of_region);
  for (const auto& [region, layers] : wall_layers(mesh)) {
    const Rows of_wall{&report, mesh_name + "/" + region_name(region)};
    of_wall.add("layers_p5", layers.p5, "count");
    of_wall.add("layers_p50", layers.median, "count");
    of_wall.add("layers_below_two", layers.below_two, "1");
  }
  for (const auto& [surface, surface_faces] : faces_by_surface(facts))
    add_surface({&report, mesh_name + "/" + surface_name(surface)}, facts, surface_faces);
  add_fov_share(rows);
  return judged(std::move(report), settings);
}

}  // namespace heartgen::validation
