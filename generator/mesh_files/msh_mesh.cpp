// SPDX-License-Identifier: GPL-3.0-or-later
// From what a .msh file says to a mesh: nodes by place, one label per tetrahedron and triangle, views as arrays.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "generator/mesh_files/msh_content.hpp"
#include "generator/mesh_files/numbering.hpp"
#include "model/error.hpp"

namespace heartgen::mesh_files {
namespace {

constexpr const char* remedy = "write it again as gmsh's version 2.2 or 4.1";

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem) {
  throw UserError(problem, path.string(), remedy);
}

constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();

/// Without the sign, which the smallest number of all would keep.
std::int32_t magnitude(std::int32_t tag) { return tag >= 0 ? tag : tag >= -most ? -tag : most; }

std::string name_of(int dimension) { return dimension == 3 ? "volume" : "surface"; }
std::string label_of(int dimension) { return dimension == 3 ? "region" : "label"; }

// ---- labels ----

/// The group of a 4.1 entity, or of what it is a part of. gmsh can make groups of its own for partitions: others first.
std::vector<std::int32_t> groups_of(const MshContent& content, int dimension, std::int32_t tag) {
  const auto found = content.entities.find({dimension, tag});
  if (found == content.entities.end()) return {};
  const auto is_of_partition = [&](std::int32_t group) {
    const auto name = content.names.find({dimension, magnitude(group)});
    return name != content.names.end() && name->second.starts_with("_part{");
  };
  auto groups = found->second.groups;
  std::erase_if(groups, is_of_partition);
  if (groups.empty() && found->second.parent_dimension == dimension && found->second.parent_tag != tag)
    return groups_of(content, dimension, found->second.parent_tag);
  return groups;
}

/// A part belongs to the entity that was cut up.
std::int32_t whole_entity(const MshContent& content, int dimension, std::int32_t tag) {
  const auto found = content.entities.find({dimension, tag});
  const bool is_part = found != content.entities.end() && found->second.parent_dimension == dimension;
  return is_part ? found->second.parent_tag : tag;
}

/// A surface between two partitions of a volume: no surface of the mesh, though it is given the volume's groups.
bool lies_between_partitions(const MshContent& content, int dimension, std::int32_t tag) {
  const auto found = content.entities.find({dimension, tag});
  return found != content.entities.end() && found->second.parent_dimension > dimension;
}

/// Labels of the elements of one dimension: their groups; a free number where an entity has none.
struct Labels {
  const MshContent* content;
  int dimension;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> signed_label{};  ///< by (entity, group of the element)
  std::set<std::int32_t> used{}, in_several{};
  std::vector<std::string> remarks{};

  template <std::size_t N>
  Labels(const MshContent& from, int of_dimension, const MshElements<N>& elements)
      : content(&from), dimension(of_dimension) {
    for (std::size_t e = 0; e < elements.entity.size(); ++e)
      if (!lies_between_partitions(from, dimension, elements.entity[e]))
        signed_label[{elements.entity[e], elements.group[e]}] = 0;
    for (auto& [of, label] : signed_label) {
      label = of.second != 0 ? of.second : group_of_entity(of.first);
      if (label != 0) used.insert(magnitude(label));
    }
    number_the_rest();
  }
  std::int32_t group_of_entity(std::int32_t entity) {
    const auto groups = groups_of(*content, dimension, entity);
    if (groups.empty()) return 0;
    const auto whole = whole_entity(*content, dimension, entity);
    if (groups.size() > 1 && in_several.insert(whole).second)
      remarks.push_back(fmt::format("{} {} is in the groups {}: its {} is {}", name_of(dimension), whole,
                                    fmt::join(groups, ", "), label_of(dimension), magnitude(groups[0])));
    return groups[0];
  }
  /// Entities and groups have numbers of their own: an entity's may be that of another group.
  void number_the_rest() {
    const bool has_groups = !used.empty();
    std::map<std::int32_t, std::int32_t> label_of_whole;
    for (auto& [of, label] : signed_label) {
      if (label != 0) continue;
      const auto whole = whole_entity(*content, dimension, of.first);
      const auto known = label_of_whole.find(whole);
      label = known != label_of_whole.end() ? known->second : free_label(std::max(magnitude(whole), 1));
      if (known != label_of_whole.end()) continue;
      label_of_whole[whole] = label;
      if (has_groups)
        remarks.push_back(fmt::format("{} {} has no physical group: its {} is {}", name_of(dimension), whole,
                                      label_of(dimension), label));
    }
  }
  std::int32_t free_label(std::int32_t wanted) {
    if (used.insert(wanted).second) return wanted;
    std::int32_t free = *used.rbegin() < most ? *used.rbegin() + 1 : 1;
    while (!used.insert(free).second) ++free;
    return free;
  }
};

// ---- elements ----

/// Places of the elements that are kept: none twice, which is how 2.2 writes an element of two groups.
template <std::size_t N>
std::vector<std::size_t> first_of_each(const MshElements<N>& elements) {
  std::vector<std::array<std::int64_t, N>> sorted = elements.nodes;
  for (auto& nodes : sorted) std::sort(nodes.begin(), nodes.end());
  std::vector<std::size_t> order(sorted.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return std::tie(sorted[a], a) < std::tie(sorted[b], b); });
  const auto end = std::unique(order.begin(), order.end(), [&](auto a, auto b) { return sorted[a] == sorted[b]; });
  order.erase(end, order.end());
  std::sort(order.begin(), order.end());
  return order;
}

