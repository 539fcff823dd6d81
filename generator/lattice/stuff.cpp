#include "generator/lattice/stuff.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "generator/lattice/background.hpp"
#include "generator/lattice/feature.hpp"
#include "generator/lattice/quality.hpp"
#include "generator/parallel/threads.hpp"
#include "model/sort_unique.hpp"

namespace heart::lattice {
namespace {

using Edge = std::pair<std::int32_t, std::int32_t>;

constexpr int halvings = 8;  // of an edge to find where it crosses: 1/256 of its length

double finest_edge(const Materials& m) {
  if (m.finest_edge_mm > 0) return m.finest_edge_mm;
  // The size field varies slowly: its samples at a sixty-fourth of the box miss little.
  constexpr int samples = 64;
  std::array<double, samples> finest;
  const Vec3 box = m.box_max_mm - m.box_min_mm;
  parallel::parallel_for(0, samples, [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k) {
      double least = m.edge_mm(m.box_min_mm);
      for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
          const Vec3 share{(i + 0.5) / samples, (j + 0.5) / samples, (static_cast<double>(k) + 0.5) / samples};
          least = std::min(least, m.edge_mm(m.box_min_mm + Vec3{share.x * box.x, share.y * box.y, share.z * box.z}));
        }
      finest[static_cast<std::size_t>(k)] = least;
    }
  });
  return *std::min_element(finest.begin(), finest.end());
}

// Labels of the nodes as `touches`. Cells all of whose nodes are outside are left out, but for those around the nodes
// of the others: what the outside looks like around a node is seen only where all its cells are there.
Complex label_lattice(const Materials& materials, Background background) {
  Complex c;
  c.nodes_mm = std::move(background.nodes_mm);
  c.spacing_mm = std::move(background.spacing_mm);
  c.touches = std::move(background.sides);
  parallel::parallel_for(0, static_cast<std::int64_t>(c.nodes_mm.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      c.touches[n] |= bit_of(materials.label_at(c.nodes_mm[n]));
  });
  std::vector<std::uint8_t> is_near(c.nodes_mm.size(), 0);
  for (const auto& cell : background.cells)
    if (std::any_of(cell.begin(), cell.end(), [&](std::int32_t n) { return (c.bits(n) & bit_of(0)) == 0; }))
      for (const auto n : cell) is_near[static_cast<std::size_t>(n)] = 1;
  const auto is_left_out = [&](const Cell& cell) {
    return std::none_of(cell.begin(), cell.end(),
                        [&](std::int32_t n) { return is_near[static_cast<std::size_t>(n)] != 0; });
  };
  for (const auto& cell : background.cells)
    if (is_left_out(cell))
      for (const auto n : cell) c.touches[static_cast<std::size_t>(n)] |= hull_bit;
  std::erase_if(background.cells, is_left_out);
  c.cells = background.cells;  // as long as it is: the lattice of the whole box is far longer
  std::vector<Cell>().swap(background.cells);
  c.label.assign(c.cells.size(), 1);  // not yet known; 0 would be dropped
  compress(c);
  return c;
}

constexpr LabelBits label_bits = ~(side_bits | hull_bit);

LabelBits labels_of(const Complex& c, std::int32_t node) { return c.bits(node) & label_bits; }
bool crosses(const Complex& c, std::int32_t a, std::int32_t b) { return (labels_of(c, a) & labels_of(c, b)) == 0; }

LabelBits common_labels(const Complex& c, const Cell& cell) {
  return labels_of(c, cell[0]) & labels_of(c, cell[1]) & labels_of(c, cell[2]) & labels_of(c, cell[3]);
}

std::vector<Edge> crossing_edges(const Complex& c) {
  std::vector<Edge> edges;
  for (const auto& cell : c.cells) {
    if (cell[0] < 0 || common_labels(c, cell) != 0) continue;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (crosses(c, cell[i], cell[j])) edges.push_back(std::minmax(cell[i], cell[j]));
  }
  sort_unique(edges);
  return edges;
}

/// Where an edge leaves the labels of its first node.
struct Crossing {
  double share = 0;      ///< of the edge, from the first node
  LabelBits labels = 0;  ///< on the two sides
};

