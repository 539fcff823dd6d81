// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/mesh_heart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "generator/adapters/cgal_mesher.hpp"
#include "generator/mesh/border.hpp"
#include "generator/mesh/cavities.hpp"
#include "generator/mesh/curves.hpp"
#include "generator/mesh/distmesh_cells.hpp"
#include "generator/mesh/domain.hpp"
#include "generator/mesh/floating_walls.hpp"
#include "generator/mesh/improve_kept.hpp"
#include "generator/mesh/insulation.hpp"
#include "generator/mesh/label_repair.hpp"
#include "generator/mesh/lattice_cells.hpp"
#include "generator/mesh/own_edges.hpp"
#include "generator/mesh/seeds.hpp"
#include "generator/mesh/size_field.hpp"
#include "generator/mesh/sort_cells.hpp"
#include "generator/mesh/surfaces.hpp"
#include "generator/mesh/tetgen_cells.hpp"
#include "model/error.hpp"

namespace heartgen::mesh {
namespace {

constexpr double layer_edges = 1.0;       // thickness of the layer around the image, in the coarsest edges
constexpr std::int64_t crumb_cells = 30;  // pieces of a region of so few cells go to their neighbour
constexpr double seed_distance = 0.4;     // distance between first points, in local edges

constexpr std::array<std::string_view, 4> backends{"lattice", "distmesh", "cgal", "tetgen"};

struct DomainFunction {
  const MeshDomain* domain;
  double layer_mm;
  int operator()(const Vec3& lps_mm) const {
    const Vec3 index = index_from_lps(domain->grid, lps_mm);
    const double beyond = beyond_border_mm(domain->grid, index);
    if (beyond > layer_mm) return 0;
    const int region = region_at(*domain, index);
    return region == 0 ? 0 : beyond > 0 ? region + beyond_border : region;
  }
};

adapters::ImplicitDomain implicit_domain(const MeshDomain& domain, const Volume<float>& sizes, double layer_mm) {
  adapters::ImplicitDomain implicit;
  implicit.label_at = DomainFunction{&domain, layer_mm};
  implicit.edge_mm = [&sizes](const Vec3& lps_mm) { return edge_at(sizes, lps_mm); };
  const auto& grid = domain.grid;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (int axis = 0; axis < 3; ++axis) {
      const double margin = 0.5 + (layer_mm + 1) / grid.spacing_mm[axis];
      const auto last = static_cast<double>(grid.size[static_cast<std::size_t>(axis)] - 1);
      index[axis] = (corner >> axis) & 1 ? last + margin : -margin;
    }
    const Vec3 p = lps_from_index(grid, index);
    for (int axis = 0; axis < 3; ++axis) {
      implicit.box_min_mm[axis] = corner == 0 ? p[axis] : std::min(implicit.box_min_mm[axis], p[axis]);
      implicit.box_max_mm[axis] = corner == 0 ? p[axis] : std::max(implicit.box_max_mm[axis], p[axis]);
    }
  }
  LabelVolume voxels;
  voxels.grid = grid;
  voxels.voxels = domain.voxels;
  implicit.surface_points_mm =
      surface_seeds(voxels, implicit.label_at, [&](const Vec3& p) { return seed_distance * edge_at(sizes, p); });
  for (const auto& p : border_layer_points(domain, layer_mm, layer_mm)) implicit.surface_points_mm.push_back(p);
  implicit.curve_balls = balls_along(border_curves(domain, sizes));
  return implicit;
}

constexpr std::int32_t inside_torso = -1;  // between a stub and the torso that it becomes a part of

/// Of an artery that ends once.
std::int32_t end_of(Region artery) { return *surface_from_name(region_name(tag(artery)) + "_end"); }

/// Between a stub, which becomes a part of the torso or goes, and another region.
std::int32_t surface_of_stub(Region other) {
  if (other == Region::torso) return inside_torso;
  if (other == Region::aorta || other == Region::pulmonary_artery) return end_of(other);
  return surface_between(other, Region::torso);
}

std::int32_t surface_of(std::int32_t label, std::int32_t other) {
  if (label == artery_stub_label || other == artery_stub_label)
    return surface_of_stub(static_cast<Region>(label == artery_stub_label ? other : label));
  if (other == label + beyond_border)
    return surface_at_border(surface_between(static_cast<Region>(label), Region::none));
  return surface_between(static_cast<Region>(label), static_cast<Region>(other % beyond_border));
}

bool has_torso(const MeshDomain& domain) { return domain.share_of[tag(Region::torso)] >= 0; }

// The meshes of the bundle have manifold boundaries: everything, the walls, the blood.
std::array<LabelSet, 3> manifold_sets(bool has_torso) {
  std::array<LabelSet, 3> sets{};
  for (const auto& row : region_table()) {
    const auto at = static_cast<std::size_t>(row.tag);
    sets[0][at] = true;
    sets[1][at] = is_myocardium(static_cast<Region>(row.tag));
    sets[2][at] = is_blood(static_cast<Region>(row.tag));
  }
  sets[0][artery_stub_label] = has_torso;
  return sets;
}

// The Delaunay back end: CGAL's refinement, then our own repair.
LabelledCells delaunay_cells(const MeshDomain& domain, const Volume<float>& sizes) {
  const float coarsest = *std::max_element(sizes.voxels.begin(), sizes.voxels.end());
  auto cells = adapters::mesh_implicit(implicit_domain(domain, sizes, layer_edges * coarsest), {});
  repair_labels(cells.nodes_mm, cells.cells, cells.label, manifold_sets(has_torso(domain)), crumb_cells);
  flatten_border(domain.grid, cells.nodes_mm, cells.cells, cells.label);
  improve_kept(cells, beyond_border);
  flatten_border(domain.grid, cells.nodes_mm, cells.cells, cells.label);
  return cells;
}

/// What floats takes the label around it; where that leaves a boundary that touches itself, a few cells more change.
void join_walls(LabelledCells& cells, bool has_torso) {
  constexpr int max_rounds = 4;  // what one step mends, the other may break again
  const auto sets = manifold_sets(has_torso);
  for (int round = 0; round < max_rounds; ++round) {
    if (absorb_floating_walls(cells.nodes_mm, cells.cells, cells.label, sets[1]) == 0) return;
    repair_labels(cells.nodes_mm, cells.cells, cells.label, sets, 0);
    cells.is_on_surface.clear();
  }
}

/// What a face of a vessel against a stub is called: an end, or the vessel's wall beside another vessel's stub.
std::int32_t surface_at_stub(const TetMesh& mesh, const Face& face, Region vessel, const std::vector<HeartEnd>& ends) {
  constexpr double plane_tolerance_mm = 0.5;
  Vec3 center;
  for (const auto node : face) center += mesh.nodes_mm[static_cast<std::size_t>(node)] / 3;
  const auto* end = nearest_end(ends, vessel, center);
  const bool is_end =
      end != nullptr && std::abs(dot(center - end->plane.center_mm, end->plane.normal)) < plane_tolerance_mm;
  return is_end ? end->surface : surface_between(vessel, Region::torso);
}

/// Stubs become the torso's.
void settle_ends(TetMesh& mesh, const std::vector<HeartEnd>& ends) {
  if (ends.empty()) return;
  for (auto& region : mesh.region)
    if (region == artery_stub_label) region = tag(Region::torso);
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    auto surface = mesh.surface[f];
    if (surface == inside_torso) continue;
    for (const Region vessel : {Region::aorta, Region::pulmonary_artery})
      if (surface == end_of(vessel)) surface = surface_at_stub(mesh, mesh.faces[f], vessel, ends);
    mesh.faces[kept] = mesh.faces[f];
    mesh.surface[kept++] = surface;
  }
  mesh.faces.resize(kept);
  mesh.surface.resize(kept);
}