template <std::size_t N>
struct KeptElements {
  std::vector<std::array<std::int32_t, N>> nodes;
  std::vector<double> label;
  std::vector<std::int64_t> id;
};

template <std::size_t N>
KeptElements<N> kept_elements(const MshContent& content, const MshElements<N>& elements, const Numbering& numbering,
                              const std::filesystem::path& path, std::vector<std::string>& remarks, OtherCells& other) {
  constexpr int dimension = N == 4 ? 3 : 2;
  Labels labels(content, dimension, elements);
  KeptElements<N> kept;
  std::size_t between = 0;
  const auto firsts = first_of_each(elements);
  for (const auto e : firsts) {
    if (lies_between_partitions(content, dimension, elements.entity[e])) {
      ++between;
      continue;
    }
    auto& nodes = kept.nodes.emplace_back();
    for (std::size_t i = 0; i < N; ++i) {
      nodes[i] = numbering.find(elements.nodes[e][i]);
      if (nodes[i] < 0) fail(path, fmt::format("an element names node {}, which is missing", elements.nodes[e][i]));
    }
    const auto label = labels.signed_label.at({elements.entity[e], elements.group[e]});
    if (label < 0 && N == 3) std::swap(nodes[1], nodes[2]);  // the group takes the surface turned over
    kept.label.push_back(magnitude(label));
    kept.id.push_back(elements.id[e]);
  }
  remarks.insert(remarks.end(), labels.remarks.begin(), labels.remarks.end());
  if (firsts.size() < elements.nodes.size())
    remarks.push_back(fmt::format("{} {} stand there again in another group: the first group is taken",
                                  elements.nodes.size() - firsts.size(), N == 4 ? "tetrahedra" : "triangles"));
  if (between > 0) other.lower["partition-boundary triangles"] = between;
  return kept;
}

// ---- views ----

/// Arrays of one kind of places: points, tetrahedra or triangles.
struct Target {
  const Numbering* numbering;
  std::size_t size;
  std::map<std::string, std::vector<double>>& scalars;
  std::map<std::string, std::vector<Vec3>>& vectors;
  std::map<std::string, std::vector<Mat3>>& tensors;

  bool has(const std::string& name) const {
    return scalars.contains(name) || vectors.contains(name) || tensors.contains(name);
  }
};

/// "fiber"; "fiber_2" where a view of that name is there already.
std::string free_name(const std::string& name, const std::vector<const Target*>& targets) {
  const auto taken = [&](const std::string& tried) {
    return std::any_of(targets.begin(), targets.end(), [&](const Target* target) { return target->has(tried); });
  };
  std::string tried = name.empty() ? "view" : name;
  for (int n = 2; taken(tried); ++n) tried = fmt::format("{}_{}", name.empty() ? "view" : name, n);
  return tried;
}

