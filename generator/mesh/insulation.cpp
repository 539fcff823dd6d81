// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/insulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>
#include <vector>

#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::mesh {
namespace {

using Marks = std::vector<std::uint8_t>;

bool is_atrial(std::int32_t region) {
  return region == tag(Region::la_wall) || region == tag(Region::ra_wall) || is_annulus(static_cast<Region>(region));
}
bool is_ventricular(std::int32_t region) { return is_myocardium(static_cast<Region>(region)) && !is_atrial(region); }

std::int32_t wall_of(std::int32_t annulus) {
  return annulus == tag(Region::la_annulus) ? tag(Region::la_wall) : tag(Region::ra_wall);
}
std::int32_t annulus_of(std::int32_t wall) {
  return wall == tag(Region::la_wall) ? tag(Region::la_annulus) : tag(Region::ra_annulus);
}

template <class IsPart>
Marks nodes_of_cells(const TetMesh& mesh, const IsPart& is_part) {
  Marks marks(mesh.nodes_mm.size(), 0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (is_part(c))
      for (const auto node : mesh.cells[c]) marks[static_cast<std::size_t>(node)] = 1;
  return marks;
}

template <std::size_t N>
std::int64_t count_marked(const Marks& marks, const std::array<std::int32_t, N>& nodes) {
  return std::count_if(nodes.begin(), nodes.end(),
                       [&](std::int32_t n) { return marks[static_cast<std::size_t>(n)] != 0; });
}

Face ascending(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

/// A face of a cell: its nodes ascending, and as seen from outside of the cell.
struct CellSide {
  Face key, outward;
  std::int32_t region;
  bool operator<(const CellSide& other) const { return std::tie(key, region) < std::tie(other.key, other.region); }
};

/// Of the cells' faces, those with all nodes marked, by their nodes, the lower region first.
std::vector<CellSide> sides_between(const TetMesh& mesh, const Marks& marks) {
  constexpr std::array<std::array<std::size_t, 3>, 4> corners{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::vector<CellSide> sides;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (count_marked(marks, mesh.cells[c]) < 3) continue;
    for (const auto& corner : corners) {
      const Face face{mesh.cells[c][corner[0]], mesh.cells[c][corner[1]], mesh.cells[c][corner[2]]};
      if (count_marked(marks, face) == 3) sides.push_back({ascending(face), face, mesh.region[c]});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

/// The lower region's side of a face; the end where there is none.
std::vector<CellSide>::const_iterator find_side(const std::vector<CellSide>& sides, const Face& face) {
  const Face key = ascending(face);
  const auto found = std::lower_bound(sides.begin(), sides.end(), key,
                                      [](const CellSide& side, const Face& k) { return side.key < k; });
  return found != sides.end() && found->key == key ? found : sides.end();
}

/// Faces look out of the lower of their regions, which regions that have changed may turn round.
void turn_faces(TetMesh& mesh, const Marks& marks, const std::vector<CellSide>& sides) {
  for (auto& face : mesh.faces)
    if (count_marked(marks, face) == 3)
      if (const auto side = find_side(sides, face); side != sides.end()) face = side->outward;
}

void add_borders(TetMesh& mesh, const std::vector<CellSide>& sides) {
  const auto border = *surface_from_name("annulus_border");
  for (std::size_t s = 0; s + 1 < sides.size(); ++s) {
    const auto &wall = sides[s], &annulus = sides[s + 1];
    const bool is_border = wall.key == annulus.key && is_annulus(static_cast<Region>(annulus.region)) &&
                           wall.region == wall_of(annulus.region);
    if (!is_border) continue;
    mesh.faces.push_back(wall.outward);
    mesh.surface.push_back(border);
  }
}

bool is_annulus_cell(const TetMesh& mesh, std::size_t cell) {
  return is_annulus(static_cast<Region>(mesh.region[cell]));
}

/// Faces and borders for annuli that the regions have got.
void label_annuli(TetMesh& mesh) {
  const auto marks = nodes_of_cells(mesh, [&](std::size_t c) { return is_annulus_cell(mesh, c); });
  const auto sides = sides_between(mesh, marks);
  turn_faces(mesh, marks, sides);
  add_borders(mesh, sides);
}

template <class T>
void append_copies(std::vector<T>& values, const std::vector<std::int32_t>& of) {
  if (values.empty()) return;
  for (const auto node : of) values.push_back(values[static_cast<std::size_t>(node)]);
}

/// Nodes at the same place as one before: the id of that; of all others their own.
std::vector<std::int32_t> first_at_place(const TetMesh& mesh) {
  std::vector<std::int32_t> order(mesh.nodes_mm.size()), first(mesh.nodes_mm.size());
  for (std::size_t n = 0; n < order.size(); ++n) order[n] = static_cast<std::int32_t>(n);
  const auto key = [&](std::int32_t n) {
    const Vec3& p = mesh.nodes_mm[static_cast<std::size_t>(n)];
    return std::tuple(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_same = i > 0 && key(order[i]) == key(order[i - 1]);
    first[static_cast<std::size_t>(order[i])] = is_same ? first[static_cast<std::size_t>(order[i - 1])] : order[i];
  }
  return first;
}

void rename_nodes(TetMesh& mesh, const std::vector<std::int32_t>& name) {
  const auto rename = [&](auto& elements) {
    for (auto& element : elements)
      for (auto& node : element) node = name[static_cast<std::size_t>(node)];
  };
  rename(mesh.cells);
  rename(mesh.faces);
  for (auto& cavity : mesh.cavities) rename(cavity.faces);
  for (auto& rim : mesh.rims) {
    for (auto& node : rim.nodes) node = name[static_cast<std::size_t>(node)];
    sort_unique(rim.nodes);
  }
}

void drop_nodes_from(TetMesh& mesh, std::size_t count) {
  const auto cut = [count](auto& values) {
    if (!values.empty()) values.resize(count);
  };
  cut(mesh.nodes_mm);
  for (auto* axes : {&mesh.node_fibers.fiber, &mesh.node_fibers.sheet, &mesh.node_fibers.sheet_normal}) cut(*axes);
  cut(mesh.fiber_source);
  cut(mesh.parent_node);
}

}  // namespace

Insulation insulation_named(const std::string& name) {
  if (name == "layer") return Insulation::layer;
  if (name == "split") return Insulation::split;
  if (name == "none") return Insulation::none;
  throw UserError(fmt::format("unknown insulation \"{}\"", name), "mesh.insulation",
                  "give \"layer\", \"split\" or \"none\"");
}

void add_annuli(TetMesh& mesh) {
  const auto marks = nodes_of_cells(mesh, [&](std::size_t c) { return is_ventricular(mesh.region[c]); });
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (is_atrial(mesh.region[c]) && !is_annulus_cell(mesh, c) && count_marked(marks, mesh.cells[c]) > 0)
      mesh.region[c] = annulus_of(mesh.region[c]);
  label_annuli(mesh);
}

void split_nodes(TetMesh& mesh) {
  const auto of_ventricles = nodes_of_cells(mesh, [&](std::size_t c) { return is_ventricular(mesh.region[c]); });
  const auto of_atria = nodes_of_cells(mesh, [&](std::size_t c) { return is_atrial(mesh.region[c]); });
  std::vector<std::int32_t> shared, copy(mesh.nodes_mm.size());
  Marks marks(mesh.nodes_mm.size(), 0);
  for (std::size_t n = 0; n < copy.size(); ++n) {
    copy[n] = static_cast<std::int32_t>(n);
    if (of_ventricles[n] == 0 || of_atria[n] == 0) continue;
    marks[n] = 1;
    copy[n] = static_cast<std::int32_t>(mesh.nodes_mm.size() + shared.size());
    shared.push_back(static_cast<std::int32_t>(n));
  }
  const auto renamed = [&](auto element) {
    for (auto& node : element) node = copy[static_cast<std::size_t>(node)];
    return element;
  };
  const auto sides = sides_between(mesh, of_atria);
  std::vector<Face> of_other_side;
  for (auto& face : mesh.faces) {
    if (count_marked(marks, face) == 0) continue;
    const auto first = find_side(sides, face);
    if (first == sides.end()) continue;
    const auto second = std::next(first);
    const bool has_second = second != sides.end() && second->key == first->key;
    if (has_second && is_atrial(first->region) != is_atrial(second->region))
      of_other_side.push_back(renamed(is_atrial(first->region) ? first->outward : second->outward));
    else if (is_atrial(first->region))
      face = renamed(face);
  }
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (is_atrial(mesh.region[c])) mesh.cells[c] = renamed(mesh.cells[c]);
  mesh.faces.insert(mesh.faces.end(), of_other_side.begin(), of_other_side.end());
  mesh.surface.resize(mesh.faces.size(), *surface_from_name("atrioventricular_junction"));
  for (auto& rim : mesh.rims) {
    const auto nodes = rim.nodes;
    for (const auto node : nodes) rim.nodes.push_back(copy[static_cast<std::size_t>(node)]);
    sort_unique(rim.nodes);
  }
  for (auto& cavity : mesh.cavities)
    if (cavity.region == tag(Region::la_blood) || cavity.region == tag(Region::ra_blood))
      for (auto& face : cavity.faces) face = renamed(face);
  append_copies(mesh.nodes_mm, shared);
  for (auto* axes : {&mesh.node_fibers.fiber, &mesh.node_fibers.sheet, &mesh.node_fibers.sheet_normal})
    append_copies(*axes, shared);
  append_copies(mesh.fiber_source, shared);
  append_copies(mesh.parent_node, shared);
}

void take_out_annuli(TetMesh& mesh) {
  const auto marks = nodes_of_cells(mesh, [&](std::size_t c) { return is_annulus_cell(mesh, c); });
  for (auto& region : mesh.region)
    if (is_annulus(static_cast<Region>(region))) region = wall_of(region);
  const auto border = *surface_from_name("annulus_border");
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.surface[f] == border) continue;
    mesh.faces[kept] = mesh.faces[f];
    mesh.surface[kept++] = mesh.surface[f];
  }
  mesh.faces.resize(kept);
  mesh.surface.resize(kept);
  turn_faces(mesh, marks, sides_between(mesh, marks));
}

/// Copies are behind all other nodes. Faces between both sides stay once.
void merge_split_nodes(TetMesh& mesh) {
  const auto first = first_at_place(mesh);
  std::size_t own = first.size();
  while (own > 0 && first[own - 1] != static_cast<std::int32_t>(own) - 1) --own;
  if (own == first.size()) return;
  rename_nodes(mesh, first);
  drop_nodes_from(mesh, own);
  const auto junction = *surface_from_name("atrioventricular_junction");
  std::vector<Face> met;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (mesh.surface[f] == junction) met.push_back(ascending(mesh.faces[f]));
  std::sort(met.begin(), met.end());
  std::size_t kept = 0;
  std::vector<std::uint8_t> is_kept(met.size(), 0);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.surface[f] == junction) {
      const auto at = std::lower_bound(met.begin(), met.end(), ascending(mesh.faces[f])) - met.begin();
      if (std::exchange(is_kept[static_cast<std::size_t>(at)], 1) != 0) continue;
    }
    mesh.faces[kept] = mesh.faces[f];
    mesh.surface[kept++] = mesh.surface[f];
  }
  mesh.faces.resize(kept);
  mesh.surface.resize(kept);
}

}  // namespace heartgen::mesh
