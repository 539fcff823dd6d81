// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/surface_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace heartgen::report {
namespace {

/// Per triangle and edge (corner k to k + 1) the triangle beyond it; -1 where there is none or more than one.
std::vector<std::array<std::int32_t, 3>> neighbours_of(const ViewPart& part) {
  struct Edge {
    std::uint32_t a, b;
    std::int32_t triangle;
    std::size_t side;
  };
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < part.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(part.triangles[t][k], part.triangles[t][(k + 1) % 3]);
      edges.push_back({a, b, static_cast<std::int32_t>(t), k});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return std::tie(x.a, x.b, x.triangle) < std::tie(y.a, y.b, y.triangle);
  });
  std::vector<std::array<std::int32_t, 3>> beyond(part.triangles.size(), {-1, -1, -1});
  for (std::size_t e = 0; e < edges.size();) {
    std::size_t end = e + 1;
    while (end < edges.size() && edges[end].a == edges[e].a && edges[end].b == edges[e].b) ++end;
    if (end - e == 2) {
      const Edge &x = edges[e], &y = edges[e + 1];
      beyond[static_cast<std::size_t>(x.triangle)][x.side] = y.triangle;
      beyond[static_cast<std::size_t>(y.triangle)][y.side] = x.triangle;
    }
    e = end;
  }
  return beyond;
}

struct Walker {
  const ViewPart& part;
  std::vector<std::array<std::int32_t, 3>> beyond;

  std::array<Vec3, 3> corners(std::int32_t t) const {
    const auto& ids = part.triangles[static_cast<std::size_t>(t)];
    return {part.points_mm[ids[0]], part.points_mm[ids[1]], part.points_mm[ids[2]]};
  }

  static Vec3 normal_of(const std::array<Vec3, 3>& c) { return normalized(cross(c[1] - c[0], c[2] - c[0])); }

  /// Mean axis of the corners along the triangle, with the sign of `heading`; nothing where it stands out of it.
  std::optional<Vec3> direction(std::int32_t t, const Vec3& heading) const {
    constexpr double min_share = 0.34;  // 70 degrees
    Vec3 sum;
    for (const auto id : part.triangles[static_cast<std::size_t>(t)]) {
      const Vec3& axis = part.fibers[id];
      sum += dot(axis, dot(sum, sum) > 0 ? sum : heading) < 0 ? -axis : axis;
    }
    sum = normalized(sum);
    const Vec3 normal = normal_of(corners(t));
    const Vec3 along = sum - dot(sum, normal) * normal;
    if (norm(along) < min_share) return std::nullopt;
    return normalized(dot(along, heading) < 0 ? -along : along);
  }

  /// Where a ray inside the triangle leaves it: the side and the way to it; side 3: nowhere.
  static std::pair<std::size_t, double> exit_of(const std::array<Vec3, 3>& c, const Vec3& p, const Vec3& d,
                                                std::size_t entered) {
    const Vec3 normal = normal_of(c);
    std::pair<std::size_t, double> best{3, 1e300};
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == entered) continue;
      const Vec3 out = cross(c[(k + 1) % 3] - c[k], normal);
      const double speed = dot(d, out);
      if (speed <= 1e-12) continue;
      const double way = std::max(0.0, dot(c[k] - p, out) / speed);
      if (way < best.second) best = {k, way};
    }
    return best;
  }

  std::size_t side_towards(std::int32_t t, std::int32_t from) const {
    const auto& sides = beyond[static_cast<std::size_t>(t)];
    return static_cast<std::size_t>(std::find(sides.begin(), sides.end(), from) - sides.begin());
  }

  void follow(std::int32_t t, Vec3 p, Vec3 heading, double length_mm, SurfaceLine& line) const {
    constexpr double flattest_fold = 0.3;  // cosine between the normals of neighbours
    constexpr int max_triangles = 200;
    std::size_t entered = 3;
    for (int step = 0; step < max_triangles && length_mm > 0; ++step) {
      const auto d = direction(t, heading);
      const auto c = corners(t);
      if (!d) return;
      const auto [side, way] = exit_of(c, p, *d, entered);
      if (side == 3) return;
      p += std::min(way, length_mm) * *d;
      line.points_mm.push_back(p);
      line.nearest.push_back(part.triangles[static_cast<std::size_t>(t)][side]);
      if (way >= length_mm) return;
      length_mm -= way;
      const auto next = beyond[static_cast<std::size_t>(t)][side];
      if (next < 0 || dot(normal_of(corners(next)), normal_of(c)) < flattest_fold) return;
      entered = side_towards(next, t);
      t = next, heading = *d;
    }
  }

  SurfaceLine through(std::int32_t t, double length_mm) const {
    const auto c = corners(t);
    const Vec3 middle = (c[0] + c[1] + c[2]) / 3;
    const auto ids = part.triangles[static_cast<std::size_t>(t)];
    const auto d = direction(t, part.fibers[ids[0]]);
    SurfaceLine line, back;
    if (!d) return line;
    follow(t, middle, -*d, length_mm / 2, back);
    line.points_mm.assign(back.points_mm.rbegin(), back.points_mm.rend());
    line.nearest.assign(back.nearest.rbegin(), back.nearest.rend());
    line.points_mm.push_back(middle), line.nearest.push_back(ids[0]);
    follow(t, middle, *d, length_mm / 2, line);
    return line;
  }
};

/// One triangle per cube, the first in their order.
std::vector<std::int32_t> seeds_of(const Walker& walker, double spacing_mm) {
  std::vector<std::pair<std::array<std::int64_t, 3>, std::int32_t>> cubes;
  for (std::size_t t = 0; t < walker.part.triangles.size(); ++t) {
    const auto c = walker.corners(static_cast<std::int32_t>(t));
    const Vec3 middle = (c[0] + c[1] + c[2]) / 3;
    const auto cube = [&](double v) { return static_cast<std::int64_t>(std::floor(v / spacing_mm)); };
    cubes.push_back({{cube(middle.z), cube(middle.y), cube(middle.x)}, static_cast<std::int32_t>(t)});
  }
  std::sort(cubes.begin(), cubes.end());
  std::vector<std::int32_t> seeds;
  for (std::size_t i = 0; i < cubes.size(); ++i)
    if (i == 0 || cubes[i].first != cubes[i - 1].first) seeds.push_back(cubes[i].second);
  return seeds;
}

}  // namespace

std::vector<SurfaceLine> surface_lines(const ViewPart& part, double spacing_mm, double length_mm) {
  constexpr std::size_t min_points = 3;
  std::vector<SurfaceLine> lines;
  if (part.fibers.empty()) return lines;
  const Walker walker{part, neighbours_of(part)};
  for (const auto seed : seeds_of(walker, spacing_mm)) {
    SurfaceLine line = walker.through(seed, length_mm);
    if (line.points_mm.size() >= min_points) lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace heartgen::report
