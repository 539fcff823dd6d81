#include "validation/region_topology.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>

namespace heart::validation {
namespace {

constexpr double mm3_per_ml = 1000;

/// Sets that are joined; the smallest member stands for each.
struct Sets {
  std::vector<std::int32_t> parent;

  explicit Sets(std::size_t count) : parent(count) { std::iota(parent.begin(), parent.end(), 0); }
  std::int32_t root(std::int32_t i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
      auto& up = parent[static_cast<std::size_t>(i)];
      up = parent[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  }
  void join(std::int32_t a, std::int32_t b) {
    const auto x = root(a), y = root(b);
    parent[static_cast<std::size_t>(std::max(x, y))] = std::min(x, y);
  }
};

template <class T>
std::int64_t count_different(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  return std::unique(values.begin(), values.end()) - values.begin();
}

std::uint64_t edge_key(std::int32_t a, std::int32_t b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint64_t>(std::max(a, b));
}

/// Nodes and edges that cells or faces use.
struct Skeleton {
  std::vector<std::uint64_t> edges;
  std::vector<std::int32_t> nodes;

  template <std::size_t N>
  void add(const std::array<std::int32_t, N>& ids) {
    for (std::size_t i = 0; i < N; ++i) {
      nodes.push_back(ids[i]);
      for (std::size_t j = i + 1; j < N; ++j) edges.push_back(edge_key(ids[i], ids[j]));
    }
  }
  std::int64_t nodes_minus_edges() { return count_different(nodes) - count_different(edges); }
};

struct MeshRegion {
  const TetMesh* mesh;
  std::int32_t region;
  bool has(std::int32_t cell) const { return cell >= 0 && mesh->region[static_cast<std::size_t>(cell)] == region; }
};

std::vector<double> component_volumes(const MeshRegion& in, const std::vector<MeshFace>& faces) {
  Sets sets(in.mesh->cells.size());
  for (const auto& face : faces)
    if (in.has(face.cell) && in.has(face.other)) sets.join(face.cell, face.other);
  std::map<std::int32_t, double> volume;
  for (std::size_t c = 0; c < in.mesh->cells.size(); ++c)
    if (in.mesh->region[c] == in.region)
      volume[sets.root(static_cast<std::int32_t>(c))] += cell_volume_mm3(*in.mesh, in.mesh->cells[c]) / mm3_per_ml;
  std::vector<double> sizes;
  for (const auto& [root, size] : volume) sizes.push_back(size);
  std::sort(sizes.begin(), sizes.end(), std::greater<>());
  return sizes;
}

/// Volume that a face spans with the origin, positive where the face looks away from it out of its cell.
double spanned_volume(const TetMesh& mesh, const MeshFace& face) {
  const auto node = [&](std::int32_t n) { return mesh.nodes_mm[static_cast<std::size_t>(n)]; };
  const Vec3 a = node(face.nodes[0]), b = node(face.nodes[1]), c = node(face.nodes[2]);
  Vec3 middle;
  for (const auto n : mesh.cells[static_cast<std::size_t>(face.cell)]) middle += 0.25 * node(n);
  const double volume = dot(a, cross(b, c));
  return dot(cross(b - a, c - a), middle - a) > 0 ? -volume : volume;
}

/// One node of every piece of the mesh's surface that has the outside around it, not a void inside it.
std::vector<std::int32_t> outer_shells(const TetMesh& mesh, const std::vector<MeshFace>& faces) {
  Sets sets(mesh.nodes_mm.size());
  for (const auto& face : faces)
    if (face.other < 0)
      for (const auto n : face.nodes) sets.join(n, face.nodes[0]);
  std::map<std::int32_t, double> volume;
  for (const auto& face : faces)
    if (face.other < 0) volume[sets.root(face.nodes[0])] += spanned_volume(mesh, face);
  std::vector<std::int32_t> shells;
  for (const auto& [root, size] : volume)
    if (size > 0) shells.push_back(root);
  return shells;
}

/// Pieces of what is around the region, beside the outside of the mesh, which the last set stands for.
std::int64_t cavity_count(const MeshRegion& in, const std::vector<MeshFace>& faces) {
  const auto nodes = in.mesh->nodes_mm.size();
  const auto outside = static_cast<std::int32_t>(nodes);
  Sets sets(nodes + 1);
  std::vector<bool> around(nodes + 1, false);
  around[nodes] = true;
  const auto take = [&](const auto& ids) {
    for (const auto n : ids) {
      around[static_cast<std::size_t>(n)] = true;
      sets.join(n, ids[0]);
    }
  };
  for (std::size_t c = 0; c < in.mesh->cells.size(); ++c)
    if (in.mesh->region[c] != in.region) take(in.mesh->cells[c]);
  for (const auto& face : faces)
    if (face.other < 0) take(face.nodes);
  for (const auto node : outer_shells(*in.mesh, faces)) sets.join(node, outside);
  std::int64_t pieces = 0;
  for (std::size_t n = 0; n <= nodes; ++n)
    pieces += around[n] && sets.root(static_cast<std::int32_t>(n)) == static_cast<std::int32_t>(n);
  return pieces - 1;
}

// ---- voxels ----

/// Voxels of a box, 1 where they have the label; one layer of 0 around the label's own box.
struct VoxelBox {
  Index3 size{0, 0, 0};
  std::vector<std::uint8_t> inside;

