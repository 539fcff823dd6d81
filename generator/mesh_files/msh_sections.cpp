// SPDX-License-Identifier: GPL-3.0-or-later
// The sections of a .msh file, one after the other. Text and binary files of both versions have the same ones.
#include <iterator>
#include <set>

#include "generator/mesh_files/msh_content.hpp"
#include "generator/mesh_files/value_stream.hpp"

namespace heartgen::mesh_files {
namespace {

constexpr const char* remedy = "write it again as gmsh's version 2.2 or 4.1";
constexpr int triangle = 2, tetrahedron = 4;

struct ElementType {
  std::size_t nodes;
  int dimension;
  const char* plural;
};

/// gmsh's element types from 0 on. Of others a binary file does not say where the next element begins.
constexpr std::array<ElementType, 32> element_types{{{0, 0, ""},
                                                     {2, 1, "lines"},
                                                     {3, 2, "triangles"},
                                                     {4, 2, "quadrilaterals"},
                                                     {4, 3, "tetrahedra"},
                                                     {8, 3, "hexahedra"},
                                                     {6, 3, "prisms"},
                                                     {5, 3, "pyramids"},
                                                     {3, 1, "quadratic lines"},
                                                     {6, 2, "quadratic triangles"},
                                                     {9, 2, "quadratic quadrilaterals"},
                                                     {10, 3, "quadratic tetrahedra"},
                                                     {27, 3, "quadratic hexahedra"},
                                                     {18, 3, "quadratic prisms"},
                                                     {14, 3, "quadratic pyramids"},
                                                     {1, 0, "points"},
                                                     {8, 2, "quadratic quadrilaterals"},
                                                     {20, 3, "quadratic hexahedra"},
                                                     {15, 3, "quadratic prisms"},
                                                     {13, 3, "quadratic pyramids"},
                                                     {9, 2, "triangles of order 3"},
                                                     {10, 2, "triangles of order 3"},
                                                     {12, 2, "triangles of order 4"},
                                                     {15, 2, "triangles of order 4"},
                                                     {15, 2, "triangles of order 5"},
                                                     {21, 2, "triangles of order 5"},
                                                     {4, 1, "lines of order 3"},
                                                     {5, 1, "lines of order 4"},
                                                     {6, 1, "lines of order 5"},
                                                     {20, 3, "tetrahedra of order 3"},
                                                     {35, 3, "tetrahedra of order 4"},
                                                     {56, 3, "tetrahedra of order 5"}}};

/// gmsh writes the same mesh again before a view that it appends. False: it is another mesh.
bool append(MshContent& all, MshContent&& next) {
  auto views = std::move(all.views);
  views.insert(views.end(), std::make_move_iterator(next.views.begin()), std::make_move_iterator(next.views.end()));
  const bool is_same = all.node_id == next.node_id && all.nodes == next.nodes && all.tets.nodes == next.tets.nodes &&
                       all.triangles.nodes == next.triangles.nodes;
  if (!all.nodes.empty() && !next.nodes.empty() && !is_same) return false;
  if (all.nodes.empty()) all = std::move(next);
  all.views = std::move(views);
  return true;
}

struct Parser {
  Values in;
  MshContent content{};
  bool is_version_4 = false;
  std::set<std::string> found{};  ///< sections

  bool is_text() const { return in.kind == Kind::text; }

  // ---- the frame of every section ----

  /// The name on the next line that opens a section; empty at the end of the file.
  std::string next_section() {
    while (!in.rest.empty()) {
      const auto line = in.line();
      if (line.starts_with('$') && !line.starts_with("$End")) return std::string(line.substr(1));
    }
    return {};
  }
  void end_section(const std::string& name) {
    if (in.word() != "$End" + name) in.fail(fmt::format("its section ${} does not end where it should", name));
  }
  /// What no one reads here may hold anything, also bytes.
  void skip_section(const std::string& name) {
    const auto end = in.rest.find("$End" + name);
    if (end == std::string_view::npos) in.fail(fmt::format("its section ${} does not end", name));
    in.rest.remove_prefix(end);
    end_section(name);
    if (name != "Comments" && name != "InterpolationScheme") ++content.other_sections[name];
  }

  void read_format() {
    const std::string version(in.word());
    const bool is_binary = in.next<int>() != 0;
    const auto bytes = in.next<int>();
    if (version != "4.1" && !version.starts_with("2")) in.fail(fmt::format("has version {}", version));
    is_version_4 = version == "4.1";
    if (is_binary) {
      in.line();
      in.kind = Kind::binary;
      const auto one = in.next<std::int32_t>();
      constexpr std::int32_t one_swapped = 1 << 24;
      if (bytes != 8 || (one != 1 && one != one_swapped)) in.fail("is a binary file of an unknown kind");
      if (one == one_swapped) in.kind = Kind::swapped;
    }
    end_section("MeshFormat");
  }

