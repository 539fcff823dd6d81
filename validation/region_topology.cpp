// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/region_topology.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

#include "model/crop.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::validation {
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

/// For every node the regions of its cells, ascending: region[start[n]] .. region[start[n + 1]]. A place in this list
/// stands for what one region has there. Regions are numbers of `tags`.
struct NodeRegions {
  std::vector<std::int32_t> tags;
  std::vector<std::int32_t> of_cell;
  std::vector<std::size_t> start;
  std::vector<std::int32_t> region;

  std::size_t place(std::int32_t node, std::int32_t wanted) const {
    auto at = start[static_cast<std::size_t>(node)];
    while (region[at] != wanted) ++at;
    return at;
  }
};

/// With the mesh's boundary as one more region, the last one.
NodeRegions node_regions(const TetMesh& mesh, const std::vector<MeshFace>& faces) {
  NodeRegions result;
  result.tags.assign(mesh.region.begin(), mesh.region.end());
  sort_unique(result.tags);
  result.of_cell.reserve(mesh.region.size());
  for (const auto tag : mesh.region)
    result.of_cell.push_back(
        static_cast<std::int32_t>(std::lower_bound(result.tags.begin(), result.tags.end(), tag) - result.tags.begin()));
  const auto nodes = mesh.nodes_mm.size();
  std::vector<std::vector<std::int32_t>> more(nodes);  // beside the first region met
  std::vector<std::int32_t> first(nodes, -1);
  const auto take = [&](std::int32_t node, std::int32_t region) {
    const auto n = static_cast<std::size_t>(node);
    if (first[n] < 0) first[n] = region;
    if (first[n] != region && std::find(more[n].begin(), more[n].end(), region) == more[n].end())
      more[n].push_back(region);
  };
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto n : mesh.cells[c]) take(n, result.of_cell[c]);
  for (const auto& face : faces)
    if (face.other < 0)
      for (const auto n : face.nodes) take(n, static_cast<std::int32_t>(result.tags.size()));
  result.start.push_back(0);
  for (std::size_t n = 0; n < nodes; ++n) {
    if (first[n] >= 0) more[n].push_back(first[n]);
    std::sort(more[n].begin(), more[n].end());
    result.region.insert(result.region.end(), more[n].begin(), more[n].end());
    result.start.push_back(result.region.size());
  }
  return result;
}

/// Different edges that cells or faces of each region have, less its nodes there. `take_all(add)` calls
/// add(ids, region) for each cell or face.
template <std::size_t N, class TakeAll>
std::vector<std::int64_t> edges_less_nodes(std::size_t nodes, std::size_t regions, TakeAll take_all) {
  // Filed under the smaller node: the larger one, or again itself for the node alone, and the region.
  std::vector<std::size_t> start(nodes + 1, 0);
  take_all([&](std::array<std::int32_t, N> ids, std::int32_t) {
    std::sort(ids.begin(), ids.end());
    for (std::size_t i = 0; i < N; ++i) start[static_cast<std::size_t>(ids[i]) + 1] += N - i;
  });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::pair<std::int32_t, std::int32_t>> items(start.back());
  auto next = start;
  take_all([&](std::array<std::int32_t, N> ids, std::int32_t region) {
    std::sort(ids.begin(), ids.end());
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = i; j < N; ++j) items[next[static_cast<std::size_t>(ids[i])]++] = {ids[j], region};
  });
  std::vector<std::int64_t> result(regions, 0);
  for (std::size_t n = 0; n < nodes; ++n) {
    const auto first = items.begin() + static_cast<std::ptrdiff_t>(start[n]);
    const auto last = items.begin() + static_cast<std::ptrdiff_t>(start[n + 1]);
    std::sort(first, last);
    for (auto at = first; at != last; ++at)
      if (at == first || *at != *(at - 1))
        result[static_cast<std::size_t>(at->second)] += at->first == static_cast<std::int32_t>(n) ? -1 : 1;
  }
  return result;
}

