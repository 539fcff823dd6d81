// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/painting/triangles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <tuple>
#include <utility>
#include <vector>

#include "generator/parallel/threads.hpp"
#include "model/bounding_box.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"

namespace heartgen::painting {
namespace {

using adapters::TriangleSurface;

constexpr std::size_t stl_head = 84, stl_triangle = 50;  // bytes

[[noreturn]] void refuse(const std::string& path, const std::string& problem) {
  throw UserError(problem, path, "is the file complete, and of the kind its name says?");
}

std::string bytes_of(const std::string& path) {
  require_input_file(path);
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Triangles as STL has them: three corners each, one behind the other.
TriangleSurface surface_of_corners(std::vector<Vec3> corners) {
  TriangleSurface surface;
  surface.points = std::move(corners);
  for (std::size_t p = 0; p + 2 < surface.points.size(); p += 3) {
    const auto first = static_cast<std::int32_t>(p);
    surface.faces.push_back({first, first + 1, first + 2});
  }
  return surface;
}

float float_at(const std::string& bytes, std::size_t at) {
  float value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// The number of triangles of a binary file, whose length says that it is one.
std::optional<std::size_t> binary_count(const std::string& bytes) {
  if (bytes.size() < stl_head) return std::nullopt;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return bytes.size() == stl_head + stl_triangle * count ? std::optional<std::size_t>(count) : std::nullopt;
}

TriangleSurface read_stl(const std::string& path) {
  const std::string bytes = bytes_of(path);
  std::vector<Vec3> corners;
  if (const auto count = binary_count(bytes)) {
    for (std::size_t t = 0; t < *count; ++t)
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto at = stl_head + stl_triangle * t + 12 * (corner + 1);  // behind the normal
        corners.push_back({float_at(bytes, at), float_at(bytes, at + 4), float_at(bytes, at + 8)});
      }
    return surface_of_corners(std::move(corners));
  }
  if (!bytes.starts_with("solid")) refuse(path, "is no STL: neither its length nor its first word is one's");
  std::istringstream words(bytes);
  words.imbue(std::locale::classic());
  std::string last;
  for (std::string word; words >> word; last = word) {
    if (word != "vertex") continue;
    Vec3 corner;
    if (!(words >> corner.x >> corner.y >> corner.z)) refuse(path, "has a vertex that is not three numbers");
    corners.push_back(corner);
  }
  if (!bytes.ends_with("\n") && last == "endloop") refuse(path, "ends in a triangle");
  if (corners.size() % 3 != 0) refuse(path, fmt::format("has {} corners, which are no triangles", corners.size()));
  return surface_of_corners(std::move(corners));
}

void merge_points(TriangleSurface& surface) {
  std::vector<std::int32_t> order(surface.points.size()), merged(surface.points.size());
  for (std::size_t p = 0; p < order.size(); ++p) order[p] = static_cast<std::int32_t>(p);
  const auto key = [&](std::int32_t p) {
    const Vec3& v = surface.points[static_cast<std::size_t>(p)];
    return std::tuple(v.x, v.y, v.z);
  };
  std::sort(order.begin(), order.end(),
            [&](std::int32_t a, std::int32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto here = static_cast<std::size_t>(order[i]);
    if (i == 0 || key(order[i]) != key(order[i - 1])) points.push_back(surface.points[here]);
    merged[here] = static_cast<std::int32_t>(points.size()) - 1;
  }
  surface.points = std::move(points);
  for (auto& face : surface.faces)
    for (auto& point : face) point = merged[static_cast<std::size_t>(point)];
  std::erase_if(surface.faces, [](const Face& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
}

std::size_t open_edges(const TriangleSurface& surface) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (const auto& face : surface.faces)
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(std::minmax(face[i], face[(i + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (std::size_t e = 0; e < edges.size();) {
    std::size_t next = e;
    while (next < edges.size() && edges[next] == edges[e]) ++next;
    open += (next - e) % 2;
    e = next;
  }
  return open;
}

/// Twice the area of (a, b, p) in the plane of x and y, from the lesser to the greater point whatever the order: two
/// triangles with one edge get exactly opposite numbers.
double side(const Vec3& a, const Vec3& b, double x, double y) {
  const bool turned = std::tie(b.x, b.y) < std::tie(a.x, a.y);
  const Vec3 &from = turned ? b : a, &to = turned ? a : b;
  const double area = (to.x - from.x) * (y - from.y) - (to.y - from.y) * (x - from.x);
  return turned ? -area : area;
}

/// Whether a side belongs to the triangle on its left where a ray meets it exactly.
bool owns(const Vec3& a, const Vec3& b) { return b.y < a.y || (a.y == b.y && b.x < a.x); }

/// Where the ray at (x, y) along z meets a triangle, if it does; each edge belongs to one of two triangles.
std::optional<double> height_at(std::array<Vec3, 3> t, double x, double y) {
  double area = side(t[0], t[1], t[2].x, t[2].y);
  if (area == 0) return std::nullopt;
  if (area < 0) std::swap(t[1], t[2]);
  area = std::abs(area);
  std::array<double, 3> weight{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &a = t[(i + 1) % 3], &b = t[(i + 2) % 3];
    weight[i] = side(a, b, x, y);
    if (weight[i] < 0 || (weight[i] == 0 && !owns(a, b))) return std::nullopt;
  }
  return (weight[0] * t[0].z + weight[1] * t[1].z + weight[2] * t[2].z) / (weight[0] + weight[1] + weight[2]);
}

/// Throws UserError for a surface that is no patient's.
Grid grid_around(const TriangleSurface& surface, double voxel_mm, const std::string& path) {
  constexpr double max_voxels = 64e6, max_grid_mm = 2000;
  const auto [low, high] = bounding_box(surface.points);
  const Vec3 extent = high - low;
  if (const double widest = std::max({extent.x, extent.y, extent.z}); widest > max_grid_mm)
    throw UserError(fmt::format("is {:.3g} mm wide", widest), path, "give a surface in mm, in the frame LPS");
  double h = voxel_mm;
  while ((extent.x / h + 1) * (extent.y / h + 1) * (extent.z / h + 1) > max_voxels) h *= 1.1;
  Grid grid;
  grid.spacing_mm = {h, h, h};
  for (int axis = 0; axis < 3; ++axis) {
    grid.size[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::ceil(extent[axis] / h)) + 1;
    grid.origin_mm[axis] = low[axis];
  }
  return grid;
}

struct Crossing {
  std::int64_t column;  ///< j * columns along x + i
  double z;
  bool operator<(const Crossing& other) const { return std::tie(column, z) < std::tie(other.column, other.z); }
};

std::vector<Crossing> crossings_of(const TriangleSurface& surface, const Grid& grid) {
  std::vector<Crossing> crossings;
  const double h = grid.spacing_mm.x;
  const auto first = [&](double low, int axis) {
    return std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor((low - grid.origin_mm[axis]) / h)));
  };
  const auto last = [&](double high, int axis) {
    return std::min(grid.size[static_cast<std::size_t>(axis)] - 1,
                    static_cast<std::int64_t>(std::ceil((high - grid.origin_mm[axis]) / h)));
  };
  for (const auto& face : surface.faces) {
    std::array<Vec3, 3> t;
    for (std::size_t i = 0; i < 3; ++i) t[i] = surface.points[static_cast<std::size_t>(face[i])];
    const auto [low_x, high_x] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [low_y, high_y] = std::minmax({t[0].y, t[1].y, t[2].y});
    for (auto j = first(low_y, 1); j <= last(high_y, 1); ++j)
      for (auto i = first(low_x, 0); i <= last(high_x, 0); ++i)
        if (const auto z = height_at(t, grid.origin_mm.x + static_cast<double>(i) * h,
                                     grid.origin_mm.y + static_cast<double>(j) * h))
          crossings.push_back({j * grid.size[0] + i, *z});
  }
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

}  // namespace

bool is_surface_name(const std::string& path) {
  const auto ending = std::filesystem::path(path).extension();
  return ending == ".stl" || ending == ".vtp" || ending == ".vtk";
}

TriangleSurface read_surface_file(const std::string& path) {
  TriangleSurface surface =
      std::filesystem::path(path).extension() == ".stl" ? read_stl(path) : adapters::read_triangles(path);
  for (const auto& p : surface.points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      refuse(path, "a coordinate is not a finite number");
  merge_points(surface);
  if (surface.faces.empty()) throw UserError("holds no triangle", path, "give a closed surface of triangles");
  return surface;
}

Mask inside_of(const TriangleSurface& surface, double voxel_mm, const std::string& path) {
  if (const auto open = open_edges(surface); open > 0)
    throw UserError(fmt::format("is no closed surface: {} of its edges have a triangle on one side alone", open), path,
                    "close its holes, or give a label image");
  Mask mask(grid_around(surface, voxel_mm, path));
  const Grid& grid = mask.grid;
  const auto crossings = crossings_of(surface, grid);
  const auto above = [&](double z) {  // the first voxel centre not below z
    return std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil((z - grid.origin_mm.z) / grid.spacing_mm.z)));
  };
  for (std::size_t c = 0; c + 1 < crossings.size(); c += 2) {
    const auto column = crossings[c].column;
    const auto end = std::min(above(crossings[c + 1].z), grid.size[2]);
    for (auto k = above(crossings[c].z); k < end; ++k) mask(column % grid.size[0], column / grid.size[0], k) = 1;
  }
  return mask;
}

}  // namespace heartgen::painting
