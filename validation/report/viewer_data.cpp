// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/viewer_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "model/labels.hpp"
#include "validation/heart_frame.hpp"
#include "validation/report/page_data.hpp"
#include "validation/report/palette.hpp"
#include "validation/report/streamlines.hpp"
#include "validation/report/surface_lines.hpp"
#include "validation/value_grid.hpp"

namespace heartgen::report {
namespace {

using Json = nlohmann::json;

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

  void append(Blob& blob, const Vec3& p) const {
    for (int a = 0; a < 3; ++a)
      blob.append(static_cast<std::uint64_t>(std::clamp(std::lround((p[a] - low[a]) / scale_mm), 0L, 65535L)), 2);
  }
};

Json vec_json(const Vec3& v) { return {v.x, v.y, v.z}; }
Json color_json(const Rgb& c) { return {c.r, c.g, c.b}; }

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string part_name(const ViewPart& part) {
  if (part.is_valve) return surface_name(part.region);
  return part.is_glass ? "skin" : region_name(part.region);
}

/// Writes parts and lines; all offsets of the index are into `blob`.
struct Packer {
  const std::vector<validation::WallField>& fields;
  Quantizer quantizer;
  bool walls_exist;
  Blob blob{};

  Json part(const ViewPart& part) {
    const bool muscle = !part.is_valve && is_myocardium(static_cast<Region>(part.region));
    Json json;
    json["name"] = part_name(part);
    json["label"] = spaced(part_name(part));
    json["mesh"] = part.mesh;
    json["group"] = part.is_valve ? "valves" : muscle ? "muscle" : is_blood_part(part) ? "blood" : "body";
    json["color"] = color_json(part.is_valve ? surface_color(part.region) : region_color(part.region));
    json["muscle"] = muscle;
    json["glass"] = part.is_glass;
    json["thinned"] = part.is_thinned;
    json["shown"] = muscle || !walls_exist;
    json["vertices"] = part.points_mm.size();
    json["triangles"] = part.triangles.size();
    json["positions"] = blob.start();
    for (const Vec3& p : part.points_mm) quantizer.append(blob, p);
    for (std::size_t f = 0; f < part.fields.size(); ++f) json["fields"][fields[f].id] = bytes(part.fields[f]);
    json["indices"] = blob.start();
    for (const auto& t : part.triangles)
      for (const auto id : t) blob.append(id, 4);
    json["surface"] = blob.start();
    for (const auto s : part.surface) blob.append(static_cast<std::uint64_t>(s), 2);
    json["quality"] = bytes(part.quality_deg);
    return json;
  }

  static bool is_blood_part(const ViewPart& part) { return is_blood(static_cast<Region>(part.region)); }

  std::size_t bytes(const std::vector<std::uint8_t>& values) {
    const auto start = blob.start();
    blob.bytes.insert(blob.bytes.end(), values.begin(), values.end());
    return start;
  }

  /// Polylines: all points, the length of each line, and a byte (0: none) per point.
  Json lines(const std::vector<std::vector<Vec3>>& polylines, const std::vector<std::uint8_t>& helix) {
    Json json;
    std::size_t vertices = 0;
    for (const auto& line : polylines) vertices += line.size();
    json["lines"] = polylines.size();
    json["vertices"] = vertices;
    json["positions"] = blob.start();
    for (const auto& line : polylines)
      for (const Vec3& p : line) quantizer.append(blob, p);
    json["helix"] = bytes(helix);
    json["lengths"] = blob.start();
    for (const auto& line : polylines) blob.append(line.size(), 2);
    return json;
  }

  /// On the part's own surface: fibres of a wall, the rim of a valve. Null where there are none.
  Json part_lines(const ViewPart& part, const ViewerSettings& settings) {
    std::vector<std::vector<Vec3>> polylines;
    std::vector<std::uint8_t> helix;
    const bool has_helix = !fields.empty() && fields[0].id == "helix" && !part.fields.empty();
    for (auto& line : surface_lines(part, settings.line_spacing_mm, settings.line_length_mm)) {
      for (const auto n : line.nearest) helix.push_back(has_helix ? part.fields[0][n] : std::uint8_t{0});
      polylines.push_back(std::move(line.points_mm));
    }
    if (part.is_valve)
      for (const auto& [a, b] : rim_edges(part)) {
        polylines.push_back({part.points_mm[a], part.points_mm[b]});
        helix.insert(helix.end(), 2, 0);
      }
    return polylines.empty() ? Json(nullptr) : lines(polylines, helix);
  }

  /// Those inside a wall, for the faces that a cut opens.
  Json inner_lines(const std::vector<Streamline>& all, const std::vector<std::int32_t>& region_of_node,
                   std::int32_t region) {
    const validation::WallField scale{"helix", "", "", -90, 90, {}, {}};
    std::vector<std::vector<Vec3>> polylines;
    std::vector<std::uint8_t> helix;
    for (const Streamline& line : all) {
      if (region_of_node[static_cast<std::size_t>(line.seed)] != region) continue;
      for (const double h : line.helix_deg) helix.push_back(validation::byte_of(scale, h));
      polylines.push_back(line.points_mm);
    }
    return polylines.empty() ? Json(nullptr) : lines(polylines, helix);
  }

