// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/view_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "model/labels.hpp"
#include "validation/boundary_faces.hpp"

namespace heartgen::report {
namespace {

/// Faces to show, with what is known of each.
struct Faces {
  std::vector<Face> nodes;
  std::vector<std::int32_t> part;  ///< region, or surface of a valve
  std::vector<std::int32_t> surface;
  std::vector<std::uint8_t> quality_deg;
};

/// What is shown of one mesh.
struct Source {
  std::string name;
  const TetMesh* mesh = nullptr;
  const std::vector<validation::WallField>* fields = nullptr;  ///< null off the walls
};

/// Nodes merged per cube; each cluster stands for the mean of its cube's nodes.
struct Clusters {
  std::vector<std::int32_t> of_node;  ///< -1 for nodes that are on no surface
  std::vector<std::size_t> first;     ///< a node of each
  std::vector<Vec3> points_mm;
  std::vector<Vec3> fibers;
};

/// Every node of the faces with its cube, in order; without a size every node is its own cube.
std::vector<std::pair<std::array<std::int64_t, 3>, std::size_t>> cubes_of(const TetMesh& mesh, const Faces& faces,
                                                                          double cube_mm) {
  std::vector<std::uint8_t> used(mesh.nodes_mm.size(), 0);
  for (const Face& f : faces.nodes)
    for (const auto n : f) used[static_cast<std::size_t>(n)] = 1;
  std::vector<std::pair<std::array<std::int64_t, 3>, std::size_t>> cubes;
  const auto cube = [&](double v) { return static_cast<std::int64_t>(std::floor(v / cube_mm)); };
  for (std::size_t n = 0; n < used.size(); ++n) {
    if (!used[n]) continue;
    const Vec3& p = mesh.nodes_mm[n];
    if (cube_mm > 0)
      cubes.push_back({{cube(p.z), cube(p.y), cube(p.x)}, n});
    else
      cubes.push_back({{static_cast<std::int64_t>(n), 0, 0}, n});
  }
  std::sort(cubes.begin(), cubes.end());
  return cubes;
}

Clusters cluster_nodes(const TetMesh& mesh, const Faces& faces, double cube_mm) {
  const auto cubes = cubes_of(mesh, faces, cube_mm);
  const bool has_fibers = mesh.node_fibers.fiber.size() == mesh.nodes_mm.size();
  Clusters clusters;
  clusters.of_node.assign(mesh.nodes_mm.size(), -1);
  std::vector<double> count;
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    const std::size_t n = cubes[i].second;
    if (i == 0 || cubes[i].first != cubes[i - 1].first) {
      clusters.first.push_back(n);
      clusters.points_mm.emplace_back(), clusters.fibers.emplace_back(), count.push_back(0);
    }
    clusters.of_node[n] = static_cast<std::int32_t>(count.size()) - 1;
    clusters.points_mm.back() += mesh.nodes_mm[n];
    count.back() += 1;
    if (!has_fibers) continue;
    const Vec3& fiber = mesh.node_fibers.fiber[n];
    clusters.fibers.back() += dot(fiber, clusters.fibers.back()) < 0 ? -fiber : fiber;
  }
  for (std::size_t c = 0; c < count.size(); ++c) clusters.points_mm[c] = clusters.points_mm[c] / count[c];
  return clusters;
}

struct PartMaker {
  const Source& source;
  const Faces& faces;
  const Clusters& clusters;
  bool is_thinned;

