// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/isosurface_stuffing.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>

#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/stuffing/background_lattice.hpp"
#include "generator/stuffing/lattice_cells.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/quality.hpp"
#include "generator/tetmesh/shared_marks.hpp"
#include "generator/tetmesh/slabs.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::stuffing {
namespace {

using tetmesh::Complex;
using tetmesh::LabelBits;
using tetmesh::Materials;

using Edge = std::pair<std::int32_t, std::int32_t>;

// Of an edge to find where it crosses: 1/256 of its length, or 1/32 where the place is projected onto the surface
// anyway.
constexpr int halvings = 8, halvings_to_snap = 5;

std::int64_t node_count(const Complex& c) { return static_cast<std::int64_t>(c.nodes_mm.size()); }
std::int64_t cell_count(const Complex& c) { return static_cast<std::int64_t>(c.cells.size()); }

// Labels of the nodes as `touches`. Cells all of whose nodes are outside are left out (label 0), but for those around
// the nodes of the others: what the outside looks like around a node is seen only where all its cells are there.
Complex label_lattice(Background background) {
  Complex c;
  c.nodes_mm = std::move(background.nodes_mm);
  c.spacing_mm = std::move(background.spacing_mm);
  c.touches = std::move(background.sides);
  c.cells = std::move(background.cells);
  c.label.resize(c.cells.size());  // 1: not yet known
  for (std::size_t n = 0; n < c.touches.size(); ++n)
    c.touches[n] |= tetmesh::bit_of(background.label[n]) | (background.lacks_cells[n] != 0 ? tetmesh::hull_bit : 0);
  std::vector<std::uint8_t> is_near(c.nodes_mm.size(), 0);
  const auto for_cells = [&](const auto& work) {
    parallel::parallel_for(0, cell_count(c), [&](std::int64_t begin, std::int64_t end) {
      for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) work(t, c.cells[t]);
    });
  };
  for_cells([&](std::size_t, const Cell& cell) {
    if (std::any_of(cell.begin(), cell.end(), [&](std::int32_t n) { return (c.bits(n) & tetmesh::bit_of(0)) == 0; }))
      for (const auto n : cell) tetmesh::set_to(is_near[static_cast<std::size_t>(n)], std::uint8_t{1});
  });
  for_cells([&](std::size_t t, const Cell& cell) {
    c.label[t] = std::any_of(cell.begin(), cell.end(),
                             [&](std::int32_t n) { return is_near[static_cast<std::size_t>(n)] != 0; });
    if (c.label[t] == 0)
      for (const auto n : cell) tetmesh::set_bits(c.touches[static_cast<std::size_t>(n)], tetmesh::hull_bit);
  });
  tetmesh::drop_unused(c);
  tetmesh::connect_stars(c);
  constexpr float min_quality = 0.65F;  // of the lattice's cells: angles in [45, 120] degrees, a little stretched
  c.quality.assign(c.cells.size(), min_quality);
  return c;
}

constexpr LabelBits label_bits = ~(tetmesh::side_bits | tetmesh::hull_bit);

LabelBits labels_of(const Complex& c, std::int32_t node) { return c.bits(node) & label_bits; }
bool is_on_feature(const Complex& c, std::int32_t node) { return tetmesh::is_constrained(labels_of(c, node)); }
bool crosses(const Complex& c, std::int32_t a, std::int32_t b) { return (labels_of(c, a) & labels_of(c, b)) == 0; }

LabelBits common_labels(const Complex& c, const Cell& cell) {
  return labels_of(c, cell[0]) & labels_of(c, cell[1]) & labels_of(c, cell[2]) & labels_of(c, cell[3]);
}

// Of each cell, what `property` says.
template <class Property>
std::vector<std::uint8_t> mark_cells(const Complex& c, const Property& property) {
  std::vector<std::uint8_t> marks(c.cells.size());
  parallel::parallel_for(0, cell_count(c), [&](std::int64_t begin, std::int64_t end) {
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t)
      marks[t] = c.cells[t][0] >= 0 && property(c.cells[t]);
  });
  return marks;
}

// To a list of the few nodes around another one.
void add_once(std::vector<std::int32_t>& nodes, std::int32_t node) {
  if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) nodes.push_back(node);
}

