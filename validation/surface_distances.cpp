// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/surface_distances.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "generator/parallel/threads.hpp"
#include "model/mesh_queries/face_tree.hpp"
#include "validation/quantiles.hpp"

namespace heartgen::validation {
namespace {

constexpr std::size_t max_samples = 60'000;
constexpr double reach_edges = 3;    // farther is "not there"
constexpr double far_edges = 0.5;    // from there on it is asked why
constexpr double march_edges = 0.1;  // thinner layers may be stepped over
constexpr double crumb_edges = 0.1;  // what is nearer to a surface than that is on it, be there a crumb or not
constexpr int halvings = 10;

/// A face between two regions or at the end of the mesh.
struct BoundaryFace {
  Face nodes;
  std::array<std::int32_t, 2> region;  // 0: the end of the mesh
  double edge_mm;
  Vec3 normal;
  bool bounds(std::int32_t tag) const { return region[0] == tag || region[1] == tag; }
};

std::vector<BoundaryFace> boundary_of_regions(const TetMesh& mesh, const std::vector<MeshFace>& faces) {
  std::vector<BoundaryFace> result;
  const auto region = [&](std::int32_t cell) { return cell < 0 ? 0 : mesh.region[static_cast<std::size_t>(cell)]; };
  for (const auto& face : faces) {
    const std::array sides{region(face.cell), region(face.other)};
    if (sides[0] == sides[1]) continue;
    const auto at = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(face.nodes[i])]; };
    const Vec3 a = at(1) - at(0), b = at(2) - at(0);
    result.push_back({face.nodes, sides, (norm(a) + norm(b) + norm(b - a)) / 3, normalized(cross(a, b))});
  }
  return result;
}

/// How far from `start` towards `way` the region changes; `limit_mm` where it does not.
double distance_to_change(const LabelAt& label_at, std::int32_t region, bool inside, const Vec3& start, const Vec3& way,
                          double step_mm, double limit_mm) {
  const auto differs = [&](double t) { return (label_at(start + t * way) == region) != inside; };
  double low = 0, high = step_mm;
  while (!differs(high)) {
    low = high;
    high += step_mm;
    if (high > limit_mm) return limit_mm;
  }
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (differs(middle) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

/// `count` places of [0, total), evenly.
std::vector<std::size_t> evenly(std::size_t total) {
  std::vector<std::size_t> places;
  const std::size_t count = std::min(total, max_samples);
  for (std::size_t i = 0; i < count; ++i) places.push_back(i * total / count);
  return places;
}

/// Directions from the middle of a cube to places all over its surface, at most 24 degrees from any other.
std::vector<Vec3> many_ways() {
  constexpr int half = 2, width = 2 * half + 1;
  std::vector<Vec3> ways;
  for (int i = 0; i < width * width * width; ++i) {
    const std::array at{i % width - half, i / width % width - half, i / (width * width) - half};
    if (std::max({std::abs(at[0]), std::abs(at[1]), std::abs(at[2])}) == half)
      ways.push_back(normalized({static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])}));
  }
  return ways;
}

/// The normal first. It is the way to the surface where that is flat: at rims, and where three regions meet, a place on
/// the surface itself can be far from it along the normals of its faces. So what is not near that way is looked at all
/// around, in the steps of `search`: regions that meet sharply are thin there.
double distance_to_boundary(const LabelAt& label_at, std::int32_t region, const Vec3& start, const Vec3& normal,
                            double edge_mm, const SurfaceSearch& search) {
  static const auto ways = many_ways();
  const bool inside = label_at(start) == region;
  double nearest = reach_edges * edge_mm;
  const auto look = [&](const Vec3& way, double step_edges) {
    const double found = distance_to_change(label_at, region, inside, start, way, step_edges * edge_mm, nearest);
    nearest = std::min(nearest, found);
  };
  look(normal, march_edges);
  look(-normal, march_edges);
  if (nearest > search.enough_edges * edge_mm)
    for (const auto& way : ways) look(way, search.step_edges);
  return nearest;
}

/// Neighbouring voxels with different labels: the first one's offset and the axis along which the other follows.
struct VoxelPair {
  Index3 at;
  int axis;
};

