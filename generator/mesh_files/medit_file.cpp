// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh_files/medit_file.hpp"

#include <cctype>
#include <limits>

#include "generator/mesh_files/value_stream.hpp"

namespace heartgen::mesh_files {
namespace {

constexpr const char* remedy = "give a mesh as Medit, FreeFEM, mmg or TetGen write it";

/// A section of elements, its number in binary files, and what its elements are.
struct ElementKind {
  std::string_view keyword;
  int code;
  std::size_t nodes;
  int dimension;
  const char* plural;
};

constexpr std::array<ElementKind, 11> element_kinds{{{"Tetrahedra", 8, 4, 3, "tetrahedra"},
                                                     {"Triangles", 6, 3, 2, "triangles"},
                                                     {"Edges", 5, 2, 1, "lines"},
                                                     {"Quadrilaterals", 7, 4, 2, "quadrilaterals"},
                                                     {"Prisms", 9, 6, 3, "prisms"},
                                                     {"Hexahedra", 10, 8, 3, "hexahedra"},
                                                     {"Hexaedra", 10, 8, 3, "hexahedra"},
                                                     {"Pyramids", 49, 5, 3, "pyramids"},
                                                     {"TrianglesP2", 24, 6, 2, "quadratic triangles"},
                                                     {"EdgesP2", 25, 3, 1, "quadratic lines"},
                                                     {"TetrahedraP2", 30, 10, 3, "quadratic tetrahedra"}}};

struct Parser {
  Values in;
  int version = 2;  ///< of binary files: from 2 on reals are doubles, from 3 on places, from 4 on counts have 64 bits
  UnstructuredData mesh{};
  OtherCells other{};
  std::vector<double> vertex_reference{};

  bool is_text() const { return in.kind == Kind::text; }
  std::int64_t whole() {
    return is_text() || version >= 4 ? in.next<std::int64_t>() : static_cast<std::int64_t>(in.next<std::int32_t>());
  }
  std::size_t count() { return in.checked(whole()); }

  void read_vertices() {
    for (auto left = count(); left > 0; --left) {
      const Vec3 p = is_text() || version >= 2 ? in.vector() : in.vector<float>();
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) in.fail("a coordinate is not finite");
      mesh.points.push_back(p);
      vertex_reference.push_back(static_cast<double>(whole()));
    }
  }
  template <std::size_t N>
  void read_cells(std::vector<std::array<std::int32_t, N>>& cells, std::vector<double>& reference) {
    for (auto left = count(); left > 0; --left) {
      auto& cell = cells.emplace_back();
      for (auto& node : cell) {
        const auto number = whole();
        constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
        node = static_cast<std::int32_t>(std::clamp<std::int64_t>(number, 0, most) - 1);  // checked at the end
      }
      reference.push_back(static_cast<double>(whole()));
    }
  }
  /// Cells may stand before the vertices.
  template <std::size_t N>
  void check_cells(const std::vector<std::array<std::int32_t, N>>& cells) const {
    for (const auto& cell : cells)
      for (const auto node : cell)
        if (node < 0 || static_cast<std::size_t>(node) >= mesh.points.size())
          in.fail(fmt::format("a cell names vertex {}, but there are {}", node + 1LL, mesh.points.size()));
  }
  void read_elements(const ElementKind& kind) {
    if (kind.keyword == "Tetrahedra") return read_cells(mesh.tets, mesh.cell_scalars["region"]);
    if (kind.keyword == "Triangles") return read_cells(mesh.faces, mesh.face_scalars["region"]);
    const auto number = count();
    for (std::size_t value = 0; value < number * (kind.nodes + 1); ++value) whole();
    if (number > 0) (kind.dimension == 3 ? other.volumes : other.lower)[kind.plural] += number;
  }
  void require_dimension(std::int64_t dimension) const {
    if (dimension != 3) in.fail(fmt::format("is a mesh of dimension {}, not 3", dimension));
  }

  // ---- text ----

  /// Sections of corners, ridges, normals ...: numbers up to the next word.
  void skip_section(std::string_view keyword) {
    for (;;) {
      in.skip_blanks();
      if (in.rest.empty() || std::isalpha(static_cast<unsigned char>(in.rest.front())) != 0) break;
      in.word();
    }
    mesh.remarks.push_back(fmt::format("left out: section {}", keyword));
  }
  void read_text() {
    if (in.word() != "MeshVersionFormatted") in.fail("does not begin with MeshVersionFormatted");
    in.next<int>();
    while (!in.is_at_end()) {
      const auto keyword = in.word();
      const auto* kind = std::find_if(element_kinds.begin(), element_kinds.end(),
                                      [&](const auto& known) { return known.keyword == keyword; });
      if (keyword == "End") return;
      if (keyword == "Dimension")
        require_dimension(whole());
      else if (keyword == "Vertices")
        read_vertices();
      else if (kind != element_kinds.end())
        read_elements(*kind);
      else if (std::isalpha(static_cast<unsigned char>(keyword.front())) != 0)
        skip_section(keyword);
      else
        in.fail(fmt::format("has \"{}\" where a section should begin", keyword.substr(0, 20)));
    }
  }

  // ---- binary ----

  void read_binary() {
    constexpr int dimension = 3, vertices = 4, end = 54;
    const std::string_view file = in.rest;
    in.kind = Kind::binary;
    const auto one = in.next<std::int32_t>();
    if (one != 1 && one != 1 << 24) in.fail("is no binary Medit file");
    if (one != 1) in.kind = Kind::swapped;
    version = in.next<std::int32_t>();
    if (version < 1 || version > 4) in.fail(fmt::format("has version {}", version));
    for (;;) {
      const auto code = in.next<std::int32_t>();
      if (code == end) return;
      const auto next = version >= 3 ? in.next<std::int64_t>() : in.next<std::int32_t>();
      const auto here = static_cast<std::int64_t>(file.size() - in.rest.size());
      const auto* kind = std::find_if(element_kinds.begin(), element_kinds.end(),
                                      [&](const auto& known) { return known.code == code; });
      if (code == dimension)
        require_dimension(in.next<std::int32_t>());
      else if (code == vertices)
        read_vertices();
      else if (kind != element_kinds.end())
        read_elements(*kind);
      else
        mesh.remarks.push_back(fmt::format("left out: section of kind {}", code));
      if (next == 0) return;
      if (next < here || next > static_cast<std::int64_t>(file.size())) in.fail("points to a place outside of itself");
      in.rest = file.substr(static_cast<std::size_t>(next));
    }
  }
};

}  // namespace

UnstructuredData read_medit(const std::filesystem::path& path) {
  const std::string file = whole_file(path);
  Parser parser{{file, &path, remedy, Kind::text, true}};
  if (path.extension() == ".meshb")
    parser.read_binary();
  else
    parser.read_text();
  auto& mesh = parser.mesh;
  parser.check_cells(mesh.tets);
  parser.check_cells(mesh.faces);
  mesh.integers = {"region", "vertex_reference"};
  const auto& references = parser.vertex_reference;
  if (std::any_of(references.begin(), references.end(), [](double r) { return r != 0; }))
    mesh.point_scalars["vertex_reference"] = references;
  settle_other_cells(mesh, parser.other, path);
  return std::move(mesh);
}

}  // namespace heartgen::mesh_files