/// "aorta_end", "aorta_end_2", and not "lv_endocardium".
bool is_end(std::int32_t surface) {
  const auto name = surface_name(surface);
  return name.ends_with("_end") || name.find("_end_") != std::string::npos;
}

void add_rims(TetMesh& mesh) {
  std::vector<std::int32_t> surfaces;
  for (const auto* name : {"mitral_orifice", "aortic_orifice", "tricuspid_orifice", "pulmonary_orifice"})
    surfaces.push_back(*surface_from_name(name));
  std::set<std::int32_t> ends(mesh.surface.begin(), mesh.surface.end());
  std::erase_if(ends, [](std::int32_t surface) { return !is_end(surface); });
  surfaces.insert(surfaces.end(), ends.begin(), ends.end());
  for (const auto surface : surfaces)
    if (auto rim = rim_of(mesh, surface); !rim.nodes.empty()) mesh.rims.push_back(std::move(rim));
}

Face ascending(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

// Faces of the cells that are kept, as the whole mesh labels them; normals out of the kept cell.
void copy_faces(const TetMesh& mesh, const std::vector<std::int32_t>& new_node, TetMesh& part) {
  std::vector<std::pair<Face, std::int32_t>> labelled;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    Face face = mesh.faces[f];
    for (auto& n : face) n = new_node[static_cast<std::size_t>(n)];
    face = ascending(face);
    if (face[0] >= 0) labelled.emplace_back(face, mesh.surface[f]);
  }
  std::sort(labelled.begin(), labelled.end());
  for (const auto& face : cell_faces(part.cells)) {
    const std::pair<Face, std::int32_t> key{ascending(face.nodes), 0};
    const auto found = std::lower_bound(labelled.begin(), labelled.end(), key);
    if (found == labelled.end() || found->first != key.first) continue;
    const auto region = [&](std::int32_t cell) { return part.region[static_cast<std::size_t>(cell)]; };
    const bool turned = face.other >= 0 && region(face.other) < region(face.cell);
    part.faces.push_back(turned ? Face{face.nodes[0], face.nodes[2], face.nodes[1]} : face.nodes);
    part.surface.push_back(found->second);
  }
}