Crossing find_crossing(const Materials& materials, const Complex& c, const Edge& edge) {
  const LabelBits own = labels_of(c, edge.first);
  const Vec3 start = c.at(edge.first), way = c.at(edge.second) - start;
  double low = 0, high = 1;
  LabelBits before = 0, after = 0;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    const LabelBits label = bit_of(materials.label_at(start + middle * way));
    const bool inside = (label & own) != 0;
    (inside ? low : high) = middle;
    (inside ? before : after) = label;
  }
  const auto any = [](LabelBits bits) { return bits & (~bits + 1); };
  if (before == 0) before = any(own);
  if (after == 0) after = any(labels_of(c, edge.second));
  return {0.5 * (low + high), before | after};
}

std::vector<Crossing> find_crossings(const Materials& materials, const Complex& c, const std::vector<Edge>& edges) {
  std::vector<Crossing> crossings(edges.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(edges.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e)
      crossings[e] = find_crossing(materials, c, edges[e]);
  });
  return crossings;
}

// Moves a node where no cell around it becomes worse than `least` or, if it is that bad already, than it is.
bool try_move(Complex& c, std::int32_t node, const Vec3& target, double least) {
  auto& position = c.nodes_mm[static_cast<std::size_t>(node)];
  const Vec3 old = position;
  const double bound = std::min(least, worst_quality(c, c.star(node)));
  position = target;
  const auto star = c.star(node);
  if (std::any_of(star.begin(), star.end(), [&](std::int32_t t) { return quality(c, c.cell(t)) < bound; })) {
    position = old;
    return false;
  }
  for (const auto t : star) update_quality(c, t);
  return true;
}

/// A node that could move onto a feature; nearest first.
struct Snap {
  double distance;  ///< relative
  std::int32_t node;
  LabelBits labels;  ///< that the node would touch
  Vec3 target;
  Edge edge;              ///< that crosses, or
  Face face{-1, -1, -1};  ///< the face through which the curve goes
  bool operator<(const Snap& other) const {
    if (distance != other.distance) return distance < other.distance;
    if (node != other.node) return node < other.node;
    return std::tie(edge, face) < std::tie(other.edge, other.face);
  }
};

// Faces whose nodes have three different labels: a curve goes through them.
std::vector<Face> pierced_faces(const Complex& c) {
  std::vector<Face> faces;
  for (const auto& cell : c.cells) {
    if (common_labels(c, cell) != 0) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      Face face{cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]};
      if (!crosses(c, face[0], face[1]) || !crosses(c, face[1], face[2]) || !crosses(c, face[0], face[2])) continue;
      std::sort(face.begin(), face.end());
      faces.push_back(face);
    }
  }
  sort_unique(faces);
  return faces;
}

std::vector<Snap> curve_snaps(const Materials& materials, const Complex& c, const std::vector<Face>& faces,
                              double reach) {
  constexpr int newton_steps = 6;
  std::vector<std::array<Snap, 3>> found(faces.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(faces.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      const Face& face = faces[f];
      const LabelBits labels = labels_of(c, face[0]) | labels_of(c, face[1]) | labels_of(c, face[2]);
      const Vec3 center = (c.at(face[0]) + c.at(face[1]) + c.at(face[2])) / 3;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto node = face[i];
        const Vec3 start = 0.5 * (center + c.at(node));
        const Vec3 target = project(materials, (c.bits(node) & side_bits) | labels, start, newton_steps);
        const double spacing = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(node)]);
        const auto feature = feature_at(materials, labels, target);
        const bool is_on = distance_to(feature) < 0.02 * spacing && norm(target - center) < spacing;
        const double distance = is_on ? norm(target - c.at(node)) / spacing : 9;
        found[f][i] = {distance, node, labels, target, {-1, -1}, face};
      }
    }
  });
  std::vector<Snap> snaps;
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
    if (is_open && try_move(c, snap.node, snap.target, settings.least_quality))
      c.touches[static_cast<std::size_t>(snap.node)] |= snap.labels;
  }
}

std::vector<Snap> surface_snaps(const Materials& materials, const Complex& c, double reach) {
  const auto edges = crossing_edges(c);
  const auto crossings = find_crossings(materials, c, edges);
  std::vector<Snap> snaps;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [a, b] = edges[e];
    const auto& crossing = crossings[e];
    for (const bool from_first : {true, false}) {
      const double share = from_first ? crossing.share : 1 - crossing.share;
      const auto node = from_first ? a : b;
      if (share > reach || std::popcount(labels_of(c, node)) > 1) continue;
      if ((crossing.labels & labels_of(c, node)) == 0) continue;  // a third material lies between
      const Vec3 target = c.at(a) + crossing.share * (c.at(b) - c.at(a));
      snaps.push_back(
          {share * norm(c.at(b) - c.at(a)) / static_cast<double>(c.spacing_mm[static_cast<std::size_t>(node)]), node,
           crossing.labels, target, edges[e]});
    }
  }
  std::sort(snaps.begin(), snaps.end());
  return snaps;
}