// The edges that cross, ascending.
std::vector<Edge> crossing_edges(const Complex& c) {
  const auto is_crossed = mark_cells(c, [&](const Cell& cell) { return common_labels(c, cell) == 0; });
  return parallel::gather<Edge>(0, node_count(c), [&](std::int64_t begin, std::int64_t end, std::vector<Edge>& edges) {
    std::vector<std::int32_t> others;
    for (auto n = begin; n < end; ++n) {
      const auto node = static_cast<std::int32_t>(n);
      others.clear();
      for (const auto t : c.star(node)) {
        if (is_crossed[static_cast<std::size_t>(t)] == 0) continue;
        for (const auto other : c.cell(t))
          if (other > node && crosses(c, node, other)) add_once(others, other);
      }
      std::sort(others.begin(), others.end());
      for (const auto other : others) edges.emplace_back(node, other);
    }
  });
}

// Only those in cells at the nodes from `first_node` on.
std::vector<Edge> crossing_edges_from(const Complex& c, std::int64_t first_node) {
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Edge>& edges) {
    for (auto node = begin; node < end; ++node)
      for (const auto t : c.star(static_cast<std::int32_t>(node))) {
        const Cell& cell = c.cell(t);
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = i + 1; j < 4; ++j)
            if (crosses(c, cell[i], cell[j])) edges.push_back(std::minmax(cell[i], cell[j]));
      }
  };
  return parallel::gather_sorted<Edge>(first_node, node_count(c), find);
}

/// Where an edge leaves the labels of its first node.
struct Crossing {
  double share = 0;      ///< of the edge, from the first node
  LabelBits labels = 0;  ///< on the two sides
  Vec3 point;            ///< there
};

Crossing find_crossing(const Materials& materials, const Complex& c, const Edge& edge, int steps) {
  const LabelBits own = labels_of(c, edge.first);
  const Vec3 start = c.at(edge.first), way = c.at(edge.second) - start;
  double low = 0, high = 1;
  LabelBits before = 0, after = 0;
  for (int i = 0; i < steps; ++i) {
    const double middle = 0.5 * (low + high);
    const LabelBits label = tetmesh::bit_of(materials.label_at(start + middle * way));
    const bool inside = (label & own) != 0;
    (inside ? low : high) = middle;
    (inside ? before : after) = label;
  }
  const auto any = [](LabelBits bits) { return bits & (~bits + 1); };
  if (before == 0) before = any(own);
  if (after == 0) after = any(labels_of(c, edge.second));
  const double share = 0.5 * (low + high);
  return {share, before | after, start + share * way};
}

std::vector<Crossing> find_crossings(const Materials& materials, const Complex& c, const std::vector<Edge>& edges,
                                     int steps) {
  std::vector<Crossing> crossings(edges.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(edges.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e)
      crossings[e] = find_crossing(materials, c, edges[e], steps);
  });
  return crossings;
}

/// A node that could move onto a curve; nearest first.
struct CurveSnap {
  double distance;  ///< relative
  std::int32_t node;
  LabelBits labels;  ///< that the node would touch
  Vec3 target;
  Face face;  ///< through which the curve goes
  bool operator<(const CurveSnap& other) const {
    if (distance != other.distance) return distance < other.distance;
    return node != other.node ? node < other.node : face < other.face;
  }
};

// Faces whose nodes have three different labels: a curve goes through them.
std::vector<Face> pierced_faces(const Complex& c) {
  return parallel::gather_sorted<Face>(
      0, cell_count(c), [&](std::int64_t begin, std::int64_t end, std::vector<Face>& faces) {
        for (auto t = begin; t < end; ++t) {
          const Cell& cell = c.cell(static_cast<std::int32_t>(t));
          if (common_labels(c, cell) != 0) continue;
          for (std::size_t i = 0; i < 4; ++i) {
            Face face{cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]};
            if (!crosses(c, face[0], face[1]) || !crosses(c, face[1], face[2]) || !crosses(c, face[0], face[2]))
              continue;
            std::sort(face.begin(), face.end());
            faces.push_back(face);
          }
        }
      });
}

std::vector<CurveSnap> curve_snaps(const Materials& materials, const Complex& c, const std::vector<Face>& faces,
                                   double reach) {
  constexpr int newton_steps = 6;
  std::vector<std::array<CurveSnap, 3>> found(faces.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(faces.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      const Face& face = faces[f];
      const LabelBits labels = labels_of(c, face[0]) | labels_of(c, face[1]) | labels_of(c, face[2]);
      const Vec3 center = (c.at(face[0]) + c.at(face[1]) + c.at(face[2])) / 3;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto node = face[i];
        const Vec3 start = 0.5 * (center + c.at(node));
        const Vec3 target =
            tetmesh::project(materials, (c.bits(node) & tetmesh::side_bits) | labels, start, newton_steps);
        const double spacing = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(node)]);
        const auto feature = tetmesh::feature_at(materials, labels, target);
        const bool is_on = tetmesh::distance_to(feature) < 0.02 * spacing && norm(target - center) < spacing;
        const double distance = is_on ? norm(target - c.at(node)) / spacing : 9;
        found[f][i] = {distance, node, labels, target, face};
      }
    }
  });
  std::vector<CurveSnap> snaps;
  for (const auto& three : found)
    for (const auto& snap : three)
      if (snap.distance < reach) snaps.push_back(snap);
  std::sort(snaps.begin(), snaps.end());
  return snaps;
}

