// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/cut.hpp"

#include <algorithm>

#include "exporters/adjacency.hpp"
#include "model/error.hpp"

namespace heartgen::exporters {
namespace {

bool is_ventricle(Region r) {
  return r == Region::lv_myocardium || r == Region::rv_myocardium || r == Region::papillary;
}
bool is_atrium(Region r) { return is_myocardium(r) && !is_ventricle(r); }

struct NamedSet {
  std::string_view name;
  bool (*holds)(Region);
};
constexpr NamedSet named_sets[] = {
    {"ventricles", &is_ventricle}, {"atria", &is_atrium}, {"walls", &is_myocardium}, {"blood", &is_blood}};

std::set<std::int32_t> regions_named(const std::string& name) {
  if (const auto region = region_from_name(name)) return {tag(*region)};
  std::string known;
  for (const auto& set : named_sets) {
    known += std::string(set.name) + ", ";
    if (set.name != name) continue;
    std::set<std::int32_t> tags;
    for (const auto& row : region_table())
      if (set.holds(static_cast<Region>(row.tag))) tags.insert(row.tag);
    return tags;
  }
  for (const auto& row : region_table()) known += std::string(row.name) + (row.name == "torso" ? "" : ", ");
  throw UserError("there is no region '" + name + "'", "export --only", "known: " + known);
}

/// Ids of what is kept, ascending, and the new id of every old one (-1: gone).
struct Kept {
  std::vector<std::int32_t> old_id, new_id;
};

template <class Keep>
Kept keep_where(std::size_t count, const Keep& keep) {
  Kept kept;
  kept.new_id.assign(count, -1);
  for (std::size_t i = 0; i < count; ++i) {
    if (!keep(i)) continue;
    kept.new_id[i] = static_cast<std::int32_t>(kept.old_id.size());
    kept.old_id.push_back(static_cast<std::int32_t>(i));
  }
  return kept;
}

template <class T>
std::vector<T> picked(const std::vector<T>& values, const std::vector<std::int32_t>& ids) {
  if (values.empty()) return {};
  std::vector<T> result;
  result.reserve(ids.size());
  for (const auto id : ids) result.push_back(values[static_cast<std::size_t>(id)]);
  return result;
}

FiberField picked(const FiberField& fibers, const std::vector<std::int32_t>& ids) {
  return {picked(fibers.fiber, ids), picked(fibers.sheet, ids), picked(fibers.sheet_normal, ids)};
}

template <std::size_t N>
void renumber(std::vector<std::array<std::int32_t, N>>& elements, const std::vector<std::int32_t>& new_id) {
  for (auto& element : elements)
    for (auto& node : element) node = new_id[static_cast<std::size_t>(node)];
}

/// Out of the kept cell, which may be the second of the face's two.
Face turned_outwards(const Face& face, bool kept_first) { return kept_first ? face : Face{face[0], face[2], face[1]}; }

void keep_faces(const TetMesh& mesh, const Kept& cells, TetMesh& part) {
  const auto sides = cells_of_faces(mesh);
  const auto junction = *surface_from_name("atrioventricular_junction"), base = *surface_from_name("base");
  const auto region = [&](std::int32_t cell) { return mesh.region[static_cast<std::size_t>(cell)]; };
  const auto is_kept = [&](std::int32_t cell) {
    return cell >= 0 && cells.new_id[static_cast<std::size_t>(cell)] >= 0;
  };
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto [a, b] = sides[f];
    if (!is_kept(a) && !is_kept(b)) continue;
    const bool is_new = b >= 0 && is_kept(a) != is_kept(b);
    const bool lower_kept = !is_new || (region(a) < region(b)) == is_kept(a);  // faces look to the higher region
    part.faces.push_back(turned_outwards(mesh.faces[f], lower_kept));
    part.surface.push_back(is_new && mesh.surface[f] == junction ? base : mesh.surface[f]);
  }
}

void keep_rims(const TetMesh& mesh, const Kept& nodes, TetMesh& part) {
  for (const auto& rim : mesh.rims) {
    Rim kept{rim.name, rim.tag, {}};
    for (const auto node : rim.nodes)
      if (const auto id = nodes.new_id[static_cast<std::size_t>(node)]; id >= 0) kept.nodes.push_back(id);
    if (!kept.nodes.empty()) part.rims.push_back(std::move(kept));
  }
}

/// Those whose every node is kept.
void keep_cavities(const TetMesh& mesh, const Kept& nodes, TetMesh& part) {
  for (Cavity cavity : mesh.cavities) {
    renumber(cavity.faces, nodes.new_id);
    const bool is_whole = std::all_of(cavity.faces.begin(), cavity.faces.end(),
                                      [](const Face& face) { return face[0] >= 0 && face[1] >= 0 && face[2] >= 0; });
    if (is_whole) part.cavities.push_back(std::move(cavity));
  }
}

}  // namespace

std::set<std::int32_t> regions_named(std::span<const std::string> names) {
  std::set<std::int32_t> tags;
  for (const auto& name : names) tags.merge(regions_named(name));
  return tags;
}

TetMesh only_regions(const TetMesh& mesh, const std::set<std::int32_t>& regions) {
  const Kept cells = keep_where(mesh.cells.size(), [&](std::size_t c) { return regions.contains(mesh.region[c]); });
  std::vector<char> used(mesh.nodes_mm.size(), 0);
  for (const auto cell : cells.old_id)
    for (const auto node : mesh.cells[static_cast<std::size_t>(cell)]) used[static_cast<std::size_t>(node)] = 1;
  const Kept nodes = keep_where(used.size(), [&](std::size_t n) { return used[n] != 0; });
  TetMesh part;
  part.nodes_mm = picked(mesh.nodes_mm, nodes.old_id);
  part.cells = picked(mesh.cells, cells.old_id);
  part.region = picked(mesh.region, cells.old_id);
  keep_faces(mesh, cells, part);
  renumber(part.cells, nodes.new_id);
  renumber(part.faces, nodes.new_id);
  keep_rims(mesh, nodes, part);
  part.node_fibers = picked(mesh.node_fibers, nodes.old_id);
  part.cell_fibers = picked(mesh.cell_fibers, cells.old_id);
  part.fiber_source = picked(mesh.fiber_source, nodes.old_id);
  part.rule_difference_deg = picked(mesh.rule_difference_deg, cells.old_id);
  part.user_region = picked(mesh.user_region, cells.old_id);
  for (const auto& region : mesh.user_regions)
    part.user_regions.push_back({region.name, region.tag, picked(region.fraction, cells.old_id)});
  keep_cavities(mesh, nodes, part);
  part.parent_node = nodes.old_id;
  part.parent_cell = cells.old_id;
  return part;
}

TetMesh without_interfaces(TetMesh mesh) {
  const auto sides = cells_of_faces(mesh);
  const Kept outer = keep_where(mesh.faces.size(), [&](std::size_t f) { return sides[f][1] < 0; });
  mesh.faces = picked(mesh.faces, outer.old_id);
  mesh.surface = picked(mesh.surface, outer.old_id);
  return mesh;
}

}  // namespace heartgen::exporters
