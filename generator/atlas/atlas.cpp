// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/atlas/atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "generator/adapters/vtk_io.hpp"
#include "generator/atlas/exnode.hpp"
#include "generator/atlas/point_axes.hpp"
#include "generator/atlas/voxel_atlas.hpp"
#include "generator/mesh_files/msh_file.hpp"
#include "model/axis_tensor.hpp"
#include "model/bounding_box.hpp"
#include "model/error.hpp"
#include "model/fiber_names.hpp"
#include "model/priors.hpp"

namespace heartgen::atlas {
namespace {

constexpr const char* expected = "a fibre atlas is a mesh of tetrahedra with one vector per point or per cell";

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// The longest side of the box decides.
double unit_in_mm(const std::string& name, const std::vector<Vec3>& points) {
  const double side = longest_side(points);
  for (const double unit : {1.0, 10.0, 1000.0, 0.001})
    if (side * unit >= priors::heart_min_mm && side * unit <= priors::heart_max_mm) return unit;
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

std::vector<Vec3> unit_axes(const std::vector<Vec3>& vectors) {
  std::vector<Vec3> axes(vectors.size());
  std::transform(vectors.begin(), vectors.end(), axes.begin(), [](const Vec3& v) { return normalized(v); });
  return axes;
}

std::vector<Vec3> leading_axes(const std::vector<Mat3>& tensors) {
  std::vector<Vec3> axes;
  axes.reserve(tensors.size());
  for (const Mat3& t : tensors) axes.push_back(leading_axis({{t[0].x, t[1].y, t[2].z, t[0].y, t[0].z, t[1].z}}));
  return axes;
}

/// An array that may be the fibres.
struct Candidate {
  std::string name;
  bool is_on_points;
  const std::vector<Vec3>* vectors;  ///< or else tensors
  const std::vector<Mat3>* tensors;

  std::string text() const { return fmt::format("{} array \"{}\"", is_on_points ? "point" : "cell", name); }
};

/// Points before cells, vectors before tensors, each by name.
std::vector<Candidate> candidates_in(const UnstructuredData& data) {
  std::vector<Candidate> all;
  for (const auto& [name, values] : data.point_vectors) all.push_back({name, true, &values, nullptr});
  for (const auto& [name, values] : data.cell_vectors) all.push_back({name, false, &values, nullptr});
  for (const auto& [name, values] : data.point_tensors) all.push_back({name, true, nullptr, &values});
  for (const auto& [name, values] : data.cell_tensors) all.push_back({name, false, nullptr, &values});
  return all;
}

bool is_something_else(const std::string& name) {
  std::string lower = name;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto axis = axis_name(name);
  return axis == AxisName::sheet || axis == AxisName::sheet_normal || lower.starts_with("normal");
}

Candidate chosen_array(const UnstructuredData& data, const std::string& wanted, const std::string& path) {
  const auto all = candidates_in(data);
  if (all.empty()) throw UserError("the atlas has no array of vectors or tensors", path, expected);
  std::vector<std::string> texts;
  for (const auto& candidate : all) texts.push_back(candidate.text());
  const auto list = fmt::format("its vectors and tensors: {}", fmt::join(texts, ", "));
  const auto is_it = [&](const Candidate& candidate) {
    return wanted.empty() ? axis_name(candidate.name) == AxisName::fiber : candidate.name == wanted;
  };
  const auto found = std::find_if(all.begin(), all.end(), is_it);
  if (found != all.end()) return *found;
  if (!wanted.empty()) throw UserError(fmt::format("has no array \"{}\" of vectors or tensors", wanted), path, list);
  if (all.size() == 1 && !is_something_else(all.front().name)) return all.front();
  throw UserError("the atlas has no array with a known name of fibres", path,
                  list + "; name one: --atlas-array NAME, or input.atlas_array in the recipe");
}

}  // namespace

FiberAtlas make_fiber_atlas(std::string name, std::vector<Vec3> points, std::vector<Cell> cells,
                            const std::vector<Vec3>& vectors) {
  check_mesh(name, points, cells, vectors);
  FiberAtlas atlas;
  atlas.unit_in_mm = unit_in_mm(name, points);
  for (Vec3& p : points) p *= atlas.unit_in_mm;
  orient(cells, points);
  atlas.fiber = vectors.size() == points.size() ? unit_axes(vectors) : point_axes(points, cells, vectors);
  if (std::all_of(atlas.fiber.begin(), atlas.fiber.end(), [](const Vec3& f) { return norm(f) == 0; }))
    throw UserError("all vectors of the atlas are zero", name, expected);
  atlas.points_mm = std::move(points);
  atlas.cells = std::move(cells);
  atlas.name = std::move(name);
  return atlas;
}

FiberAtlas read_fiber_atlas(const std::string& path, const std::string& array) {
  if (!array.empty() && (is_exnode_path(path) || is_image_path(path)))
    throw UserError("has no arrays to choose from", path, "leave out --atlas-array and input.atlas_array");
  if (is_exnode_path(path)) return read_exnode_atlas(path);
  if (is_image_path(path)) return read_voxel_atlas(path);
  auto data = path.ends_with(".msh") ? mesh_files::read_msh(path) : adapters::read_unstructured(path);
  const auto chosen = chosen_array(data, array, path);
  const auto fibers = chosen.vectors ? *chosen.vectors : leading_axes(*chosen.tensors);
  auto atlas = make_fiber_atlas(path, std::move(data.points), std::move(data.tets), fibers);
  atlas.name = std::filesystem::path(path).filename().string();
  atlas.array = chosen.text();
  return atlas;
}

}  // namespace heartgen::atlas
