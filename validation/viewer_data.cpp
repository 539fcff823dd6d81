#include "validation/viewer_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "model/labels.hpp"
#include "validation/angle_grid.hpp"
#include "validation/boundary_faces.hpp"
#include "validation/heart_frame.hpp"
#include "validation/html_text.hpp"
#include "validation/palette.hpp"
#include "validation/pictures.hpp"
#include "validation/streamlines.hpp"

namespace heart::validation {
namespace {

using Json = nlohmann::json;

/// One surface of the view.
struct Part {
  std::int32_t region = 0;
  std::vector<Vec3> points_mm;
  std::vector<double> helix_deg;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  bool glass = false;
};

/// Node ids merged per cube of side `cube_mm`; each id stands for the mean of its cube's surface nodes.
struct Clusters {
  std::vector<std::int32_t> of_node;  ///< -1 for nodes that are on no surface
  std::vector<Vec3> points_mm;
  std::vector<double> helix_deg;
};

Clusters cluster_nodes(const TetMesh& mesh, const BoundaryFaces& boundary, const std::vector<double>& helix_deg,
                       double cube_mm) {
  std::vector<std::uint8_t> used(mesh.nodes_mm.size(), 0);
  for (const Face& f : boundary.faces)
    for (const auto n : f) used[static_cast<std::size_t>(n)] = 1;
  std::vector<std::pair<std::array<std::int64_t, 3>, std::size_t>> cubes;
  for (std::size_t n = 0; n < used.size(); ++n) {
    if (!used[n]) continue;
    const auto cube = [&](double v) { return static_cast<std::int64_t>(std::floor(v / cube_mm)); };
    const Vec3& p = mesh.nodes_mm[n];
    // Without clustering every node is its own cube.
    if (cube_mm > 0)
      cubes.push_back({{cube(p.z), cube(p.y), cube(p.x)}, n});
    else
      cubes.push_back({{static_cast<std::int64_t>(n), 0, 0}, n});
  }
  std::sort(cubes.begin(), cubes.end());
  Clusters clusters;
  clusters.of_node.assign(used.size(), -1);
  std::vector<double> count, helix_count;
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    if (i == 0 || cubes[i].first != cubes[i - 1].first) {
      clusters.points_mm.emplace_back();
      clusters.helix_deg.push_back(0), count.push_back(0), helix_count.push_back(0);
    }
    const std::size_t n = cubes[i].second;
    clusters.of_node[n] = static_cast<std::int32_t>(clusters.points_mm.size()) - 1;
    clusters.points_mm.back() += mesh.nodes_mm[n];
    count.back() += 1;
    if (!helix_deg.empty() && std::isfinite(helix_deg[n]))
      clusters.helix_deg.back() += helix_deg[n], helix_count.back() += 1;
  }
  for (std::size_t c = 0; c < count.size(); ++c) {
    clusters.points_mm[c] = clusters.points_mm[c] / count[c];
    clusters.helix_deg[c] = helix_count[c] > 0 ? clusters.helix_deg[c] / helix_count[c] : std::nan("");
  }
  return clusters;
}

/// Triangles of one region after clustering, with ids local to the part.
Part make_part(const BoundaryFaces& boundary, const std::vector<std::int32_t>& region_of_face, std::int32_t region,
               const Clusters& clusters) {
  Part part;
  part.region = region;
  std::vector<std::int32_t> local(clusters.points_mm.size(), -1);
  for (std::size_t f = 0; f < boundary.faces.size(); ++f) {
    if (region_of_face[f] != region) continue;
    std::array<std::int32_t, 3> ids{};
    for (std::size_t k = 0; k < 3; ++k) ids[k] = clusters.of_node[static_cast<std::size_t>(boundary.faces[f][k])];
    if (ids[0] == ids[1] || ids[1] == ids[2] || ids[0] == ids[2]) continue;
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      auto& id = local[static_cast<std::size_t>(ids[k])];
      if (id < 0) {
        id = static_cast<std::int32_t>(part.points_mm.size());
        part.points_mm.push_back(clusters.points_mm[static_cast<std::size_t>(ids[k])]);
        part.helix_deg.push_back(clusters.helix_deg[static_cast<std::size_t>(ids[k])]);
      }
      triangle[k] = static_cast<std::uint32_t>(id);
    }
    part.triangles.push_back(triangle);
  }
  return part;
}