  /// Triangles of one part, with ids local to it; those that clustering made flat are gone.
  ViewPart make(std::int32_t part_tag, std::vector<std::int32_t>& local) const {
    ViewPart part{source.name, part_tag, false, false, is_thinned, {}, {}, {}, {}, {}};
    std::vector<std::size_t> members;
    for (std::size_t f = 0; f < faces.nodes.size(); ++f) {
      if (faces.part[f] != part_tag) continue;
      std::array<std::int32_t, 3> ids{};
      for (std::size_t k = 0; k < 3; ++k) ids[k] = clusters.of_node[static_cast<std::size_t>(faces.nodes[f][k])];
      if (ids[0] == ids[1] || ids[1] == ids[2] || ids[0] == ids[2]) continue;
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        auto& id = local[static_cast<std::size_t>(ids[k])];
        if (id < 0) {
          id = static_cast<std::int32_t>(members.size());
          members.push_back(static_cast<std::size_t>(ids[k]));
        }
        triangle[k] = static_cast<std::uint32_t>(id);
      }
      part.triangles.push_back(triangle);
      part.surface.push_back(faces.surface[f]);
      part.quality_deg.push_back(faces.quality_deg[f]);
    }
    add_points(part, members);
    for (const auto c : members) local[c] = -1;
    return part;
  }

  void add_points(ViewPart& part, const std::vector<std::size_t>& members) const {
    for (const auto c : members) part.points_mm.push_back(clusters.points_mm[c]);
    if (!source.fields) return;
    for (const auto c : members) part.fibers.push_back(normalized(clusters.fibers[c]));
    for (const validation::WallField& field : *source.fields) {
      auto& bytes = part.fields.emplace_back();
      for (const auto c : members) bytes.push_back(validation::byte_of(field, field.values[clusters.first[c]]));
    }
  }
};

double total_area_mm2(const TetMesh& mesh, const Faces& faces) {
  double area = 0;
  for (const Face& f : faces.nodes) {
    const Vec3& a = mesh.nodes_mm[static_cast<std::size_t>(f[0])];
    area += 0.5 * norm(cross(mesh.nodes_mm[static_cast<std::size_t>(f[1])] - a,
                             mesh.nodes_mm[static_cast<std::size_t>(f[2])] - a));
  }
  return area;
}

/// The given parts, at most `limit` triangles in all.
std::vector<ViewPart> parts_of(const Source& source, const Faces& faces, const std::set<std::int32_t>& tags,
                               std::size_t limit) {
  double cube_mm = faces.nodes.size() > limit
                       ? std::sqrt(2.4 * total_area_mm2(*source.mesh, faces) / static_cast<double>(limit))
                       : 0;
  for (;; cube_mm *= 1.15) {
    const Clusters clusters = cluster_nodes(*source.mesh, faces, cube_mm);
    std::vector<std::int32_t> local(clusters.points_mm.size(), -1);
    std::vector<ViewPart> parts;
    std::size_t total = 0;
    for (const auto part_tag : tags) {
      parts.push_back(PartMaker{source, faces, clusters, cube_mm > 0}.make(part_tag, local));
      total += parts.back().triangles.size();
    }
    if (total > limit && cube_mm > 0) continue;
    std::erase_if(parts, [](const ViewPart& part) { return part.triangles.empty(); });
    return parts;
  }
}

/// Listed faces by their nodes.
struct SurfaceOfFace {
  std::vector<std::pair<Face, std::int32_t>> listed;

  explicit SurfaceOfFace(const TetMesh& mesh) {
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) listed.emplace_back(ascending(mesh.faces[f]), mesh.surface[f]);
    std::sort(listed.begin(), listed.end());
  }
  static Face ascending(Face face) {
    std::sort(face.begin(), face.end());
    return face;
  }
  std::int32_t operator()(const Face& face) const {
    const auto key = std::pair{ascending(face), std::int32_t{-1}};
    const auto at = std::lower_bound(listed.begin(), listed.end(), key);
    return at != listed.end() && at->first == key.first ? at->second : 0;
  }
};

std::uint8_t degrees(double angle) { return static_cast<std::uint8_t>(std::clamp(std::lround(angle), 0L, 255L)); }

Faces shown_faces(const TetMesh& mesh, const validation::BoundaryFaces& boundary, const SurfaceOfFace& surface) {
  Faces faces;
  faces.nodes = boundary.faces;
  for (std::size_t f = 0; f < faces.nodes.size(); ++f) {
    const auto cell = static_cast<std::size_t>(boundary.cell[f]);
    faces.part.push_back(mesh.region[cell]);
    faces.surface.push_back(surface(faces.nodes[f]));
    faces.quality_deg.push_back(degrees(validation::min_dihedral_deg(mesh, cell)));
  }
  return faces;
}