void snap_to_surfaces(const Materials& materials, Complex& c, const StuffSettings& settings) {
  for (const auto& snap : surface_snaps(materials, c, settings.edge_reach)) {
    if (std::popcount(labels_of(c, snap.node)) > 1 || !crosses(c, snap.edge.first, snap.edge.second)) continue;
    const LabelBits sides = c.bits(snap.node) & side_bits;
    const Vec3 target = project(materials, sides | snap.labels, snap.target, 2);
    if (norm(target - snap.target) > 0.25 * static_cast<double>(c.spacing_mm[static_cast<std::size_t>(snap.node)]))
      continue;
    if (try_move(c, snap.node, target, settings.least_quality))
      c.touches[static_cast<std::size_t>(snap.node)] |= snap.labels;
  }
}

void divide_edge(Complex& c, const Edge& edge, std::int32_t middle) {
  std::vector<std::int32_t> ring;
  for (const auto t : c.star(edge.first))
    if (has(c.cell(t), edge.second)) ring.push_back(t);
  for (const auto t : ring) {
    const Cell old = c.cell(t);
    remove_cell(c, t);
    for (const auto replaced : {edge.first, edge.second}) {
      Cell made = old;
      std::replace(made.begin(), made.end(), replaced, middle);
      add_cell(c, made, 1);
    }
  }
}

/// An edge to divide, and where.
struct Cut {
  Edge edge;
  Crossing crossing;
};

std::vector<Cut> open_cuts(const Materials& materials, const Complex& c) {
  const auto edges = crossing_edges(c);
  const auto crossings = find_crossings(materials, c, edges);
  std::vector<Cut> cuts;
  cuts.reserve(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) cuts.push_back({edges[e], crossings[e]});
  return cuts;
}

// Edges from a node on a surface to one that has no label but one of its own, in the star of the first.
void collect_edges_off_surface(const Complex& c, std::int32_t node, std::vector<Edge>& edges) {
  edges.clear();
  if (std::popcount(labels_of(c, node)) < 2) return;
  for (const auto t : c.star(node))
    for (const auto other : c.cell(t))
      if (std::popcount(labels_of(c, other)) == 1 && !crosses(c, node, other)) edges.emplace_back(node, other);
  sort_unique(edges);
}

// Edges between nodes of the same label in the cells around a node on a surface; others may see them again.
void collect_edges_beside_surface(const Complex& c, std::int32_t node, std::vector<Edge>& edges) {
  edges.clear();
  if (std::popcount(labels_of(c, node)) < 2) return;
  for (const auto t : c.star(node)) {
    const Cell& cell = c.cell(t);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (std::popcount(labels_of(c, cell[i])) == 1 && labels_of(c, cell[i]) == labels_of(c, cell[j]))
          edges.push_back(std::minmax(cell[i], cell[j]));
  }
  sort_unique(edges);
}

// Where an edge whose ends have a label in common leaves a sheet of another material that it goes through; no labels
// where there is none. No label tells such an edge from others.
Crossing find_hidden_crossing(const Materials& materials, const Complex& c, const Edge& edge) {
  constexpr std::array sampled{0.5, 0.25};  // of the edge
  constexpr double least_depth = 0.1;       // of the lattice's width: the surface may be a little curved
  const Vec3 start = c.at(edge.first), way = c.at(edge.second) - start;
  const LabelBits own = labels_of(c, edge.second);
  const double spacing = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(edge.first)]);
  for (const double share : sampled) {
    const Vec3 sample = start + share * way;
    const LabelBits between = bit_of(materials.label_at(sample));
    if (between == own || distance_to(feature_at(materials, between | own, sample)) < least_depth * spacing) continue;
    double low = share, high = 1;
    LabelBits after = own;
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (low + high);
      const LabelBits label = bit_of(materials.label_at(start + middle * way));
      (label == between ? low : high) = middle;
      if (label != between) after = label;
    }
    return {0.5 * (low + high), between | after};
  }
  return {};
}