  const std::uint8_t* row(std::int64_t j, std::int64_t k) const {
    return inside.data() + static_cast<std::size_t>((k * size[1] + j) * size[0]);
  }
};

VoxelBox crop(const LabelVolume& labels, std::uint8_t label) {
  const auto& size = labels.grid.size;
  Index3 low = size, high{-1, -1, -1};
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        if (labels.voxels[v] != label) continue;
        const Index3 at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], at[a]), high[a] = std::max(high[a], at[a]);
      }
  VoxelBox box;
  if (high[0] < 0) return box;
  for (std::size_t a = 0; a < 3; ++a) box.size[a] = high[a] - low[a] + 3;
  box.inside.assign(static_cast<std::size_t>(box.size[0] * box.size[1] * box.size[2]), 0);
  for (std::int64_t k = low[2]; k <= high[2]; ++k)
    for (std::int64_t j = low[1]; j <= high[1]; ++j) {
      auto* row = const_cast<std::uint8_t*>(box.row(j - low[1] + 1, k - low[2] + 1));
      for (std::int64_t i = low[0]; i <= high[0]; ++i) row[i - low[0] + 1] = labels(i, j, k) == label;
    }
  return box;
}

/// Voxels, less pairs, plus squares of four, less cubes of eight.
std::int64_t euler_characteristic(const VoxelBox& box) {
  std::int64_t sum = 0;
  for (std::int64_t k = 0; k + 1 < box.size[2]; ++k)
    for (std::int64_t j = 0; j + 1 < box.size[1]; ++j) {
      const auto* a = box.row(j, k);
      const auto* b = box.row(j + 1, k);
      const auto* c = box.row(j, k + 1);
      const auto* d = box.row(j + 1, k + 1);
      std::int32_t row = 0;
      for (std::int64_t i = 0; i + 1 < box.size[0]; ++i) {
        const int ab = a[i] & b[i], ac = a[i] & c[i], all = ab & c[i] & d[i];
        const int next = a[i + 1];
        row += a[i] - (a[i] & next) - ab - ac + all + (ab & next & b[i + 1]) + (ac & next & c[i + 1]) -
               (all & next & b[i + 1] & c[i + 1] & d[i + 1]);
      }
      sum += row;
    }
  return sum;
}

/// Voxels of one row in a row that have one value.
struct Stretch {
  std::int32_t begin, end;
};

