// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/fill_loop.hpp"

#include <algorithm>
#include <limits>

#include "model/contract.hpp"

namespace heartgen::mesh {
namespace {

constexpr double side_weight = 1e-3;  // of squared sides, beside areas: flat loops can be filled in many ways
constexpr double taken_cost = 1e9;    // mm2: only where nothing else is left

/// Least cost of each part of a loop, from node i to node j, and the node between them that gives it.
struct Parts {
  std::size_t count;
  std::vector<double> cost;
  std::vector<std::size_t> middle;
  explicit Parts(std::size_t n) : count(n), cost(n * n, 0), middle(n * n, 0) {}
  std::size_t at(std::size_t i, std::size_t j) const { return i * count + j; }
};

/// The same loop for both directions: its smallest node first, and then the smaller of that node's neighbours.
std::vector<std::int32_t> canonical(std::vector<std::int32_t> loop) {
  std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  if (loop.back() < loop[1]) std::reverse(loop.begin() + 1, loop.end());
  return loop;
}

Parts least_costs(const std::vector<Vec3>& nodes_mm, const std::vector<std::int32_t>& loop,
                  const std::function<bool(std::int32_t, std::int32_t)>& is_taken) {
  const std::size_t n = loop.size();
  Parts parts(n);
  const auto point = [&](std::size_t i) { return nodes_mm[static_cast<std::size_t>(loop[i])]; };
  const auto side_cost = [&](std::size_t i, std::size_t j) {
    if (j == i + 1 || (i == 0 && j + 1 == n)) return 0.0;  // the loop's own
    const Vec3 side = point(j) - point(i);
    const auto [a, b] = std::minmax(loop[i], loop[j]);
    return side_weight * dot(side, side) + (is_taken(a, b) ? taken_cost : 0);
  };
  for (std::size_t length = 2; length < n; ++length)
    for (std::size_t i = 0; i + length < n; ++i) {
      const std::size_t j = i + length;
      double least = std::numeric_limits<double>::max();
      for (std::size_t k = i + 1; k < j; ++k) {
        const double area = norm(cross(point(k) - point(i), point(j) - point(i))) / 2;
        const double cost = parts.cost[parts.at(i, k)] + parts.cost[parts.at(k, j)] + area;
        if (cost >= least) continue;
        least = cost;
        parts.middle[parts.at(i, j)] = k;
      }
      parts.cost[parts.at(i, j)] = least + side_cost(i, j);
    }
  return parts;
}

}  // namespace

std::vector<Face> fill_loop(const std::vector<Vec3>& nodes_mm, const std::vector<std::int32_t>& given,
                            const std::function<bool(std::int32_t, std::int32_t)>& is_taken) {
  HEARTGEN_EXPECTS(given.size() >= 3);
  const auto loop = canonical(given);
  const auto parts = least_costs(nodes_mm, loop, is_taken);
  const auto first = std::find(given.begin(), given.end(), loop[0]) - given.begin();
  const bool is_turned = given[static_cast<std::size_t>(first + 1) % given.size()] != loop[1];
  std::vector<Face> faces;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, loop.size() - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j < i + 2) continue;
    const std::size_t k = parts.middle[parts.at(i, j)];
    faces.push_back(is_turned ? Face{loop[i], loop[j], loop[k]} : Face{loop[i], loop[k], loop[j]});
    open.emplace_back(i, k);
    open.emplace_back(k, j);
  }
  return faces;
}

}  // namespace heartgen::mesh
