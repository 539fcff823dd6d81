// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/lattice_cells.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "generator/parallel/threads.hpp"

namespace heartgen::stuffing {
namespace {

/// A face of a leaf: its corners in cyclic order, in units of finest cells.
struct Square {
  std::array<TreeIndex, 4> corners;
  TreeIndex across;  // the finest cell beyond the first corner
  std::size_t axis;
  bool upper;
};

TreeIndex between(const TreeIndex& a, const TreeIndex& b) {
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

Square square_of(const Leaf& leaf, std::size_t axis, bool upper) {
  const std::int32_t width = 1 << leaf.level;
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  Square square{{}, leaf.low, axis, upper};
  for (std::size_t corner = 0; corner < 4; ++corner) {
    auto& place = square.corners[corner];
    place = leaf.low;
    if (upper) place[axis] += width;
    if (corner == 1 || corner == 2) place[u] += width;
    if (corner >= 2) place[v] += width;
  }
  square.across[axis] += upper ? width : -1;
  return square;
}

constexpr std::int64_t no_slot = std::numeric_limits<std::int64_t>::max();

/// Makes the cells of some leaves.
struct Builder {
  const Octree* tree;
  const NearLeaves* near;  // null: everything is
  const std::function<int(const Vec3&)>* label_at;
  Background result;
  std::vector<std::int32_t> corner_node;  // per corner of the finest cells, -1: none
  std::vector<std::int32_t> center_node;  // per leaf, at the offset of its first finest cell
  std::vector<std::int64_t> slot;         // per node: offset in corner_node, -1 - offset in center_node, or `no_slot`

  bool is_near(const TreeIndex& finest_cell) const { return near == nullptr || near->contains(*tree, finest_cell); }

  std::int32_t add_node(const std::array<double, 3>& at, double width, std::int64_t in_slot) {
    tetmesh::LabelBits sides = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      if (at[axis] == 0) sides |= tetmesh::bit_of(tetmesh::first_side + 2 * a);
      if (at[axis] == tree->size[axis]) sides |= tetmesh::bit_of(tetmesh::first_side + 2 * a + 1);
    }
    result.nodes_mm.push_back(tree->position_mm(at));
    result.sides.push_back(sides);
    slot.push_back(in_slot);
    result.spacing_mm.push_back(static_cast<float>(width * tree->step_mm.x));
    return static_cast<std::int32_t>(result.nodes_mm.size()) - 1;
  }
  void describe(std::uint8_t label, bool lacks_cells) {
    result.label.push_back(label);
    result.lacks_cells.push_back(lacks_cells ? 1 : 0);
  }
  std::int32_t corner(const TreeIndex& at, std::int32_t width) {
    auto& node = corner_node[tree->corner_offset(at)];
    if (node < 0) {
      node = add_node({static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])}, width,
                      static_cast<std::int64_t>(tree->corner_offset(at)));
      if (near != nullptr) describe(near->corner_label[tree->corner_offset(at)], touches_far_leaf(at));
    }
    auto& spacing = result.spacing_mm[static_cast<std::size_t>(node)];
    spacing = std::min(spacing, static_cast<float>(width * tree->step_mm.x));
    return node;
  }
  bool touches_far_leaf(const TreeIndex& corner) const {
    for (std::int32_t cell = 0; cell < 8; ++cell) {
      const TreeIndex beside{corner[0] - (cell & 1), corner[1] - ((cell >> 1) & 1), corner[2] - (cell >> 2)};
      if (tree->contains(beside) && !is_near(beside)) return true;
    }
    return false;
  }
  std::int32_t center(const TreeIndex& low, std::int32_t width) {
    auto& node = center_node[tree->offset(low)];
    if (node >= 0) return node;
    node = add_node({low[0] + 0.5 * width, low[1] + 0.5 * width, low[2] + 0.5 * width}, width,
                    -1 - static_cast<std::int64_t>(tree->offset(low)));
    if (near != nullptr) describe(near->center_label[tree->offset(low)], is_beside_far_leaf(low, width));
    return node;
  }
  // Only with leaves of the same size does a centre share cells.
  bool is_beside_far_leaf(const TreeIndex& low, std::int32_t width) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const std::int32_t step : {-1, width}) {
        TreeIndex beside = low;
        beside[axis] += step;
        if (!tree->contains(beside) || is_near(beside)) continue;
        if (1 << tree->level[tree->offset(beside)] == width) return true;
      }
    return false;
  }
  std::int32_t middle_of_side(const std::array<double, 3>& at, double width) {
    const auto node = add_node(at, width, no_slot);
    if (near != nullptr) describe(static_cast<std::uint8_t>((*label_at)(result.nodes_mm.back())), false);
    return node;
  }
  void add_cell(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    const auto& p = result.nodes_mm;
    const Vec3 origin = p[static_cast<std::size_t>(a)];
    const auto edge = [&](std::int32_t n) { return p[static_cast<std::size_t>(n)] - origin; };
    if (dot(edge(b), cross(edge(c), edge(d))) < 0) std::swap(c, d);
    result.cells.push_back({a, b, c, d});
  }
};

// Cells on the two nodes `first` and `second` and the edges of a square; an edge that a finer leaf divides gives two.
void add_around_square(Builder& b, const Square& square, std::int32_t first, std::int32_t second, std::int32_t width) {
  for (std::size_t i = 0; i < 4; ++i) {
    const TreeIndex& from = square.corners[i];
    const TreeIndex& to = square.corners[(i + 1) % 4];
    const auto start = b.corner(from, width), end = b.corner(to, width);
    const TreeIndex middle = between(from, to);
    if (width > 1 && is_leaf_corner(*b.tree, middle)) {
      const auto half = b.corner(middle, width / 2);
      b.add_cell(first, second, start, half);
      b.add_cell(first, second, half, end);
    } else {
      b.add_cell(first, second, start, end);
    }
  }
}