void copy_rims(const TetMesh& mesh, const std::vector<std::int32_t>& new_node, TetMesh& part) {
  for (const auto& rim : mesh.rims) {
    Rim kept{rim.name, rim.tag, {}};
    for (const auto n : rim.nodes)
      if (const auto id = new_node[static_cast<std::size_t>(n)]; id >= 0) kept.nodes.push_back(id);
    if (!kept.nodes.empty()) part.rims.push_back(std::move(kept));
  }
}

std::vector<Region> regions_where(bool (*accept)(Region)) {
  std::vector<Region> regions;
  for (const auto& row : region_table())
    if (accept(static_cast<Region>(row.tag))) regions.push_back(static_cast<Region>(row.tag));
  return regions;
}

/// Of the walls cut out of the whole mesh, whose nodes their parent ids name.
void add_cavities(const TetMesh& whole, TetMesh& walls) {
  std::vector<std::int32_t> new_node(whole.nodes_mm.size(), -1);
  for (std::size_t n = 0; n < walls.parent_node.size(); ++n)
    new_node[static_cast<std::size_t>(walls.parent_node[n])] = static_cast<std::int32_t>(n);
  walls.cavities = cavities_of_part(find_cavities(whole), new_node);
}

void require(const LabelVolume& labels, std::initializer_list<Region> regions) {
  std::array<bool, 256> present{};
  for (const auto voxel : labels.voxels) present[voxel] = true;
  for (const Region r : regions)
    if (!present[tag(r)])
      throw UserError(fmt::format("region {} is empty", region_name(tag(r))), "mesh",
                      "look at the label map; check the seeds, the valve planes and the segmentation steps");
}

}  // namespace

void check_settings(const MeshSettings& s) {
  for (const auto& [name, value] : {std::pair{"heart_edge_mm", s.heart_edge_mm},
                                    {"blood_edge_mm", s.blood_edge_mm},
                                    {"torso_edge_mm", s.torso_edge_mm},
                                    {"growth", s.growth}})
    if (!(value > 0) || !std::isfinite(value))
      throw UserError(fmt::format("{} is {}", name, value), "recipe, [mesh]", "it must be a positive number");
  if (std::find(backends.begin(), backends.end(), s.backend) == backends.end())
    throw UserError(fmt::format("unknown backend \"{}\"", s.backend), "recipe, [mesh]",
                    fmt::format("use \"{}\"", fmt::join(backends, "\", \"")));
  insulation_named(s.insulation);
  if (s.wall_layers < 0 || s.wall_layers > max_wall_layers)
    throw UserError(fmt::format("wall_layers is {}", s.wall_layers), "recipe, [mesh]",
                    fmt::format("it must be a whole number from 0 to {}", max_wall_layers));
  constexpr double max_smoothing_mm = 20;  // nothing of a heart is left then
  if (!(s.smoothing_mm >= 0 && s.smoothing_mm <= max_smoothing_mm))
    throw UserError(fmt::format("smoothing_mm is {}", s.smoothing_mm), "recipe, [mesh]",
                    fmt::format("it must be between 0 and {:g}", max_smoothing_mm));
}

LabelVolume heart_only(const LabelVolume& labels) {
  LabelVolume heart = labels;
  for (auto& voxel : heart.voxels)
    if (!is_myocardium(static_cast<Region>(voxel)) && !is_blood(static_cast<Region>(voxel))) voxel = 0;
  return heart;
}

