// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/transfer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "generator/fibers/frame.hpp"
#include "generator/parallel/threads.hpp"
#include "model/bounding_box.hpp"
#include "model/error.hpp"
#include "model/mesh_queries/face_tree.hpp"

namespace heartgen::fibers {
namespace {

struct Place {
  std::int32_t cell = -1;
  std::array<double, 4> weights{};  ///< of its corners, none negative, together 1
  double distance_mm = 0;           ///< 0 inside the mesh
};

std::array<Vec3, 4> corners_of(const TetMesh& mesh, const Cell& cell) {
  std::array<Vec3, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = mesh.nodes_mm[static_cast<std::size_t>(cell[i])];
  return corners;
}

/// A triangle with the same box as the cell: the tree looks at boxes only.
mesh_queries::Triangle box_of(const std::array<Vec3, 4>& corners) {
  Vec3 low = corners[0], high = corners[0];
  for (const auto& p : corners)
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  return {low, high, low};
}

struct OwnedFace {
  Face face;  ///< ascending
  std::int32_t cell = 0;
  friend bool operator<(const OwnedFace& a, const OwnedFace& b) {
    return std::pair(a.face, a.cell) < std::pair(b.face, b.cell);
  }
};

/// Faces that one cell alone has.
std::vector<OwnedFace> boundary(const TetMesh& mesh) {
  std::vector<OwnedFace> all;
  all.reserve(4 * mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      OwnedFace owned{{}, static_cast<std::int32_t>(c)};
      for (std::size_t i = 0; i < 3; ++i) owned.face[i] = mesh.cells[c][(left_out + 1 + i) % 4];
      std::sort(owned.face.begin(), owned.face.end());
      all.push_back(owned);
    }
  std::sort(all.begin(), all.end());
  std::vector<OwnedFace> outer;
  for (std::size_t f = 0; f < all.size(); ++f) {
    const bool before = f > 0 && all[f - 1].face == all[f].face;
    const bool after = f + 1 < all.size() && all[f + 1].face == all[f].face;
    if (!before && !after) outer.push_back(all[f]);
  }
  return outer;
}

/// A mesh in which places are looked up.
struct Lookup {
  const TetMesh* mesh;
  mesh_queries::FaceTree cells;    ///< boxes around cells, numbered like them
  mesh_queries::FaceTree surface;  ///< numbered like `outer`
  std::vector<OwnedFace> outer;

  explicit Lookup(const TetMesh& from) : mesh(&from), outer(boundary(from)) {
    std::vector<mesh_queries::Triangle> boxes;
    boxes.reserve(from.cells.size());
    for (const auto& cell : from.cells) boxes.push_back(box_of(corners_of(from, cell)));
    cells = mesh_queries::make_face_tree(std::move(boxes));
    std::vector<Face> faces;
    faces.reserve(outer.size());
    for (const auto& owned : outer) faces.push_back(owned.face);
    surface = mesh_queries::make_face_tree(from.nodes_mm, faces);
  }

  std::array<double, 4> weights(std::int32_t cell, const Vec3& point) const {
    const auto at = corners_of(*mesh, mesh->cells[static_cast<std::size_t>(cell)]);
    const Vec3 a = at[1] - at[0], b = at[2] - at[0], d = at[3] - at[0], p = point - at[0];
    const double volume = dot(a, cross(b, d));
    if (volume == 0) return {-1, 0, 0, 0};  // holds nothing
    const double u = dot(p, cross(b, d)) / volume, v = dot(a, cross(p, d)) / volume, w = dot(a, cross(b, p)) / volume;
    return {1 - u - v - w, u, v, w};
  }

  Place place(std::int32_t cell, const Vec3& point, double distance_mm) const {
    Place place{cell, weights(cell, point), distance_mm};
    double sum = 0;
    for (auto& w : place.weights) sum += w = std::max(w, 0.0);
    if (!(sum > 0)) place.weights = {1, 1, 1, 1}, sum = 4;
    for (auto& w : place.weights) w /= sum;
    return place;
  }