bool is_orifice(std::int32_t surface) { return surface_name(surface).ends_with("_orifice"); }

/// Orifices that the mesh lists and no mesh before it did.
std::vector<ViewPart> valve_parts(const Source& source, std::set<std::int32_t>& done) {
  Faces faces;
  std::set<std::int32_t> tags;
  for (std::size_t f = 0; f < source.mesh->faces.size(); ++f) {
    const auto surface = source.mesh->surface[f];
    if (!is_orifice(surface) || done.count(surface)) continue;
    tags.insert(surface);
    faces.nodes.push_back(source.mesh->faces[f]);
    faces.part.push_back(surface), faces.surface.push_back(surface), faces.quality_deg.push_back(0);
  }
  done.insert(tags.begin(), tags.end());
  auto parts = parts_of({source.name, source.mesh, nullptr}, faces, tags, faces.nodes.size());
  for (ViewPart& part : parts) part.is_valve = true;
  return parts;
}

std::vector<ViewPart> mesh_parts(const Source& source, const std::vector<validation::MeshFace>& mesh_faces,
                                 const std::set<std::int32_t>& regions, std::size_t budget) {
  const TetMesh& mesh = *source.mesh;
  const SurfaceOfFace surface(mesh);
  std::vector<std::uint8_t> chosen(mesh.cells.size());
  for (std::size_t c = 0; c < chosen.size(); ++c) chosen[c] = regions.count(mesh.region[c]) > 0;
  const Faces faces = shown_faces(mesh, validation::boundary_faces(mesh, mesh_faces, chosen, true), surface);
  auto parts = parts_of(source, faces, regions, budget);
  if (source.name != "torso") return parts;
  const std::int32_t torso = tag(Region::torso);
  Faces outer = shown_faces(
      mesh, validation::boundary_faces(mesh, mesh_faces, std::vector<std::uint8_t>(mesh.cells.size(), 1)), surface);
  outer.part.assign(outer.nodes.size(), torso);
  for (ViewPart& skin : parts_of(source, outer, {torso}, budget)) {
    skin.is_glass = true;
    parts.push_back(std::move(skin));
  }
  return parts;
}

}  // namespace

std::vector<ViewPart> view_parts(const std::map<std::string, TetMesh>& meshes, const validation::FacesOfMeshes& faces,
                                 const std::vector<validation::WallField>& fields, const ViewerSettings& settings) {
  std::vector<ViewPart> parts, valves;
  std::set<std::int32_t> done, done_valves;
  for (const char* name : {"myocardium", "chambers", "trachea", "carotid", "torso"}) {
    const auto found = meshes.find(name);
    if (found == meshes.end() || found->second.cells.empty()) continue;
    const TetMesh& mesh = found->second;
    std::set<std::int32_t> regions;
    for (const auto region : mesh.region)
      if (!done.count(region)) regions.insert(region);
    if (found->first == "torso") regions.erase(tag(Region::torso));
    done.insert(regions.begin(), regions.end());
    const bool is_walls = found->first == "myocardium";
    const Source source{found->first, &mesh, is_walls ? &fields : nullptr};
    for (auto& part : mesh_parts(source, faces.at(found->first), regions,
                                 is_walls ? settings.heart_triangles : settings.body_triangles))
      parts.push_back(std::move(part));
    for (auto& part : valve_parts(source, done_valves)) valves.push_back(std::move(part));
  }
  for (auto& part : valves) parts.push_back(std::move(part));
  return parts;
}

std::vector<std::array<std::uint32_t, 2>> rim_edges(const ViewPart& part) {
  std::vector<std::array<std::uint32_t, 2>> edges, rim;
  for (const auto& t : part.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.push_back({a, b});
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 0; e < edges.size();) {
    std::size_t end = e + 1;
    while (end < edges.size() && edges[end] == edges[e]) ++end;
    if (end - e == 1) rim.push_back(edges[e]);
    e = end;
  }
  return rim;
}

}  // namespace heartgen::report
