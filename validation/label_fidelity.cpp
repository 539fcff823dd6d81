#include "validation/label_fidelity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "generator/parallel/threads.hpp"
#include "model/face_tree.hpp"
#include "model/labels.hpp"
#include "validation/mesh_topology.hpp"
#include "validation/quantiles.hpp"
#include "validation/region_topology.hpp"

namespace heart::validation {
namespace {

constexpr double mm3_per_ml = 1000;
constexpr std::size_t most_samples = 200'000;
constexpr double reach_edges = 3;    // farther is "not there"
constexpr double far_edges = 0.5;    // from there on it is asked why
constexpr double march_edges = 0.1;  // thinner layers may be stepped over
constexpr double crumb_edges = 0.1;  // what is nearer to a surface than that is on it, be there a crumb or not
constexpr int halvings = 10;
constexpr double crumb_cells = 100;  // pieces of less than so many mean cells of their region are crumbs
constexpr double surely_kept = 2;    // crumbs

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

struct Sample {
  std::array<std::int32_t, 2> region;
  double distance_mm = 0, edge_mm = 1;
};

/// `count` places of [0, total), evenly.
std::vector<std::size_t> evenly(std::size_t total) {
  std::vector<std::size_t> places;
  const std::size_t count = std::min(total, most_samples);
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
/// around, in smaller steps: regions that meet sharply are thin there.
double distance_to_boundary(const LabelAt& label_at, std::int32_t region, const Vec3& start, const Vec3& normal,
                            double edge_mm) {
  constexpr double enough_edges = 0.05;
  static const auto ways = many_ways();
  const bool inside = label_at(start) == region;
  double nearest = reach_edges * edge_mm;
  const auto look = [&](const Vec3& way, double step_edges) {
    const double found = distance_to_change(label_at, region, inside, start, way, step_edges * edge_mm, nearest);
    nearest = std::min(nearest, found);
  };
  look(normal, march_edges);
  look(-normal, march_edges);
  if (nearest > enough_edges * edge_mm)
    for (const auto& way : ways) look(way, march_edges / 4);
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

std::vector<std::uint8_t> labels_at_voxels(const Grid& grid, const LabelAt& label_at) {
  std::vector<std::uint8_t> label(static_cast<std::size_t>(grid.voxel_count()));
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i)
          label[static_cast<std::size_t>(grid.offset(i, j, k))] = static_cast<std::uint8_t>(
              label_at(lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})));
  });
  return label;
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
    if (static_cast<double>(piece.size()) * grid.voxel_volume_mm3() / mm3_per_ml < crumb_ml[label[first]])
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
std::vector<Sample> distances_to_labels(const TetMesh& mesh, const std::vector<BoundaryFace>& faces,
                                        const LabelAt& label_at, const Crumbs& crumbs) {
  const auto places = evenly(2 * faces.size());
  std::vector<Sample> samples(places.size(), {{0, 0}, 0, 1});
  parallel::parallel_for(0, static_cast<std::int64_t>(places.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      const auto& face = faces[places[s] / 2];
      const auto at = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(face.nodes[i])]; };
      const Vec3 start = places[s] % 2 == 0 ? (at(0) + at(1) + at(2)) / 3 : at(places[s] / 2 % 3);
      const double distance = distance_to_boundary(label_at, face.region[0], start, face.normal, face.edge_mm);
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
std::vector<Sample> distances_from_labels(const Grid& grid, const std::vector<BoundaryFace>& faces,
                                          const FaceTree& tree, const std::set<std::int32_t>& regions,
                                          const LabelAt& label_at, const std::vector<std::uint8_t>& label,
                                          const Crumbs& crumbs) {
  auto pairs = changing_pairs(grid, label);
  std::erase_if(pairs, [&](const VoxelPair& pair) {
    Index3 beyond = pair.at;
    ++beyond[static_cast<std::size_t>(pair.axis)];
    return crumbs.contains(pair.at) || crumbs.contains(beyond);
  });
  const auto places = evenly(pairs.size());
  std::vector<Sample> samples(places.size(), {{0, 0}, 0, 1});
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
      const auto nearest = nearest_face(
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

struct Rows {
  Report* report;
  std::string scope;
  void add(const std::string& metric, double value, const char* unit, std::optional<double> at_least = {},
           std::optional<double> at_most = {}) const {
    report->push_back({"mesh", scope, metric, value, unit, at_least, at_most});
  }
};

/// Samples on one region's boundary (0: all).
void add_distances(const Rows& rows, const std::string& name, const std::vector<Sample>& samples, std::int32_t region,
                   std::optional<double> most_edges) {
  std::vector<double> mm, edges;
  for (const auto& s : samples) {
    const bool counts = region == 0 ? s.region[0] != s.region[1] : s.region[0] == region || s.region[1] == region;
    if (!counts) continue;
    mm.push_back(s.distance_mm);
    edges.push_back(s.distance_mm / s.edge_mm);
  }
  if (mm.empty()) return;
  rows.add(name + "_p50", quantile(mm, 0.5), "mm");
  rows.add(name + "_p99", quantile(mm, 0.99), "mm");
  rows.add(name + "_max", quantile(mm, 1), "mm");
  rows.add(name + "_p99_in_edges", quantile(edges, 0.99), "edges", {}, most_edges);
  rows.add(name + "_max_in_edges", quantile(edges, 1), "edges");
}

std::int64_t larger_than(const std::vector<double>& sizes, double least) {
  return std::count_if(sizes.begin(), sizes.end(), [&](double s) { return s > least; });
}

/// Crumbs do not count: the mesher may drop them, and cut them off thin strands. Pieces that touch at edges or corners
/// of voxels (`separate_ml`: those that do not) may be one in the mesh. Around the heart the mesh may be too coarse for
/// what the label map shows: nothing is judged there (no bounds).
void add_topology(const Rows& rows, const RegionTopology& mesh, const RegionTopology& labels,
                  const std::vector<double>& separate_ml, double crumb_ml, const ValidationSettings* bounds) {
  double volume = 0, label_volume = 0;
  for (const double v : mesh.components_ml) volume += v;
  for (const double v : labels.components_ml) label_volume += v;
  rows.add("volume_of_labels", label_volume, "ml");
  if (label_volume > 0) rows.add("volume_difference", 100 * (volume / label_volume - 1), "%");
  double crumbs = 0;
  for (const double v : labels.components_ml) crumbs += v < crumb_ml ? v : 0;
  rows.add("crumbs_of_labels", crumbs, "ml");
  const auto count = [&](const char* metric, std::int64_t value) {
    rows.add(metric, static_cast<double>(value), "count");
  };
  const auto at_most = [&](const char* metric, std::int64_t value, int bound) {
    rows.add(metric, static_cast<double>(std::max<std::int64_t>(value, 0)), "count", {},
             bounds != nullptr ? std::optional<double>(bound) : std::nullopt);
  };
  const auto all = [](const RegionTopology& t) { return static_cast<std::int64_t>(t.components_ml.size()); };
  const auto pieces = larger_than(mesh.components_ml, crumb_ml);
  const auto label_pieces = larger_than(labels.components_ml, crumb_ml);
  count("pieces", pieces);
  count("pieces_of_labels", label_pieces);
  at_most("pieces_added", pieces - all(labels), 0);
  // A region without any cell is lost, however small it was.
  const auto kept_for_sure = larger_than(separate_ml, surely_kept * crumb_ml);
  const auto least_kept = std::max<std::int64_t>(kept_for_sure, label_volume > 0 ? 1 : 0);
  at_most("pieces_lost", least_kept - all(mesh), 0);
  count("handles", mesh.handles);
  count("handles_of_labels", labels.handles);
  at_most("handles_added", mesh.handles - labels.handles, bounds != nullptr ? bounds->maximum_handles_added : 0);
  count("cavities", mesh.cavities);
  count("cavities_of_labels", labels.cavities);
}

/// Volume below which pieces are crumbs, per label: of its cells, or of all cells where it has none (0 too).
std::array<double, 256> crumb_sizes(const TetMesh& mesh) {
  std::array<double, 256> volume{}, count{};
  double all = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const double v = cell_volume_mm3(mesh, mesh.cells[c]) / mm3_per_ml;
    all += v;
    volume[static_cast<std::size_t>(mesh.region[c])] += v;
    ++count[static_cast<std::size_t>(mesh.region[c])];
  }
  const double mean = all / std::max(static_cast<double>(mesh.cells.size()), 1.0);
  std::array<double, 256> crumb_ml{};
  for (std::size_t label = 0; label < crumb_ml.size(); ++label)
    crumb_ml[label] = crumb_cells * (count[label] > 0 ? volume[label] / count[label] : mean);
  return crumb_ml;
}

std::set<std::int32_t> with_those_of(const LabelVolume& labels, std::set<std::int32_t> regions) {
  std::array<bool, 256> present{};
  for (const auto voxel : labels.voxels) present[voxel] = true;
  for (std::size_t region = 1; region < present.size(); ++region)
    if (present[region]) regions.insert(static_cast<std::int32_t>(region));
  return regions;
}

}  // namespace

Report check_against_labels(const std::string& mesh_name, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                            const LabelVolume& labels, const LabelAt& label_at, const ValidationSettings& settings) {
  Report report;
  const auto boundary = boundary_of_regions(mesh, faces);
  const std::set<std::int32_t> regions(mesh.region.begin(), mesh.region.end());
  std::vector<Face> triangles;
  triangles.reserve(boundary.size());
  for (const auto& face : boundary) triangles.push_back(face.nodes);
  const auto tree = make_face_tree(mesh.nodes_mm, triangles);
  const auto crumb_ml = crumb_sizes(mesh);
  const auto label = labels_at_voxels(labels.grid, label_at);
  const Crumbs crumbs{labels.grid, crumbs_of(labels.grid, label, crumb_ml)};
  const auto to_labels = distances_to_labels(mesh, boundary, label_at, crumbs);
  const auto from_labels = distances_from_labels(labels.grid, boundary, tree, regions, label_at, label, crumbs);

  auto topologies = region_topologies(mesh, faces);

  const Rows all{&report, mesh_name};
  add_distances(all, "to_labels", to_labels, 0, {});
  add_distances(all, "from_labels", from_labels, 0, {});
  for (const auto region : with_those_of(labels, regions)) {
    const bool judges = is_myocardium(static_cast<Region>(region)) || is_blood(static_cast<Region>(region));
    const auto most_edges = judges ? std::optional(settings.maximum_surface_distance) : std::nullopt;
    const Rows rows{&report, mesh_name + "/" + region_name(region)};
    const auto value = static_cast<std::uint8_t>(region);
    add_topology(rows, topologies[region], region_topology(labels, value), separate_pieces_ml(labels, value),
                 crumb_ml[value], judges ? &settings : nullptr);
    add_distances(rows, "to_labels", to_labels, region, {});
    add_distances(rows, "from_labels", from_labels, region, most_edges);
  }
  return report;
}

}  // namespace heart::validation
