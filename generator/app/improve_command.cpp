#include "generator/app/improve_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "generator/adapters/vtk_io.hpp"
#include "generator/improve/carry_data.hpp"
#include "generator/improve/msh_file.hpp"
#include "generator/improve/orient.hpp"
#include "model/error.hpp"
#include "model/text.hpp"
#include "validation/cell_quality.hpp"

namespace heart::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Names that programs give to the array of regions, ours first.
constexpr std::array region_names{"region",    "gmsh:physical",    "CellEntityIds",  "material",
                                  "medit:ref", "elemTag",          "tags",           "tag",
                                  "attribute", "gmsh:geometrical", "PhysicalGroups", "label"};

bool is_msh(const std::string& path) { return fs::path(path).extension() == ".msh"; }

/// What was read: arrays of any kind, and from .msh files names and triangles.
struct UserMesh {
  adapters::UnstructuredData data;
  improve::MshMesh gmsh;  ///< names and faces only
  std::string region_name;
  std::vector<std::int32_t> region;
};

std::vector<std::int32_t> whole_numbers(const std::vector<double>& values, const std::string& name,
                                        const std::string& file) {
  if (!improve::are_codes(values))
    throw UserError(fmt::format("the array \"{}\" does not hold whole numbers", name), file,
                    "name the array with the regions: --region NAME");
  return {values.begin(), values.end()};
}

void find_region(UserMesh& mesh, const ImproveCommand& command) {
  const auto& arrays = mesh.data.cell_scalars;
  if (!command.region.empty() && !arrays.contains(command.region)) {
    std::vector<std::string> names;
    names.reserve(arrays.size());
    for (const auto& [name, values] : arrays) names.push_back(name);
    throw UserError(fmt::format("has no cell array \"{}\"", command.region), command.input,
                    names.empty() ? "it has no array of one number per cell"
                                  : fmt::format("its arrays: {}", fmt::join(names, ", ")));
  }
  mesh.region_name = command.region;
  for (const auto* name : region_names)
    if (mesh.region_name.empty() && arrays.contains(name)) mesh.region_name = name;
  if (mesh.region_name.empty()) return;
  mesh.region = whole_numbers(arrays.at(mesh.region_name), mesh.region_name, command.input);
}

UserMesh read_mesh(const ImproveCommand& command) {
  UserMesh mesh;
  if (is_msh(command.input)) {
    mesh.gmsh = improve::read_msh(command.input);
    mesh.data.points = std::move(mesh.gmsh.nodes);
    mesh.data.tets = std::move(mesh.gmsh.cells);
    mesh.data.cell_scalars["region"] = {mesh.gmsh.region.begin(), mesh.gmsh.region.end()};
  } else {
    mesh.data = adapters::read_unstructured(command.input);
  }
  for (const auto& name : command.drop) {
    const auto dropped = mesh.data.point_scalars.erase(name) + mesh.data.point_vectors.erase(name) +
                         mesh.data.point_tensors.erase(name) + mesh.data.cell_scalars.erase(name) +
                         mesh.data.cell_vectors.erase(name) + mesh.data.cell_tensors.erase(name);
    if (dropped == 0) throw UserError(fmt::format("has no array \"{}\"", name), command.input, "correct --drop");
  }
  find_region(mesh, command);
  return mesh;
}

void refuse_ids(const UserMesh& mesh, const std::string& file) {
  const auto refuse = [&](const char* what, const std::string& name) {
    throw UserError(fmt::format("the array \"{}\" numbers the {} and cannot be carried to others", name, what), file,
                    "leave it out: --drop " + name);
  };
  for (const auto& [name, values] : mesh.data.point_scalars)
    if (improve::are_ids(values)) refuse("nodes", name);
  for (const auto& [name, values] : mesh.data.cell_scalars)
    if (name != mesh.region_name && improve::are_ids(values)) refuse("cells", name);
}

