#include "generator/atlas/atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "generator/adapters/vtk_io.hpp"
#include "generator/atlas/axis_tensor.hpp"
#include "generator/atlas/exnode.hpp"
#include "generator/atlas/voxel_atlas.hpp"
#include "model/error.hpp"

namespace heart::atlas {
namespace {

constexpr const char* expected = "a fibre atlas is a mesh of tetrahedra with one vector per point or per cell";
// A pair of ventricles spans 50 mm (small animal or child) to 250 mm; the longest side of the box decides the unit.
constexpr double smallest_heart_mm = 50, largest_heart_mm = 250;

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

double longest_side(const std::vector<Vec3>& points) {
  Vec3 low = points.front(), high = points.front();
  for (const Vec3& p : points)
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

double unit_in_mm(const std::string& name, const std::vector<Vec3>& points) {
  const double side = longest_side(points);
  for (const double unit : {1.0, 10.0, 1000.0, 0.001})
    if (side * unit >= smallest_heart_mm && side * unit <= largest_heart_mm) return unit;
  throw UserError(fmt::format("the atlas is {:.4g} units long, which is no heart's size in mm, cm, m or um", side),
                  name, "scale its points to mm");
}

void check_mesh(const std::string& name, const std::vector<Vec3>& points, const std::vector<Cell>& cells,
                const std::vector<Vec3>& vectors) {
  if (points.empty() || cells.empty()) throw UserError("the atlas has no tetrahedra", name, expected);
  if (vectors.size() != points.size() && vectors.size() != cells.size())
    throw UserError(
        fmt::format("the atlas has {} vectors for {} points and {} cells", vectors.size(), points.size(), cells.size()),
        name, expected);
  for (const Vec3& p : points)
    if (!finite(p)) throw UserError("the atlas has a point that is not finite", name, "repair the file");
  for (const Vec3& v : vectors)
    if (!finite(v)) throw UserError("the atlas has a fibre vector that is not finite", name, "repair the file");
  for (const Cell& cell : cells)
    for (const auto node : cell)
      if (node < 0 || static_cast<std::size_t>(node) >= points.size())
        throw UserError(fmt::format("a cell of the atlas names point {}, which does not exist", node), name,
                        "repair the file");
}

void orient(std::vector<Cell>& cells, const std::vector<Vec3>& points) {
  const auto at = [&](std::int32_t n) { return points[static_cast<std::size_t>(n)]; };
  for (Cell& c : cells)
    if (dot(at(c[1]) - at(c[0]), cross(at(c[2]) - at(c[0]), at(c[3]) - at(c[0]))) < 0) std::swap(c[2], c[3]);
}

std::vector<Vec3> point_axes(std::size_t points, const std::vector<Cell>& cells, const std::vector<Vec3>& vectors) {
  std::vector<Vec3> axes(points);
  if (vectors.size() == points) {
    std::transform(vectors.begin(), vectors.end(), axes.begin(), [](const Vec3& v) { return normalized(v); });
    return axes;
  }
  std::vector<AxisTensor> sum(points);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const auto node : cells[c]) sum[static_cast<std::size_t>(node)] += axis_tensor(normalized(vectors[c]));
  for (std::size_t p = 0; p < points; ++p)
    if (trace(sum[p]) > 0) axes[p] = leading_axis(sum[p]);
  return axes;
}

template <class T>
const std::vector<T>* preferred(const std::map<std::string, std::vector<T>>& arrays) {
  const std::vector<T>* first = nullptr;
  for (const auto& [name, array] : arrays) {
    if (array.empty()) continue;
    std::string start = name.substr(0, 3);
    std::transform(start.begin(), start.end(), start.begin(),
                   [](unsigned char c) { return static_cast<char>(c | 32); });
    if (start == "fib") return &array;
    if (!first) first = &array;
  }
  return first;
}

std::vector<Vec3> leading_axes(const std::vector<Mat3>& tensors) {
  std::vector<Vec3> axes;
  axes.reserve(tensors.size());
  for (const Mat3& t : tensors) axes.push_back(leading_axis({{t[0].x, t[1].y, t[2].z, t[0].y, t[0].z, t[1].z}}));
  return axes;
}

std::vector<Vec3> fibers_of(const adapters::UnstructuredData& data, const std::string& path) {
  if (const auto* vectors = preferred(data.point_vectors)) return *vectors;
  if (const auto* vectors = preferred(data.cell_vectors)) return *vectors;
  if (const auto* tensors = preferred(data.point_tensors)) return leading_axes(*tensors);
  if (const auto* tensors = preferred(data.cell_tensors)) return leading_axes(*tensors);
  throw UserError("the atlas has no array of vectors or tensors", path, expected);
}

}  // namespace

FiberAtlas make_fiber_atlas(std::string name, std::vector<Vec3> points, std::vector<Cell> cells,
                            const std::vector<Vec3>& vectors) {
  check_mesh(name, points, cells, vectors);
  FiberAtlas atlas;
  atlas.unit_in_mm = unit_in_mm(name, points);
  for (Vec3& p : points) p *= atlas.unit_in_mm;
  orient(cells, points);
  atlas.fiber = point_axes(points.size(), cells, vectors);
  if (std::all_of(atlas.fiber.begin(), atlas.fiber.end(), [](const Vec3& f) { return norm(f) == 0; }))
    throw UserError("all vectors of the atlas are zero", name, expected);
  atlas.points_mm = std::move(points);
  atlas.cells = std::move(cells);
  atlas.name = std::move(name);
  return atlas;
}

FiberAtlas read_fiber_atlas(const std::string& path) {
  if (is_exnode_path(path)) return read_exnode_atlas(path);
  if (is_image_path(path)) return read_voxel_atlas(path);
  auto data = adapters::read_unstructured(path);
  const auto fibers = fibers_of(data, path);
  auto atlas = make_fiber_atlas(path, std::move(data.points), std::move(data.tets), fibers);
  atlas.name = std::filesystem::path(path).filename().string();
  return atlas;
}

}  // namespace heart::atlas