  /// `near` is scratch.
  Place find(const Vec3& point, std::vector<std::int32_t>& near) const {
    constexpr double rounding = 1e-10;
    near.clear();
    mesh_queries::faces_in_box(cells, point, point, near);
    std::int32_t best = -1;
    double depth = -rounding;
    for (const auto cell : near) {
      const auto w = weights(cell, point);
      const double least = *std::min_element(w.begin(), w.end());
      if (least > depth) best = cell, depth = least;
    }
    if (best >= 0) return place(best, point, 0);
    const auto found = mesh_queries::nearest_face(surface, point, std::numeric_limits<double>::max());
    return place(outer[static_cast<std::size_t>(found.face)].cell, found.point_mm, found.distance_mm);
  }
};

MaterialAxes axes_at(const TetMesh& from, const Place& place) {
  AxisTensor fiber, sheet;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto n = static_cast<std::size_t>(from.cells[static_cast<std::size_t>(place.cell)][i]);
    fiber += place.weights[i] * axis_tensor(from.node_fibers.fiber[n]);
    sheet += place.weights[i] * axis_tensor(from.node_fibers.sheet[n]);
  }
  const Vec3 along = leading_axis(fiber);
  return along == Vec3{} ? MaterialAxes{} : material_axes(along, leading_axis(sheet));
}

std::uint8_t source_at(const TetMesh& from, const Place& place) {
  const auto largest = std::max_element(place.weights.begin(), place.weights.end()) - place.weights.begin();
  const auto& cell = from.cells[static_cast<std::size_t>(place.cell)];
  return from.fiber_source[static_cast<std::size_t>(cell[static_cast<std::size_t>(largest)])];
}

bool is_middle(const Place& place) {
  constexpr double rounding = 1e-9;
  return place.distance_mm == 0 && std::all_of(place.weights.begin(), place.weights.end(),
                                               [](double w) { return std::abs(w - 0.25) < rounding; });
}

/// At the middle of a cell that has axes of its own these are known better than the corners tell.
MaterialAxes cell_axes_at(const TetMesh& from, const Place& place) {
  const auto c = static_cast<std::size_t>(place.cell);
  const auto& own = from.cell_fibers;
  const bool is_known = c < own.fiber.size() && c < own.sheet.size() && own.fiber[c] != Vec3{};
  return is_known && is_middle(place) ? material_axes(own.fiber[c], own.sheet[c]) : axes_at(from, place);
}

/// Frames and places of points given by number.
template <class PointAt, class AxesAt>
std::vector<Place> fill(const Lookup& lookup, std::size_t count, const PointAt& point_at, const AxesAt& axes_of,
                        double reach_mm, FiberField& field) {
  field.fiber.resize(count);
  field.sheet.resize(count);
  field.sheet_normal.resize(count);
  std::vector<Place> places(count);
  parallel::parallel_for(0, static_cast<std::int64_t>(count), [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::int32_t> near;
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      places[n] = lookup.find(point_at(n), near);
      if (places[n].distance_mm > reach_mm) continue;
      const MaterialAxes axes = axes_of(*lookup.mesh, places[n]);
      field.fiber[n] = axes.fiber;
      field.sheet[n] = axes.sheet;
      field.sheet_normal[n] = axes.sheet_normal;
    }
  });
  return places;
}

void check(const TetMesh& from) {
  const auto count = from.nodes_mm.size();
  if (from.cells.empty() || from.node_fibers.fiber.size() != count || from.node_fibers.sheet.size() != count)
    throw UserError("has no fibres and sheets on its nodes", "the mesh that fibres are taken from",
                    "give a myocardium mesh with the arrays \"fiber\" and \"sheet\"");
}

}  // namespace

TransferredFibers transfer_fibers(const TetMesh& from, const std::vector<Vec3>& nodes_mm,
                                  const std::vector<Cell>& cells, double reach_mm) {
  check(from);
  const Lookup lookup(from);
  TransferredFibers result;
  const auto places = fill(
      lookup, nodes_mm.size(), [&](std::size_t n) { return nodes_mm[n]; }, axes_at, reach_mm, result.node);
  const bool with_source = from.fiber_source.size() == from.nodes_mm.size();
  if (with_source) result.source.resize(nodes_mm.size());
  for (std::size_t n = 0; n < places.size(); ++n) {
    result.farthest_mm = std::max(result.farthest_mm, places[n].distance_mm);
    const bool beyond = places[n].distance_mm > reach_mm;
    result.beyond_nodes += beyond;
    if (with_source && !beyond) result.source[n] = source_at(from, places[n]);
  }
  const auto middle = [&](std::size_t c) {
    Vec3 sum;
    for (const auto n : cells[c]) sum += 0.25 * nodes_mm[static_cast<std::size_t>(n)];
    return sum;
  };
  fill(lookup, cells.size(), middle, cell_axes_at, reach_mm, result.cell);
  return result;
}

std::optional<double> scale_onto(const TetMesh& from, const std::vector<Vec3>& points, double reach_mm) {
  constexpr double clearly = 3, smallest_piece = 0.1, largest = 1.5, max_search_mm = 5, nearly_all = 0.95;
  constexpr std::size_t max_points = 1000;
  if (points.empty() || from.cells.empty()) return {};
  const double ratio = longest_side(points) / longest_side(from.nodes_mm);
  const auto may_be = [&](double factor) {  // larger than the heart only where that is the whole difference
    return ratio * factor < largest && ratio * factor > (factor > 1 ? smallest_piece : 1 / largest) &&
           (factor > 1 ? ratio < 1 / clearly : ratio > clearly);
  };
  std::optional<Lookup> lookup;
  for (const double factor : {10.0, 1000.0, 0.1, 0.001}) {
    if (!may_be(factor)) continue;
    if (!lookup) lookup.emplace(from);
    std::vector<std::int32_t> near;
    std::size_t looked_at = 0, on_it = 0;
    for (std::size_t n = 0; n < points.size(); n += points.size() / max_points + 1, ++looked_at)
      on_it += lookup->find(factor * points[n], near).distance_mm <= std::min(reach_mm, max_search_mm);
    if (static_cast<double>(on_it) >= nearly_all * static_cast<double>(looked_at)) return factor;
  }
  return {};
}

}  // namespace heartgen::fibers