TetMesh mesh_labels(const LabelVolume& labels, const MeshSettings& settings, LatticeReport* report,
                    const Volume<float>* own_edges_mm) {
  check_settings(settings);
  return mesh_domain(make_domain(labels, settings), settings, report, own_edges_mm, find_heart_ends(labels));
}

TetMesh mesh_domain(const MeshDomain& domain, const MeshSettings& settings, LatticeReport* report,
                    const Volume<float>* own_edges_mm, const std::vector<HeartEnd>& ends) {
  check_settings(settings);
  const bool is_delaunay = settings.backend == "cgal";
  const auto own = own_edges_mm == nullptr ? std::vector<float>{} : own_edges_on(*own_edges_mm, domain.grid);
  const auto sizes = size_field(domain, settings, is_delaunay ? LabelSet{} : regions_with_shape(), own);
  const auto sets = manifold_sets(has_torso(domain));
  auto cells = is_delaunay                      ? delaunay_cells(domain, sizes)
               : settings.backend == "tetgen"   ? tetgen_cells(domain, sizes, sets, crumb_cells, report)
               : settings.backend == "distmesh" ? distmesh_cells(domain, sizes, sets, crumb_cells, report)
                                                : lattice_cells(domain, sizes, sets, crumb_cells, report, ends);
  join_walls(cells, has_torso(domain));
  sort_cells(cells.nodes_mm, cells.cells, cells.label);
  const bool keeps_stubs = has_torso(domain);
  auto mesh = assemble(
      cells,
      [=](std::int32_t label) {
        return label > 0 && label < beyond_border && (keeps_stubs || label != artery_stub_label);
      },
      surface_of);
  settle_ends(mesh, ends);
  label_border_faces(mesh, domain.grid);
  add_rims(mesh);
  return mesh;
}

TetMesh extract_regions(const TetMesh& mesh, std::span<const Region> regions) {
  std::array<bool, 256> kept{};
  for (const Region r : regions) kept[tag(r)] = true;
  TetMesh part;
  std::vector<std::int32_t> new_node(mesh.nodes_mm.size(), -1);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (!kept[static_cast<std::size_t>(mesh.region[c])]) continue;
    part.cells.push_back(mesh.cells[c]);
    part.region.push_back(mesh.region[c]);
    part.parent_cell.push_back(static_cast<std::int32_t>(c));
    for (const auto n : mesh.cells[c]) new_node[static_cast<std::size_t>(n)] = 0;
  }
  for (std::size_t n = 0; n < new_node.size(); ++n) {
    if (new_node[n] < 0) continue;
    new_node[n] = static_cast<std::int32_t>(part.nodes_mm.size());
    part.nodes_mm.push_back(mesh.nodes_mm[n]);
    part.parent_node.push_back(static_cast<std::int32_t>(n));
  }
  for (auto& cell : part.cells)
    for (auto& n : cell) n = new_node[static_cast<std::size_t>(n)];
  copy_faces(mesh, new_node, part);
  copy_rims(mesh, new_node, part);
  return part;
}

std::map<std::string, TetMesh> mesh_heart(const LabelVolume& labels, const MeshSettings& settings,
                                          const Volume<float>* own_edges_mm) {
  const auto wanted = [&](const char* name) {
    return std::find(settings.meshes.begin(), settings.meshes.end(), name) != settings.meshes.end();
  };
  if (wanted("myocardium")) require(labels, {Region::lv_myocardium, Region::rv_myocardium});
  if (wanted("myocardium") || wanted("chambers")) require(labels, {Region::lv_blood});
  std::map<std::string, TetMesh> meshes;
  if (!wanted("myocardium") && !wanted("chambers") && !wanted("torso")) return meshes;
  auto whole = mesh_labels(wanted("torso") ? labels : heart_only(labels), settings, nullptr, own_edges_mm);
  for (const auto& [name, accept] : {std::pair{"myocardium", &is_myocardium}, std::pair{"chambers", &is_blood}}) {
    if (!wanted(name)) continue;
    auto& part = meshes[name] = extract_regions(whole, regions_where(accept));
    if (accept == &is_myocardium) add_cavities(whole, part);
    if (wanted("torso")) continue;
    part.parent_node.clear();
    part.parent_cell.clear();
  }
  if (wanted("torso")) meshes["torso"] = std::move(whole);
  return meshes;
}

}  // namespace heartgen::mesh
