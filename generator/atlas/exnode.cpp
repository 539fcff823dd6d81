// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/atlas/exnode.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

#include "generator/atlas/exnode_geometry.hpp"
#include "model/axis_tensor.hpp"

namespace heartgen::atlas {
namespace {

namespace fs = std::filesystem;
using exnode::corners;
using exnode::Evaluator;

constexpr std::array<std::size_t, 3> divisions{10, 8, 6};  // of an element of a heart's wall: cells of about 2 mm

/// Points closer than this are one: neighbouring elements share their faces.
constexpr double same_point_mm = 1e-3;

struct Builder {
  std::map<std::array<std::int64_t, 3>, std::int32_t> ids;
  std::vector<Vec3> points;
  std::vector<AxisTensor> axes;
  std::vector<Cell> cells;

  std::int32_t add(const Vec3& p, const Vec3& fiber) {
    std::array<std::int64_t, 3> key;
    for (std::size_t a = 0; a < 3; ++a) key[a] = std::llround(p[static_cast<int>(a)] / same_point_mm);
    const auto [at, is_new] = ids.try_emplace(key, static_cast<std::int32_t>(points.size()));
    if (is_new) points.push_back(p), axes.emplace_back();
    axes[static_cast<std::size_t>(at->second)] += axis_tensor(fiber);
    return at->second;
  }

  /// Six tetrahedra around the diagonal from the first to the last corner; flat ones are left out.
  void add_brick(const std::array<std::int32_t, corners>& corner) {
    constexpr double min_volume_mm3 = 1e-6;
    constexpr std::array<std::array<std::size_t, 4>, 6> split{
        {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
    for (const auto& four : split) {
      Cell cell;
      std::array<Vec3, 4> p;
      for (std::size_t k = 0; k < 4; ++k) {
        cell[k] = corner[four[k]];
        p[k] = points[static_cast<std::size_t>(cell[k])];
      }
      if (std::abs(dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0]))) > 6 * min_volume_mm3) cells.push_back(cell);
    }
  }

  void add_element(const Evaluator& element) {
    const std::size_t n1 = divisions[0], n2 = divisions[1], n3 = divisions[2];
    std::vector<std::int32_t> id;
    for (std::size_t k = 0; k <= n3; ++k)
      for (std::size_t j = 0; j <= n2; ++j)
        for (std::size_t i = 0; i <= n1; ++i) {
          const Vec3 xi{static_cast<double>(i) / static_cast<double>(n1),
                        static_cast<double>(j) / static_cast<double>(n2),
                        static_cast<double>(k) / static_cast<double>(n3)};
          id.push_back(add(element.place(xi).position, element.fiber(xi)));
        }
    for (std::size_t k = 0; k < n3; ++k)
      for (std::size_t j = 0; j < n2; ++j)
        for (std::size_t i = 0; i < n1; ++i) {
          std::array<std::int32_t, corners> corner;
          for (std::size_t c = 0; c < corners; ++c)
            corner[c] = id[((k + (c >> 2)) * (n2 + 1) + j + ((c >> 1) & 1)) * (n1 + 1) + i + (c & 1)];
          add_brick(corner);
        }
  }
};

/// "heart.exnode.gz" and ".exelem" become "heart.exelem.gz", or "heart.exelem" where only that exists.
std::string partner(const std::string& path, const std::string& from, const std::string& to) {
  std::string other = path;
  other.replace(other.rfind(from), from.size(), to);
  if (fs::exists(other)) return other;
  const std::string zipped = ".gz";
  const bool ends = other.ends_with(zipped);
  const std::string second = ends ? other.substr(0, other.size() - zipped.size()) : other + zipped;
  return fs::exists(second) ? second : other;
}

}  // namespace

bool is_exnode_path(const std::string& path) {
  for (const char* ending : {".exnode", ".exelem", ".exnode.gz", ".exelem.gz"})
    if (path.ends_with(ending)) return true;
  return false;
}

FiberAtlas read_exnode_atlas(const std::string& path) {
  const bool is_node = path.rfind(".exnode") != std::string::npos && path.rfind(".exelem") == std::string::npos;
  const std::string node_path = is_node ? path : partner(path, ".exelem", ".exnode");
  const std::string element_path = is_node ? partner(path, ".exnode", ".exelem") : path;
  const auto nodes = exnode::read_nodes(node_path);
  const auto elements = exnode::read_elements(element_path);
  Builder builder;
  for (const auto& element : elements.elements) builder.add_element(Evaluator(element_path, nodes, elements, element));
  std::vector<Vec3> fibers;
  for (const auto& tensor : builder.axes) fibers.push_back(leading_axis(tensor));
  auto atlas = make_fiber_atlas(path, std::move(builder.points), std::move(builder.cells), fibers);
  atlas.name = fs::path(path).filename().string();
  return atlas;
}

}  // namespace heartgen::atlas
