#include "generator/improve/msh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

#include "model/error.hpp"
#include "model/text.hpp"

namespace heart::improve {
namespace {

constexpr int triangle = 2, tetrahedron = 4;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem) {
  throw UserError(problem, path.string(), "write it again as gmsh's version 2.2 or 4.1, as text");
}

std::string whole_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw UserError("no such file, or no right to read it", path.string(), "check the path");
  std::string text((std::istreambuf_iterator<char>(stream)), {});
  std::erase(text, '\r');
  return text;
}

/// Values separated by blanks.
struct Values {
  std::istringstream text;
  const std::filesystem::path* path;

  template <class T>
  T next() {
    T value{};
    if (!(text >> value)) fail(*path, "ends too early, or has letters where a number belongs");
    return value;
  }
  std::size_t count() {
    const auto value = next<std::int64_t>();
    constexpr std::int64_t most = 2'000'000'000;
    if (value < 0 || value > most) fail(*path, fmt::format("{} is no count", value));
    return static_cast<std::size_t>(value);
  }
};

/// The text between $name and $Endname; empty where there is none.
std::string section(const std::string& file, const std::string& name) {
  const auto begin = file.find("$" + name + "\n");
  const auto end = file.find("$End" + name, begin);
  if (begin == std::string::npos || end == std::string::npos) return "";
  return file.substr(begin + name.size() + 2, end - begin - name.size() - 2);
}

struct Reader {
  const std::filesystem::path* path;
  std::string file;
  MshMesh mesh{};
  std::map<std::int64_t, std::int32_t> node{};                      // by the file's number
  std::map<std::pair<int, std::int64_t>, std::int32_t> physical{};  // of (dimension, entity), in 4.1

  Values values(const std::string& name) const {
    const auto text = section(file, name);
    if (text.empty()) fail(*path, fmt::format("has no section ${}", name));
    return {std::istringstream(text), path};
  }
  void read_names() {
    const auto text = section(file, "PhysicalNames");
    if (text.empty()) return;
    Values in{std::istringstream(text), path};
    for (auto left = in.count(); left > 0; --left) {
      const int dimension = in.next<int>();
      const auto tag = in.next<std::int32_t>();
      std::string name;
      std::getline(in.text, name);
      const auto first = name.find('"'), last = name.rfind('"');
      if (first == last) fail(*path, "a physical name is not in quotes");
      mesh.names[{dimension, tag}] = name.substr(first + 1, last - first - 1);
    }
  }
  void add_node(std::int64_t id, const Vec3& p) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) fail(*path, "a coordinate is not finite");
    if (!node.emplace(id, static_cast<std::int32_t>(mesh.nodes.size())).second)
      fail(*path, fmt::format("node {} stands there twice", id));
    mesh.nodes.push_back(p);
  }
  Vec3 point(Values& in) const {
    const double x = in.next<double>(), y = in.next<double>(), z = in.next<double>();
    return {x, y, z};
  }
  template <std::size_t N>
  std::array<std::int32_t, N> corners(Values& in) const {
    std::array<std::int32_t, N> ids;
    for (auto& id : ids) {
      const auto number = in.next<std::int64_t>();
      const auto found = node.find(number);
      if (found == node.end()) fail(*path, fmt::format("an element names node {}, which is missing", number));
      id = found->second;
    }
    return ids;
  }
  void add_element(Values& in, int type, std::int32_t tag) {
    if (type == tetrahedron) {
      mesh.cells.push_back(corners<4>(in));
      mesh.region.push_back(tag);
    } else if (type == triangle) {
      mesh.faces.push_back(corners<3>(in));
      mesh.surface.push_back(tag);
    } else {
      std::string rest;
      std::getline(in.text, rest);
    }
  }
  void read_version_2() {
    auto in = values("Nodes");
    for (auto left = in.count(); left > 0; --left) {
      const auto id = in.next<std::int64_t>();
      add_node(id, point(in));
    }
    auto elements = values("Elements");
    for (auto left = elements.count(); left > 0; --left) {
      elements.next<std::int64_t>();
      const int type = elements.next<int>();
      std::vector<std::int32_t> tags(elements.count());
      for (auto& tag : tags) tag = elements.next<std::int32_t>();
      const bool unnamed = tags.empty() || (tags[0] == 0 && tags.size() < 2);
      add_element(elements, type, unnamed ? 1 : tags[0] != 0 ? tags[0] : tags[1]);
    }
  }
  void read_entities() {
    const auto text = section(file, "Entities");
    if (text.empty()) return;
    Values in{std::istringstream(text), path};
    std::array<std::size_t, 4> counts{};
    for (auto& count : counts) count = in.count();
    for (int dimension = 0; dimension <= 3; ++dimension)
      for (auto left = counts[static_cast<std::size_t>(dimension)]; left > 0; --left) {
        const auto tag = in.next<std::int64_t>();
        for (int i = 0; i < (dimension == 0 ? 3 : 6); ++i) in.next<double>();
        for (auto groups = in.count(); groups > 0; --groups)
          physical.emplace(std::pair{dimension, tag}, in.next<std::int32_t>());
        if (dimension > 0)
          for (auto parts = in.count(); parts > 0; --parts) in.next<std::int64_t>();
      }
  }
  void read_version_4() {
    read_entities();
    auto in = values("Nodes");
    auto blocks = in.count();
    for (int i = 0; i < 3; ++i) in.next<std::int64_t>();
    for (; blocks > 0; --blocks) {
      for (int i = 0; i < 2; ++i) in.next<std::int64_t>();
      if (in.next<int>() != 0) fail(*path, "has parametric nodes");
      std::vector<std::int64_t> ids(in.count());
      for (auto& id : ids) id = in.next<std::int64_t>();
      for (const auto id : ids) add_node(id, point(in));
    }
    auto elements = values("Elements");
    blocks = elements.count();
    for (int i = 0; i < 3; ++i) elements.next<std::int64_t>();
    for (; blocks > 0; --blocks) {
      const int dimension = elements.next<int>();
      const auto entity = elements.next<std::int64_t>();
      const int type = elements.next<int>();
      const auto group = physical.find({dimension, entity});
      const auto tag = group != physical.end() ? group->second : static_cast<std::int32_t>(entity);
      for (auto left = elements.count(); left > 0; --left) {
        elements.next<std::int64_t>();
        add_element(elements, type, tag);
      }
    }
  }
};

}  // namespace

MshMesh read_msh(const std::filesystem::path& path) {
  Reader reader{&path, whole_file(path)};
  auto in = reader.values("MeshFormat");
  const auto version = in.next<std::string>();
  if (in.next<int>() != 0) fail(path, "is a binary .msh file");
  reader.read_names();
  if (version.starts_with("2"))
    reader.read_version_2();
  else if (version == "4.1")
    reader.read_version_4();
  else
    fail(path, fmt::format("has version {}", version));
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