/// Connected pieces of the voxels with `value`: `reach` 0 joins neighbouring rows where their stretches overlap, and
/// only rows that share a face; 1 also where they meet at edges and corners. Returns sizes in voxels.
std::vector<std::int64_t> piece_sizes(const VoxelBox& box, std::uint8_t value, std::int32_t reach) {
  const auto rows = box.size[1] * box.size[2];
  std::vector<Stretch> stretches;
  std::vector<std::size_t> first(static_cast<std::size_t>(rows) + 1, 0);
  for (std::int64_t r = 0; r < rows; ++r) {
    const auto* row = box.inside.data() + static_cast<std::size_t>(r * box.size[0]);
    for (std::int64_t i = 0; i < box.size[0];) {
      const auto begin = i;
      while (i < box.size[0] && row[i] == value) ++i;
      if (i > begin) stretches.push_back({static_cast<std::int32_t>(begin), static_cast<std::int32_t>(i)});
      i += i == begin;
    }
    first[static_cast<std::size_t>(r) + 1] = stretches.size();
  }
  Sets sets(stretches.size());
  const auto join_rows = [&](std::int64_t r, std::int64_t s) {
    auto a = first[static_cast<std::size_t>(r)], b = first[static_cast<std::size_t>(s)];
    const auto a_end = first[static_cast<std::size_t>(r) + 1], b_end = first[static_cast<std::size_t>(s) + 1];
    while (a < a_end && b < b_end) {
      if (stretches[a].begin < stretches[b].end + reach && stretches[b].begin < stretches[a].end + reach)
        sets.join(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b));
      ++(stretches[a].end < stretches[b].end ? a : b);
    }
  };
  for (std::int64_t k = 0; k < box.size[2]; ++k)
    for (std::int64_t j = 0; j < box.size[1]; ++j) {
      const auto r = k * box.size[1] + j;
      if (j > 0) join_rows(r, r - 1);
      if (k > 0) join_rows(r, r - box.size[1]);
      if (reach > 0 && k > 0 && j > 0) join_rows(r, r - box.size[1] - 1);
      if (reach > 0 && k > 0 && j + 1 < box.size[1]) join_rows(r, r - box.size[1] + 1);
    }
  std::map<std::int32_t, std::int64_t> size_of;
  for (std::size_t s = 0; s < stretches.size(); ++s)
    size_of[sets.root(static_cast<std::int32_t>(s))] += stretches[s].end - stretches[s].begin;
  std::vector<std::int64_t> sizes;
  for (const auto& [root, size] : size_of) sizes.push_back(size);
  return sizes;
}

}  // namespace

RegionTopology region_topology(const TetMesh& mesh, const std::vector<MeshFace>& faces, std::int32_t region) {
  const MeshRegion in{&mesh, region};
  Skeleton whole, boundary;
  std::int64_t cells = 0, inner_faces = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == region) {
      ++cells;
      whole.add(mesh.cells[c]);
    }
  for (const auto& face : faces) {
    if (in.has(face.cell) && in.has(face.other)) ++inner_faces;
    if (in.has(face.cell) != in.has(face.other)) boundary.add(face.nodes);
  }
  // Cells, faces, edges and nodes inside the region: those of its boundary do not count. Poincaré duality turns their
  // alternating sum into the Euler characteristic of the open set.
  const std::int64_t inner_nodes_minus_edges = whole.nodes_minus_edges() - boundary.nodes_minus_edges();
  const std::int64_t characteristic = cells - inner_faces - inner_nodes_minus_edges;
  RegionTopology topology;
  topology.components_ml = component_volumes(in, faces);
  topology.cavities = cells == 0 ? 0 : cavity_count(in, faces);
  topology.handles = static_cast<std::int64_t>(topology.components_ml.size()) + topology.cavities - characteristic;
  return topology;
}

RegionTopology region_topology(const LabelVolume& labels, std::uint8_t label) {
  RegionTopology topology;
  const auto box = crop(labels, label);
  if (box.inside.empty()) return topology;
  for (const auto size : piece_sizes(box, 1, 0))
    topology.components_ml.push_back(static_cast<double>(size) * labels.grid.voxel_volume_mm3() / mm3_per_ml);
  std::sort(topology.components_ml.begin(), topology.components_ml.end(), std::greater<>());
  topology.cavities = static_cast<std::int64_t>(piece_sizes(box, 0, 1).size()) - 1;
  topology.handles =
      static_cast<std::int64_t>(topology.components_ml.size()) + topology.cavities - euler_characteristic(box);
  return topology;
}

}  // namespace heart::validation