void snap_to_curves(const Materials& materials, Complex& c, const StuffSettings& settings) {
  for (const auto& snap : curve_snaps(materials, c, pierced_faces(c), settings.curve_reach)) {
    const bool is_open = crosses(c, snap.face[0], snap.face[1]) && crosses(c, snap.face[1], snap.face[2]) &&
                         crosses(c, snap.face[0], snap.face[2]);
    if (is_open && tetmesh::move_node(c, snap.node, snap.target, settings.min_quality))
      c.touches[static_cast<std::size_t>(snap.node)] |= snap.labels;
  }
}

/// A node that could move onto the surface that an edge of it crosses; nearest first.
struct SurfaceSnap {
  double distance;  ///< relative
  std::int32_t node, edge;
  bool operator==(const SurfaceSnap&) const = default;
  bool operator<(const SurfaceSnap& other) const {
    return std::tie(distance, node, edge) < std::tie(other.distance, other.node, other.edge);
  }
};

std::vector<SurfaceSnap> surface_snaps(const Complex& c, const std::vector<Edge>& edges,
                                       const std::vector<Crossing>& crossings, double reach) {
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<SurfaceSnap>& snaps) {
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
      const auto [a, b] = edges[e];
      const auto& crossing = crossings[e];
      for (const bool from_first : {true, false}) {
        const double share = from_first ? crossing.share : 1 - crossing.share;
        const auto node = from_first ? a : b;
        if (share > reach || is_on_feature(c, node)) continue;
        if ((crossing.labels & labels_of(c, node)) == 0) continue;  // a third material lies between
        const double spacing = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(node)]);
        snaps.push_back({share * norm(c.at(b) - c.at(a)) / spacing, node, static_cast<std::int32_t>(e)});
      }
    }
  };
  return parallel::gather_sorted<SurfaceSnap>(0, static_cast<std::int64_t>(edges.size()), find);
}

void snap_to_surfaces(const Materials& materials, Complex& c, const StuffSettings& settings) {
  const auto edges = crossing_edges(c);
  const auto crossings = find_crossings(materials, c, edges, halvings_to_snap);
  const auto snaps = surface_snaps(c, edges, crossings, settings.edge_reach);
  const auto snap_one = [&](std::size_t i) {
    const auto node = snaps[i].node;
    const auto e = static_cast<std::size_t>(snaps[i].edge);
    if (is_on_feature(c, node) || !crosses(c, edges[e].first, edges[e].second)) return;
    const LabelBits labels = crossings[e].labels, sides = c.bits(node) & tetmesh::side_bits;
    const Vec3 target = tetmesh::project(materials, sides | labels, crossings[e].point, 2);
    if (norm(target - crossings[e].point) > 0.25 * static_cast<double>(c.spacing_mm[static_cast<std::size_t>(node)]))
      return;
    if (tetmesh::move_node(c, node, target, settings.min_quality)) c.touches[static_cast<std::size_t>(node)] |= labels;
  };
  constexpr std::size_t fewest = 20'000;  // in a slab: at its borders, what is nearer may come later
  tetmesh::for_slabs(
      tetmesh::slabs_across(c, 1, snaps.size() / fewest), snaps.size(),
      [&](std::size_t i) { return c.at(snaps[i].node); }, snap_one);
}

void split_edge(Complex& c, const Edge& edge, std::int32_t middle) {
  std::vector<std::int32_t> ring;
  for (const auto t : c.star(edge.first))
    if (tetmesh::has(c.cell(t), edge.second)) ring.push_back(t);
  for (const auto t : ring) {
    const Cell old = c.cell(t);
    tetmesh::remove_cell(c, t);
    for (const auto replaced : {edge.first, edge.second}) {
      Cell made = old;
      std::replace(made.begin(), made.end(), replaced, middle);
      tetmesh::add_unrated_cell(c, made, 1);
    }
  }
}

/// An edge to divide, and where.
struct Cut {
  Edge edge;
  Crossing crossing;
};

