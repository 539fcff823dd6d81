// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh_files/tetgen_file.hpp"

#include "generator/mesh_files/numbering.hpp"
#include "generator/mesh_files/value_stream.hpp"

namespace heartgen::mesh_files {
namespace {

namespace fs = std::filesystem;

constexpr const char* remedy = "write NAME.node, NAME.ele and NAME.face again, as text and all of one mesh";

struct TetgenFile {
  fs::path path;
  std::string bytes;

  Values values() const {
    if (bytes.substr(0, 200).find("BIN") != std::string::npos)
      throw UserError("is of Chaste's binary kind", path.string(), remedy);
    return {bytes, &path, remedy, Kind::text, true};
  }
};

TetgenFile open(const fs::path& path, const char* ending) {
  TetgenFile file{fs::path(path).replace_extension(ending), {}};
  file.bytes = whole_file(file.path);
  return file;
}

bool is_there(const fs::path& path, const char* ending) { return fs::exists(fs::path(path).replace_extension(ending)); }

/// The numbers of a file's first line; what it does not say is 0.
std::array<std::int64_t, 4> header_of(Values& in) {
  std::array<std::int64_t, 4> header{};
  auto line = in.filled_line();
  for (std::size_t i = 0; i < header.size() && !line.is_at_end(); ++i) header[i] = line.next<std::int64_t>();
  in.checked(header[0]);
  return header;
}

void refuse_rest(Values& in) {
  if (!in.is_at_end()) in.fail("goes on behind what its first line counts");
}

std::string attribute(std::size_t number) { return "attribute_" + std::to_string(number); }

/// Returns the numbers of the nodes.
std::vector<std::int64_t> read_nodes(const TetgenFile& file, UnstructuredData& mesh) {
  auto in = file.values();
  const auto [count, dimension, attributes, markers] = header_of(in);
  const auto attribute_count = in.checked(attributes);
  if (dimension != 3) in.fail(fmt::format("has points of {} coordinates, not of 3", dimension));
  std::vector<std::int64_t> numbers;
  for (std::int64_t n = 0; n < count; ++n) {
    auto line = in.filled_line();
    numbers.push_back(line.next<std::int64_t>());
    mesh.points.push_back(line.point());
    for (std::size_t a = 1; a <= attribute_count; ++a) mesh.point_scalars[attribute(a)].push_back(line.next<double>());
    if (markers > 0) mesh.point_scalars["boundary_marker"].push_back(line.next<double>());
  }
  refuse_rest(in);
  return numbers;
}

template <std::size_t N>
std::array<std::int32_t, N> read_corners(Values& line, const Numbering& numbering) {
  std::array<std::int32_t, N> corners;
  for (auto& corner : corners) {
    const auto number = line.next<std::int64_t>();
    corner = numbering.find(number);
    if (corner < 0) line.fail(fmt::format("names node {}, which is missing", number));
  }
  return corners;
}

void read_cells(const TetgenFile& file, const Numbering& numbering, UnstructuredData& mesh) {
  auto in = file.values();
  const auto [count, nodes, attributes, none] = header_of(in);
  const auto attribute_count = in.checked(attributes);
  OtherCells other;
  if (nodes == 10) other.volumes["quadratic tetrahedra"] = static_cast<std::size_t>(count);
  if (nodes != 4 && nodes != 10) in.fail(fmt::format("has elements of {} nodes, not of 4", nodes));
  for (std::int64_t c = 0; c < count && nodes == 4; ++c) {
    auto line = in.filled_line();
    line.next<std::int64_t>();
    mesh.tets.push_back(read_corners<4>(line, numbering));
    for (std::size_t a = 1; a <= attribute_count; ++a)
      mesh.cell_scalars[a == 1 ? "region" : attribute(a)].push_back(line.next<double>());
  }
  settle_other_cells(mesh, other, file.path);
  refuse_rest(in);
}

/// Faces without a marker are TetGen's list of all faces, and tell nothing.
void read_faces(const TetgenFile& file, const Numbering& numbering, UnstructuredData& mesh) {
  auto in = file.values();
  const auto [count, markers, none, nothing] = header_of(in);
  std::size_t unmarked = 0;
  for (std::int64_t f = 0; f < count; ++f) {
    auto line = in.filled_line();
    line.next<std::int64_t>();
    const auto face = read_corners<3>(line, numbering);
    const auto marker = markers > 0 ? line.next<double>() : 0;
    unmarked += marker == 0;
    if (marker == 0) continue;
    mesh.faces.push_back(face);
    mesh.face_scalars["region"].push_back(marker);
  }
  refuse_rest(in);
  if (unmarked > 0) mesh.remarks.push_back(fmt::format("left out: {} triangles without a marker", unmarked));
}

/// Chaste's axes per element, which follow the number of elements.
void read_axes(const TetgenFile& file, const std::vector<const char*>& names, UnstructuredData& mesh) {
  auto in = file.values();
  const auto count = header_of(in)[0];
  if (static_cast<std::size_t>(count) != mesh.tets.size())
    in.fail(fmt::format("has axes of {} elements, but there are {}", count, mesh.tets.size()));
  for (std::int64_t c = 0; c < count; ++c)
    for (const auto* name : names) mesh.cell_vectors[name].push_back(in.vector());
  refuse_rest(in);
}

}  // namespace

UnstructuredData read_tetgen(const fs::path& path) {
  UnstructuredData mesh;
  mesh.integers = {"region", "boundary_marker"};
  const auto node_file = open(path, ".node");
  const Numbering numbering(read_nodes(node_file, mesh));
  if (const auto twice = numbering.repeated())
    node_file.values().fail(fmt::format("node {} stands there twice", *twice));
  read_cells(open(path, ".ele"), numbering, mesh);
  if (is_there(path, ".face")) read_faces(open(path, ".face"), numbering, mesh);
  if (is_there(path, ".ortho"))
    read_axes(open(path, ".ortho"), {"fiber", "sheet", "sheet_normal"}, mesh);
  else if (is_there(path, ".axi"))
    read_axes(open(path, ".axi"), {"fiber"}, mesh);
  return mesh;
}

}  // namespace heartgen::mesh_files