bool is_axis(const std::string& name) {
  static const std::set<std::string> axes{"fiber", "fibre", "sheet", "sheet_normal", "f0", "s0", "n0"};
  return axes.contains(name);
}

template <class T>
std::vector<T> picked(const std::vector<T>& values, const std::vector<std::int32_t>& from) {
  std::vector<T> result;
  result.reserve(from.size());
  for (const auto i : from) result.push_back(values[static_cast<std::size_t>(i)]);
  return result;
}

adapters::UnstructuredData carry(const UserMesh& old, const improve::ImprovedMesh& improved) {
  const auto cells = improve::oriented_cells(old.data.points, old.data.tets);
  const auto nodes_from = improve::node_sources(old.data.points, cells, improved);
  const auto cells_from = improve::cell_sources(old.data.points, cells, old.region, improved);
  adapters::UnstructuredData result;
  result.points = improved.nodes_mm;
  result.tets = improved.cells;
  for (const auto& [name, values] : old.data.point_scalars)
    result.point_scalars[name] = improve::carried(values, nodes_from);
  for (const auto& [name, values] : old.data.point_vectors)
    result.point_vectors[name] =
        is_axis(name) ? improve::carried_axes(values, nodes_from) : improve::carried(values, nodes_from);
  for (const auto& [name, values] : old.data.point_tensors)
    result.point_tensors[name] = improve::carried(values, nodes_from);
  for (const auto& [name, values] : old.data.cell_scalars) result.cell_scalars[name] = picked(values, cells_from);
  for (const auto& [name, values] : old.data.cell_vectors) result.cell_vectors[name] = picked(values, cells_from);
  for (const auto& [name, values] : old.data.cell_tensors) result.cell_tensors[name] = picked(values, cells_from);
  if (!old.region_name.empty()) result.cell_scalars[old.region_name] = {improved.region.begin(), improved.region.end()};
  auto& vectors = result.point_vectors;
  if (vectors.contains("fiber") && vectors.contains("sheet") && vectors.contains("sheet_normal"))
    improve::straighten(vectors["fiber"], vectors["sheet"], vectors["sheet_normal"]);
  return result;
}

/// The file's triangles with their new numbers, where the surfaces stayed.
void carry_faces(improve::MshMesh& gmsh, const improve::ImprovedMesh& improved, std::size_t old_nodes) {
  std::vector<std::int32_t> id(old_nodes, -1);
  for (std::size_t n = 0; n < improved.old_node.size(); ++n)
    if (improved.old_node[n] >= 0) id[static_cast<std::size_t>(improved.old_node[n])] = static_cast<std::int32_t>(n);
  std::size_t kept = 0;
  for (std::size_t f = 0; f < gmsh.faces.size(); ++f) {
    Face face = gmsh.faces[f];
    for (auto& n : face) n = id[static_cast<std::size_t>(n)];
    if (!improved.is_fixed || std::any_of(face.begin(), face.end(), [](std::int32_t n) { return n < 0; })) continue;
    gmsh.faces[kept] = face;
    gmsh.surface[kept++] = gmsh.surface[f];
  }
  gmsh.faces.resize(kept);
  gmsh.surface.resize(kept);
}

void write_mesh(const std::string& path, const adapters::UnstructuredData& data, improve::MshMesh gmsh,
                const std::vector<std::int32_t>& region) {
  if (!is_msh(path)) {
    adapters::write_unstructured(path, data);
    return;
  }
  gmsh.nodes = data.points;
  gmsh.cells = data.tets;
  gmsh.region = region;
  improve::write_msh(path, gmsh);
}

// ---- what is printed ----

constexpr std::size_t bin_count = 14;
constexpr double bin_deg = 5;

struct Angles {
  std::size_t nodes = 0, cells = 0;
  std::int64_t inverted = 0;
  double least_deg = 180, most_deg = 0;
  std::array<std::int64_t, bin_count> cells_by_least{};  ///< smallest dihedral angle, in steps of 5 degrees
};

