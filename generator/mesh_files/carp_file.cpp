// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh_files/carp_file.hpp"

#include "generator/mesh_files/value_stream.hpp"

namespace heartgen::mesh_files {
namespace {

namespace fs = std::filesystem;

constexpr const char* remedy = "write NAME.pts, NAME.elem and NAME.lon again, all of one mesh";
constexpr std::size_t header_bytes = 1024;  // of binary files

struct ElementType {
  std::string_view name;
  std::size_t nodes;
  int dimension;
  const char* plural;
};

/// In the order of the numbers that binary files have for them.
constexpr std::array<ElementType, 8> element_types{{{"Tt", 4, 3, "tetrahedra"},
                                                    {"Hx", 8, 3, "hexahedra"},
                                                    {"Oc", 6, 3, "octahedra"},
                                                    {"Py", 5, 3, "pyramids"},
                                                    {"Pr", 6, 3, "prisms"},
                                                    {"Qd", 4, 2, "quadrilaterals"},
                                                    {"Tr", 3, 2, "triangles"},
                                                    {"Ln", 2, 1, "lines"}}};
constexpr std::size_t carp_tetrahedron = 0, carp_triangle = 6;

/// One of the three files: its values behind the header, and the numbers of that.
struct CarpFile {
  fs::path path;
  std::string bytes;
  bool is_binary = false;