std::vector<VoxelPair> changing_pairs(const Grid& grid, const std::vector<std::uint8_t>& label) {
  std::vector<VoxelPair> pairs;
  const std::array<std::int64_t, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Index3 at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a)
          if (at[a] + 1 < grid.size[a] && label[v] != label[v + static_cast<std::size_t>(stride[a])])
            pairs.push_back({at, static_cast<int>(a)});
      }
  return pairs;
}

/// 1 for the voxels of pieces of a label, joined through faces, smaller than `crumb_ml[label]`.
std::vector<std::uint8_t> crumbs_of(const Grid& grid, const std::vector<std::uint8_t>& label,
                                    const std::array<double, 256>& crumb_ml) {
  const auto& size = grid.size;
  std::vector<std::uint8_t> seen(label.size(), 0), crumb(label.size(), 0);
  std::vector<std::size_t> piece;
  for (std::size_t first = 0; first < label.size(); ++first) {
    if (seen[first]) continue;
    seen[first] = 1;
    piece.assign(1, first);
    for (std::size_t p = 0; p < piece.size(); ++p) {
      const auto v = static_cast<std::int64_t>(piece[p]);
      const Index3 at{v % size[0], v / size[0] % size[1], v / (size[0] * size[1])};
      std::int64_t stride = 1;
      for (std::size_t a = 0; a < 3; stride *= size[a], ++a)
        for (const std::int64_t way : {-1, 1}) {
          if (at[a] + way < 0 || at[a] + way >= size[a]) continue;
          const auto next = static_cast<std::size_t>(v + way * stride);
          if (seen[next] || label[next] != label[first]) continue;
          seen[next] = 1;
          piece.push_back(next);
        }
    }
    if (static_cast<double>(piece.size()) * grid.voxel_volume_mm3() / 1000 < crumb_ml[label[first]])
      for (const auto v : piece) crumb[v] = 1;
  }
  return crumb;
}

/// Voxels of pieces of the label map that the mesher may drop.
struct Crumbs {
  Grid grid;
  std::vector<std::uint8_t> is_crumb;
  bool contains(const Index3& at) const {
    return grid.contains(at[0], at[1], at[2]) &&
           is_crumb[static_cast<std::size_t>(grid.offset(at[0], at[1], at[2]))] != 0;
  }
  /// Whether one of the voxels around a place is one of them.
  bool are_at(const Vec3& lps_mm) const {
    const Vec3 index = index_from_lps(grid, lps_mm);
    const auto low = [&](int axis) { return static_cast<std::int64_t>(std::floor(index[axis])); };
    for (std::int64_t corner = 0; corner < 8; ++corner)
      if (contains({low(0) + (corner & 1), low(1) + (corner >> 1 & 1), low(2) + (corner >> 2)})) return true;
    return false;
  }
};

/// From the middle and one corner of each face: the corners of all faces together are all nodes.
std::vector<SurfaceSample> distances_to_labels(const TetMesh& mesh, const std::vector<BoundaryFace>& faces,
                                               const LabelAt& label_at, const Crumbs& crumbs,
                                               const SurfaceSearch& search) {
  const auto places = evenly(2 * faces.size());
  std::vector<SurfaceSample> samples(places.size(), {{0, 0}, 0, 1});
  parallel::parallel_for(0, static_cast<std::int64_t>(places.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      const auto& face = faces[places[s] / 2];
      const auto at = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(face.nodes[i])]; };
      const Vec3 start = places[s] % 2 == 0 ? (at(0) + at(1) + at(2)) / 3 : at(places[s] / 2 % 3);
      const double distance = distance_to_boundary(label_at, face.region[0], start, face.normal, face.edge_mm, search);
      if (distance > crumb_edges * face.edge_mm && crumbs.are_at(start)) continue;
      samples[s] = {face.region, distance, face.edge_mm};
    }
  });
  return samples;
}

/// Whether the region around a place is thinner than an edge along one of the axes.
bool is_thin(const LabelAt& label_at, const Vec3& place, double edge_mm) {
  const int own = label_at(place);
  const auto depth = [&](const Vec3& way) {
    return distance_to_change(label_at, own, true, place, way, march_edges * edge_mm, edge_mm);
  };
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 way;
    way[axis] = 1;
    if (depth(way) + depth(-way) < edge_mm) return true;
  }
  return false;
}