Angles measure(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells) {
  Angles angles{nodes.size(), cells.size()};
  for (const auto& cell : cells) {
    std::array<Vec3, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = nodes[static_cast<std::size_t>(cell[i])];
    const auto q = validation::cell_quality(corners);
    angles.inverted += !(q.volume_mm3 > 0);
    angles.least_deg = std::min(angles.least_deg, q.min_dihedral_deg);
    angles.most_deg = std::max(angles.most_deg, q.max_dihedral_deg);
    ++angles.cells_by_least[std::min(static_cast<std::size_t>(q.min_dihedral_deg / bin_deg), bin_count - 1)];
  }
  return angles;
}

Json as_json(const Angles& a) {
  return {{"nodes", a.nodes},
          {"cells", a.cells},
          {"inverted_cells", a.inverted},
          {"dihedral_min_deg", a.least_deg},
          {"dihedral_max_deg", a.most_deg},
          {"cells_by_smallest_angle_in_steps_of_5_deg", a.cells_by_least}};
}

void print(const Angles& before, const Angles& after) {
  fmt::print("{:<28} {:>12} {:>12}\n", "", "before", "after");
  const auto row = [](const char* name, const auto& a, const auto& b) {
    fmt::print("{:<28} {:>12} {:>12}\n", name, a, b);
  };
  row("nodes", before.nodes, after.nodes);
  row("cells", before.cells, after.cells);
  row("inverted cells", before.inverted, after.inverted);
  row("smallest dihedral angle", fmt::format("{:.3f}", before.least_deg), fmt::format("{:.3f}", after.least_deg));
  row("largest dihedral angle", fmt::format("{:.3f}", before.most_deg), fmt::format("{:.3f}", after.most_deg));
  fmt::print("cells by smallest angle:\n");
  for (std::size_t bin = 0; bin < bin_count; ++bin)
    row(fmt::format("  {:>2.0f} to {:>2.0f} degrees", bin_deg * static_cast<double>(bin),
                    bin_deg * static_cast<double>(bin + 1))
            .c_str(),
        before.cells_by_least[bin], after.cells_by_least[bin]);
}

void check_paths(const ImproveCommand& command) {
  for (const auto& path : {command.input, command.output}) {
    const auto extension = fs::path(path).extension();
    if (extension != ".vtu" && extension != ".vtk" && extension != ".msh")
      throw UserError("is of no known kind", path, "use .vtu, .vtk or .msh");
  }
  check_output(command.output);
}

}  // namespace

int improve_command(const ImproveCommand& command) {
  check_paths(command);
  auto mesh = read_mesh(command);
  refuse_ids(mesh, command.input);
  const auto improved = improve::improve_mesh(mesh.data.points, mesh.data.tets, mesh.region, command.settings);
  const auto before = measure(mesh.data.points, improve::oriented_cells(mesh.data.points, mesh.data.tets));
  const auto after = measure(improved.nodes_mm, improved.cells);
  carry_faces(mesh.gmsh, improved, mesh.data.points.size());
  write_mesh(command.output, carry(mesh, improved), std::move(mesh.gmsh), improved.region);
  if (command.json) {
    fmt::print("{}\n", Json{{"output", command.output},
                            {"before", as_json(before)},
                            {"after", as_json(after)},
                            {"cells_below_goal", improved.cells_below_goal},
                            {"surfaces_unchanged", improved.is_fixed},
                            {"surface_distance_max", improved.drift_mm}}
                           .dump(1));
    return 0;
  }
  print(before, after);
  fmt::print("{} cells stay below the goal of {:g} degrees\n", improved.cells_below_goal, command.settings.goal_deg);
  if (improved.is_fixed)
    fmt::print("surfaces, interfaces and their faces: unchanged\n");
  else
    fmt::print("surfaces and interfaces: within {:.3g} of the given ones\n", improved.drift_mm);
  fmt::print("{}\n", command.output);
  return 0;
}

}  // namespace heart::app
