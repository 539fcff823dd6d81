// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/insulation_checks.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "model/labels.hpp"

namespace heartgen::validation {
namespace {

enum Side : std::uint8_t { nowhere = 0, in_atria = 1, in_ventricles = 2, in_both = 3 };

/// Annuli do not conduct.
Side side_of(std::int32_t region) {
  switch (static_cast<Region>(region)) {
    case Region::la_wall:
    case Region::ra_wall:
      return in_atria;
    case Region::lv_myocardium:
    case Region::rv_myocardium:
    case Region::papillary:
      return in_ventricles;
    default:
      return nowhere;
  }
}

std::vector<std::uint8_t> sides_of_nodes(const TetMesh& mesh) {
  std::vector<std::uint8_t> sides(mesh.nodes_mm.size(), nowhere);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto node : mesh.cells[c]) sides[static_cast<std::size_t>(node)] |= side_of(mesh.region[c]);
  return sides;
}

/// Faces with a conducting cell of each side.
std::int64_t faces_between(const TetMesh& mesh, const std::vector<std::uint8_t>& sides) {
  struct CellFace {
    Face nodes;
    Side side;
  };
  std::vector<CellFace> faces;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t out = 0; out < 4 && side_of(mesh.region[c]) != nowhere; ++out) {
      const Cell& n = mesh.cells[c];
      Face face{n[(out + 1) % 4], n[(out + 2) % 4], n[(out + 3) % 4]};
      if (std::any_of(face.begin(), face.end(),
                      [&](auto node) { return sides[static_cast<std::size_t>(node)] != in_both; }))
        continue;
      std::sort(face.begin(), face.end());
      faces.push_back({face, side_of(mesh.region[c])});
    }
  std::sort(faces.begin(), faces.end(), [](const CellFace& a, const CellFace& b) { return a.nodes < b.nodes; });
  std::int64_t between = 0;
  for (std::size_t f = 0; f + 1 < faces.size(); ++f)
    between += faces[f].nodes == faces[f + 1].nodes && faces[f].side != faces[f + 1].side;
  return between;
}

}  // namespace

Report check_insulation(const std::map<std::string, TetMesh>& meshes, bool is_insulated) {
  Report report;
  for (const auto& [name, mesh] : meshes) {
    const auto sides = sides_of_nodes(mesh);
    const auto has = [&](Side side) {
      return std::any_of(sides.begin(), sides.end(), [side](std::uint8_t s) { return (s & side) != 0; });
    };
    if (!has(in_atria) || !has(in_ventricles)) continue;
    const auto add = [&, scope = name](const char* metric, std::int64_t value) {
      report.push_back({"insulation", scope, metric, static_cast<double>(value), "count", {}, {}});
    };
    add(is_insulated ? "conducting_faces" : "shared_faces", faces_between(mesh, sides));
    add(is_insulated ? "conducting_nodes" : "shared_nodes", std::count(sides.begin(), sides.end(), in_both));
    add("annulus_cells", std::count_if(mesh.region.begin(), mesh.region.end(),
                                       [](std::int32_t region) { return is_annulus(static_cast<Region>(region)); }));
  }
  return report;
}

}  // namespace heartgen::validation