// Against a leaf twice as large, the pyramid on a square is halved along the diagonal from the large face's centre.
void add_half_pyramids(Builder& b, const Square& square, std::int32_t center, std::int32_t width) {
  std::array<std::int32_t, 4> nodes;
  std::size_t on_center = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    nodes[i] = b.corner(square.corners[i], width);
    bool central = true;
    for (std::size_t axis = 0; axis < 3; ++axis)
      central = central && (axis == square.axis || (square.corners[i][axis] / width) % 2 == 1);
    if (central) on_center = i;
  }
  const auto at = [&](std::size_t i) { return nodes[(on_center + i) % 4]; };
  b.add_cell(center, at(0), at(1), at(2));
  b.add_cell(center, at(0), at(2), at(3));
}

void add_leaf(Builder& b, const Leaf& leaf) {
  const std::int32_t width = 1 << leaf.level;
  const auto own = b.center(leaf.low, width);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      const Square square = square_of(leaf, axis, upper);
      const bool beyond = square.across[axis] < 0 || square.across[axis] >= b.tree->size[axis];
      const int other = beyond ? -1 : b.tree->level[b.tree->offset(square.across)];
      if (other == leaf.level) {
        TreeIndex low = leaf.low;
        low[axis] += width;
        if (upper && b.is_near(low)) add_around_square(b, square, own, b.center(low, width), width);
      } else if (other > leaf.level) {
        add_half_pyramids(b, square, own, width);
      } else if (beyond) {
        std::array<double, 3> middle;
        for (std::size_t a = 0; a < 3; ++a) middle[a] = 0.5 * (square.corners[0][a] + square.corners[2][a]);
        add_around_square(b, square, own, b.middle_of_side(middle, width), width);
      } else {
        add_around_square(b, square, own, b.corner(between(square.corners[0], square.corners[2]), width / 2), width);
      }
    }
}

// As if the builder had gone on with the leaves of the other one.
void join(Builder& builder, Builder other) {
  auto &to = builder.result, &from = other.result;
  std::vector<std::int32_t> id(from.nodes_mm.size());
  for (std::size_t n = 0; n < id.size(); ++n) {
    const auto slot = other.slot[n];
    std::int32_t own = -1;
    auto& known = slot == no_slot ? own
                  : slot >= 0     ? builder.corner_node[static_cast<std::size_t>(slot)]
                                  : builder.center_node[static_cast<std::size_t>(-1 - slot)];
    if (known < 0) {
      known = static_cast<std::int32_t>(to.nodes_mm.size());
      to.nodes_mm.push_back(from.nodes_mm[n]);
      to.spacing_mm.push_back(from.spacing_mm[n]);
      to.sides.push_back(from.sides[n]);
      if (!from.label.empty()) builder.describe(from.label[n], from.lacks_cells[n] != 0);
    }
    auto& spacing = to.spacing_mm[static_cast<std::size_t>(known)];
    spacing = std::min(spacing, from.spacing_mm[n]);
    id[n] = known;
  }
  const auto before = to.cells.size();
  to.cells.resize(before + from.cells.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(from.cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c)
      for (std::size_t i = 0; i < 4; ++i) to.cells[before + c][i] = id[static_cast<std::size_t>(from.cells[c][i])];
  });
}

Background build(const Builder& start) {
  const Octree& tree = *start.tree;
  std::vector<Leaf> wanted;
  std::copy_if(tree.leaves.begin(), tree.leaves.end(), std::back_inserter(wanted),
               [&](const Leaf& leaf) { return start.is_near(leaf.low); });
  // Memory that is asked for but not written costs nothing; growing vectors would hold two copies.
  constexpr std::size_t max_cells_per_leaf = 16, max_nodes_per_leaf = 3;
  std::vector<Builder> builders(static_cast<std::size_t>(parallel::thread_count()), start);
  parallel::parallel_for(0, static_cast<std::int64_t>(wanted.size()),
                         [&](std::int64_t begin, std::int64_t end, int piece) {
                           auto& builder = builders[static_cast<std::size_t>(piece)];
                           // The first one will hold what the others make.
                           const auto leaves = piece == 0 ? wanted.size() : static_cast<std::size_t>(end - begin);
                           builder.result.cells.reserve(max_cells_per_leaf * leaves);
                           builder.result.nodes_mm.reserve(max_nodes_per_leaf * leaves);
                           builder.center_node.assign(tree.level.size(), -1);
                           builder.corner_node.assign(tree.corner_offset({0, 0, tree.size[2] + 1}), -1);
                           for (auto l = begin; l < end; ++l) add_leaf(builder, wanted[static_cast<std::size_t>(l)]);
                         });
  for (std::size_t piece = 1; piece < builders.size(); ++piece) join(builders[0], std::move(builders[piece]));
  return std::move(builders[0].result);
}

}  // namespace

Background make_background(const Octree& tree) { return build({&tree, nullptr, nullptr, {}, {}, {}, {}}); }

Background make_background(const Octree& tree, const std::function<int(const Vec3&)>& label_at,
                           const NearLeaves& near) {
  return build({&tree, &near, &label_at, {}, {}, {}, {}});
}

}  // namespace heartgen::stuffing
