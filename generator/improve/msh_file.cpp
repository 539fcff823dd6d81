#include "generator/improve/msh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

#include "model/error.hpp"
#include "model/text.hpp"

namespace heart::improve {
namespace {

constexpr int triangle = 2, tetrahedron = 4;

/// Nodes of gmsh's element types 1 to 31; of the others a binary file does not say where the next one begins.
constexpr std::array<std::size_t, 32> nodes_of_type{0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                                    8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem) {
  throw UserError(problem, path.string(), "write it again as gmsh's version 2.2 or 4.1");
}

std::string whole_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw UserError("no such file, or no right to read it", path.string(), "check the path");
  return {std::istreambuf_iterator<char>(stream), {}};
}

enum class Kind { text, binary, swapped };  ///< swapped: binary, of a machine with the other order of bytes

/// Values one after another: separated by blanks, or as they lie in memory.
struct Values {
  std::string_view rest;
  const std::filesystem::path* path;
  Kind kind = Kind::text;

  [[noreturn]] void fail_here() const {
    fail(*path, kind == Kind::text ? "ends too early, or has letters where a number belongs" : "ends too early");
  }
  std::string_view word() {
    constexpr const char* blanks = " \t\n";
    rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
    const auto found = rest.substr(0, rest.find_first_of(blanks));
    rest.remove_prefix(found.size());
    return found;
  }
  std::string_view line() {
    const auto found = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(found.size() + 1, rest.size()));
    return found;
  }
  template <class T>
  T next_of_text() {
    auto text = word();
    if (text.starts_with('+')) text.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) fail_here();
    return value;
  }
  /// T is the type that binary files have there.
  template <class T>
  T next() {
    if (kind == Kind::text) return next_of_text<T>();
    if (rest.size() < sizeof(T)) fail_here();
    std::array<char, sizeof(T)> bytes;
    std::copy_n(rest.begin(), sizeof(T), bytes.begin());
    rest.remove_prefix(sizeof(T));
    if (kind == Kind::swapped) std::reverse(bytes.begin(), bytes.end());
    T value{};
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  template <class T>
  void skip(std::size_t count) {
    for (; count > 0; --count) next<T>();
  }
  /// Everything that is counted takes a byte or more, so that a wrong count asks for no absurd memory.
  std::size_t checked(std::int64_t value) const {
    if (value < 0) fail(*path, fmt::format("{} is no count", value));
    if (static_cast<std::size_t>(value) > rest.size()) fail_here();
    return static_cast<std::size_t>(value);
  }
  template <class T = std::int64_t>
  std::size_t count() {
    return checked(next<T>());
  }
  std::size_t count_of_text() { return checked(next_of_text<std::int64_t>()); }
  /// A line's text before binary values: they begin behind its end.
  std::size_t count_on_a_line() {
    const auto value = count_of_text();
    line();
    return value;
  }
};

struct Reader {
  const std::filesystem::path* path;
  std::string file;
  Kind kind = Kind::text;
  std::size_t at = 0;  // up to where binary sections are read; what lies there may look like a heading
  MshMesh mesh{};
  std::map<std::int64_t, std::int32_t> node{};                      // by the file's number
  std::map<std::pair<int, std::int64_t>, std::int32_t> physical{};  // of (dimension, entity), in 4.1