/// Neither side of a sample is a crumb, nor, where the mesh is far from it, thinner than an edge: the mesher may drop
/// these.
std::vector<SurfaceSample> distances_from_labels(const Grid& grid, const std::vector<BoundaryFace>& faces,
                                                 const mesh_queries::FaceTree& tree,
                                                 const std::set<std::int32_t>& regions, const LabelAt& label_at,
                                                 const std::vector<std::uint8_t>& label, const Crumbs& crumbs) {
  auto pairs = changing_pairs(grid, label);
  std::erase_if(pairs, [&](const VoxelPair& pair) {
    Index3 beyond = pair.at;
    ++beyond[static_cast<std::size_t>(pair.axis)];
    return crumbs.contains(pair.at) || crumbs.contains(beyond);
  });
  const auto places = evenly(pairs.size());
  std::vector<SurfaceSample> samples(places.size(), {{0, 0}, 0, 1});
  parallel::parallel_for(0, static_cast<std::int64_t>(places.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      const auto [at, axis] = pairs[places[s]];
      const Vec3 index{static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
      Vec3 step;
      step[axis] = 1;
      const Vec3 start = lps_from_index(grid, index), way = lps_from_index(grid, index + step) - start;
      const int own = label_at(start), beyond = label_at(start + way);
      const int region = regions.contains(own) ? own : beyond;
      if (!regions.contains(region)) continue;
      const double length = norm(way);
      const double t = distance_to_change(label_at, region, region == own, start, way / length, length, 2 * length);
      const Vec3 point = start + (t / length) * way;
      constexpr double anywhere_mm = 1e9;
      const auto nearest = mesh_queries::nearest_face(
          tree, point, anywhere_mm, [&](std::int32_t f) { return faces[static_cast<std::size_t>(f)].bounds(region); });
      if (nearest.face < 0) continue;
      const double edge = faces[static_cast<std::size_t>(nearest.face)].edge_mm;
      if (nearest.distance_mm > far_edges * edge &&
          (is_thin(label_at, start, edge) || is_thin(label_at, start + way, edge)))
        continue;
      samples[s] = {{region, region == own ? beyond : own}, nearest.distance_mm, edge};
    }
  });
  return samples;
}

}  // namespace

SurfaceDistances surface_distances(const TetMesh& mesh, const std::vector<MeshFace>& faces, const LabelVolume& labels,
                                   const LabelAt& label_at, const std::array<double, 256>& crumb_ml,
                                   const SurfaceSearch& search) {
  const auto boundary = boundary_of_regions(mesh, faces);
  const std::set<std::int32_t> regions(mesh.region.begin(), mesh.region.end());
  std::vector<Face> triangles;
  triangles.reserve(boundary.size());
  for (const auto& face : boundary) triangles.push_back(face.nodes);
  const auto tree = mesh_queries::make_face_tree(mesh.nodes_mm, triangles);
  const Crumbs crumbs{labels.grid, crumbs_of(labels.grid, labels.voxels, crumb_ml)};
  return {distances_to_labels(mesh, boundary, label_at, crumbs, search),
          distances_from_labels(labels.grid, boundary, tree, regions, label_at, labels.voxels, crumbs)};
}

void add_distance_rows(const std::string& scope, const std::string& name, const std::vector<SurfaceSample>& samples,
                       std::int32_t region, Report& report) {
  std::vector<double> mm, edges;
  for (const auto& s : samples) {
    const bool counts = region == 0 ? s.region[0] != s.region[1] : s.region[0] == region || s.region[1] == region;
    if (!counts) continue;
    mm.push_back(s.distance_mm);
    edges.push_back(s.distance_mm / s.edge_mm);
  }
  if (mm.empty()) return;
  const auto add = [&](const char* suffix, const std::vector<double>& values, double q, const char* unit) {
    report.push_back({"mesh", scope, name + suffix, quantile(values, q), unit, {}, {}});
  };
  add("_p50", mm, 0.5, "mm");
  add("_p99", mm, 0.99, "mm");
  add("_max", mm, 1, "mm");
  add("_p99_in_edges", edges, 0.99, "edges");
  add("_max_in_edges", edges, 1, "edges");
}

}  // namespace heartgen::validation