  void read_names() {
    for (auto left = in.count_of_text(); left > 0; --left) {
      const int dimension = in.next_of_text<int>();
      const auto tag = in.next_of_text<std::int32_t>();
      const auto line = in.line();
      const auto first = line.find('"'), last = line.rfind('"');
      if (first == last) in.fail("a physical name is not in quotes");
      content.names[{dimension, tag}] = line.substr(first + 1, last - first - 1);
    }
  }

  // ---- entities of 4.1 ----

  template <class Read>
  void read_entities_with(const Read& read_one) {
    std::array<std::size_t, 4> counts{};
    for (auto& count : counts) count = in.count();
    for (int dimension = 0; dimension <= 3; ++dimension)
      for (auto left = counts[static_cast<std::size_t>(dimension)]; left > 0; --left) read_one(dimension);
  }
  /// Box, groups and boundary, as whole entities and parts of them have them.
  void read_groups(int dimension, MshEntity& entity) {
    in.skip<double>(dimension == 0 ? 3 : 6);
    for (auto left = in.count(); left > 0; --left) entity.groups.push_back(in.next<std::int32_t>());
    if (dimension > 0) in.skip<std::int32_t>(in.count());
  }
  void read_entities() {
    read_entities_with([this](int dimension) {
      const auto tag = in.next<std::int32_t>();
      read_groups(dimension, content.entities[{dimension, tag}]);
    });
  }
  void read_partitioned_entities() {
    in.count();
    in.skip<std::int32_t>(2 * in.count());  // ghosts
    read_entities_with([this](int dimension) {
      const auto tag = in.next<std::int32_t>();
      auto& entity = content.entities[{dimension, tag}];
      entity.parent_dimension = in.next<std::int32_t>();
      entity.parent_tag = in.next<std::int32_t>();
      in.skip<std::int32_t>(in.count());
      read_groups(dimension, entity);
    });
  }

  // ---- nodes ----

  void read_nodes_2() {
    for (auto left = in.count_on_a_line(); left > 0; --left) {
      content.node_id.push_back(is_text() ? in.next<std::int64_t>() : in.next<std::int32_t>());
      content.nodes.push_back(in.point());
    }
  }
  void read_nodes_4() {
    auto blocks = in.count();
    in.skip<std::int64_t>(3);
    for (; blocks > 0; --blocks) {
      const auto dimension = in.next<std::int32_t>();
      in.next<std::int32_t>();
      const bool is_parametric = in.next<std::int32_t>() != 0;
      const auto count = in.count();
      for (std::size_t n = 0; n < count; ++n) content.node_id.push_back(in.next<std::int64_t>());
      for (std::size_t n = 0; n < count; ++n) {
        content.nodes.push_back(in.point());
        if (is_parametric) in.skip<double>(static_cast<std::size_t>(std::clamp(dimension, 0, 3)));
      }
    }
  }

  // ---- elements ----