  /// What follows the section's heading; empty where there is none.
  std::string_view section(const std::string& name) const {
    const std::string heading = "$" + name + "\n";
    const auto begin = file.find(heading, at);
    if (begin == std::string::npos) return {};
    const auto rest = std::string_view(file).substr(begin + heading.size());
    return kind == Kind::text ? rest.substr(0, rest.find("$End" + name)) : rest;
  }
  Values values(const std::string& name) const {
    const auto text = section(name);
    if (text.empty()) fail(*path, fmt::format("has no section ${}", name));
    return {text, path, kind};
  }
  void end(Values& in, const std::string& name) {
    if (kind == Kind::text) return;
    if (in.word() != "$End" + name) fail(*path, fmt::format("its section ${} does not end where it should", name));
    at = file.size() - in.rest.size();
  }
  std::string read_version() {
    const auto begin = file.find("$MeshFormat");
    if (begin == std::string::npos) fail(*path, "has no section $MeshFormat");
    Values in{std::string_view(file).substr(begin + std::string_view("$MeshFormat").size()), path};
    in.line();
    std::string version(in.word());
    const bool is_binary = in.next<int>() != 0;
    const auto bytes = in.next<int>();
    if (!is_binary) {
      std::erase(file, '\r');
      return version;
    }
    in.line();
    in.kind = Kind::binary;
    const auto one = in.next<std::int32_t>();
    constexpr std::int32_t one_swapped = 1 << 24;
    if (bytes != 8 || (one != 1 && one != one_swapped)) fail(*path, "is a binary file of an unknown kind");
    kind = one == 1 ? Kind::binary : Kind::swapped;
    end(in, "MeshFormat");
    return version;
  }
  void read_names() {
    const auto text = section("PhysicalNames");
    if (text.empty()) return;
    Values in{text, path};
    for (auto left = in.count(); left > 0; --left) {
      const int dimension = in.next<int>();
      const auto tag = in.next<std::int32_t>();
      const auto name = in.line();
      const auto first = name.find('"'), last = name.rfind('"');
      if (first == last) fail(*path, "a physical name is not in quotes");
      mesh.names[{dimension, tag}] = name.substr(first + 1, last - first - 1);
    }
    end(in, "PhysicalNames");
  }
  void add_node(std::int64_t id, const Vec3& p) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) fail(*path, "a coordinate is not finite");
    if (!node.emplace(id, static_cast<std::int32_t>(mesh.nodes.size())).second)
      fail(*path, fmt::format("node {} stands there twice", id));
    mesh.nodes.push_back(p);
  }
  static Vec3 point(Values& in) {
    const auto x = in.next<double>(), y = in.next<double>(), z = in.next<double>();
    return {x, y, z};
  }
  template <std::size_t N, class Id>
  std::array<std::int32_t, N> corners(Values& in) const {
    std::array<std::int32_t, N> ids;
    for (auto& id : ids) {
      const auto number = static_cast<std::int64_t>(in.next<Id>());
      const auto found = node.find(number);
      if (found == node.end()) fail(*path, fmt::format("an element names node {}, which is missing", number));
      id = found->second;
    }
    return ids;
  }
  template <class Id>
  void add_element(Values& in, int type, std::int32_t tag) {
    if (type == tetrahedron) {
      mesh.cells.push_back(corners<4, Id>(in));
      mesh.region.push_back(tag);
    } else if (type == triangle) {
      mesh.faces.push_back(corners<3, Id>(in));
      mesh.surface.push_back(tag);
    } else if (kind == Kind::text) {
      in.line();
    } else {
      if (type < 1 || static_cast<std::size_t>(type) >= nodes_of_type.size())
        fail(*path, fmt::format("has elements of type {}", type));
      in.skip<Id>(nodes_of_type[static_cast<std::size_t>(type)]);
    }
  }
  static std::int32_t tag_among(const std::vector<std::int32_t>& tags) {
    const bool unnamed = tags.empty() || (tags[0] == 0 && tags.size() < 2);
    return unnamed ? 1 : tags[0] != 0 ? tags[0] : tags[1];
  }
  /// Of text: each element with its type and its number of tags.
  void read_elements_2(Values& in) {
    for (auto left = in.count(); left > 0; --left) {
      in.next<std::int64_t>();
      const int type = in.next<int>();
      std::vector<std::int32_t> tags(in.count());
      for (auto& tag : tags) tag = in.next<std::int32_t>();
      add_element<std::int64_t>(in, type, tag_among(tags));
    }
  }
  /// In blocks that say both once.
  void read_binary_elements_2(Values& in) {
    for (auto left = in.count_on_a_line(); left > 0;) {
      const int type = in.next<std::int32_t>();
      const auto count = in.count<std::int32_t>();
      std::vector<std::int32_t> tags(in.count<std::int32_t>());
      if (count == 0 || count > left) fail(*path, "its blocks of elements have other counts than it says");
      for (std::size_t e = 0; e < count; ++e) {
        in.next<std::int32_t>();
        for (auto& tag : tags) tag = in.next<std::int32_t>();
        add_element<std::int32_t>(in, type, tag_among(tags));
      }
      left -= count;
    }
  }
  void read_version_2() {
    const bool is_text = kind == Kind::text;
    auto in = values("Nodes");
    for (auto left = in.count_on_a_line(); left > 0; --left) {
      const auto id = is_text ? in.next<std::int64_t>() : in.next<std::int32_t>();
      add_node(id, point(in));
    }
    end(in, "Nodes");
    auto elements = values("Elements");
    if (is_text)
      read_elements_2(elements);
    else
      read_binary_elements_2(elements);
    end(elements, "Elements");
  }
  void read_entities() {
    const auto text = section("Entities");
    if (text.empty()) return;
    Values in{text, path, kind};
    std::array<std::size_t, 4> counts{};
    for (auto& count : counts) count = in.count();
    for (int dimension = 0; dimension <= 3; ++dimension)
      for (auto left = counts[static_cast<std::size_t>(dimension)]; left > 0; --left) {
        const auto tag = in.next<std::int32_t>();
        in.skip<double>(dimension == 0 ? 3 : 6);
        for (auto groups = in.count(); groups > 0; --groups)
          physical.emplace(std::pair{dimension, tag}, in.next<std::int32_t>());
        if (dimension > 0) in.skip<std::int32_t>(in.count());
      }
    end(in, "Entities");
  }
  void read_nodes_4() {
    auto in = values("Nodes");
    auto blocks = in.count();
    in.skip<std::int64_t>(3);
    for (; blocks > 0; --blocks) {
      in.skip<std::int32_t>(2);
      if (in.next<std::int32_t>() != 0) fail(*path, "has parametric nodes");
      std::vector<std::int64_t> ids(in.count());
      for (auto& id : ids) id = in.next<std::int64_t>();
      for (const auto id : ids) add_node(id, point(in));
    }
    end(in, "Nodes");
  }
  void read_elements_4() {
    auto in = values("Elements");
    auto blocks = in.count();
    in.skip<std::int64_t>(3);
    for (; blocks > 0; --blocks) {
      const int dimension = in.next<std::int32_t>();
      const auto entity = in.next<std::int32_t>();
      const int type = in.next<std::int32_t>();
      const auto group = physical.find({dimension, entity});
      const auto tag = group != physical.end() ? group->second : entity;
      for (auto left = in.count(); left > 0; --left) {
        in.next<std::int64_t>();
        add_element<std::int64_t>(in, type, tag);
      }
    }
    end(in, "Elements");
  }
};

}  // namespace