std::vector<Cut> cuts_of(const Materials& materials, const Complex& c, const std::vector<Edge>& edges) {
  const auto crossings = find_crossings(materials, c, edges, halvings);
  std::vector<Cut> cuts;
  cuts.reserve(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) cuts.push_back({edges[e], crossings[e]});
  return cuts;
}

// Edges from a node on a surface to one that has no label but one of its own, in the star of the first.
void collect_edges_off_surface(const Complex& c, std::int32_t node, std::vector<std::int32_t>& others) {
  others.clear();
  if (!is_on_feature(c, node)) return;
  for (const auto t : c.star(node))
    for (const auto other : c.cell(t))
      if (!is_on_feature(c, other) && !crosses(c, node, other)) add_once(others, other);
}

// Edges from a node to later ones of the same label, in cells with a node on a surface.
void collect_edges_beside_surface(const Complex& c, const std::vector<std::uint8_t>& is_at_surface, std::int32_t node,
                                  std::vector<std::int32_t>& others) {
  others.clear();
  const LabelBits own = labels_of(c, node);
  if (is_on_feature(c, node)) return;
  for (const auto t : c.star(node)) {
    if (is_at_surface[static_cast<std::size_t>(t)] == 0) continue;
    for (const auto other : c.cell(t))
      if (other > node && labels_of(c, other) == own) add_once(others, other);
  }
}

// Where an edge whose ends have a label in common leaves a sheet of another material that it goes through; no labels
// where there is none. No label tells such an edge from others.
Crossing find_hidden_crossing(const Materials& materials, const Complex& c, const Edge& edge) {
  constexpr std::array sampled{0.5, 0.25};  // of the edge
  constexpr double min_depth = 0.1;         // of the lattice's width: the surface may be a little curved
  const Vec3 start = c.at(edge.first), way = c.at(edge.second) - start;
  const LabelBits own = labels_of(c, edge.second);
  const double spacing = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(edge.first)]);
  for (const double share : sampled) {
    const Vec3 sample = start + share * way;
    const LabelBits between = tetmesh::bit_of(materials.label_at(sample));
    if (between == own ||
        tetmesh::distance_to(tetmesh::feature_at(materials, between | own, sample)) < min_depth * spacing)
      continue;
    double low = share, high = 1;
    LabelBits after = own;
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (low + high);
      const LabelBits label = tetmesh::bit_of(materials.label_at(start + middle * way));
      (label == between ? low : high) = middle;
      if (label != between) after = label;
    }
    const double crossed = 0.5 * (low + high);
    return {crossed, between | after, start + crossed * way};
  }
  return {};
}

// Of the edges that `collect` finds at the nodes from `first_node` on.
template <class Collect>
std::vector<Cut> hidden_cuts(const Materials& materials, const Complex& c, std::int64_t first_node,
                             const Collect& collect) {
  return parallel::gather<Cut>(first_node, node_count(c),
                               [&](std::int64_t begin, std::int64_t end, std::vector<Cut>& cuts) {
                                 std::vector<std::int32_t> others;
                                 for (auto node = begin; node < end; ++node) {
                                   collect(static_cast<std::int32_t>(node), others);
                                   std::sort(others.begin(), others.end());
                                   for (const auto other : others) {
                                     const Edge edge{static_cast<std::int32_t>(node), other};
                                     const auto crossing = find_hidden_crossing(materials, c, edge);
                                     if (crossing.labels != 0) cuts.push_back({edge, crossing});
                                   }
                                 }
                               });
}

// Divides an edge. At a crossing very near to a node, or on an edge that is `never_divided`, the node touches both
// sides where it is.
void cut_edge(Complex& c, const Cut& cut, bool never_divided) {
  constexpr double near = 0.08;
  const auto [a, b] = cut.edge;
  const double share = cut.crossing.share;
  if (share < near || share > 1 - near || never_divided) {
    const auto nearer = share < 0.5 ? a : b;
    c.touches[static_cast<std::size_t>(nearer)] |= cut.crossing.labels | labels_of(c, share < 0.5 ? b : a);
    return;
  }
  const LabelBits sides = c.bits(a) & c.bits(b) & tetmesh::side_bits;
  const float spacing = std::min(c.spacing_mm[static_cast<std::size_t>(a)], c.spacing_mm[static_cast<std::size_t>(b)]);
  split_edge(c, cut.edge, tetmesh::add_node(c, cut.crossing.point, sides | cut.crossing.labels, spacing));
}