// Of the edges that `collect` finds at the nodes from `first_node` on.
std::vector<Cut> hidden_cuts(const Materials& materials, const Complex& c, std::size_t first_node,
                             void (*collect)(const Complex&, std::int32_t, std::vector<Edge>&)) {
  std::vector<std::vector<Cut>> of_piece(static_cast<std::size_t>(parallel::thread_count()));
  const auto find = [&](std::int64_t begin, std::int64_t end, int piece) {
    std::vector<Edge> edges;
    for (auto node = begin; node < end; ++node) {
      collect(c, static_cast<std::int32_t>(node), edges);
      for (const auto& edge : edges) {
        const auto crossing = find_hidden_crossing(materials, c, edge);
        if (crossing.labels != 0) of_piece[static_cast<std::size_t>(piece)].push_back({edge, crossing});
      }
    }
  };
  parallel::parallel_for(static_cast<std::int64_t>(first_node), static_cast<std::int64_t>(c.nodes_mm.size()), find);
  std::vector<Cut> cuts;
  for (const auto& piece : of_piece) cuts.insert(cuts.end(), piece.begin(), piece.end());
  std::sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.edge < b.edge; });
  cuts.erase(std::unique(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.edge == b.edge; }),
             cuts.end());
  return cuts;
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
  const LabelBits sides = c.bits(a) & c.bits(b) & side_bits;
  const Vec3 point = c.at(a) + share * (c.at(b) - c.at(a));
  const float spacing = std::min(c.spacing_mm[static_cast<std::size_t>(a)], c.spacing_mm[static_cast<std::size_t>(b)]);
  divide_edge(c, cut.edge, add_node(c, point, sides | cut.crossing.labels, spacing));
}

// Whether the two parts of every cell around an edge that is divided at `point` are good enough.
bool may_divide(const Complex& c, const Edge& edge, const Vec3& point, double least) {
  for (const auto t : c.star(edge.first)) {
    const Cell& cell = c.cell(t);
    if (!has(cell, edge.second)) continue;
    for (const auto replaced : {edge.first, edge.second}) {
      const auto at = [&](std::size_t i) { return cell[i] == replaced ? point : c.at(cell[i]); };
      if (cell_quality(at(0), at(1), at(2), at(3)) < least) return false;
    }
  }
  return true;
}

// A sheet that an edge goes through unseen is no reason for cells that nothing can repair.
void cut_hidden_edge(Complex& c, const Cut& cut) {
  constexpr double least = 0.02;
  const auto [a, b] = cut.edge;
  if (std::popcount(labels_of(c, b)) != 1 || (labels_of(c, b) & cut.crossing.labels) == 0) return;
  if (may_divide(c, cut.edge, c.at(a) + cut.crossing.share * (c.at(b) - c.at(a)), least)) cut_edge(c, cut, false);
}

// Divides edges where they cross.
void cut_edges(const Materials& materials, Complex& c) {
  constexpr int most_rounds = 6;
  const auto cut_open = [&] {
    for (int round = 0; round < most_rounds; ++round) {
      const auto cuts = open_cuts(materials, c);
      if (cuts.empty()) return;
      for (const auto& cut : cuts)
        if (crosses(c, cut.edge.first, cut.edge.second)) cut_edge(c, cut, round + 1 == most_rounds);
    }
  };
  cut_open();
  const auto cut_hidden = [&](std::size_t first_node, auto* collect) {
    const auto cuts = hidden_cuts(materials, c, first_node, collect);
    for (const auto& cut : cuts) cut_hidden_edge(c, cut);
    cut_open();
  };
  cut_hidden(0, collect_edges_beside_surface);
  std::size_t first_node = 0;
  for (int round = 0; round < most_rounds; ++round) {  // after the first one, what is left of edges that were cut
    const auto next = c.nodes_mm.size();
    cut_hidden(first_node, collect_edges_off_surface);
    if (c.nodes_mm.size() == next) break;
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
      const bool fits = common == 0 || (common & bit_of(there)) != 0;
      c.label[i] = static_cast<std::uint8_t>(fits ? there : std::countr_zero(common));
    }
  });
  for (auto& bits : c.touches) bits &= side_bits | hull_bit;
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
  connect(c);
}

}  // namespace

Complex stuff(const Materials& materials, const StuffSettings& settings) {
  const auto tree = make_octree(materials.box_min_mm, materials.box_max_mm, finest_edge(materials), materials.edge_mm);
  auto c = label_lattice(materials, make_background(tree));
  snap_to_curves(materials, c, settings);
  snap_to_surfaces(materials, c, settings);
  cut_edges(materials, c);
  label_cells(materials, c);
  close_gaps(c);
  return c;
}

}  // namespace heart::lattice