  template <class Id, std::size_t N>
  void add(MshElements<N>& elements, std::int64_t id, std::int32_t entity, std::int32_t group) {
    std::array<std::int64_t, N> nodes;
    for (auto& node : nodes) node = static_cast<std::int64_t>(in.next<Id>());
    elements.id.push_back(id);
    elements.nodes.push_back(nodes);
    elements.entity.push_back(entity);
    elements.group.push_back(group);
  }
  template <class Id>
  void read_element(int type, std::int64_t id, std::int32_t entity, std::int32_t group) {
    if (type == tetrahedron) return add<Id>(content.tets, id, entity, group);
    if (type == triangle) return add<Id>(content.triangles, id, entity, group);
    const bool is_known = type > 0 && static_cast<std::size_t>(type) < element_types.size();
    if (!is_known && !is_text()) in.fail(fmt::format("has elements of type {}", type));
    const auto& known = element_types[is_known ? static_cast<std::size_t>(type) : 0];
    ++(known.dimension == 3 || !is_known
           ? content.other.volumes
           : content.other.lower)[is_known ? known.plural : fmt::format("elements of type {}", type)];
    if (is_text())
      in.line();
    else
      in.skip<Id>(known.nodes);
  }
  static std::int32_t tag_at(const std::vector<std::int32_t>& tags, std::size_t place) {
    return place < tags.size() ? tags[place] : 0;
  }
  /// Of text: each element with its type and its tags.
  void read_text_elements_2() {
    for (auto left = in.count(); left > 0; --left) {
      const auto id = in.next<std::int64_t>();
      const int type = in.next<int>();
      std::vector<std::int32_t> tags(in.count());
      for (auto& tag : tags) tag = in.next<std::int32_t>();
      read_element<std::int64_t>(type, id, tag_at(tags, 1), tag_at(tags, 0));
    }
  }
  /// In blocks that say type and number of tags once.
  void read_binary_elements_2() {
    for (auto left = in.count_on_a_line(); left > 0;) {
      const int type = in.next<std::int32_t>();
      const auto count = in.count<std::int32_t>();
      std::vector<std::int32_t> tags(in.count<std::int32_t>());
      if (count == 0 || count > left) in.fail("its blocks of elements have other counts than it says");
      for (std::size_t e = 0; e < count; ++e) {
        const auto id = in.next<std::int32_t>();
        for (auto& tag : tags) tag = in.next<std::int32_t>();
        read_element<std::int32_t>(type, id, tag_at(tags, 1), tag_at(tags, 0));
      }
      left -= count;
    }
  }
  void read_elements_4() {
    auto blocks = in.count();
    in.skip<std::int64_t>(3);
    for (; blocks > 0; --blocks) {
      in.next<std::int32_t>();
      const auto entity = in.next<std::int32_t>();
      const int type = in.next<std::int32_t>();
      for (auto left = in.count(); left > 0; --left) {
        const auto id = in.next<std::int64_t>();
        read_element<std::int64_t>(type, id, entity, 0);
      }
    }
  }

  // ---- views ----

  std::string read_view_name() {
    std::string name;
    const auto count = in.count_on_a_line();
    for (std::size_t i = 0; i < count; ++i) {
      const auto line = in.line();
      if (i == 0) name = line;
    }
    std::erase(name, '"');
    return name;
  }
  void read_view(bool is_on_nodes) {
    MshView view{is_on_nodes, read_view_name(), 0, 1, {}, {}};
    for (auto left = in.count_of_text(); left > 0; --left) in.next_of_text<double>();
    std::vector<std::int64_t> tags(in.count_of_text());
    for (auto& tag : tags) tag = in.next_of_text<std::int64_t>();
    in.line();
    if (tags.size() < 3) in.fail(fmt::format("the view \"{}\" does not say how many values it has", view.name));
    view.step = static_cast<int>(tags[0]);
    view.components = static_cast<int>(in.checked(tags[1]));
    for (auto left = in.checked(tags[2]); left > 0; --left) {
      view.id.push_back(is_text() ? in.next<std::int64_t>() : in.next<std::int32_t>());
      for (int c = 0; c < view.components; ++c) view.values.push_back(in.next<double>());
    }
    content.views.push_back(std::move(view));
  }

  // ---- all of it ----

  /// False: nobody reads such a section.
  bool read_section(const std::string& name) {
    if (name == "PhysicalNames")
      read_names();
    else if (name == "Entities" && is_version_4)
      read_entities();
    else if (name == "PartitionedEntities" && is_version_4)
      read_partitioned_entities();
    else if (name == "Nodes")
      is_version_4 ? read_nodes_4() : read_nodes_2();
    else if (name == "Elements")
      is_version_4 ? read_elements_4() : is_text() ? read_text_elements_2() : read_binary_elements_2();
    else if (name == "NodeData" || name == "ElementData")
      read_view(name == "NodeData");
    else
      return false;
    return true;
  }
  /// Up to the next $MeshFormat or the end; false at the end.
  bool read_sections() {
    for (auto name = next_section(); !name.empty(); name = next_section()) {
      if (name == "MeshFormat") return true;
      found.insert(name);
      if (read_section(name))
        end_section(name);
      else
        skip_section(name);
    }
    return false;
  }
  void read_all() {
    while (next_section() != "MeshFormat")
      if (in.rest.empty()) in.fail("has no section $MeshFormat");
    MshContent all;
    for (bool goes_on = true; goes_on;) {
      in.kind = Kind::text;
      read_format();
      goes_on = read_sections();
      if (!append(all, std::move(content))) in.fail("holds two different meshes");
      content = {};
    }
    content = std::move(all);
    for (const char* name : {"Nodes", "Elements"})
      if (!found.contains(name)) in.fail(fmt::format("has no section ${}", name));
  }
};

}  // namespace

MshContent read_msh_content(const std::filesystem::path& path) {
  const std::string file = whole_file(path);
  Parser parser{{file, &path, remedy}};
  parser.read_all();
  return std::move(parser.content);
}

}  // namespace heartgen::mesh_files