double total_area_mm2(const TetMesh& mesh, const BoundaryFaces& boundary) {
  double area = 0;
  for (const Face& f : boundary.faces) {
    const Vec3& a = mesh.nodes_mm[static_cast<std::size_t>(f[0])];
    area += 0.5 * norm(cross(mesh.nodes_mm[static_cast<std::size_t>(f[1])] - a,
                             mesh.nodes_mm[static_cast<std::size_t>(f[2])] - a));
  }
  return area;
}

/// The parts of one mesh: the given regions, at most `budget` triangles in all. `skin` merges everything else of the
/// torso into its outer surface.
std::vector<Part> mesh_parts(const TetMesh& mesh, const std::vector<MeshFace>& faces,
                             const std::set<std::int32_t>& regions, bool skin, std::size_t budget,
                             const std::vector<double>& helix_deg) {
  std::vector<Part> parts;
  const auto gather = [&](const BoundaryFaces& boundary, const std::vector<std::int32_t>& region_of_face,
                          const std::set<std::int32_t>& names, std::size_t limit) {
    double cube_mm = boundary.faces.size() > limit
                         ? std::sqrt(2.4 * total_area_mm2(mesh, boundary) / static_cast<double>(limit))
                         : 0;
    for (;; cube_mm *= 1.15) {
      const Clusters clusters = cluster_nodes(mesh, boundary, helix_deg, cube_mm);
      std::vector<Part> made;
      std::size_t total = 0;
      for (const auto region : names) {
        made.push_back(make_part(boundary, region_of_face, region, clusters));
        total += made.back().triangles.size();
      }
      if (total > limit && cube_mm > 0) continue;
      for (Part& part : made)
        if (!part.triangles.empty()) parts.push_back(std::move(part));
      return;
    }
  };
  std::vector<std::uint8_t> chosen(mesh.cells.size());
  for (std::size_t c = 0; c < chosen.size(); ++c) chosen[c] = regions.count(mesh.region[c]) > 0;
  const BoundaryFaces boundary = boundary_faces(mesh, faces, chosen, true);
  std::vector<std::int32_t> region_of_face;
  for (const auto c : boundary.cell) region_of_face.push_back(mesh.region[static_cast<std::size_t>(c)]);
  gather(boundary, region_of_face, regions, budget);
  if (skin) {
    const BoundaryFaces outer = boundary_faces(mesh, faces, std::vector<std::uint8_t>(mesh.cells.size(), 1));
    const std::int32_t torso = tag(Region::torso);
    gather(outer, std::vector<std::int32_t>(outer.faces.size(), torso), {torso}, budget);
    if (!parts.empty()) parts.back().glass = true;
  }
  return parts;
}

std::vector<Part> all_parts(const std::map<std::string, TetMesh>& meshes, const FacesOfMeshes& faces,
                            const ViewerSettings& settings, const std::vector<double>& helix_deg) {
  std::vector<Part> parts;
  std::set<std::int32_t> done;
  for (const char* name : {"myocardium", "chambers", "trachea", "carotid", "torso"}) {
    const auto found = meshes.find(name);
    if (found == meshes.end() || found->second.cells.empty()) continue;
    const TetMesh& mesh = found->second;
    std::set<std::int32_t> regions;
    for (const auto region : mesh.region)
      if (!done.count(region)) regions.insert(region);
    const bool is_torso = found->first == "torso";
    if (is_torso) regions.erase(tag(Region::torso));
    done.insert(regions.begin(), regions.end());
    const bool is_walls = found->first == "myocardium";
    const std::size_t budget = is_walls ? settings.heart_triangles : settings.body_triangles;
    for (Part& part : mesh_parts(mesh, faces.at(found->first), regions, is_torso, budget,
                                 is_walls ? helix_deg : std::vector<double>{}))
      parts.push_back(std::move(part));
  }
  return parts;
}