MshMesh read_msh(const std::filesystem::path& path) {
  Reader reader{&path, whole_file(path)};
  const auto version = reader.read_version();
  reader.read_names();
  if (version.starts_with("2")) {
    reader.read_version_2();
  } else if (version == "4.1") {
    reader.read_entities();
    reader.read_nodes_4();
    reader.read_elements_4();
  } else {
    fail(path, fmt::format("has version {}", version));
  }
  if (reader.mesh.cells.empty()) fail(path, "there is no tetrahedron in the file");
  return std::move(reader.mesh);
}

void write_msh(const std::filesystem::path& path, const MshMesh& mesh) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  if (!mesh.names.empty()) {
    text += fmt::format("$PhysicalNames\n{}\n", mesh.names.size());
    for (const auto& [key, name] : mesh.names) text += fmt::format("{} {} \"{}\"\n", key.first, key.second, name);
    text += "$EndPhysicalNames\n";
  }
  text += fmt::format("$Nodes\n{}\n", mesh.nodes.size());
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    text += fmt::format("{} {} {} {}\n", n + 1, mesh.nodes[n].x, mesh.nodes[n].y, mesh.nodes[n].z);
  text += fmt::format("$EndNodes\n$Elements\n{}\n", mesh.cells.size() + mesh.faces.size());
  std::size_t id = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto& n = mesh.cells[c];
    text += fmt::format("{} 4 2 {} {} {} {} {} {}\n", ++id, mesh.region[c], mesh.region[c], n[0] + 1, n[1] + 1,
                        n[2] + 1, n[3] + 1);
  }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& n = mesh.faces[f];
    text +=
        fmt::format("{} 2 2 {} {} {} {} {}\n", ++id, mesh.surface[f], mesh.surface[f], n[0] + 1, n[1] + 1, n[2] + 1);
  }
  write_text(path.string(), text + "$EndElements\n");
}

}  // namespace heart::improve