/// Euler characteristic of each region's inside: cells, faces, edges and nodes but for those of its boundary. Poincaré
/// duality makes that of the open set of their alternating sum.
std::vector<std::int64_t> characteristics(const TetMesh& mesh, const std::vector<MeshFace>& faces,
                                          const NodeRegions& regions) {
  const auto region = [&](std::int32_t cell) {
    return cell < 0 ? -1 : regions.of_cell[static_cast<std::size_t>(cell)];
  };
  const auto nodes = mesh.nodes_mm.size();
  const auto whole = edges_less_nodes<4>(nodes, regions.tags.size(), [&](const auto& add) {
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) add(mesh.cells[c], regions.of_cell[c]);
  });
  const auto boundary = edges_less_nodes<3>(nodes, regions.tags.size(), [&](const auto& add) {
    for (const auto& face : faces) {
      const auto a = region(face.cell), b = region(face.other);
      if (a == b) continue;
      add(face.nodes, a);
      if (b >= 0) add(face.nodes, b);
    }
  });
  std::vector<std::int64_t> sum(regions.tags.size(), 0);
  for (const auto r : regions.of_cell) ++sum[static_cast<std::size_t>(r)];
  for (const auto& face : faces)
    if (region(face.cell) == region(face.other)) --sum[static_cast<std::size_t>(region(face.cell))];
  for (std::size_t r = 0; r < sum.size(); ++r) sum[r] += whole[r] - boundary[r];
  return sum;
}