  Values values(std::vector<std::int64_t>& header) const {
    Values in{bytes, &path, remedy};
    if (!is_binary) return in;
    if (bytes.size() < header_bytes) in.fail_here();
    Values head{in.rest.substr(0, std::min(bytes.find('\0'), header_bytes)), &path, remedy};
    while (!head.is_at_end()) header.push_back(head.next<std::int64_t>());
    in.rest.remove_prefix(header_bytes);
    if (header.size() < 3) in.fail("its header does not say how much it holds");
    in.kind = header[header.size() - 2] == 0 ? Kind::binary : Kind::swapped;  // written little-endian, or big
    return in;
  }
};

CarpFile open(const fs::path& path, const char* ending, bool is_binary) {
  CarpFile file{fs::path(path).replace_extension(std::string(is_binary ? ".b" : ".") + ending), {}, is_binary};
  file.bytes = whole_file(file.path);
  return file;
}

std::vector<Vec3> read_points(const CarpFile& file) {
  std::vector<std::int64_t> header;
  auto in = file.values(header);
  std::vector<Vec3> points;
  for (auto left = file.is_binary ? in.checked(header[0]) : in.count(); left > 0; --left) {
    const Vec3 p = file.is_binary ? in.vector<float>() : in.vector();
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) in.fail("a coordinate is not finite");
    points.push_back(p);
  }
  if (!file.is_binary && !in.is_at_end()) in.fail("goes on behind its last point");
  return points;
}

/// What every element of the file became.
enum class Fate : std::uint8_t { tetrahedron, triangle, left_out };

struct Elements {
  std::vector<Fate> fate;
  OtherCells other;
};

std::size_t type_of(const Values& in, std::string_view name) {
  for (std::size_t t = 0; t < element_types.size(); ++t)
    if (element_types[t].name == name) return t;
  in.fail(fmt::format("has an element of the unknown kind \"{}\"", name.substr(0, 20)));
}

template <std::size_t N>
std::array<std::int32_t, N> read_nodes(Values& in, std::size_t points) {
  std::array<std::int32_t, N> nodes;
  for (auto& node : nodes) {
    node = in.next<std::int32_t>();
    if (node < 0 || static_cast<std::size_t>(node) >= points)
      in.fail(fmt::format("an element names node {}, but there are {}", node, points));
  }
  return nodes;
}

/// The values behind an element's kind: nodes, and its tag where the line has one.
void read_element(Values& in, std::size_t type, UnstructuredData& mesh, Elements& elements) {
  const auto tag = [&in] { return in.kind == Kind::text && in.is_at_end() ? 0 : in.next<std::int32_t>(); };
  if (type == carp_tetrahedron) {
    mesh.tets.push_back(read_nodes<4>(in, mesh.points.size()));
    mesh.cell_scalars["region"].push_back(tag());
    elements.fate.push_back(Fate::tetrahedron);
  } else if (type == carp_triangle) {
    mesh.faces.push_back(read_nodes<3>(in, mesh.points.size()));
    mesh.face_scalars["region"].push_back(tag());
    elements.fate.push_back(Fate::triangle);
  } else {
    in.skip<std::int32_t>(element_types[type].nodes);
    tag();
    ++(element_types[type].dimension == 3 ? elements.other.volumes : elements.other.lower)[element_types[type].plural];
    elements.fate.push_back(Fate::left_out);
  }
}

Elements read_elements(const CarpFile& file, UnstructuredData& mesh) {
  std::vector<std::int64_t> header;
  auto in = file.values(header);
  Elements elements;
  for (auto left = file.is_binary ? in.checked(header[0]) : in.count(); left > 0; --left) {
    if (file.is_binary) {
      const auto type = in.next<std::int32_t>();
      if (type < 0 || static_cast<std::size_t>(type) >= element_types.size())
        in.fail(fmt::format("has an element of the unknown kind {}", type));
      read_element(in, static_cast<std::size_t>(type), mesh, elements);
    } else {
      auto line = in.filled_line();
      const auto type = type_of(line, line.word());
      read_element(line, type, mesh, elements);
    }
  }
  if (!file.is_binary && !in.is_at_end()) in.fail("goes on behind its last element");
  return elements;
}

void keep_axis(const Vec3& axis, Fate fate, const char* name, UnstructuredData& mesh) {
  if (fate == Fate::tetrahedron) mesh.cell_vectors[name].push_back(axis);
  if (fate == Fate::triangle) mesh.face_vectors[name].push_back(axis);
}

/// A first line of 3 or 6 numbers is the first element's: files of before had no header.
std::size_t axes_of_text(Values& in) {
  Values first = in;
  auto line = first.filled_line();
  std::size_t numbers = 0;
  for (; !line.is_at_end(); ++numbers) line.next<double>();
  if (numbers == 3 || numbers == 6) return numbers / 3;
  const auto axes = in.next<double>();
  if (numbers != 1 || (axes != 1 && axes != 2)) in.fail("has neither one nor two axes per element");
  return static_cast<std::size_t>(axes);
}

void read_axes(const CarpFile& file, const Elements& elements, UnstructuredData& mesh) {
  std::vector<std::int64_t> header;
  auto in = file.values(header);
  if (file.is_binary && header[0] != 1 && header[0] != 2) in.fail("has neither one nor two axes per element");
  const auto axes = file.is_binary ? static_cast<std::size_t>(header[0]) : axes_of_text(in);
  for (const auto fate : elements.fate)
    for (std::size_t a = 0; a < axes; ++a)
      keep_axis(file.is_binary ? in.vector<float>() : in.vector(), fate, a == 0 ? "fiber" : "sheet", mesh);
  if (!file.is_binary && !in.is_at_end()) in.fail("has more axes than the mesh has elements");
}

}  // namespace

UnstructuredData read_carp(const fs::path& path) {
  const bool is_binary = path.extension().string().starts_with(".b");
  UnstructuredData mesh;
  mesh.integers.insert("region");
  mesh.points = read_points(open(path, "pts", is_binary));
  const auto element_file = open(path, "elem", is_binary);
  const auto elements = read_elements(element_file, mesh);
  settle_other_cells(mesh, elements.other, element_file.path);
  if (fs::exists(fs::path(path).replace_extension(is_binary ? ".blon" : ".lon")))
    read_axes(open(path, "lon", is_binary), elements, mesh);
  return mesh;
}

}  // namespace heartgen::mesh_files
