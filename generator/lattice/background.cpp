#include "generator/lattice/background.hpp"

#include <algorithm>
#include <utility>

namespace heart::lattice {
namespace {

/// A face of a leaf: its corners in cyclic order, in units of finest cells.
struct Square {
  std::array<Place, 4> corners;
  Place across;  // the finest cell beyond the first corner
  std::size_t axis;
  bool upper;
};

Place between(const Place& a, const Place& b) { return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}; }

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

struct Builder {
  const Octree* tree;
  Background result;
  std::vector<std::int32_t> corner_node;  // per corner of the finest cells, -1: none
  std::vector<bool> is_corner;            // of any leaf
  std::vector<std::int32_t> center_node;  // per leaf, at the offset of its first finest cell

  std::size_t corner_offset(const Place& at) const {
    const auto nx = static_cast<std::size_t>(tree->size[0]) + 1, ny = static_cast<std::size_t>(tree->size[1]) + 1;
    return (static_cast<std::size_t>(at[2]) * ny + static_cast<std::size_t>(at[1])) * nx +
           static_cast<std::size_t>(at[0]);
  }
  std::int32_t add_node(const std::array<double, 3>& at, double width) {
    LabelBits sides = 0;
    Vec3 position = tree->origin_mm;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      position[a] += at[axis] * tree->step_mm[a];
      if (at[axis] == 0) sides |= bit_of(first_side + 2 * a);
      if (at[axis] == tree->size[axis]) sides |= bit_of(first_side + 2 * a + 1);
    }
    result.nodes_mm.push_back(position);
    result.sides.push_back(sides);
    result.spacing_mm.push_back(static_cast<float>(width * tree->step_mm.x));
    return static_cast<std::int32_t>(result.nodes_mm.size()) - 1;
  }
  std::int32_t corner(const Place& at, std::int32_t width) {
    auto& node = corner_node[corner_offset(at)];
    if (node < 0)
      node = add_node({static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])}, width);
    auto& spacing = result.spacing_mm[static_cast<std::size_t>(node)];
    spacing = std::min(spacing, static_cast<float>(width * tree->step_mm.x));
    return node;
  }
  std::int32_t center(const Place& low, std::int32_t width) {
    auto& node = center_node[tree->offset(low)];
    if (node < 0) node = add_node({low[0] + 0.5 * width, low[1] + 0.5 * width, low[2] + 0.5 * width}, width);
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

void mark_corners(Builder& builder) {
  for (const auto& leaf : builder.tree->leaves) {
    const std::int32_t width = 1 << leaf.level;
    for (std::int32_t c = 0; c < 8; ++c)
      builder.is_corner[builder.corner_offset({leaf.low[0] + (c & 1) * width, leaf.low[1] + ((c >> 1) & 1) * width,
                                               leaf.low[2] + (c >> 2) * width})] = true;
  }
}

// Cells on the two nodes `first` and `second` and the edges of a square; an edge that a finer leaf divides gives two.
void add_around_square(Builder& b, const Square& square, std::int32_t first, std::int32_t second, std::int32_t width) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Place& from = square.corners[i];
    const Place& to = square.corners[(i + 1) % 4];
    const auto start = b.corner(from, width), end = b.corner(to, width);
    const Place middle = between(from, to);
    if (width > 1 && b.is_corner[b.corner_offset(middle)]) {
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
        Place low = leaf.low;
        low[axis] += width;
        if (upper) add_around_square(b, square, own, b.center(low, width), width);
      } else if (other > leaf.level) {
        add_half_pyramids(b, square, own, width);
      } else if (beyond) {
        std::array<double, 3> middle;
        for (std::size_t a = 0; a < 3; ++a) middle[a] = 0.5 * (square.corners[0][a] + square.corners[2][a]);
        add_around_square(b, square, own, b.add_node(middle, width), width);
      } else {
        add_around_square(b, square, own, b.corner(between(square.corners[0], square.corners[2]), width / 2), width);
      }
    }
}

}  // namespace

Background make_background(const Octree& tree) {
  Builder builder{&tree, {}, {}, {}, std::vector<std::int32_t>(tree.level.size(), -1)};
  const auto corners = builder.corner_offset({0, 0, tree.size[2] + 1});
  builder.corner_node.assign(corners, -1);
  builder.is_corner.assign(corners, false);
  mark_corners(builder);
  // Memory that is asked for but not written costs nothing; growing vectors would hold two copies.
  constexpr std::size_t most_cells_per_leaf = 16, most_nodes_per_leaf = 3;
  builder.result.cells.reserve(most_cells_per_leaf * tree.leaves.size());
  builder.result.nodes_mm.reserve(most_nodes_per_leaf * tree.leaves.size());
  for (const auto& leaf : tree.leaves) add_leaf(builder, leaf);
  return std::move(builder.result);
}

}  // namespace heart::lattice