/// Volumes of the pieces of each region, largest first.
std::vector<std::vector<double>> component_volumes(const TetMesh& mesh, const std::vector<MeshFace>& faces,
                                                   const NodeRegions& regions) {
  Sets sets(mesh.cells.size());
  const auto region = [&](std::int32_t cell) { return regions.of_cell[static_cast<std::size_t>(cell)]; };
  for (const auto& face : faces)
    if (face.other >= 0 && region(face.cell) == region(face.other)) sets.join(face.cell, face.other);
  std::vector<double> volume(mesh.cells.size(), 0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    volume[static_cast<std::size_t>(sets.root(static_cast<std::int32_t>(c)))] +=
        cell_volume_mm3(mesh, mesh.cells[c]) / mm3_per_ml;
  std::vector<std::vector<double>> sizes(regions.tags.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (sets.root(static_cast<std::int32_t>(c)) == static_cast<std::int32_t>(c))
      sizes[static_cast<std::size_t>(regions.of_cell[c])].push_back(volume[c]);
  for (auto& of_region : sizes) std::sort(of_region.begin(), of_region.end(), std::greater<>());
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

/// What hangs together through nodes: pieces of the regions and of the mesh's boundary, and which of them touch.
struct Contacts {
  std::vector<std::int32_t> region;                             ///< per piece
  std::vector<std::pair<std::int32_t, std::int32_t>> touching;  ///< pieces, ascending
  std::vector<std::int32_t> outer;                              ///< pieces with the outside around them
};

Contacts contacts_of(const TetMesh& mesh, const std::vector<MeshFace>& faces, const NodeRegions& regions) {
  Sets sets(regions.region.size());
  const auto boundary = static_cast<std::int32_t>(regions.tags.size());
  const auto place = [&](std::int32_t node, std::int32_t region) {
    return static_cast<std::int32_t>(regions.place(node, region));
  };
  const auto join = [&](const auto& ids, std::int32_t region) {
    for (const auto n : ids) sets.join(place(n, region), place(ids[0], region));
  };
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) join(mesh.cells[c], regions.of_cell[c]);
  for (const auto& face : faces)
    if (face.other < 0) join(face.nodes, boundary);
  Contacts contacts;
  std::vector<std::int32_t> piece(regions.region.size(), -1);
  const auto piece_at = [&](std::size_t at) {
    return piece[static_cast<std::size_t>(sets.root(static_cast<std::int32_t>(at)))];
  };
  for (std::size_t at = 0; at < piece.size(); ++at)
    if (sets.root(static_cast<std::int32_t>(at)) == static_cast<std::int32_t>(at)) {
      piece[at] = static_cast<std::int32_t>(contacts.region.size());
      contacts.region.push_back(regions.region[at]);
    }
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n)
    for (auto a = regions.start[n]; a < regions.start[n + 1]; ++a)
      for (auto b = a + 1; b < regions.start[n + 1]; ++b) contacts.touching.emplace_back(piece_at(a), piece_at(b));
  sort_unique(contacts.touching);
  for (const auto node : outer_shells(mesh, faces)) contacts.outer.push_back(piece_at(regions.place(node, boundary)));
  return contacts;
}

/// Pieces of what is around the region, beside the outside of the mesh, which the last set stands for.
std::int64_t cavity_count(const Contacts& contacts, std::int32_t region) {
  const auto pieces = contacts.region.size();
  const auto around = [&](std::int32_t piece) { return contacts.region[static_cast<std::size_t>(piece)] != region; };
  Sets sets(pieces + 1);
  for (const auto& [a, b] : contacts.touching)
    if (around(a) && around(b)) sets.join(a, b);
  for (const auto piece : contacts.outer) sets.join(piece, static_cast<std::int32_t>(pieces));
  std::int64_t count = -1;
  for (std::int32_t p = 0; p <= static_cast<std::int32_t>(pieces); ++p)
    count += (p == static_cast<std::int32_t>(pieces) || around(p)) && sets.root(p) == p;
  return count;
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

VoxelBox voxels_of(const LabelVolume& labels, std::uint8_t label) {
  const Box tight = bounding_box(labels, 0, [&](std::uint8_t value) { return value == label; });
  VoxelBox box;
  if (tight.empty()) return box;
  const auto& low = tight.begin;
  for (std::size_t a = 0; a < 3; ++a) box.size[a] = tight.end[a] - low[a] + 2;
  box.inside.assign(static_cast<std::size_t>(box.size[0] * box.size[1] * box.size[2]), 0);
  for (std::int64_t k = low[2]; k < tight.end[2]; ++k)
    for (std::int64_t j = low[1]; j < tight.end[1]; ++j) {
      auto* row = const_cast<std::uint8_t*>(box.row(j - low[1] + 1, k - low[2] + 1));
      for (std::int64_t i = low[0]; i < tight.end[0]; ++i) row[i - low[0] + 1] = labels(i, j, k) == label;
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
  sizes.reserve(size_of.size());
  for (const auto& [root, size] : size_of) sizes.push_back(size);
  return sizes;
}

std::vector<double> volumes_ml(const std::vector<std::int64_t>& sizes, const Grid& grid) {
  std::vector<double> volumes;
  volumes.reserve(sizes.size());
  for (const auto size : sizes) volumes.push_back(static_cast<double>(size) * grid.voxel_volume_mm3() / mm3_per_ml);
  std::sort(volumes.begin(), volumes.end(), std::greater<>());
  return volumes;
}

}  // namespace

std::map<std::int32_t, RegionTopology> region_topologies(const TetMesh& mesh, const std::vector<MeshFace>& faces) {
  const auto regions = node_regions(mesh, faces);
  const auto contacts = contacts_of(mesh, faces, regions);
  const auto characteristic = characteristics(mesh, faces, regions);
  auto volumes = component_volumes(mesh, faces, regions);
  std::map<std::int32_t, RegionTopology> result;
  for (std::size_t r = 0; r < regions.tags.size(); ++r) {
    RegionTopology& topology = result[regions.tags[r]];
    topology.components_ml = std::move(volumes[r]);
    topology.cavities = cavity_count(contacts, static_cast<std::int32_t>(r));
    topology.handles = static_cast<std::int64_t>(topology.components_ml.size()) + topology.cavities - characteristic[r];
  }
  return result;
}

RegionTopology region_topology(const LabelVolume& labels, std::uint8_t label) {
  RegionTopology topology;
  const auto box = voxels_of(labels, label);
  if (box.inside.empty()) return topology;
  topology.components_ml = volumes_ml(piece_sizes(box, 1, 0), labels.grid);
  topology.cavities = static_cast<std::int64_t>(piece_sizes(box, 0, 1).size()) - 1;
  topology.handles =
      static_cast<std::int64_t>(topology.components_ml.size()) + topology.cavities - euler_characteristic(box);
  return topology;
}

std::vector<double> separate_pieces_ml(const LabelVolume& labels, std::uint8_t label) {
  const auto box = voxels_of(labels, label);
  return box.inside.empty() ? std::vector<double>{} : volumes_ml(piece_sizes(box, 1, 1), labels.grid);
}

}  // namespace heartgen::validation