// Whether the two parts of every cell around an edge that is divided at `point` are good enough.
bool may_divide(const Complex& c, const Edge& edge, const Vec3& point, double least) {
  for (const auto t : c.star(edge.first)) {
    const Cell& cell = c.cell(t);
    if (!tetmesh::has(cell, edge.second)) continue;
    for (const auto replaced : {edge.first, edge.second}) {
      const auto at = [&](std::size_t i) { return cell[i] == replaced ? point : c.at(cell[i]); };
      if (tetmesh::cell_quality(at(0), at(1), at(2), at(3)) < least) return false;
    }
  }
  return true;
}

// A sheet that an edge goes through unseen is no reason for cells that nothing can repair.
void cut_hidden_edge(Complex& c, const Cut& cut) {
  constexpr double least = 0.02;
  const auto b = cut.edge.second;
  if (is_on_feature(c, b) || (labels_of(c, b) & cut.crossing.labels) == 0) return;
  if (may_divide(c, cut.edge, cut.crossing.point, least)) cut_edge(c, cut, false);
}

// Divides edges until none crosses. Whatever is divided, only edges at new nodes can cross after that.
void cut_open(const Materials& materials, Complex& c, std::vector<Edge> edges) {
  constexpr int max_rounds = 6;
  for (int round = 0; round < max_rounds && !edges.empty(); ++round) {
    const auto first_node = node_count(c);
    for (const auto& cut : cuts_of(materials, c, edges))
      if (crosses(c, cut.edge.first, cut.edge.second)) cut_edge(c, cut, round + 1 == max_rounds);
    edges = crossing_edges_from(c, first_node);
  }
}

// Divides edges where they cross.
void cut_edges(const Materials& materials, Complex& c) {
  constexpr int max_rounds = 6;
  cut_open(materials, c, crossing_edges(c));
  const auto cut_hidden = [&](std::int64_t first_node, const auto& collect) {
    const auto next = node_count(c);
    for (const auto& cut : hidden_cuts(materials, c, first_node, collect)) cut_hidden_edge(c, cut);
    cut_open(materials, c, crossing_edges_from(c, next));
  };
  const auto is_at_surface = mark_cells(c, [&](const Cell& cell) {
    return std::any_of(cell.begin(), cell.end(), [&](std::int32_t n) { return is_on_feature(c, n); });
  });
  cut_hidden(0, [&](std::int32_t node, std::vector<std::int32_t>& others) {
    collect_edges_beside_surface(c, is_at_surface, node, others);
  });
  std::int64_t first_node = 0;
  for (int round = 0; round < max_rounds; ++round) {  // after the first one, what is left of edges that were cut
    const auto next = node_count(c);
    cut_hidden(first_node, [&](std::int32_t node, std::vector<std::int32_t>& others) {
      collect_edges_off_surface(c, node, others);
    });
    if (node_count(c) == next) break;
    first_node = next;
  }
}

void label_cells(const Materials& materials, Complex& c) {
  parallel::parallel_for(0, static_cast<std::int64_t>(c.cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const Cell& cell = c.cells[i];
      if (cell[0] < 0) continue;
      const LabelBits common = common_labels(c, cell);
      if (std::popcount(common) == 1) {
        c.label[i] = static_cast<std::uint8_t>(std::countr_zero(common));
        continue;
      }
      const int there = materials.label_at(0.25 * (c.at(cell[0]) + c.at(cell[1]) + c.at(cell[2]) + c.at(cell[3])));
      const bool fits = common == 0 || (common & tetmesh::bit_of(there)) != 0;
      c.label[i] = static_cast<std::uint8_t>(fits ? there : std::countr_zero(common));
    }
  });
  for (auto& bits : c.touches) bits &= tetmesh::side_bits | tetmesh::hull_bit;
}

// Free slots out, cells with label 0 kept.
void close_gaps(Complex& c) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < c.cells.size(); ++i) {
    if (c.cells[i][0] < 0) continue;
    c.cells[kept] = c.cells[i];
    c.label[kept++] = c.label[i];
  }
  c.cells.resize(kept);
  c.label.resize(kept);
}

}  // namespace

Complex stuff_isosurfaces(const Materials& materials, const Lattice& lattice, const StuffSettings& settings) {
  auto c = label_lattice(make_background(lattice.tree, materials.label_at, lattice.near));
  snap_to_curves(materials, c, settings);
  snap_to_surfaces(materials, c, settings);
  cut_edges(materials, c);
  label_cells(materials, c);
  close_gaps(c);
  return c;
}

Complex stuff_isosurfaces(const Materials& materials, const StuffSettings& settings) {
  return stuff_isosurfaces(materials, build_background_lattice(materials), settings);
}

}  // namespace heartgen::stuffing