Vec3 vector_at(const std::vector<double>& values, std::size_t first) {
  return {values[first], values[first + 1], values[first + 2]};
}

/// Returns at how many places the view has a value.
std::size_t put(const MshView& view, const std::string& name, const Target& target) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // (place, row)
  for (std::size_t row = 0; row < view.id.size(); ++row)
    if (const auto place = target.numbering->find(view.id[row]); place >= 0)
      pairs.emplace_back(static_cast<std::size_t>(place), row);
  if (pairs.empty()) return 0;
  const auto fill = [&](auto& values, auto zero, const auto& at) {
    values.assign(target.size, zero);
    for (const auto& [place, row] : pairs) values[place] = at(row * static_cast<std::size_t>(view.components));
  };
  const auto& v = view.values;
  if (view.components == 1) fill(target.scalars[name], 0.0, [&](std::size_t i) { return v[i]; });
  if (view.components == 3) fill(target.vectors[name], Vec3{}, [&](std::size_t i) { return vector_at(v, i); });
  if (view.components == 9)
    fill(target.tensors[name], Mat3{{Vec3{}, Vec3{}, Vec3{}}}, [&](std::size_t i) {
      return Mat3{{vector_at(v, i), vector_at(v, i + 3), vector_at(v, i + 6)}};
    });
  return pairs.size();
}

void add_view(const MshView& view, const std::vector<const Target*>& targets, std::vector<std::string>& remarks) {
  if (view.components != 1 && view.components != 3 && view.components != 9) {
    remarks.push_back(fmt::format("left out: the view \"{}\" of {} components", view.name, view.components));
    return;
  }
  const auto name = free_name(view.name, targets);
  if (name != view.name)
    remarks.push_back(fmt::format("a view \"{}\" of step {} is the array \"{}\"", view.name, view.step, name));
  std::size_t first_count = 0;
  for (const auto* target : targets) {
    const auto count = put(view, name, *target);
    if (target == targets.front()) first_count = count;
  }
  if (first_count > 0 && first_count < targets.front()->size)
    remarks.push_back(fmt::format("the view \"{}\" has values at {} of {} places: 0 at the others", name, first_count,
                                  targets.front()->size));
}

void add_views(const MshContent& content, const Numbering& nodes, const std::vector<std::int64_t>& tet_id,
               const std::vector<std::int64_t>& triangle_id, UnstructuredData& mesh) {
  const Numbering tets(tet_id), triangles(triangle_id);
  const Target points{&nodes, mesh.points.size(), mesh.point_scalars, mesh.point_vectors, mesh.point_tensors};
  const Target cells{&tets, mesh.tets.size(), mesh.cell_scalars, mesh.cell_vectors, mesh.cell_tensors};
  const Target faces{&triangles, mesh.faces.size(), mesh.face_scalars, mesh.face_vectors, mesh.face_tensors};
  for (const auto& view : content.views)
    add_view(view, view.is_on_nodes ? std::vector{&points} : std::vector{&cells, &faces}, mesh.remarks);
}

}  // namespace

UnstructuredData mesh_of(const MshContent& content, const std::filesystem::path& path) {
  const Numbering numbering(content.node_id);
  if (const auto twice = numbering.repeated()) fail(path, fmt::format("node {} stands there twice", *twice));
  UnstructuredData mesh;
  mesh.points = content.nodes;
  mesh.names = content.names;
  OtherCells other = content.other;
  auto cells = kept_elements(content, content.tets, numbering, path, mesh.remarks, other);
  auto faces = kept_elements(content, content.triangles, numbering, path, mesh.remarks, other);
  mesh.tets = std::move(cells.nodes);
  mesh.faces = std::move(faces.nodes);
  settle_other_cells(mesh, other, path);
  mesh.integers.insert("region");
  mesh.cell_scalars["region"] = std::move(cells.label);
  if (!mesh.faces.empty()) mesh.face_scalars["region"] = std::move(faces.label);
  add_views(content, numbering, cells.id, faces.id, mesh);
  for (const auto& [name, count] : content.other_sections)
    mesh.remarks.push_back(fmt::format("left out: {} section{} ${}", count, count == 1 ? "" : "s", name));
  return mesh;
}

}  // namespace heartgen::mesh_files