/// Binary blob under construction; every array starts at a multiple of four.
struct Blob {
  std::vector<std::uint8_t> bytes;

  std::size_t start() {
    while (bytes.size() % 4) bytes.push_back(0);
    return bytes.size();
  }
  void append(std::uint64_t value, int width) {
    for (int b = 0; b < width; ++b) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * b)));
  }
};

struct Extent {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void add(const Vec3& p) {
    for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
  }
  Vec3 middle() const { return 0.5 * (low + high); }
};

struct Quantizer {
  Vec3 low;
  double scale_mm = 1;

  void append_points(Blob& blob, const std::vector<Vec3>& points) const {
    for (const Vec3& p : points)
      for (int a = 0; a < 3; ++a)
        blob.append(static_cast<std::uint64_t>(std::clamp(std::lround((p[a] - low[a]) / scale_mm), 0L, 65535L)), 2);
  }
};

/// 0: unknown; 1 .. 255: -90 .. 90 degrees.
std::uint64_t helix_byte(double angle_deg) {
  if (!std::isfinite(angle_deg)) return 0;
  return static_cast<std::uint64_t>(1 + std::lround((std::clamp(angle_deg, -90.0, 90.0) + 90) / 180 * 254));
}

std::string label_text(std::int32_t region) {
  if (region == tag(Region::torso)) return "skin";
  std::string name = region_name(region);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Json part_json(const Part& part, Blob& blob, const Quantizer& quantizer, bool walls_exist) {
  Json json;
  const Rgb color = region_color(part.region);
  const bool muscle = is_myocardium(static_cast<Region>(part.region));
  json["label"] = label_text(part.region);
  json["color"] = {color.r, color.g, color.b};
  json["muscle"] = muscle;
  json["glass"] = part.glass;
  json["shown"] = muscle || !walls_exist;
  json["vertices"] = part.points_mm.size();
  json["triangles"] = part.triangles.size();
  json["positions"] = blob.start();
  quantizer.append_points(blob, part.points_mm);
  json["helix"] = blob.start();
  for (const double h : part.helix_deg) blob.append(helix_byte(h), 1);
  json["indices"] = blob.start();
  for (const auto& t : part.triangles)
    for (const auto id : t) blob.append(id, 4);
  return json;
}

Json lines_json(const std::vector<Streamline>& lines, Blob& blob, const Quantizer& quantizer) {
  Json json;
  std::size_t vertices = 0;
  for (const auto& line : lines) vertices += line.points_mm.size();
  json["lines"] = lines.size();
  json["vertices"] = vertices;
  json["positions"] = blob.start();
  for (const auto& line : lines) quantizer.append_points(blob, line.points_mm);
  json["helix"] = blob.start();
  for (const auto& line : lines)
    for (const double h : line.helix_deg) blob.append(helix_byte(h), 1);
  json["lengths"] = blob.start();
  for (const auto& line : lines) blob.append(line.points_mm.size(), 2);
  return json;
}

std::vector<Streamline> fiber_lines(const TetMesh& walls, const std::vector<double>& helix_deg,
                                    const ViewerSettings& settings) {
  if (walls.node_fibers.fiber.size() != walls.nodes_mm.size() || walls.nodes_mm.empty()) return {};
  std::vector<std::uint8_t> allowed(walls.nodes_mm.size());
  for (std::size_t n = 0; n < allowed.size(); ++n) allowed[n] = std::isfinite(helix_deg[n]);
  const auto seeds = thinned_nodes(walls, allowed, settings.line_spacing_mm);
  return trace_fibers(walls, seeds, helix_deg, {1.2, settings.line_length_mm});
}

Json vec_json(const Vec3& v) { return {v.x, v.y, v.z}; }

/// What the view turns around: the walls of the heart where there are any.
struct Framing {
  Extent all;
  Vec3 center_mm;
  double radius_mm = 1;
};

Framing frame_parts(const std::vector<Part>& parts, bool has_walls) {
  Framing framing;
  Extent focus;
  const auto in_focus = [&](const Part& part) { return !has_walls || is_myocardium(static_cast<Region>(part.region)); };
  for (const Part& part : parts)
    for (const Vec3& p : part.points_mm) {
      framing.all.add(p);
      if (in_focus(part)) focus.add(p);
    }
  framing.center_mm = focus.middle();
  for (const Part& part : parts)
    if (in_focus(part))
      for (const Vec3& p : part.points_mm) framing.radius_mm = std::max(framing.radius_mm, norm(p - framing.center_mm));
  return framing;
}

/// Null without fibres.
Json angles_json(const TetMesh& walls, const std::vector<double>& helix_deg, Blob& blob) {
  const AngleGrid angles = angle_grid(walls, helix_deg);
  if (angles.angle_deg.empty()) return nullptr;
  Json json = {{"count", angles.count}, {"spacing", angles.spacing_mm}, {"low", vec_json(angles.low_mm)}};
  json["values"] = blob.start();
  for (const double angle : angles.angle_deg) blob.append(helix_byte(angle), 1);
  return json;
}

}  // namespace

