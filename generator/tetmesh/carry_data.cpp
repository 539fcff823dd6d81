// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/carry_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <type_traits>
#include <utility>

#include "generator/parallel/threads.hpp"
#include "model/mesh_queries/face_tree.hpp"

namespace heartgen::tetmesh {
namespace {

/// The cells of every node, one list after the other.
struct Stars {
  std::vector<std::int32_t> first, pool;

  Stars(std::size_t nodes, const std::vector<Cell>& cells) : first(nodes + 1, 0) {
    for (const auto& cell : cells)
      for (const auto n : cell) ++first[static_cast<std::size_t>(n) + 1];
    for (std::size_t n = 0; n < nodes; ++n) first[n + 1] += first[n];
    pool.resize(4 * cells.size());
    auto next = first;
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (const auto n : cells[c])
        pool[static_cast<std::size_t>(next[static_cast<std::size_t>(n)]++)] = static_cast<std::int32_t>(c);
  }
  template <class Visit>
  void visit(std::int32_t node, const Visit& visit_cell) const {
    const auto n = static_cast<std::size_t>(node);
    for (auto i = first[n]; i < first[n + 1]; ++i) visit_cell(pool[static_cast<std::size_t>(i)]);
  }
};

/// A mesh in which places are looked up, from the nearest node on.
struct Places {
  const std::vector<Vec3>* nodes;
  const std::vector<Cell>* cells;
  Stars stars;
  mesh_queries::FaceTree tree;     // of nodes in use, as triangles without size
  std::vector<std::int32_t> used;  // their ids

  Places(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& all)
      : nodes(&nodes_mm), cells(&all), stars(nodes_mm.size(), all) {
    std::vector<mesh_queries::Triangle> points;
    for (std::size_t n = 0; n < nodes_mm.size(); ++n) {
      if (stars.first[n] == stars.first[n + 1]) continue;
      used.push_back(static_cast<std::int32_t>(n));
      points.push_back({nodes_mm[n], nodes_mm[n], nodes_mm[n]});
    }
    tree = mesh_queries::make_face_tree(std::move(points));
  }
  std::array<double, 4> weights(std::int32_t cell, const Vec3& point) const {
    const auto& c = (*cells)[static_cast<std::size_t>(cell)];
    const auto at = [&](std::size_t i) { return (*nodes)[static_cast<std::size_t>(c[i])]; };
    const Vec3 a = at(1) - at(0), b = at(2) - at(0), d = at(3) - at(0), p = point - at(0);
    const double volume = dot(a, cross(b, d));
    if (volume == 0) return {-1e300, 0, 0, 0};
    const double u = dot(p, cross(b, d)) / volume, v = dot(a, cross(p, d)) / volume, w = dot(a, cross(b, p)) / volume;
    return {1 - u - v - w, u, v, w};
  }
  /// The cell in which the point lies deepest, among those two steps around the nearest node that `accept` takes.
  template <class Accept>
  std::int32_t find(const Vec3& point, const Accept& accept) const {
    constexpr double anywhere_mm = 1e9;
    const auto nearest = used[static_cast<std::size_t>(mesh_queries::nearest_face(tree, point, anywhere_mm).face)];
    std::set<std::int32_t> near;
    stars.visit(nearest, [&](std::int32_t c) {
      for (const auto n : (*cells)[static_cast<std::size_t>(c)])
        stars.visit(n, [&](std::int32_t other) { near.insert(other); });
    });
    std::int32_t best = -1;
    double depth = -std::numeric_limits<double>::infinity();
    for (const auto c : near) {
      if (!accept(c)) continue;
      const auto w = weights(c, point);
      const double least = *std::min_element(w.begin(), w.end());
      if (best < 0 || least > depth) best = c, depth = least;
    }
    return best;
  }
};

NodeSource source_of(const Places& places, const Vec3& point) {
  const auto cell = places.find(point, [](std::int32_t) { return true; });
  auto weights = places.weights(cell, point);
  double sum = 0;
  for (auto& w : weights) sum += w = std::max(w, 0.0);
  NodeSource source{(*places.cells)[static_cast<std::size_t>(cell)], weights};
  if (!(sum > 0)) source.weights = {1, 0, 0, 0}, sum = 1;
  for (auto& w : source.weights) w /= sum;
  const auto largest =
      static_cast<std::size_t>(std::max_element(source.weights.begin(), source.weights.end()) - source.weights.begin());
  std::swap(source.nodes[0], source.nodes[largest]);
  std::swap(source.weights[0], source.weights[largest]);
  return source;
}

template <class T>
std::vector<T> mixed(const std::vector<T>& values, const std::vector<NodeSource>& sources, const auto& add) {
  std::vector<T> result;
  result.reserve(sources.size());
  for (const auto& source : sources) {
    const auto value = [&](std::size_t i) -> const T& { return values[static_cast<std::size_t>(source.nodes[i])]; };
    if (source.weights[0] == 1) {
      result.push_back(value(0));
      continue;
    }
    T sum{};
    if constexpr (std::is_same_v<T, Mat3>) sum = Mat3{{Vec3{}, Vec3{}, Vec3{}}};
    for (std::size_t i = 0; i < 4; ++i) add(sum, source.weights[i], value(i), value(0));
    result.push_back(sum);
  }
  return result;
}

}  // namespace

std::vector<NodeSource> node_sources(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                                     const ImprovedMesh& improved) {
  const Places places(nodes_mm, cells);
  std::vector<NodeSource> sources(improved.nodes_mm.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(sources.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const auto old = improved.old_node[n];
      const bool stayed = old >= 0 && improved.nodes_mm[n] == nodes_mm[static_cast<std::size_t>(old)];
      sources[n] = stayed ? NodeSource{{old, old, old, old}, {1, 0, 0, 0}} : source_of(places, improved.nodes_mm[n]);
    }
  });
  return sources;
}