  Json grids(const TetMesh& walls) {
    if (walls.nodes_mm.empty()) return nullptr;
    const validation::ValueGrid grid = validation::make_value_grid(walls.nodes_mm);
    Json json = {{"count", grid.count}, {"spacing", grid.spacing_mm}, {"low", vec_json(grid.low_mm)}};
    for (const validation::WallField& field : fields) {
      std::vector<std::uint8_t> cubes;
      for (const double v : validation::grid_values(
               grid, field.values, field.categories.empty() ? validation::Join::mean : validation::Join::largest))
        cubes.push_back(validation::byte_of(field, v));
      json["values"][field.id] = bytes(cubes);
    }
    return json;
  }
};

/// Lines through the inside of all walls; none without fibres.
std::vector<Streamline> wall_lines(const TetMesh& walls, const std::vector<validation::WallField>& fields,
                                   const ViewerSettings& settings) {
  if (walls.node_fibers.fiber.size() != walls.nodes_mm.size() || walls.nodes_mm.empty()) return {};
  const std::vector<std::uint8_t> all(walls.nodes_mm.size(), 1);
  const auto seeds = thinned_nodes(walls, all, settings.line_spacing_mm);
  const bool has_helix = !fields.empty() && fields[0].id == "helix";
  const std::vector<double> unknown(has_helix ? 0 : walls.nodes_mm.size(), std::nan(""));
  return trace_fibers(walls, seeds, has_helix ? fields[0].values : unknown, {1.2, settings.line_length_mm});
}

/// Of one of its cells.
std::vector<std::int32_t> regions_of_nodes(const TetMesh& mesh) {
  std::vector<std::int32_t> region(mesh.nodes_mm.size(), 0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto n : mesh.cells[c]) region[static_cast<std::size_t>(n)] = mesh.region[c];
  return region;
}

/// What the view turns around: the walls of the heart where there are any.
struct Framing {
  Extent all;
  Vec3 center_mm;
  double radius_mm = 1;
};

Framing frame_parts(const std::vector<ViewPart>& parts, bool has_walls) {
  Framing framing;
  Extent focus;
  const auto in_focus = [&](const ViewPart& part) {
    return !has_walls || (!part.is_valve && is_myocardium(static_cast<Region>(part.region)));
  };
  for (const ViewPart& part : parts)
    for (const Vec3& p : part.points_mm) {
      framing.all.add(p);
      if (in_focus(part)) focus.add(p);
    }
  framing.center_mm = focus.middle();
  for (const ViewPart& part : parts)
    if (in_focus(part))
      for (const Vec3& p : part.points_mm) framing.radius_mm = std::max(framing.radius_mm, norm(p - framing.center_mm));
  return framing;
}

Json fields_json(const std::vector<validation::WallField>& fields) {
  Json json = Json::array();
  for (const validation::WallField& f : fields)
    json.push_back({{"id", f.id},
                    {"title", f.title},
                    {"unit", f.unit},
                    {"low", f.low},
                    {"high", f.high},
                    {"categories", f.categories}});
  return json;
}

/// Names and colours of the surfaces that the parts have.
Json surfaces_json(const std::vector<ViewPart>& parts) {
  std::set<std::int32_t> tags;
  for (const ViewPart& part : parts) tags.insert(part.surface.begin(), part.surface.end());
  tags.erase(0);
  Json json = Json::array();
  for (const auto tag : tags)
    json.push_back({{"tag", tag},
                    {"name", surface_name(tag)},
                    {"label", spaced(surface_name(tag))},
                    {"color", color_json(surface_color(tag))}});
  return json;
}

}  // namespace

ViewerData viewer_data(const std::map<std::string, TetMesh>& meshes, const validation::FacesOfMeshes& faces,
                       const std::vector<validation::WallField>& fields, const ViewerSettings& settings) {
  const auto found = meshes.find("myocardium");
  const TetMesh none;
  const TetMesh& walls = found == meshes.end() ? none : found->second;
  const bool has_walls = !walls.cells.empty();
  ViewerData data;
  const auto parts = view_parts(meshes, faces, fields, settings);
  if (parts.empty()) return data;
  data.empty = false;
  const Framing framing = frame_parts(parts, has_walls);
  const Vec3 size = framing.all.high - framing.all.low;
  const double scale_mm = std::max({size.x, size.y, size.z, 1.0}) / 65535;
  Packer packer{fields, {framing.all.low, scale_mm}, has_walls};
  const auto inner = wall_lines(walls, fields, settings);
  const auto region_of_node = regions_of_nodes(walls);
  Json index;
  for (const ViewPart& part : parts) {
    Json json = packer.part(part);
    json["lines"] = packer.part_lines(part, settings);
    if (!part.fields.empty()) json["inner"] = packer.inner_lines(inner, region_of_node, part.region);
    data.has_fibers |= !part.is_valve && !json["lines"].is_null();
    data.has_valves |= part.is_valve;
    index["parts"].push_back(std::move(json));
  }
  if (has_walls) index["grids"] = packer.grids(walls);
  index["fields"] = fields_json(fields);
  index["surfaces"] = surfaces_json(parts);
  const validation::HeartFrame frame = validation::heart_frame(walls);
  const Vec3 toward = normalized(cross(-frame.to_right, frame.axis));
  index["chambersView"] = {vec_json(-frame.to_right), vec_json(frame.axis), vec_json(toward)};
  index["low"] = vec_json(framing.all.low);
  index["scale"] = scale_mm;
  index["center"] = vec_json(framing.center_mm);
  index["radius"] = framing.radius_mm;
  index["reach"] = norm(size);
  data.index_json = index.dump();
  data.data_base64 = deflated_base64(packer.blob.bytes);
  return data;
}

}  // namespace heartgen::report