ViewerData viewer_data(const std::map<std::string, TetMesh>& meshes, const ViewerSettings& settings) {
  const auto faces = faces_of_meshes(meshes);
  const auto walls = meshes.find("myocardium");
  return viewer_data(
      meshes, faces,
      walls == meshes.end() ? std::vector<double>{} : helix_angle_per_node(walls->second, faces.at("myocardium")),
      settings);
}

ViewerData viewer_data(const std::map<std::string, TetMesh>& meshes, const FacesOfMeshes& faces,
                       const std::vector<double>& helix_deg, const ViewerSettings& settings) {
  const auto found = meshes.find("myocardium");
  const TetMesh none;
  const TetMesh& walls = found == meshes.end() ? none : found->second;
  const auto parts = all_parts(meshes, faces, settings, helix_deg);
  ViewerData data;
  if (parts.empty()) return data;
  data.empty = false;
  const Framing framing = frame_parts(parts, !walls.cells.empty());
  const Vec3 size = framing.all.high - framing.all.low;
  const Quantizer quantizer{framing.all.low, std::max({size.x, size.y, size.z, 1.0}) / 65535};
  Blob blob;
  Json index;
  for (const Part& part : parts) index["parts"].push_back(part_json(part, blob, quantizer, !walls.cells.empty()));
  const auto lines = fiber_lines(walls, helix_deg, settings);
  if (!lines.empty()) index["lines"] = lines_json(lines, blob, quantizer);
  if (const Json angles = angles_json(walls, helix_deg, blob); !angles.empty()) index["angles"] = angles;
  const HeartFrame frame = heart_frame(walls);
  const Vec3 toward = normalized(cross(-frame.to_right, frame.axis));
  index["chambersView"] = {vec_json(-frame.to_right), vec_json(frame.axis), vec_json(toward)};
  index["low"] = vec_json(framing.all.low);
  index["scale"] = quantizer.scale_mm;
  index["center"] = vec_json(framing.center_mm);
  index["radius"] = framing.radius_mm;
  index["reach"] = norm(size);
  data.index_json = index.dump();
  data.data_base64 = base64(blob.bytes.data(), blob.bytes.size());
  data.has_fibers = !lines.empty();
  return data;
}

}  // namespace heart::validation