std::vector<std::int32_t> cell_sources(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                                       const std::vector<std::int32_t>& region, const ImprovedMesh& improved) {
  const Places places(nodes_mm, cells);
  std::vector<std::int32_t> sources(improved.cells.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(sources.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c) {
      Vec3 middle;
      for (const auto n : improved.cells[c]) middle += 0.25 * improved.nodes_mm[static_cast<std::size_t>(n)];
      const auto same = [&](std::int32_t old) {
        return region.empty() || region[static_cast<std::size_t>(old)] == improved.region[c];
      };
      sources[c] = places.find(middle, same);
      if (sources[c] < 0) sources[c] = places.find(middle, [](std::int32_t) { return true; });
    }
  });
  return sources;
}

bool are_codes(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == std::round(v); });
}

bool are_ids(const std::vector<double>& values) {
  return values.size() > 1 && are_codes(values) &&
         std::set<double>(values.begin(), values.end()).size() == values.size();
}

std::vector<double> carried(const std::vector<double>& values, const std::vector<NodeSource>& sources) {
  if (are_codes(values)) return mixed(values, sources, [](double& sum, double, double, double first) { sum = first; });
  return mixed(values, sources, [](double& sum, double weight, double value, double) { sum += weight * value; });
}

std::vector<Vec3> carried(const std::vector<Vec3>& values, const std::vector<NodeSource>& sources) {
  return mixed(values, sources,
               [](Vec3& sum, double weight, const Vec3& value, const Vec3&) { sum += weight * value; });
}

std::vector<Mat3> carried(const std::vector<Mat3>& values, const std::vector<NodeSource>& sources) {
  return mixed(values, sources, [](Mat3& sum, double weight, const Mat3& value, const Mat3&) {
    for (int row = 0; row < 3; ++row) sum[row] += weight * value[row];
  });
}

std::vector<Vec3> carried_axes(const std::vector<Vec3>& values, const std::vector<NodeSource>& sources) {
  auto result = mixed(values, sources, [](Vec3& sum, double weight, const Vec3& value, const Vec3& first) {
    sum += (dot(value, first) < 0 ? -weight : weight) * value;
  });
  for (std::size_t n = 0; n < result.size(); ++n) {
    if (sources[n].weights[0] == 1) continue;
    double length = 0, share = 0;  // of the corners that have an axis
    for (std::size_t i = 0; i < 4; ++i) {
      const double corner = norm(values[static_cast<std::size_t>(sources[n].nodes[i])]);
      length += sources[n].weights[i] * corner;
      share += corner > 0 ? sources[n].weights[i] : 0;
    }
    result[n] = share > 0 ? (length / share) * normalized(result[n]) : Vec3{};
  }
  return result;
}

void straighten(const std::vector<Vec3>& first, std::vector<Vec3>& second, std::vector<Vec3>& third) {
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Vec3 along = normalized(first[i]);
    const Vec3 rest = normalized(second[i] - dot(second[i], along) * along);
    if (along == Vec3{} || rest == Vec3{}) continue;
    const Vec3 last = cross(along, rest);
    second[i] = norm(second[i]) * rest;
    third[i] = (dot(last, third[i]) < 0 ? -norm(third[i]) : norm(third[i])) * last;
  }
}

}  // namespace heartgen::tetmesh
